// Every refusal: of the library (HmfError), of the binding (TypeError), of a
// callback, and what a trap leaves behind.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { HmfError, load } from '../lib/index.js';
import { pretzel, torus } from '../examples/shapes.js';
import { octahedron, smallTorus, twoTori } from './meshes.js';

let hmf;
before(async () => { hmf = await load(); });

function refused(work, status, element) {
    let caught;
    try { work(); } catch (error) { caught = error; }
    assert.ok(caught instanceof HmfError, `an HmfError, not ${caught}`);
    assert.ok(caught instanceof Error);
    assert.equal(caught.name, 'HmfError');
    assert.equal(caught.statusName, status);
    assert.equal(caught.element, element);
    assert.equal(typeof caught.index, 'number');
    assert.ok(caught.advice.length > 20 && caught.message.endsWith(caught.advice));
    assert.equal(caught.message, `${hmf.statusText(caught.status)}: ${caught.advice}`);
    return caught;
}

test('defects of meshes', () => {
    const build = (change, mesh = smallTorus()) => () => {
        const changed = change(mesh) ?? mesh;
        new hmf.Hierarchy(changed.positions, changed.triangles, { markedVertices: [] });
    };
    const twice = mesh => ({ ...mesh, triangles: [...mesh.triangles, ...mesh.triangles.slice(0, 3)] });
    const defect = refused(build(twice), 'HMF_ERROR_MESH_NON_MANIFOLD_EDGE', 'triangle');
    assert.equal(defect.status, 306);
    refused(build(() => octahedron()), 'HMF_ERROR_MESH_GENUS', null);
    const marked = markedVertices => () => { const { positions, triangles } = octahedron(); new hmf.Hierarchy(positions, triangles, { markedVertices }); };
    refused(marked([0, 1, 2]), 'HMF_ERROR_MESH_GENUS', null);
    assert.equal(refused(marked([0, 1, 2, 4, 2]), 'HMF_ERROR_OPTIONS', 'vertex').index, 2);
    assert.equal(refused(marked([0, 1, 2, 6]), 'HMF_ERROR_MESH_INDEX', null).index, 3);
    assert.throws(marked([-1]), TypeError);
    refused(build(() => twoTori()), 'HMF_ERROR_MESH_COMPONENTS', 'triangle');
    refused(build(() => ({ positions: new Float64Array(0), triangles: new Uint32Array(0) })), 'HMF_ERROR_MESH_COUNTS', null);
    assert.equal(refused(build(mesh => { mesh.triangles[4] = 99; }), 'HMF_ERROR_MESH_INDEX', 'triangle').index, 1);
    assert.equal(refused(build(mesh => { mesh.positions[7] = NaN; }), 'HMF_ERROR_MESH_NOT_FINITE', 'vertex').index, 2);
    assert.equal(refused(build(mesh => { mesh.triangles[7] = mesh.triangles[6]; }), 'HMF_ERROR_MESH_REPEATED_VERTEX', 'triangle').index, 2);
    refused(build(mesh => { mesh.triangles.set([mesh.triangles[1], mesh.triangles[0]], 0); }), 'HMF_ERROR_MESH_ORIENTATION', 'triangle');
});

test('loops, values, options and limits that the library refuses', () => {
    const { positions, triangles } = torus(12, 8);
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    const solve = loops => () => hierarchy.solve({ loops });
    const ring = Array.from({ length: 12 }, (_, i) => 8 * i);
    refused(solve({ elementKind: 'vertices', loops: [] }), 'HMF_ERROR_LOOP_COUNT', 'loop');
    refused(solve({ elementKind: 'vertices', loops: [[0, 8, 5000]] }), 'HMF_ERROR_LOOP_INDEX', 'loop');
    refused(solve({ elementKind: 'vertices', loops: [ring.slice(0, 6)] }), 'HMF_ERROR_LOOP_NOT_CLOSED', 'loop');
    refused(solve({ elementKind: 'vertices', loops: [[0, 8, 9]] }), 'HMF_ERROR_LOOP_TRIVIAL', 'loop');
    assert.equal(refused(solve({ elementKind: 'vertices', loops: [ring], weights: [-1] }), 'HMF_ERROR_LOOP_WEIGHT', 'loop').index, 0);
    refused(() => hierarchy.initialize({ elementKind: 'vertices', loops: [ring, ring.map(v => v + 2)] }), 'HMF_ERROR_LOOP_PARALLEL', 'loop');
    const { values } = hierarchy.solve();
    const foliation = change => { const changed = values.slice(); change(changed); return hierarchy.foliation(changed); };
    assert.equal(refused(() => foliation(v => { v[5] = -1; }), 'HMF_ERROR_VALUE_NOT_FINITE', 'edge').index, 5);
    refused(() => foliation(v => { v[5] += 1; }), 'HMF_ERROR_VALUE_NOT_CLOSED', 'edge');
    const pole = Float64Array.from(hierarchy.levels[0].edgeVertices()).reduce((at, v, i) => { if (v === 0) at[i >> 1] = 1; return at; }, new Float64Array(values.length));
    const round = hierarchy.foliation(pole);
    assert.ok(round.energy() > 0 && round.singularities().list.some(({ index, element }) => index > 0 && element === 0));
    for (const work of [() => round.relax(), () => round.interpolate(0), () => round.residuals(), () => round.quads(), () => hierarchy.solve({ start: round })])
        assert.throws(work, error => error.statusName === 'HMF_ERROR_VALUE_POLE');
    refused(() => hierarchy.solve({ tolerance: -1 }), 'HMF_ERROR_OPTIONS', 'option');
    refused(() => new hmf.Hierarchy(positions, triangles, { ratio: 7 }), 'HMF_ERROR_OPTIONS', 'option');
    refused(() => new hmf.Hierarchy(positions, triangles, { memoryLimit: 1000 }), 'HMF_ERROR_MEMORY_LIMIT', null);
    hierarchy.dispose();
});

test('wrong types and lengths say what to give', () => {
    const { positions, triangles } = smallTorus();
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    const wrong = (work, pattern) => assert.throws(work, error => error instanceof TypeError && pattern.test(error.message) || assert.fail(`${error}`));
    const build = (...parameters) => () => new hmf.Hierarchy(...parameters);
    wrong(build(new BigInt64Array(21), triangles), /positions\[0\] is bigint 0; give a number/);
    wrong(build([...positions.slice(1), '7'], triangles), /positions\[20\] is string 7; give a number/);
    wrong(build('positions', triangles), /positions is string positions; give a typed array or an array of numbers/);
    wrong(build(positions, Int32Array.from(triangles, v => v - 1)), /triangles\[0\] is number -1; give an index from 0/);
    wrong(build(positions, [0, 1, 2.5]), /triangles\[2\] is number 2.5; give an index from 0/);
    wrong(build(positions, new ArrayBuffer(12)), /triangles is ArrayBuffer; give a typed array or an array of indices/);
    wrong(build(positions), /triangles is undefined/);
    wrong(build(null, triangles), /positions is null/);
    wrong(build(positions.subarray(1), triangles), /positions has 20 entries, not a multiple of 3/);
    wrong(build(positions, triangles, { collaps: 'midpoint' }), /no option 'collaps'; there are collapse/);
    wrong(build(positions, triangles, { collapse: 'middle' }), /collapse is string middle; give one of .*'midpoint'/);
    wrong(build(positions, triangles, { ratio: '0.5' }), /ratio is string 0.5; give a number/);
    wrong(build(positions, triangles, { coarsest: 1.5 }), /coarsest is number 1.5; give a whole number/);
    wrong(build(positions, triangles, { progress: 1 }), /progress is number 1; give a function/);
    wrong(build(positions, triangles, 7), /options is number 7; give an object/);
    wrong(() => hierarchy.solve({ method: 'steepest' }), /method is string steepest; give one of .*'newton'/);
    wrong(() => hierarchy.solve({ stopLevel: 1 }), /stopLevel is 1; give a number below 1/);
    wrong(() => hierarchy.loops({ kind: 'knots' }), /kind is string knots; give one of 'cut'/);
    wrong(() => hierarchy.loops({ level: -1 }), /level is number -1/);
    wrong(() => hierarchy.solve({ loops: [[1, 2, 3]] }), /loops is Array; give an object/);
    wrong(() => hierarchy.solve({ loops: { elementKind: 'edges', loops: [] } }), /elementKind is string edges; give one of 'triangles', 'vertices'/);
    wrong(() => hierarchy.solve({ loops: { elementKind: 'vertices' } }), /loops.loops is missing/);
    wrong(() => hierarchy.solve({ loops: { elementKind: 'vertices', loops: [[0, -1]] } }), /loops\.loops\[0\]\[1\] is number -1/);
    wrong(() => hierarchy.solve({ loops: { ...hierarchy.loops(), weights: [1, 2] } }), /weights has 2 entries; give 1/);
    wrong(() => hierarchy.foliation(new Float64Array(20)), /values has 20 entries; give 21/);
    wrong(() => hierarchy.foliation(new Float64Array(21), 3), /level is 3/);
    wrong(() => hierarchy.foliation(new Float64Array(21), { levels: 0 }), /no option 'levels'/);
    wrong(() => hierarchy.solve({ start: hierarchy.solve().values }), /start is Float64Array; give a Foliation/);
    wrong(() => hierarchy.solve().energy({ progress: 1 }), /progress is number 1; give a function/);
    wrong(() => hierarchy.solve().interpolate(0, { level: 0 }), /no option 'level'; there are progress/);
    wrong(() => hmf.memoryEstimate('7', 14), /vertexCount is string 7/);
    wrong(() => hmf.statusText('boundary'), /status is string boundary/);
    hierarchy.dispose();
});

test('progress rises, cancels, finishes, throws', () => {
    const { positions, triangles } = pretzel(2, 3);
    const seen = [];
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 200, progress: fraction => { seen.push(fraction); } });
    assert.ok(seen.length > 2 && seen.every((fraction, i) => fraction >= 0 && fraction <= 1 && (i === 0 || fraction >= seen[i - 1])));

    refused(() => new hmf.Hierarchy(positions, triangles, { progress: () => 'cancel' }), 'HMF_CANCELLED', null);
    refused(() => hierarchy.solve({ progress: () => 'cancel' }), 'HMF_CANCELLED', null);
    let calls = 0;
    const half = hierarchy.solve({ progress: () => (++calls > 20 ? 'finish' : undefined) });
    assert.equal(half.report.status, 'HMF_CANCELLED');
    assert.equal(half.report.converged, false);
    assert.equal(half.values.length, hierarchy.levels[0].edgeCount);
    assert.ok(half.energy() > 0);

    const reason = new Error('enough');
    let after = 0;
    const throwing = () => { ++after; throw reason; };
    for (const work of [() => new hmf.Hierarchy(positions, triangles, { progress: throwing }),
        () => hierarchy.solve({ progress: throwing }), () => half.relax({ progress: throwing })]) {
        after = 0;
        assert.throws(work, error => error === reason);
        assert.equal(after, 1, 'not called again after it threw');
    }
    assert.throws(() => hierarchy.solve({ progress: () => { throw undefined; } }), error => error === undefined);
    // In the last call of all, when the result is there already.
    assert.throws(() => hierarchy.solve({ progress: fraction => { if (fraction === 1) throw reason; } }), error => error === reason);
    assert.throws(() => new hmf.Hierarchy(positions, triangles, { progress: fraction => { if (fraction === 1) throw reason; } }), error => error === reason);
    assert.throws(() => hierarchy.solve({ progress: () => 1 }), /progress returned 1; return nothing/);
    assert.throws(() => hierarchy.solve({ progress: async () => {} }), /progress returned \[object Promise\]/);
    assert.equal(hierarchy.solve().report.status, 'HMF_OK', 'it works as before');
    hierarchy.dispose();
});

test('each call that can be long reports, and can be cancelled', () => {
    const { positions, triangles } = pretzel(2, 3), hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 200 });
    const loops = hierarchy.loops({ kind: 'tunnel', level: 0 }), foliation = hierarchy.solve({ loops }), start = hierarchy.initialize(loops);
    const calls = {
        build: options => new hmf.Hierarchy(positions, triangles, options).dispose(),
        suggestMarks: options => hmf.suggestMarks(positions, triangles, options),
        components: options => hmf.components(positions, triangles, options),
        solveComponents: options => hmf.solveComponents(positions, triangles, options),
        evenDesign: options => hmf.evenDesign(positions, triangles, options),
        loops: options => hierarchy.loops({ kind: 'tunnel', level: 0, ...options }),
        initialize: options => hierarchy.initialize(loops, options),
        foliation: options => hierarchy.foliation(foliation.values, options),
        solve: options => hierarchy.solve(options),
        relax: options => start.relax(options),
        interpolate: options => foliation.interpolate(1, options),
        energy: options => foliation.energy(options),
        residuals: options => foliation.residuals(options),
        conformalScale: options => foliation.conformalScale(options),
        unevenness: options => foliation.unevenness(options),
        singularities: options => foliation.singularities(options),
        parameterize: options => foliation.parameterize(options),
        trace: options => foliation.trace({ spacing: 0.1, ...options }),
        cylinders: options => foliation.cylinders({ loops, ...options }),
        quads: options => foliation.quads(options),
        atlas: options => foliation.atlas(options),
    };
    for (const [name, call] of Object.entries(calls)) {
        const seen = [];
        call({ progress: fraction => { seen.push(fraction); } });
        assert.ok(seen.every((fraction, i) => fraction >= (seen[i - 1] ?? 0) && fraction <= 1), name);
        assert.equal(seen.at(-1), 1, name);
        // The energy of a small mesh is there before the first report.
        if (name === 'energy' && seen.length === 1) continue;
        refused(() => call({ progress: () => 'cancel' }), 'HMF_CANCELLED', null);
        const reason = new Error('enough');
        assert.throws(() => call({ progress: () => { throw reason; } }), error => error === reason, name);
    }
    hierarchy.dispose();
    assert.equal(hmf.memory.inUse, 0);
});

test('a callback may use other hierarchies, but not the one at work', () => {
    const { positions, triangles } = pretzel(2, 2), small = smallTorus();
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    const expected = hierarchy.solve().values;
    let inner;
    const values = hierarchy.solve({ progress: () => {
        if (inner) return;
        // Large enough for the memory to grow under the outer call.
        const ring = torus(200, 100);
        new hmf.Hierarchy(ring.positions, ring.triangles, { progress: () => {} }).dispose();
        inner = new hmf.Hierarchy(small.positions, small.triangles);
        inner.solve();
    } }).values;
    assert.deepEqual(values, expected);
    inner.dispose();
    const foliation = hierarchy.solve();
    for (const forbidden of [() => foliation.dispose(), () => foliation.energy(), () => hierarchy.dispose(), () => hierarchy.solve(), () => hierarchy.memoryBytes, () => hierarchy.levels[0].weights()])
        assert.throws(() => hierarchy.solve({ progress: forbidden }), /in use by the call whose progress callback is running/);
    hierarchy.dispose();
});

test('after dispose every use says so', () => {
    const { positions, triangles } = smallTorus();
    const hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve(), level = hierarchy.levels[0];
    assert.equal(hierarchy.disposed, false);
    hierarchy.dispose();
    hierarchy.dispose();
    assert.equal(hierarchy.disposed, true);
    for (const work of [() => hierarchy.solve(), () => hierarchy.loops(), () => hierarchy.initialize(), () => hierarchy.memoryBytes, () => level.weights(),
        () => foliation.energy(), () => foliation.residuals(), () => foliation.singularities(), () => foliation.relax(), () => foliation.interpolate(0)])
        assert.throws(work, /has been disposed of/);
    assert.equal(level.edgeCount, 21, 'plain numbers stay');
    assert.equal(foliation.disposed, true);
    assert.deepEqual([foliation.values.length, foliation.report.status], [21, 'HMF_OK']);
    foliation.dispose();
    const other = new hmf.Hierarchy(positions, triangles);
    const [one, two] = [other.solve(), other.solve()];
    one.dispose();
    one.dispose();
    assert.deepEqual([one.disposed, two.disposed], [true, false]);
    for (const work of [() => one.energy(), () => one.trace(), () => other.solve({ start: one })]) assert.throws(work, /foliation has been disposed of/);
    assert.ok(two.energy() > 0);
    other[Symbol.dispose ?? Symbol.for('Symbol.dispose')]();
    assert.equal(other.disposed, true);
});

test('a trap becomes an Error, and the module refuses to go on', async () => {
    const other = await load(), { positions, triangles } = smallTorus();
    const hierarchy = new other.Hierarchy(positions, triangles);
    assert.throws(() => other._module.invoke('hmf_js_trap'), error => /hmf stopped in hmf_js_trap/.test(error.message) && /load\(\)/.test(error.message) && error.cause instanceof WebAssembly.RuntimeError);
    assert.throws(() => hierarchy.solve(), /stopped in an earlier call.*load\(\)/);
    assert.throws(() => new other.Hierarchy(positions, triangles), /stopped in an earlier call/);
    hierarchy.dispose();
    // Others are not touched, and a new one works.
    const again = await load();
    for (const library of [hmf, again]) new library.Hierarchy(positions, triangles).dispose();
});

test('damaged meshes are solved or refused, and nothing else', () => {
    let state = 1;
    const random = n => { state = (Math.imul(state, 1664525) + 1013904223) >>> 0; return Math.floor((state / 2 ** 32) * n); };
    const bases = [torus(8, 6), pretzel(2, 0), pretzel(1, 1)], outcomes = new Map(), { inUse } = hmf.memory;
    const attempt = () => {
        const base = bases[random(3)], positions = base.positions.slice(), triangles = base.triangles.slice();
        for (let k = random(3); k > 0; --k) {
            const [vertex, other] = [random(positions.length / 3), random(positions.length / 3)];
            [() => { triangles[random(triangles.length)] = random(positions.length / 3 + 2); },
                () => { positions[random(positions.length)] = [NaN, 1e308, 0, -1e-300, 1e160][random(5)]; },
                () => { positions.copyWithin(3 * vertex, 3 * other, 3 * other + 3); },
                () => { for (let q = 0; q < 20; ++q) positions[random(positions.length)] += (random(1000) - 500) / 300; }][random(4)]();
        }
        const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 40 });
        try {
            const loops = hierarchy.loops({ kind: ['cut', 'handle', 'tunnel'][random(3)], level: random(hierarchy.levels.length) });
            if (random(3) === 0) loops.loops[0][random(loops.loops[0].length)] = random(hierarchy.levels[loops.level].triangleCount + 1);
            const foliation = hierarchy.solve({ loops, iterationLimit: 200 });
            foliation.trace({ critical: true, spacing: 0.2 });
            foliation.interpolate(hierarchy.levels.length - 1).interpolate(0).singularities();
            foliation.parameterize();
            return 'solved';
        } finally {
            hierarchy.dispose();
        }
    };
    for (let i = 0; i < 500; ++i) {
        let outcome;
        try {
            outcome = attempt();
        } catch (error) {
            assert.ok(error instanceof HmfError && error.statusName !== 'HMF_ERROR_INTERNAL', String(error));
            outcome = error.statusName;
        }
        outcomes.set(outcome, (outcomes.get(outcome) ?? 0) + 1);
        assert.equal(hmf.memory.inUse, inUse);
    }
    assert.ok(outcomes.get('solved') > 100 && outcomes.size > 6, JSON.stringify([...outcomes]));
});
