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
    const hole = triangles.slice(0, -3);
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    const loops = hierarchy.loops(), bad = hierarchy.foliation(hierarchy.solve().values.map((x, i) => (i === 7 ? -1 : x)));
    flat(1000, () => assert.throws(() => new hmf.Hierarchy(positions, hole)));
    flat(1000, () => assert.throws(() => new hmf.Hierarchy(positions, triangles, { memoryLimit: 100000 })));
    flat(1000, () => assert.throws(() => new hmf.Hierarchy(positions, triangles, { progress: () => { throw new Error('no'); } })));
    flat(1000, () => assert.throws(() => new hmf.Hierarchy(positions, triangles, { ratio: null })));
    flat(1000, () => assert.throws(() => hierarchy.solve({ loops: { ...loops, weights: [NaN] } })));
    flat(1000, () => assert.throws(() => hierarchy.solve({ progress: () => 'cancel' })));
    flat(1000, () => assert.throws(() => hierarchy.solve({ progress: () => { throw new Error('no'); } })));
    flat(1000, () => assert.throws(() => hierarchy.solve({ loops: { elementKind: 'vertices', loops: [[0, 1], [2, 'x']] } })));
    flat(1000, () => assert.throws(() => bad.energy()));
    flat(1000, () => assert.throws(() => bad.relax()));
    hierarchy.dispose();
    assert.equal(hmf.memory.inUse, 0);
});

test('many good calls', () => {
    const { positions, triangles } = smallTorus();
    flat(200, () => {
        const hierarchy = new hmf.Hierarchy(positions, triangles);
        const foliation = hierarchy.solve();
        foliation.singularities();
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
    // 32 bytes each: a little below and a little above 4 GiB.
    refused(() => hierarchy.solve({ historyCapacity: 134217000 }));
    refused(() => hierarchy.solve({ historyCapacity: 134217729 }));
    // 4.8 GB of zeros that nobody touches.
    refused(() => new library.Hierarchy(positions, new Uint32Array(1.2e9)));
    assert.equal(hierarchy.solve().report.status, 'HMF_OK');
    hierarchy.dispose();
});

test('a forgotten hierarchy is freed', async () => {
    setFlagsFromString('--expose-gc');
    const collect = runInNewContext('gc');
    const library = await load(), { positions, triangles } = smallTorus();
    (() => { for (let i = 0; i < 10; ++i) new library.Hierarchy(positions, triangles).solve(); })();
    assert.ok(library.memory.inUse > 0);
    for (let i = 0; i < 100 && library.memory.inUse > 0; ++i) {
        collect();
        await wait(10);
    }
    assert.equal(library.memory.inUse, 0);
});
