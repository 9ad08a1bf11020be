// A walk through the errors of the library: each that JavaScript can reach is raised, and says nothing in words of C.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { HmfError, load } from '../lib/index.js';
import { constants } from '../dist/layout.js';
import { pretzel } from '../examples/shapes.js';
import { octahedron, smallTorus, twoTori } from './meshes.js';

const cWords = /\b(hmf|HMF)_|\bNULL\b|struct_size|sizeof|->|build options|[a-z]_[a-z]|offsets\[|%[a-z]|optimis/;
// No call of the package raises these.
const unreachable = {
    HMF_ERROR_NULL: 'no pointer is NULL', HMF_ERROR_MEMORY: 'the memory of the module has to be full', HMF_ERROR_MESH_UNUSED_VERTEX: 'such vertices are dropped',
    HMF_ERROR_MESH_NOT_DELAUNAY: 'no mesh is known', HMF_ERROR_INTERNAL: 'a defect of the library', HMF_LIMIT_CLASS: 'no small mesh is known',
};

let hmf;
before(async () => { hmf = await load(); });

/** A torus that goes around twice, through itself. */
function woundTorus(n = 12) {
    const positions = [], triangles = [], at = (i, j) => n * (i % n) + j % n;
    for (let i = 0; i < n; ++i) for (let j = 0; j < n; ++j) {
        const a = 2 * Math.PI * i / n, b = 2 * Math.PI * (j + 0.3) / n, r = 3 + 0.5 * Math.cos(a) + 0.6 * Math.cos(b);
        positions.push(r * Math.cos(2 * a), r * Math.sin(2 * a), 0.6 * Math.sin(b) + 0.15 * Math.sin(a));
        triangles.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
    return { positions, triangles };
}

function* calls() {
    const build = ({ positions, triangles }, options) => new hmf.Hierarchy(positions, triangles, { warn() {}, ...options });
    const changed = change => () => { const mesh = smallTorus(); return build(change(mesh) ?? mesh, { markedVertices: [] }); };
    yield ['no triangles', changed(({ positions }) => ({ positions, triangles: [] }))];
    yield ['no vertices', changed(() => ({ positions: [], triangles: [] }))];
    yield ['index', changed(({ triangles }) => { triangles[4] = 99; })];
    yield ['not finite', changed(({ positions }) => { positions[7] = NaN; })];
    yield ['vertex twice', changed(({ triangles }) => { triangles[7] = triangles[6]; })];
    yield ['no area', changed(({ positions }) => { positions.copyWithin(3, 0, 3); })];
    yield ['no extent', () => build({ ...smallTorus(), positions: new Float64Array(21) }, { mollify: 1e-5 })];
    yield ['edge', changed(mesh => ({ ...mesh, triangles: [...mesh.triangles, ...mesh.triangles.slice(0, 3)] }))];
    yield ['orientation', changed(({ triangles }) => { triangles.set([triangles[1], triangles[0]], 0); })];
    yield ['fans', changed(() => { const { positions, triangles } = twoTori(); return { positions: positions.slice(0, -3), triangles: triangles.map(v => (v === positions.length / 3 - 1 ? 0 : v)) }; })];
    yield ['components', changed(twoTori)];
    for (const markedVertices of [[], [0, 1, 2], [0, 1, 2, 4, 2], [0, 1, 2, 6]]) yield [`marks ${markedVertices}`, () => build(octahedron(), { markedVertices })];
    const { positions, triangles } = pretzel(2, 2), whole = { positions, triangles }, open = { positions, triangles: triangles.slice(3) };
    yield ['disk', () => build({ ...octahedron(), triangles: octahedron().triangles.slice(0, 21) }, { markedVertices: [] })];
    yield ['closed', () => build(open, { closed: true })];
    yield ['memory', () => build(whole, { memoryLimit: 10000 })];
    yield ['components of a wrong index', () => hmf.components(smallTorus().positions, smallTorus().triangles.map(v => v + 3))];
    yield ['no handles', () => build(octahedron()).loops({ kind: 'handle' })];
    yield ['not embedded', () => build(woundTorus()).loops({ kind: 'handle' })];

    const hierarchy = build(whole, { coarsest: 100 }), foliation = hierarchy.solve(), cut = hierarchy.loops(), strips = (...loops) => ({ elementKind: 'triangles', loops });
    const numbers = { tolerance: [0, 1, -1, NaN], energyTolerance: [0, 2], iterationLimit: [0], stepLimit: [0], timeLimit: [-1, Infinity] };
    for (const [name, values] of Object.entries(numbers)) for (const value of values) yield [`${name} ${value}`, () => hierarchy.solve({ [name]: value })];
    for (const [name, value] of Object.entries({ ratio: 2, mollify: -1, coarsest: 0, memoryLimit: 0 })) yield [name, () => build(whole, { [name]: value })];
    yield ['single level', () => hierarchy.solve({ method: 'single-level', stopLevel: 1 })];

    // Loops.
    const [first] = cut.loops, ends = hierarchy.levels[0].edgeVertices(), ring = Array.from(triangles.slice(0, 3)), vertices = (...loops) => ({ elementKind: 'vertices', loops });
    const sets = {
        none: vertices(), 'no elements': vertices([]), index: vertices([0, 1, 99999]), 'no edge': vertices([0, positions.length / 6, positions.length / 3 - 1]),
        back: vertices(ring), parallel: strips(first, first), arc: { ...strips(first), arcs: [1] }, weight: { ...cut, weights: [1, -1] }, weights: { ...cut, weights: [1, 1e9] },
        twice: strips([...first, ...first]), cross: strips(first, hierarchy.loops({ kind: 'tunnel' }).loops[0], hierarchy.loops({ kind: 'handle' }).loops[0]),
    };
    for (const [name, loops] of Object.entries(sets)) {
        yield [`loops: ${name}`, () => hierarchy.solve({ loops })];
        yield [`initial loops: ${name}`, () => hierarchy.initialize(loops)];
    }
    const marked = build(smallTorus(), { markedVertices: [0, 1] });
    yield ['marked vertex', () => marked.solve({ loops: vertices([0, 1, 3]) })];

    // Values.
    const { values } = foliation, start = hierarchy.initialize();
    const given = { negative: values.with(5, -1), infinite: values.with(5, Infinity), zero: values.map(() => 0), tiny: values.map(x => 1e-280 * x), 'no unit': values.map(x => Math.PI * x),
        'not closed': values.with(5, 2 ** Math.ceil(Math.log2(values.reduce((a, b) => a + b)))) };
    for (const [name, some] of Object.entries(given)) yield [`values: ${name}`, () => hierarchy.foliation(some)];
    const pole = hierarchy.foliation(values.map((_, e) => (ends[2 * e] === 0 || ends[2 * e + 1] === 0 ? 1 : 0)));
    for (const name of ['relax', 'quads', 'trace', 'cylinders', 'residuals']) yield [`pole: ${name}`, () => pole[name]()];
    yield ['pole: start', () => hierarchy.solve({ start: pole })];
    yield ['not harmonic', () => start.parameterize()];
    yield ['not minimal', () => start.cylinders()];
    yield ['other loops', () => foliation.cylinders({ loops: hierarchy.loops({ kind: 'pants' }) })];
    yield ['start on another mesh', () => hierarchy.solve({ start: build(smallTorus()).solve() })];
    const twin = build(whole);
    yield ['start on another level', () => twin.solve({ start: foliation.interpolate(1) })];

    // Applications.
    const works = {
        seams: () => foliation.parameterize({ seamEdges: [10 ** 6] }), tolerance: () => foliation.parameterize({ tolerance: -1 }), margin: () => foliation.atlas({ margin: 0.5 }),
        'both sizes': () => foliation.quads({ count: 500, edgeLength: 0.1 }), count: () => foliation.quads({ count: 10 ** 12 }), 'no leaf': () => start.quads(),
        small: () => foliation.quads({ edgeLength: 1e-9 }), tiny: () => foliation.quads({ edgeLength: 1e-300 }), huge: () => foliation.quads({ edgeLength: 1e300 }),
        relax: () => foliation.quads({ relax: 10 ** 6 }), spacing: () => foliation.trace({ spacing: 1e-12 }), conjugate: () => foliation.trace({ leaves: 'conjugate', spacing: 1e-12 }),
        length: () => foliation.trace({ lengthLimit: -1 }), triangle: () => foliation.trace({ through: { triangles: [10 ** 6], barycentrics: [1, 0, 0] } }),
        sum: () => foliation.trace({ through: { triangles: [0], barycentrics: [1, 1, 0] } }), design: () => hmf.evenDesign(positions, triangles, { solveLimit: 0 }),
        picked: () => hierarchy.loopsThrough([[[99, 99, 99], [0, 0, 0], [1, 1, 1]]]),
    };
    for (const [name, work] of Object.entries(works)) yield [name, work];

    // With boundary.
    const holed = build(open, { coarsest: 100 }), solved = holed.solve(), upper = solved.interpolate(1);
    yield ['boundary: handles', () => holed.loops({ kind: 'handle' })];
    yield ['boundary: forms', () => holed.harmonicForms()];
    yield ['boundary: loops of a level', () => holed.loops({ level: 1 })];
    yield ['boundary: level of loops', () => holed.solve({ loops: { ...vertices([0, 1, 2]), level: 1 } })];
    for (const name of ['quads', 'atlas', 'cylinders']) yield [`boundary: ${name}`, () => upper[name]()];
    yield ['boundary: of values', () => holed.foliation(solved.values).cylinders()];
    yield ['arc of one vertex', () => holed.solve({ loops: { ...vertices([50]), arcs: [1] } })];
    yield ['arc inside', () => holed.solve({ loops: { ...vertices(Array.from(ends.slice(-2))), arcs: [1] } })];

    // Ended early.
    yield ['canceled', () => hierarchy.solve({ progress: () => 'cancel' })];
    yield ['canceled build', () => build(whole, { progress: () => 'cancel' })];
    for (const options of [{ progress: () => 'finish' }, { timeLimit: 0 }, { stepLimit: 1, tolerance: 1e-12 }, { method: 'whitehead', iterationLimit: 1, tolerance: 1e-12 }, { tolerance: 1e-300 }])
        yield [`early ${JSON.stringify(options)}`, () => hierarchy.solve(options)];
}

test('every error is in words of JavaScript', () => {
    const found = new Set(), said = new Set();
    for (const [name, work] of calls()) {
        let status, text;
        try {
            const { report } = work();
            [status, text] = [report.status, report.stopped?.advice];
        } catch (error) {
            assert.ok(error instanceof HmfError, `${name}: ${error}`);
            [status, text] = [error.statusName, error.message];
        }
        assert.ok(status !== 'HMF_OK' && text?.length > 20, `${name}: ${status}, ${text}`);
        assert.doesNotMatch(text, cWords, name);
        found.add(status);
        said.add(text.replace(/[-\d.e+]+/g, '#'));
    }
    const all = Object.keys(constants).filter(name => /^HMF_(ERROR|LIMIT)_|^HMF_CANCELLED$/.test(name));
    assert.deepEqual(all.filter(name => !found.has(name)).sort(), Object.keys(unreachable).sort());
    assert.ok(said.size > 60, `${said.size} sentences`);
});
