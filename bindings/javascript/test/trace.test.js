// Leaves against the foliation that they belong to.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { load } from '../lib/index.js';
import { pretzel, torus } from '../examples/shapes.js';

let hmf;
before(async () => { hmf = await load(); });

const distance = (points, i, j) => Math.hypot(...[0, 1, 2].map(k => points[3 * i + k] - points[3 * j + k]));

/** Properties that every leaf has; the mesh is level 0. */
function check(line, hierarchy) {
    const { positions, vertices, triangleEdges } = hierarchy, count = line.edges.length;
    assert.equal(line.points.length, 3 * count);
    let length = 0;
    for (let i = 0; i < count; ++i) {
        const edge = line.edges[i];
        if (edge !== 0xffffffff) {
            // The point lies on its edge.
            const ends = [0, 1].map(end => positions.subarray(3 * vertices[2 * edge + end], 3 * vertices[2 * edge + end] + 3));
            const to = ends.map(end => Math.hypot(...[0, 1, 2].map(k => end[k] - line.points[3 * i + k]))), whole = Math.hypot(...[0, 1, 2].map(k => ends[0][k] - ends[1][k]));
            assert.ok(Math.abs(to[0] + to[1] - whole) < 1e-9 * (1 + whole));
        }
        if (i + 1 < count || line.closed) {
            const next = line.edges[(i + 1) % count];
            length += distance(line.points, i, (i + 1) % count);
            if (edge !== 0xffffffff && next !== 0xffffffff && edge !== next) assert.ok(triangleEdges.get(edge).some(t => triangleEdges.get(next).includes(t)), 'consecutive points lie in one triangle');
        }
    }
    assert.ok(Math.abs(length - line.length) < 1e-9 * (1 + length));
}

function described(hierarchy) {
    const level = hierarchy.levels[0], triangleEdges = new Map();
    level.triangleEdges().forEach((edge, k) => triangleEdges.set(edge, [...(triangleEdges.get(edge) ?? []), Math.floor(k / 3)]));
    return { positions: level.positions(), vertices: level.edgeVertices(), triangleEdges };
}

test('a torus: circles at the asked distance', () => {
    const n = 48, m = 24, R = 3, r = 1, { positions, triangles } = torus(n, m, R, r);
    const hierarchy = new hmf.Hierarchy(positions, triangles), mesh = described(hierarchy);
    // The leaves are the circles around the axis; once around the tube is 2.
    const loop = Array.from({ length: n }, (_, i) => i * m);
    const foliation = hierarchy.solve({ loops: { elementKind: 'vertices', loops: [loop], weights: [2] } });
    const lines = foliation.trace({ spacing: 0.25 });
    assert.equal(lines.length, 8);
    lines.forEach((line, i) => {
        assert.equal(line.kind, 'level');
        assert.equal(line.closed, true);
        assert.deepEqual([line.begin, line.end, line.beginZero, line.endZero], ['closed', 'closed', null, null]);
        assert.equal(line.cylinder, 0);
        assert.equal(line.source, i);
        assert.ok(Math.abs(line.height - (i + 0.5) / 4) < 1e-9);
        assert.ok(line.length > 2 * Math.PI * (R - r) * 0.99 && line.length < 2 * Math.PI * (R + r) * 1.01);
        check(line, mesh);
    });
    assert.equal(foliation.trace().length, 0, 'there are no zeros');
    hierarchy.dispose();
});

test('genus 3: leaves between zeros, leaves through points, a limit', () => {
    const { positions, triangles } = pretzel(3, 3);
    const hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve(), mesh = described(hierarchy);
    const zeros = foliation.singularities().list, critical = foliation.trace();
    // A zero of order k has k + 2 of them, and each has two ends.
    assert.equal(2 * critical.length, zeros.reduce((sum, { index }) => sum - index + 2, 0));
    const ends = new Array(zeros.length).fill(0);
    critical.forEach((line, i) => {
        assert.equal(line.kind, 'critical');
        assert.equal(line.source, i);
        assert.equal(line.cylinder, null);
        assert.deepEqual([line.begin, line.end, line.closed], ['zero', 'zero', false]);
        ++ends[line.beginZero];
        ++ends[line.endZero];
        check(line, mesh);
    });
    zeros.forEach(({ index }, i) => assert.equal(ends[i], 2 - index));

    const through = { triangles: [10, 500], barycentrics: [0.2, 0.3, 0.5, 0.6, 0.2, 0.2] };
    const [first, second] = foliation.trace({ through });
    for (const [i, line] of [first, second].entries()) {
        assert.equal(line.kind, 'point');
        assert.equal(line.source, i);
        assert.equal(line.closed, true);
        assert.ok(line.edges.some(edge => mesh.triangleEdges.get(edge).includes(through.triangles[i])), 'it passes the triangle');
        check(line, mesh);
    }
    const lengthLimit = first.length / 4, [cut] = foliation.trace({ through, lengthLimit });
    assert.deepEqual([cut.begin, cut.end, cut.closed], ['limit', 'limit', false]);
    assert.ok(Math.abs(cut.length - 2 * lengthLimit) < 0.2 * first.length, `${cut.length} and ${lengthLimit}`);
    assert.equal(foliation.trace({ critical: true, spacing: 0.5, through }).length, critical.length + foliation.trace({ spacing: 0.5 }).length + 2);
    hierarchy.dispose();
});

test('conjugate leaves cross each cylinder from side to side', () => {
    const { positions, triangles } = pretzel(3, 3);
    const hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve(), cylinders = foliation.cylinders().list;
    const spacing = 0.05, lines = foliation.trace({ leaves: 'conjugate', spacing });
    cylinders.forEach(({ circumference }, c) => {
        const across = lines.filter(line => line.cylinder === c);
        assert.equal(across.length, Math.max(1, Math.round(circumference / spacing)));
        for (const line of across) assert.deepEqual([line.kind, line.closed, line.begin, line.end], ['level', false, 'critical', 'critical']);
    });
    assert.equal(lines.length, cylinders.reduce((sum, { circumference }) => sum + Math.max(1, Math.round(circumference / spacing)), 0));
    assert.deepEqual(foliation.trace({ spacing, leaves: 'foliation' }), foliation.trace({ spacing }));
    assert.throws(() => foliation.trace({ leaves: 'both' }), /leaves is string both; give one of/);
    hierarchy.dispose();
});

test('one cylinder for each loop, as high as its weight', () => {
    const { positions, triangles } = pretzel(3, 3), weights = [1, 2, 0.5];
    const hierarchy = new hmf.Hierarchy(positions, triangles, { coarsest: 200 }), loops = { ...hierarchy.loops(), weights };
    const foliation = hierarchy.solve({ loops }), { list: cylinders, leaves, ...found } = foliation.cylinders({ loops }), { triangleEdges } = described(hierarchy);
    assert.deepEqual(cylinders.map(({ loop }) => loop).sort(), [0, 1, 2]);
    const sides = new Map();
    for (const [edge, around] of triangleEdges) for (const t of around) sides.set(t, [...(sides.get(t) ?? []), edge]);
    assert.deepEqual([leaves.elementKind, leaves.level, leaves.loops.length], ['triangles', 0, 3]);
    assert.deepEqual([...leaves.weights], cylinders.map(({ height }) => height));
    for (const [i, { loop, height, circumference, modulus, area }] of cylinders.entries()) {
        assert.equal(height, weights[loop]);
        assert.ok(Math.abs(modulus - height / circumference) < 1e-12 * modulus);
        assert.ok(Math.abs(area - height * circumference) < 1e-9 * area);
        const [first, second] = [0, 1].map(side => Number(found.cornerOffsets[2 * i + side]));
        assert.deepEqual([found.cornerPlaces[first], found.cornerPlaces[second]], [0, found.twists[i]]);
        assert.ok(found.cornerVertices[first] <= found.cornerVertices[second]);
        const leaf = leaves.loops[i];
        leaf.forEach((t, k) => assert.ok(sides.get(t).some(e => sides.get(leaf[(k + 1) % leaf.length]).includes(e)), 'a closed chain'));
    }
    const energy = foliation.energy(), areas = cylinders.reduce((sum, { area }) => sum + area, 0);
    assert.ok(Math.abs(areas / energy - 1) < 1e-6, `${areas} and ${energy}`);
    // The middle leaves are loops of the same class: they give the same foliation.
    const again = hierarchy.solve({ loops: leaves });
    again.values.forEach((value, e) => assert.ok(Math.abs(value - foliation.values[e]) < 1e-6));
    const byDefault = foliation.cylinders(); // of its own loops
    assert.deepEqual(byDefault.leaves, leaves);
    assert.deepEqual(byDefault.list, cylinders);
    // Leaves name their cylinder by its place in the list.
    for (const line of foliation.trace({ spacing: 0.25 })) assert.ok(line.height < cylinders[line.cylinder].height);
    assert.throws(() => foliation.cylinders({ loops: { ...loops, weights: [1, 1, 1] } }), error => error.statusName === 'HMF_ERROR_VALUE_CLASS');
    assert.throws(() => hierarchy.initialize(loops).cylinders(), error => error.statusName === 'HMF_ERROR_VALUE_NOT_HARMONIC');
    assert.throws(() => foliation.cylinders({ loop: loops }), /no option 'loop'/);
    hierarchy.dispose();
    assert.equal(hmf.memory.inUse, 0);
});

test('what cannot be traced', () => {
    const { positions, triangles } = torus(12, 8);
    const hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve(), { inUse } = hmf.memory;
    const through = { triangles: [1, 2], barycentrics: [1, 0, 0, 2, 0, 0] };
    for (let i = 0; i < 100; ++i) assert.throws(() => foliation.trace({ through }), error => error.statusName === 'HMF_ERROR_OPTIONS' && error.index === 1);
    assert.throws(() => foliation.trace({ through: { triangles: [1], barycentrics: [1, 0] } }), /barycentrics has 2 entries; give 3/);
    assert.throws(() => foliation.trace({ through: { triangles: [1] } }), /through.barycentrics is undefined/);
    assert.throws(() => foliation.trace({ spacing: '1' }), /spacing is string 1/);
    assert.throws(() => foliation.trace({ space: 1 }), /no option 'space'/);
    assert.equal(hmf.memory.inUse, inUse);
    hierarchy.dispose();
});
