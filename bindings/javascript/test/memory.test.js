// Nothing leaks: the bytes in use come back exactly, and the memory of the
// module stays flat.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { setFlagsFromString } from 'node:v8';
import { runInNewContext } from 'node:vm';
import { setTimeout as wait } from 'node:timers/promises';
import { load } from '../lib/index.js';
import { pretzel, torus } from '../examples/shapes.js';
import { smallTorus } from './meshes.js';

let hmf;
before(async () => { hmf = await load(); });

/** Runs work often; what the first runs set up does not count. */
function flat(times, work) {
    for (let i = 0; i < 3; ++i) work();
    const { inUse, size } = hmf.memory;
    for (let i = 0; i < times; ++i) work();
    assert.deepEqual(hmf.memory, { inUse, size });
}

test('a thousand failing calls of each kind', () => {
    const { positions, triangles } = pretzel(1, 2);
    const turned = triangles.slice();
    [turned[0], turned[1]] = [turned[1], turned[0]];
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    const loops = hierarchy.loops(), foliation = hierarchy.solve(), bad = foliation.values.map((x, i) => (i === 7 ? -1 : x));
    flat(1000, () => assert.throws(() => new hmf.Hierarchy(positions, turned)));
    flat(1000, () => assert.throws(() => new hmf.Hierarchy(positions, triangles, { memoryLimit: 100000 })));
    flat(1000, () => assert.throws(() => new hmf.Hierarchy(positions, triangles, { progress: () => { throw new Error('no'); } })));
    flat(1000, () => assert.throws(() => new hmf.Hierarchy(positions, triangles, { ratio: null })));
    flat(1000, () => assert.throws(() => hierarchy.solve({ loops: { ...loops, weights: [NaN] } })));
    flat(1000, () => assert.throws(() => hierarchy.solve({ progress: () => 'cancel' })));
    flat(1000, () => assert.throws(() => hierarchy.solve({ progress: () => { throw new Error('no'); } })));
    flat(1000, () => assert.throws(() => hierarchy.solve({ loops: { elementKind: 'vertices', loops: [[0, 1], [2, 'x']] } })));
    flat(1000, () => assert.throws(() => hierarchy.foliation(bad)));
    flat(1000, () => assert.throws(() => foliation.trace({ through: { triangles: [0], barycentrics: [2, 0, 0] } })));
    flat(1000, () => assert.throws(() => foliation.cylinders({ progress: () => 'cancel' })));
    // When the foliation is there already.
    flat(100, () => assert.throws(() => hierarchy.solve({ progress: fraction => { if (fraction === 1) throw new Error('no'); } })));
    hierarchy.dispose();
    assert.equal(hmf.memory.inUse, 0);
});

test('many good calls', () => {
    const { positions, triangles } = smallTorus();
    const lasting = new hmf.Hierarchy(positions, triangles), { values } = lasting.solve();
    flat(200, () => {
        const foliation = lasting.foliation(values), again = lasting.solve({ start: foliation });
        foliation.dispose();
        again.relax().dispose();
        again.dispose();
    });
    lasting.dispose();
    flat(200, () => {
        hmf.suggestMarks(positions, triangles);
        hmf.solveComponents(positions, triangles);
        const hierarchy = new hmf.Hierarchy(positions, triangles);
        const foliation = hierarchy.solve();
        foliation.singularities();
        foliation.cylinders();
        foliation.trace({ spacing: 0.1 });
        foliation.parameterize();
        foliation.relax().interpolate(0).residuals();
        hierarchy.initialize(hierarchy.loops());
        hierarchy.dispose();
    });
    assert.equal(hmf.memory.inUse, 0);
});

test('every build that meets a limit of memory gives all of it back', () => {
    const { positions, triangles } = pretzel(2, 2);
    const full = hmf.memoryEstimate(positions.length / 3, triangles.length / 3, { coarsest: 100 });
    let failures = 0;
    for (let limit = 1000; limit < full; limit = Math.ceil(limit * 1.05)) {
        try {
            const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100, memoryLimit: limit });
            try { hierarchy.solve(); } finally { hierarchy.dispose(); }
        } catch (error) {
            assert.equal(error.statusName, 'HMF_ERROR_MEMORY_LIMIT');
            ++failures;
        }
        assert.equal(hmf.memory.inUse, 0);
    }
    assert.ok(failures > 50);
});

test('results stay valid while the memory grows', async () => {
    const library = await load(), { positions, triangles } = torus(24, 16);
    const hierarchy = new library.Hierarchy(positions, triangles), foliation = hierarchy.solve(), before = foliation.values.slice();
    const size = library.memory.size, big = torus(300, 200);
    const other = new library.Hierarchy(big.positions, big.triangles);
    assert.ok(library.memory.size > size, 'it has grown');
    assert.deepEqual(foliation.values, before);
    assert.deepEqual(hierarchy.solve().values, before);
    hierarchy.dispose();
    other.dispose();
});

test('the end of the memory is an HmfError, and the library goes on', async () => {
    const library = await load(), { positions, triangles } = smallTorus();
    const hierarchy = new library.Hierarchy(positions, triangles), { inUse } = library.memory;
    const refused = work => {
        assert.throws(work, error => error.statusName === 'HMF_ERROR_MEMORY' && /dispose/.test(error.advice));
        assert.equal(library.memory.inUse, inUse);
    };
    // 4.8 GB of zeros that nobody touches.
    refused(() => new library.Hierarchy(positions, new Uint32Array(1.2e9)));
    assert.equal(hierarchy.solve().report.status, 'HMF_OK');
    hierarchy.dispose();
});

test('forgotten foliations and hierarchies are freed', async () => {
    setFlagsFromString('--expose-gc');
    const collect = runInNewContext('gc');
    const library = await load(), { positions, triangles } = smallTorus();
    const hierarchy = new library.Hierarchy(positions, triangles), { inUse } = library.memory;
    const freed = async expected => {
        for (let i = 0; i < 100 && library.memory.inUse > expected; ++i) {
            collect();
            await wait(10);
        }
        assert.equal(library.memory.inUse, expected);
    };
    (() => { for (let i = 0; i < 10; ++i) hierarchy.solve(); })();
    assert.ok(library.memory.inUse > inUse);
    await freed(inUse);
    hierarchy.dispose();
    (() => { for (let i = 0; i < 10; ++i) new library.Hierarchy(positions, triangles).solve(); })();
    assert.ok(library.memory.inUse > 0);
    await freed(0);
});
