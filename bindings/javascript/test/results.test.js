// Results against values known otherwise.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { load } from '../lib/index.js';
import { pretzel, torus } from '../examples/shapes.js';
import { brokenTriangles, cotangentWeights, edgesOf, octahedron, smallTorus } from './meshes.js';

let hmf;
before(async () => { hmf = await load(); });

test('a torus of revolution carries the foliation of its symmetry', () => {
    const n = 24, m = 16, { positions, triangles } = torus(n, m);
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    // A loop of vertices around the axis.  The mesh is the same at every angle, so the leaves are circles around it.
    const loop = Array.from({ length: n }, (_, i) => i * m);
    const foliation = hierarchy.solve({ loops: { elementKind: 'vertices', loops: [loop], weights: [2] } });
    assert.equal(foliation.report.converged, true);
    const { edges } = edgesOf(triangles);
    let tube = 0;
    edges.forEach(([a, b], e) => {
        // Around the axis: both ends on one leaf.
        if (a % m === b % m) assert.ok(foliation.values[e] < 1e-7, `edge ${a} ${b} has ${foliation.values[e]}`);
        // Around the tube at the first angle: the lengths add up to the weight.
        if (Math.floor(a / m) === 0 && Math.floor(b / m) === 0) tube += foliation.values[e];
    });
    assert.ok(Math.abs(tube - 2) < 1e-7, `once around the tube: ${tube}`);
    hierarchy.dispose();
});

test('the harmonic forms of a torus of revolution have the period of a rectangle', () => {
    const { positions, triangles } = torus(48, 32), hierarchy = new hmf.Hierarchy(positions, triangles);
    const forms = hierarchy.harmonicForms();
    assert.deepEqual([forms.genus, forms.formCount, forms.edgeCount], [1, 2, hierarchy.levels[0].edgeCount]);
    assert.equal(forms.values.length, 2 * forms.edgeCount);
    assert.deepEqual([...forms.intersections], [0, 1, -1, 0]);
    assert.ok(Math.abs(forms.conjugation[2] - forms.innerProducts[0]) < 1e-12);
    assert.ok(forms.residual < 1e-8 && forms.conjugationError < 0.01 && forms.periodImaginary[0] > 0);
    // For the period x + iy the energies are (x^2 + y^2) / y and 1 / y.
    const [x] = forms.periodReal, [y] = forms.periodImaginary, [a, , , b] = forms.innerProducts;
    assert.ok(Math.abs(a * b * y * y / (x * x + y * y) - 1) < 0.02);
    assert.throws(() => hierarchy.harmonicForms({ level: 99 }), TypeError);
    hierarchy.dispose();
});

test('level 0 is the mesh of the caller', () => {
    const { positions, triangles } = pretzel(2, 2);
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100 });
    const level = hierarchy.levels[0], { edges, triangleEdges } = edgesOf(triangles);
    assert.equal(hierarchy.genus, 2);
    assert.deepEqual(level.positions(), positions);
    assert.deepEqual(level.triangleVertices(), triangles);
    assert.deepEqual([...level.triangleEdges()], triangleEdges);
    assert.equal(level.edgeCount, edges.length);
    const vertices = level.edgeVertices();
    edges.forEach(([a, b], e) => assert.deepEqual([vertices[2 * e], vertices[2 * e + 1]].sort(), [a, b].sort()));
    const expected = cotangentWeights(positions, triangles, edges.length, triangleEdges);
    level.weights().forEach((weight, e) => assert.ok(Math.abs(weight - expected[e]) < 1e-9 * (1 + Math.abs(weight)), `edge ${e}: ${weight} and ${expected[e]}`));
    assert.ok(hierarchy.levels.length > 1);
    hierarchy.levels.forEach(({ vertexCount, edgeCount, triangleCount }) => assert.equal(vertexCount - edgeCount + triangleCount, 2 - 2 * hierarchy.genus));
    hierarchy.dispose();
});

test('a solution is closed, without poles, harmonic, and its report tells the same', () => {
    const { positions, triangles } = pretzel(3, 3);
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 200 });
    const foliation = hierarchy.solve(), { report } = foliation;
    assert.equal(report.status, 'HMF_OK');
    assert.equal(report.method, 'newton');
    assert.equal(report.stopped, null);
    assert.equal(report.classState, 'proven');
    assert.ok(report.classRepeats < hierarchy.levels.length && report.classSeconds > 0 && report.classSeconds < report.solveSeconds);
    assert.equal(brokenTriangles(foliation.values, hierarchy.levels[0].triangleEdges()), 0);
    const residuals = foliation.residuals();
    assert.equal(Math.max(...residuals), report.residualMax);
    assert.ok(report.residualMax < 1e-8);
    assert.equal(foliation.energy(), report.energy);
    const { list, vertexIndex, triangleIndex, vertexCluster } = foliation.singularities();
    const sum = vertexIndex.reduce((a, b) => a + b, 0) + triangleIndex.reduce((a, b) => a + b, 0);
    assert.equal(sum, 4 - 4 * 3);
    assert.equal(report.indexSum, sum);
    assert.equal(list.reduce((total, { index }) => total + index, 0), sum);
    assert.ok(list.every(({ kind, index }) => index < 0 && ['vertex', 'triangle', 'cluster'].includes(kind)));
    assert.equal(report.zeros, 8);
    assert.equal(report.poles, 0);
    vertexCluster.forEach((first, v) => assert.ok(first <= v));
    assert.equal(report.levels.length, hierarchy.levels.length);
    assert.deepEqual(report.levels.map(level => [level.vertexCount, level.edgeCount]), hierarchy.levels.map(level => [level.vertexCount, level.edgeCount]));
    const corners = hierarchy.levels[0].triangleVertices(), place = v => [...positions.subarray(3 * v, 3 * v + 3)];
    for (const { kind, element, position } of list) {
        const points = (kind === 'triangle' ? [...corners.subarray(3 * element, 3 * element + 3)] : [element]).map(place);
        if (kind !== 'cluster') position.forEach((x, k) => assert.ok(Math.abs(x - points.reduce((total, p) => total + p[k] / points.length, 0)) < 1e-9));
    }
    assert.ok(foliation.unit > 0 && foliation.values.every(value => Number.isInteger(value / foliation.unit)));
    assert.ok(report.history.every((entry, i) => i === 0 || entry.seconds >= report.history[i - 1].seconds));
    const last = report.history.at(-1);
    assert.equal(last.level, 0);
    assert.ok(Math.abs(last.energy - report.energy) < 1e-9 * report.energy);
    assert.ok(report.solveSeconds > 0 && report.peakMemoryBytes > 0);
    hierarchy.dispose();
});

test('twice the weights give twice the values, bit by bit', () => {
    const { positions, triangles } = pretzel(2, 2);
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100 });
    const loops = hierarchy.loops();
    assert.equal(loops.loops.length, 2);
    const one = hierarchy.solve({ loops: { ...loops, weights: [1, 0.75] } });
    const two = hierarchy.solve({ loops: { ...loops, weights: Float64Array.of(2, 1.5) } });
    assert.deepEqual(two.values, one.values.map(x => 2 * x));
    assert.notDeepEqual(one.values, hierarchy.solve().values);
    hierarchy.dispose();
});

test('initialize gives the weights of the loops that cross an edge', () => {
    const { positions, triangles } = torus(12, 8);
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    const loops = hierarchy.loops({ level: 0, kind: 'cut' });
    const { values, level, report } = hierarchy.initialize({ ...loops, weights: [3] });
    assert.equal(level, 0);
    assert.equal(report, null);
    const crossed = new Set(), triangleEdges = hierarchy.levels[0].triangleEdges(), loop = loops.loops[0];
    loop.forEach((t, i) => {
        const next = loop[(i + 1) % loop.length];
        crossed.add([0, 1, 2].map(s => triangleEdges[3 * t + s]).find(e => [0, 1, 2].some(s => triangleEdges[3 * next + s] === e)));
    });
    values.forEach((value, e) => assert.equal(value, crossed.has(e) ? 3 : 0));
    hierarchy.dispose();
});

test('handle loops go around no hole of a plate, tunnel loops do', () => {
    const { positions, triangles } = pretzel(2, 2), holes = [-1, 1]; // their axes are parallel to z, at these x and y = 0
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100 }), triangleEdges = hierarchy.levels[0].triangleEdges();
    const sides = t => [...triangleEdges.subarray(3 * t, 3 * t + 3)];
    const center = t => [0, 1].map(k => [0, 1, 2].reduce((sum, c) => sum + positions[3 * triangles[3 * t + c] + k] / 3, 0));
    const turns = (loop, x) => Math.round(loop.reduce((sum, t, i) => {
        const [a, b] = [center(t), center(loop[(i + 1) % loop.length])].map(([px, py]) => [px - x, py]);
        return sum + Math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    }, 0) / (2 * Math.PI));
    for (const kind of ['cut', 'handle', 'tunnel']) {
        const { loops, elementKind, level } = hierarchy.loops({ kind, level: 0 });
        assert.deepEqual([elementKind, level, loops.length], ['triangles', 0, 2]);
        for (const loop of loops) {
            loop.forEach((t, i) => assert.ok(sides(t).some(e => sides(loop[(i + 1) % loop.length]).includes(e)), 'a closed chain'));
            const round = holes.map(x => turns(loop, x));
            if (kind !== 'cut') assert.equal(round.some(n => n !== 0), kind === 'tunnel', `${kind}: ${round}`);
        }
    }
    hierarchy.dispose();
});

test('pants loops: 3 genus - 3, each the core of a cylinder', () => {
    const { positions, triangles } = pretzel(3, 2), hierarchy = new hmf.Hierarchy(positions, triangles);
    const loops = hierarchy.loops({ kind: 'pants', level: 0 });
    assert.equal(loops.loops.length, 3 * 3 - 3);
    const foliation = hierarchy.solve({ loops }), { report } = foliation;
    assert.deepEqual([report.converged, report.zeros, report.poles], [true, 8, 0]);
    assert.deepEqual(foliation.cylinders({ loops }).list.map(({ loop, height }) => [loop, height]).sort(), loops.loops.map((_, i) => [i, 1]));
    hierarchy.dispose();
});

test('values go down to a coarse level and up again, relax brings them back', () => {
    const { positions, triangles } = pretzel(2, 2);
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100 });
    const coarsest = hierarchy.levels.length - 1;
    const fine = hierarchy.solve(), coarse = hierarchy.solve({ stopLevel: coarsest });
    assert.equal(coarse.level, coarsest);
    assert.equal(coarse.values.length, hierarchy.levels[coarsest].edgeCount);
    assert.equal(coarse.report.levels.length, 1);
    const up = coarse.interpolate(0);
    assert.equal(up.values.length, fine.values.length);
    assert.ok(up.energy() > fine.energy());
    const relaxed = up.relax();
    assert.equal(relaxed.report.converged, true);
    assert.equal(relaxed.report.classState, 'proven');
    fine.values.forEach((x, e) => assert.ok(Math.abs(x - relaxed.values[e]) < 1e-6));
    assert.deepEqual(up.interpolate(coarsest).values, coarse.values, 'finer and back is the identity');
    assert.equal(fine.interpolate(coarsest).level, coarsest);
    // Values may come from elsewhere, for example from a file.
    const again = hierarchy.foliation(fine.values);
    assert.equal(again.energy(), fine.energy());
    assert.notEqual(again.values, fine.values, 'values are copied');
    hierarchy.dispose();
});

test('a foliation of the same triangles elsewhere is a start', () => {
    const { positions, triangles } = pretzel(2, 2), moved = positions.map((x, i) => (i % 3 === 0 ? 1.1 * x : x));
    const [first, second] = [positions, moved].map(places => new hmf.Hierarchy(places, triangles, { coarsest: 100 }));
    const loops = { ...first.loops({ level: 0 }), weights: [1, 2] };
    const start = first.solve({ loops }), next = second.solve({ start }), expected = second.solve({ loops });
    assert.equal(next.report.converged, true);
    next.values.forEach((x, e) => assert.ok(Math.abs(x - expected.values[e]) < 1e-6));
    // Of the same hierarchy as well.
    second.solve({ start: next }).values.forEach((x, e) => assert.ok(Math.abs(x - next.values[e]) < 1e-6));
    assert.throws(() => second.solve({ start, loops }), error => error.statusName === 'HMF_ERROR_OPTIONS');
    assert.throws(() => second.solve({ start, progress: () => first.dispose() }), /in use by the call/);
    first.dispose();
    assert.throws(() => second.solve({ start }), /has been disposed of/);
    first.dispose();
    second.dispose();
});

test('a rectangle with an arc across', () => {
    const positions = [0, 0, 0, 3, 0, 0, 3, 2, 0, 0, 2, 0, 1.5, 0, 0, 1.5, 2, 0];
    const triangles = [0, 4, 5, 0, 5, 3, 4, 1, 2, 4, 2, 5];
    const hierarchy = new hmf.Hierarchy(positions, triangles, { markedVertices: [0, 1, 2, 3] });
    assert.deepEqual([hierarchy.genus, hierarchy.boundaryCount], [0, 1]);
    const foliation = hierarchy.solve({ loops: { elementKind: 'vertices', loops: [[4, 5]], arcs: [1] } });
    assert.ok(Math.abs(foliation.report.energy - 2 / 3) < 1e-8);
    const own = hierarchy.loops({ kind: 'cut', level: 0 });
    assert.deepEqual([own.loops.length, Array.from(own.arcs), own.arcSides.every(side => side < 3)], [1, [1], true]);
    assert.equal(hierarchy.solve({ loops: own }).report.energy, hierarchy.solve({ loops: { ...own } }).report.energy);
    hierarchy.dispose();
});

test('spheres have marked vertices', () => {
    const { positions, triangles } = octahedron();
    positions.forEach((x, i) => { if (i % 3 === 2) positions[i] = 3 * x; });
    const suggested = hmf.suggestMarks(positions, triangles);
    assert.ok(suggested instanceof Uint32Array && suggested.length >= 4 && suggested.length <= 24 && new Set(suggested).size === suggested.length);
    for (const marks of [suggested, [0, 1, 2, 3], Uint8Array.of(0, 1, 4, 5)]) {
        const hierarchy = new hmf.Hierarchy(positions, triangles, { markedVertices: marks });
        assert.equal(hierarchy.genus, 0);
        assert.equal(hierarchy.loops({ kind: 'pants', level: 0 }).loops.length, marks.length - 3);
        const foliation = hierarchy.solve(), { report } = foliation;
        assert.deepEqual([report.status, report.classState, report.poles, report.indexSum], ['HMF_OK', 'proven', 0, 4 - marks.length]);
        const { list } = foliation.singularities(), zeros = list.findIndex(({ index }) => index === 0);
        assert.equal(list.reduce((sum, { index }) => sum + index, 0), report.indexSum);
        assert.ok(zeros >= 0 && list.slice(0, zeros).every(({ index }) => index < 0));
        for (const { kind, index, element, position } of list.slice(zeros)) {
            assert.deepEqual([kind, index, position], ['vertex', 0, [...positions.subarray(3 * element, 3 * element + 3)]]);
            assert.ok([...marks].includes(element));
        }
        hierarchy.dispose();
    }
    const plate = pretzel(2, 2);
    assert.deepEqual(hmf.suggestMarks(plate.positions, plate.triangles), new Uint32Array(0));
});

test('several components in one call', () => {
    const parts = [torus(12, 8), octahedron(), torus(10, 9)], positions = [], triangles = [];
    for (const part of parts) {
        const first = positions.length / 3;
        positions.push(...part.positions);
        triangles.push(...Array.from(part.triangles, v => first + v));
    }
    const divided = hmf.components(positions, triangles), fractions = [];
    assert.deepEqual(divided.components.map(({ statusName }) => statusName), ['HMF_OK', 'HMF_ERROR_MESH_GENUS', 'HMF_OK']);
    divided.components.forEach((component, k) => {
        assert.deepEqual([component.positions, component.triangles], [Float64Array.from(parts[k].positions), Uint32Array.from(parts[k].triangles)]);
        component.wholeVertices.forEach((v, own) => assert.deepEqual([divided.vertexComponent[v], divided.vertexPart[v]], [k, own]));
        component.wholeTriangles.forEach((t, own) => assert.deepEqual([divided.triangleComponent[t], divided.trianglePart[t]], [k, own]));
    });
    const { values, components } = hmf.solveComponents(positions, triangles, { markedVertices: [], progress: fraction => { fractions.push(fraction); } });
    assert.ok(fractions.every((x, i) => i === 0 || x >= fractions[i - 1]) && fractions.at(-1) > 0.99);
    assert.deepEqual([components[1].report, components[1].statusName], [null, 'HMF_ERROR_MESH_GENUS']);
    assert.ok(components[1].message.length > 10 && components[1].wholeEdges.every(e => values[e] === 0));
    for (const k of [0, 2]) {
        const hierarchy = new hmf.Hierarchy(parts[k].positions, parts[k].triangles), alone = hierarchy.solve();
        assert.deepEqual(Float64Array.from(components[k].wholeEdges, e => values[e]), alone.values);
        assert.equal(components[k].report.energy, alone.report.energy);
        hierarchy.dispose();
    }

    const markedVertices = hmf.suggestMarks(positions, triangles);
    assert.ok(markedVertices.length >= 4 && markedVertices.every(v => divided.vertexComponent[v] === 1));
    assert.ok(hmf.solveComponents(positions, triangles, { markedVertices }).components.every(({ status }) => status === 0));

    const loop = Array.from({ length: 10 }, (_, i) => divided.components[2].wholeVertices[9 * i]);
    const own = hmf.solveComponents(positions, triangles, { markedVertices: [], loops: { elementKind: 'vertices', loops: [loop], weights: [2] } });
    assert.deepEqual(own.components.map(({ statusName }) => statusName), ['HMF_ERROR_LOOP_COUNT', 'HMF_ERROR_MESH_GENUS', 'HMF_OK']);
    assert.throws(() => hmf.solveComponents(positions, triangles, { loops: { elementKind: 'vertices', loops: [[0, loop[0]]] } }), /does not lie on one component/);
    assert.throws(() => hmf.solveComponents(positions, triangles, { ratio: 3 }), ({ statusName }) => statusName === 'HMF_ERROR_OPTIONS');
    assert.throws(() => hmf.solveComponents(positions, triangles, { stopLevel: 1 }), /stopLevel/);
    assert.equal(hmf.memory.inUse, 0);
});

test('mollify accepts triangles without area', () => {
    const { positions, triangles } = torus(12, 8);
    positions.copyWithin(0, 3 * 8, 3 * 8 + 3); // two vertices at one place
    assert.throws(() => new hmf.Hierarchy(positions, triangles), error => error.statusName === 'HMF_ERROR_MESH_DEGENERATE');
    const hierarchy = new hmf.Hierarchy(positions, triangles, { mollify: 1e-5 });
    assert.equal(hierarchy.solve().report.converged, true);
    hierarchy.dispose();
});

test('the methods agree on the energy', () => {
    const { positions, triangles } = pretzel(2, 2);
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100 });
    const newton = hierarchy.solve().energy();
    for (const method of ['whitehead', 'single-level']) {
        const foliation = hierarchy.solve({ method, energyTolerance: 1e-7 });
        assert.equal(foliation.report.method, method);
        assert.ok(foliation.energy() >= newton && foliation.energy() < 1.01 * newton, `${method}: ${foliation.energy()} and ${newton}`);
    }
    hierarchy.dispose();
});

test('limits are results, not exceptions', () => {
    const { positions, triangles } = pretzel(2, 2);
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100 });
    const { report, values } = hierarchy.solve({ method: 'whitehead', iterationLimit: 1, tolerance: 1e-15 });
    assert.equal(report.status, 'HMF_LIMIT_ITERATIONS');
    assert.match(report.stopped.advice, /Raise iterationLimit/);
    assert.equal(report.converged, false);
    assert.ok(report.history.length > 2);
    assert.equal(brokenTriangles(values, hierarchy.levels[0].triangleEdges()), 0);
    assert.equal(hierarchy.solve({ method: 'whitehead', timeLimit: 1e-9, tolerance: 1e-15 }).report.status, 'HMF_LIMIT_TIME');
    hierarchy.dispose();
});

test('build options reach the library', () => {
    const { positions, triangles } = pretzel(2, 2);
    const vertexCounts = options => {
        const hierarchy = new hmf.Hierarchy(positions, triangles, options);
        const counts = hierarchy.levels.map(level => level.vertexCount);
        hierarchy.dispose();
        return counts;
    };
    assert.equal(vertexCounts({ coarsest: 1000 }).length, 1, 'the mesh has fewer vertices');
    assert.ok(vertexCounts().length > 1, 'by default the coarsest level has a sixteenth of them');
    assert.ok(vertexCounts({ coarsest: 100, ratio: 0.8 }).length > vertexCounts({ coarsest: 100, ratio: 0.3 }).length);
    const positionsOf = collapse => {
        const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 100, collapse });
        const result = hierarchy.levels.at(-1).positions();
        hierarchy.dispose();
        return result;
    };
    assert.notDeepEqual(positionsOf('midpoint'), positionsOf('qslim'));
    assert.deepEqual(positionsOf('midpoint'), positionsOf('default'));
});

test('inputs are not changed, and parts of larger arrays may be given', () => {
    const { positions, triangles } = smallTorus();
    const padded = new Float64Array(positions.length + 5);
    padded.set(positions, 5);
    const part = padded.subarray(5), before = part.slice();
    const a = new hmf.Hierarchy(part, triangles), b = new hmf.Hierarchy(positions, triangles);
    assert.deepEqual(part, before);
    assert.deepEqual(a.solve().values, b.solve().values);
    a.dispose();
    b.dispose();
});

test('positions and triangles may be arrays of any kind', () => {
    const { positions, triangles } = smallTorus(), expected = new hmf.Hierarchy(positions, triangles), { values } = expected.solve();
    for (const Positions of [Float64Array, Float32Array, Int16Array, Array])
        for (const Triangles of [Uint32Array, Uint16Array, Uint8Array, Int32Array, Array]) {
            withHierarchy(new hmf.Hierarchy(Positions.from(positions), Triangles.from(triangles)), hierarchy => {
                assert.deepEqual(hierarchy.solve().values, values);
                assert.deepEqual(hierarchy.levels[0].positions(), positions);
            });
        }
    withHierarchy(new hmf.Hierarchy(Uint16Array.from(positions, x => x + 3), Uint32Array.from(triangles)), hierarchy =>
        hierarchy.solve().values.forEach((value, e) => assert.ok(Math.abs(value - values[e]) < 1e-9)));
    // One third is another number with 24 bits.
    const third = positions.map(x => x / 3);
    withHierarchy(new hmf.Hierarchy(Float32Array.from(third), triangles), hierarchy => assert.deepEqual(hierarchy.levels[0].positions(), third.map(Math.fround)));
    assert.deepEqual(expected.foliation([...values]).values, values);
    expected.dispose();
});

function withHierarchy(hierarchy, work) {
    try { work(hierarchy); } finally { hierarchy.dispose(); }
}

test('version, status texts, memory estimate', () => {
    assert.match(hmf.version, /^\d+\.\d+\.\d+$/);
    assert.equal(hmf.statusText(0), 'success');
    assert.equal(hmf.statusName(305), 'HMF_ERROR_MESH_BOUNDARY');
    assert.match(hmf.statusName(12345), /12345/);
    const { positions, triangles } = pretzel(2, 3);
    const estimate = hmf.memoryEstimate(positions.length / 3, triangles.length / 3);
    const hierarchy = new hmf.Hierarchy(positions, triangles, { memoryLimit: estimate });
    assert.ok(hierarchy.memoryBytes > 0 && hierarchy.memoryBytes < estimate);
    hierarchy.dispose();
    assert.equal(hmf.memoryEstimate(0, 0), 0);
    assert.equal(hmf.memoryEstimate(2 ** 40, 2 ** 41), 0);
});

test('loops by kind, and marked vertices by default', () => {
    const { positions, triangles } = pretzel(2, 6), hierarchy = new hmf.Hierarchy(positions, triangles);
    for (const loops of ['cut', 'handle', 'tunnel', 'pants', 'even']) assert.ok(hierarchy.solve({ loops }).report.converged, loops);
    assert.throws(() => hierarchy.solve({ loops: 'trousers' }), /'cut'/);
    assert.throws(() => hierarchy.solve({ tolerance: 0 }), /tolerance: 0 is not in \(0, 1\)/);
    assert.equal(hierarchy.solve({ timeLimit: 0 }).report.status, 'HMF_LIMIT_TIME');
    hierarchy.dispose();
});
