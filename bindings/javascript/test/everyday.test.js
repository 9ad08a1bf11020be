// What a user meets first: loops by kind, picked points, previews, holes, vertices that nothing uses, sentences in the words of JavaScript, types of all members.
import assert from 'node:assert/strict';
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { before, test } from 'node:test';
import { HmfError, load } from '../lib/index.js';
import { inWords, libraryWords } from '../lib/error.js';
import { Foliation } from '../lib/foliation.js';
import { Hierarchy } from '../lib/hierarchy.js';
import { pretzel } from '../examples/shapes.js';
import { octahedron, smallTorus, twoTori } from './meshes.js';

let hmf;
before(async () => { hmf = await load(); });

test('a hole is said, and refused where the mesh has to be closed', () => {
    const { positions, triangles } = pretzel(2, 2), said = [], warn = sentence => said.push(sentence);
    const whole = new hmf.Hierarchy(positions, triangles, { closed: true, warn });
    assert.deepEqual([whole.boundaries(), whole.warnings, said, whole.solve().report.boundaries], [[], [], [], 0]);
    const open = triangles.slice(3), hierarchy = new hmf.Hierarchy(positions, open, { warn });
    const [curve, ...others] = hierarchy.boundaries();
    assert.deepEqual([[...curve].sort(), others], [[...triangles.slice(0, 3)].sort(), []]);
    assert.match(said[0], /^1 boundary looks like a hole by accident, the smallest with 3 edges; .*closed: true/);
    assert.deepEqual([hierarchy.warnings, said.length], [said, 1]);
    const foliation = hierarchy.solve(), { report } = foliation;
    assert.equal(report.boundaries, 1);
    const orders = foliation.singularities().list.filter(({ index }) => index < 0).reduce((sum, { index }) => sum - index, 0);
    assert.deepEqual([report.zeros, report.indexSum], [orders, -orders]);
    assert.throws(() => new hmf.Hierarchy(positions, open, { closed: true, warn }),
        error => error instanceof HmfError && error.statusName === 'HMF_ERROR_MESH_BOUNDARY' && error.element === 'vertex'
            && curve.includes(error.index) && /has 1 boundary, the first with 3 edges/.test(error.message));
    for (const one of [whole, hierarchy]) one.dispose();
});

test('holes of components are said with their number', () => {
    const { positions, triangles } = twoTori(), said = [];
    const { components } = hmf.solveComponents(positions, triangles.slice(3), { warn: sentence => said.push(sentence) });
    assert.deepEqual(components.map(({ report }) => report.boundaries), [1, 0]);
    assert.match(said.join(), /^component 0: 1 boundary looks like a hole/);
});

test('vertices without a triangle are dropped with a note', () => {
    const { positions, triangles } = octahedron(), said = [], warn = sentence => said.push(sentence);
    const alone = new hmf.Hierarchy(positions, triangles), bare = alone.solve().values;
    assert.equal(alone.keptVertices, null);
    const more = Float64Array.of(9, 9, 9, ...positions), moved = triangles.map(v => v + 1);
    const hierarchy = new hmf.Hierarchy(more, moved, { warn });
    assert.deepEqual(hierarchy.keptVertices, Uint32Array.of(1, 2, 3, 4, 5, 6));
    assert.deepEqual(hierarchy.levels[0].positions(), positions);
    assert.deepEqual(hierarchy.solve().values, bare);
    assert.match(said.join(), /^dropped 1 vertex without a triangle/);
    const marked = new hmf.Hierarchy(more, moved, { warn, markedVertices: [1, 2, 3, 4] });
    assert.deepEqual(marked.markedVertices, Uint32Array.of(0, 1, 2, 3));
    assert.throws(() => new hmf.Hierarchy(more, moved, { warn, markedVertices: [0, 1, 2, 3] }), /markedVertices has 0, which belongs to no triangle/);
    for (const one of [alone, hierarchy, marked]) one.dispose();
});

test('zero is zero, or refused', () => {
    const { positions, triangles } = pretzel(2, 2), hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve();
    assert.equal(hierarchy.solve({ timeLimit: 0 }).report.status, 'HMF_LIMIT_TIME');
    for (const work of [() => hierarchy.solve({ tolerance: 0 }), () => hierarchy.solve({ iterationLimit: 0 }), () => foliation.quads({ count: 0 }), () => foliation.quads({ edgeLength: 0 }), () => foliation.trace({ spacing: 0 }), () => foliation.trace({ lengthLimit: 0 }),
        () => foliation.atlas({ margin: 0 }), () => foliation.parameterize({ tolerance: 0 }), () => hmf.evenDesign(positions, triangles, { solveLimit: 0 }), () => new hmf.Hierarchy(positions, triangles, { ratio: 2 })])
        assert.throws(work, error => error.statusName === 'HMF_ERROR_OPTIONS' && /(\w+): \S+ is not in [[(]/.test(error.message));
    hierarchy.dispose();
});

const close = (a, b) => assert.ok(Math.abs(a - b) < 1e-6 * Math.abs(b), `${a} ${b}`);
const energyOf = (hierarchy, loops) => hierarchy.solve({ loops }).report.energy;
/** Each loop has a cylinder that names it. */
const namesItsLoops = (foliation, { loops }) => assert.deepEqual(foliation.cylinders().list.map(({ loop }) => loop).sort((a, b) => a - b), loops.map((_, i) => i));

test('loops by kind, and the loops of a foliation', () => {
    const { positions, triangles } = pretzel(2, 2), hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100 });
    assert.ok(hierarchy.levels.length > 2);
    for (const kind of ['cut', 'handle', 'tunnel', 'pants']) {
        const foliation = hierarchy.solve({ loops: kind }), { loops } = foliation;
        assert.deepEqual(loops, hierarchy.loops({ kind }));
        close(energyOf(hierarchy, loops), foliation.report.energy);
        namesItsLoops(foliation, loops);
        for (const other of [foliation.interpolate(1).relax(), hierarchy.solve({ start: foliation })]) assert.deepEqual(other.loops, loops);
        assert.equal(hierarchy.foliation(foliation.values).loops, null);
        assert.ok(foliation.cylinders({ loops: null }).list.every(({ loop }) => loop === null));
        assert.deepEqual(hierarchy.initialize(kind).loops, loops);
        const { components } = hmf.solveComponents(positions, triangles, { coarsest: 100, loops: kind });
        close(components[0].report.energy, foliation.report.energy);
    }
    assert.deepEqual(hierarchy.solve().loops, hierarchy.loops());
    const { loops: design } = hmf.evenDesign(positions, triangles, { noPoles: true }), even = hierarchy.solve({ loops: 'even' });
    assert.deepEqual(even.loops, design);
    close(even.report.energy, energyOf(hierarchy, design));
    namesItsLoops(even, design);
    const own = { ...hierarchy.loops({ kind: 'pants' }), weights: [1, 2, 3] }, foliation = hierarchy.solve({ loops: own });
    assert.deepEqual(foliation.loops, own);
    own.loops.pop();
    assert.equal(foliation.loops.loops.length, 3);
    hierarchy.dispose();
});

test('spheres and disks solve by default', () => {
    const { positions, triangles } = octahedron();
    for (const mesh of [triangles, triangles.slice(0, 21)]) {
        const hierarchy = new hmf.Hierarchy(positions, mesh, { warn() {} });
        assert.deepEqual(hierarchy.markedVertices, hmf.suggestMarks(positions, mesh));
        assert.deepEqual(new hmf.Hierarchy(positions, mesh, { markedVertices: 'suggest', warn() {} }).markedVertices, hierarchy.markedVertices);
        for (const loops of [undefined, 'cut', 'pants', 'even']) assert.ok(hierarchy.solve({ loops }).report.converged);
        assert.throws(() => new hmf.Hierarchy(positions, mesh, { markedVertices: [], warn() {} }), error => error.statusName === 'HMF_ERROR_MESH_GENUS');
        hierarchy.dispose();
    }
});

test('loops through picked vertices and points', () => {
    const { positions, triangles } = pretzel(2, 2), hierarchy = new hmf.Hierarchy(positions, triangles), ends = hierarchy.levels[0].edgeVertices();
    const length = (a, b) => Math.hypot(...[0, 1, 2].map(k => positions[3 * a + k] - positions[3 * b + k]));
    // Of all vertices from one; Bellman and Ford.
    const distances = start => {
        const away = new Float64Array(positions.length / 3).fill(Infinity);
        away[start] = 0;
        for (let changed = true; changed;) {
            changed = false;
            for (let e = 0; e < ends.length; e += 2) for (const [a, b] of [[ends[e], ends[e + 1]], [ends[e + 1], ends[e]]]) {
                const more = away[a] + length(a, b);
                if (more < away[b]) [away[b], changed] = [more, true];
            }
        }
        return away;
    };
    const around = (list, term) => list.reduce((sum, stop, i) => sum + term(stop, list[(i + 1) % list.length]), 0);
    for (const loop of hierarchy.loops({ kind: 'handle' }).loops) {
        const corners = Array.from(loop).filter((_, i) => i % 3 === 0).map(t => triangles[3 * t]);
        const points = corners.map(vertex => [0, 1, 2].map(k => positions[3 * vertex + k] + 1e-4));
        const picked = hierarchy.loopsThrough([points], { within: 1e-3, weights: [2] });
        assert.deepEqual(picked, hierarchy.loopsThrough([corners], { weights: [2] }));
        assert.ok(Math.abs(around(Array.from(picked.loops[0]), length) - around(corners, (a, b) => distances(a)[b])) < 1e-9);
        close(energyOf(hierarchy, picked), energyOf(hierarchy, { elementKind: 'triangles', loops: [loop], weights: [2] }));
        assert.throws(() => hierarchy.loopsThrough([points], { within: 1e-9 }),
            error => error.statusName === 'HMF_ERROR_OPTIONS' && /picked\[0\]\[0\], \[.*\], is .* from the surface, more than within: 1/.test(error.message));
    }
    const far = [[[100, 0, 0], [0, 100, 0], [0, 0, 100]]];
    assert.throws(() => hierarchy.loopsThrough(far), /from the surface.*unit and axes/);
    assert.ok(hierarchy.loopsThrough(far, { within: 1000 }));
    assert.throws(() => hierarchy.loopsThrough([[[NaN, 0, 0], [0, 0, 0], [0, 0, 0]]]), /from the surface/);
    for (const [picked, words] of [[[[0, 1]], /at least three/], [[[0, 1, 99999]], /vertex 99999/], [[0, 1, 2], /picked\[0\]/], [[[[0, 1], [1, 2], [2, 3]]], /3/]])
        assert.throws(() => hierarchy.loopsThrough(picked), error => error instanceof TypeError && words.test(error.message));
    hierarchy.dispose();
});

test('a preview is one call', () => {
    const { positions, triangles } = pretzel(2, 2), hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100 }), n = hierarchy.levels.length;
    const preview = hierarchy.solve({ stopLevel: -1 });
    assert.equal(preview.level, n - 1);
    assert.deepEqual(preview.values, hierarchy.solve({ stopLevel: n - 1 }).values);
    assert.equal(hierarchy.solve({ stopLevel: -n }).level, 0);
    assert.throws(() => hierarchy.solve({ stopLevel: -n - 1 }), /stopLevel/);
    hierarchy.dispose();
});

/** The texts in quotes of each call that fails: what the library can say. */
function messages(folder) {
    return readdirSync(folder, { recursive: true }).filter(name => /\.[ch]pp$/.test(name)).flatMap(name =>
        [...readFileSync(`${folder}/${name}`, 'utf8').matchAll(/\bfail\((?:[^;"]|"(?:[^"\\]|\\.)*")*/g)]
            .map(([call]) => [...call.matchAll(/"((?:[^"\\]|\\.)*)"/g)].map(([, text]) => text).join('')).filter(text => text));
}

const sources = new URL('../../../src', import.meta.url).pathname;
test('every error of the library is in words of JavaScript', { skip: !existsSync(sources) && 'the sources of the library are not here' }, () => {
    const all = messages(sources);
    assert.ok(all.length > 100, `${all.length} messages`);
    for (const message of all) assert.doesNotMatch(inWords(message), /hmf_|HMF_|NULL|struct_size|->|[a-z]_[a-z]|build options|optimis/, message);
    const unused = libraryWords.filter(words => !all.some(message => message.includes(words)));
    assert.deepEqual(unused, [], 'words that no error of the library has');
});

test('index.d.ts has all members of hierarchies and foliations', () => {
    const types = readFileSync(new URL('../lib/index.d.ts', import.meta.url), 'utf8');
    const internal = ['constructor', 'adopt', 'abandon', 'refuseWhenBusy', 'perform', 'levelIndex', 'discard'];
    const { positions, triangles } = smallTorus(), hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve();
    for (const [name, one, { prototype }] of [['Hierarchy', hierarchy, Hierarchy], ['Foliation', foliation, Foliation]]) {
        const start = types.indexOf(`export interface ${name} extends`), body = types.slice(start, types.indexOf('\n}', start));
        const missing = [...Object.keys(one), ...Object.getOwnPropertyNames(prototype)].filter(member => !internal.includes(member) && !new RegExp(`\\b${member}[(:]`).test(body));
        assert.deepEqual(missing, [], name);
    }
    hierarchy.dispose();
});
