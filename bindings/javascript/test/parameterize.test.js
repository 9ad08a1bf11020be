// The parameterization against what the foliation and the mesh say.
import assert from 'node:assert/strict';
import { before, test } from 'node:test';
import { load } from '../lib/index.js';
import { pretzel, torus } from '../examples/shapes.js';

let hmf;
before(async () => { hmf = await load(); });

/** The two triangles of each edge with the side there, the lower one first. */
function sidesOf(triangleEdges, edgeCount) {
    const sides = Array.from({ length: edgeCount }, () => []);
    triangleEdges.forEach((edge, k) => sides[edge].push({ t: Math.floor(k / 3), s: k % 3 }));
    return sides;
}

/** Checks the transitions, exactly, and returns how many edges have one that is not trivial. */
function checkTransitions({ cornerUv, transition, seam }, sides) {
    let seams = 0;
    sides.forEach(([first, second], e) => {
        const [sign, du, dv] = transition.subarray(3 * e, 3 * e + 3);
        assert.ok(Math.abs(sign) === 1);
        if (!seam[e]) assert.deepEqual([sign, du, dv], [1, 0, 0]);
        else ++seams;
        for (const [a, b] of [[first.s, (second.s + 1) % 3], [(first.s + 1) % 3, second.s]]) {
            const at = 2 * (3 * first.t + a), there = 2 * (3 * second.t + b);
            assert.equal(cornerUv[there], sign * cornerUv[at] + du, `u at edge ${e}`);
            assert.equal(cornerUv[there + 1], sign * cornerUv[at + 1] + dv, `v at edge ${e}`);
        }
    });
    return seams;
}

test('a torus: |du| is the foliation, everywhere, and the map is conformal', () => {
    const { positions, triangles } = torus(120, 60);
    const hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve(), result = foliation.parameterize();
    const triangleEdges = hierarchy.levels[0].triangleEdges();
    triangleEdges.forEach((edge, k) => {
        const t = Math.floor(k / 3), next = 3 * t + ((k + 1) % 3);
        assert.ok(Math.abs(Math.abs(result.cornerUv[2 * k] - result.cornerUv[2 * next]) - foliation.values[edge]) < 1e-9);
    });
    assert.equal(checkTransitions(result, sidesOf(triangleEdges, foliation.values.length)), result.seamEdgeCount);
    assert.ok(result.cone.every(cone => cone === 2));
    assert.equal(result.flippedCount, 0);
    assert.equal(result.degenerateCount, 0);
    assert.ok(result.dilatationMean >= 1 && result.dilatationMean < 1.05, `${result.dilatationMean}`);
    assert.ok(result.dilatation.every(x => x >= 1));
    assert.ok(Math.abs(result.area / foliation.energy() - 1) < 0.02, `${result.area} and ${foliation.energy()}`);
    hierarchy.dispose();
});

test('genus 3: cones, transitions, seams, the differential', () => {
    const { positions, triangles } = pretzel(3, 4);
    const hierarchy = new hmf.Hierarchy(positions, triangles), foliation = hierarchy.solve(), result = foliation.parameterize();
    const [{ edgeCount, vertexCount, triangleCount }] = hierarchy.levels, vertices = hierarchy.levels[0].edgeVertices();
    assert.deepEqual([result.cornerUv, result.transition, result.seam, result.cone, result.dilatation, result.differential].map(array => array.length),
        [6 * triangleCount, 3 * edgeCount, edgeCount, vertexCount, triangleCount, 2 * triangleCount]);
    assert.equal(result.cone.reduce((sum, cone) => sum + 2 - cone, 0), 4 - 4 * 3);
    const sides = sidesOf(hierarchy.levels[0].triangleEdges(), edgeCount);
    assert.equal(checkTransitions(result, sides), result.seamEdgeCount);
    const lengths = Float64Array.from({ length: edgeCount }, (_, e) =>
        Math.hypot(...[0, 1, 2].map(k => positions[3 * vertices[2 * e] + k] - positions[3 * vertices[2 * e + 1] + k])));
    const length = result.seam.reduce((sum, cut, e) => sum + cut * lengths[e], 0);
    assert.ok(Math.abs(length / result.seamLength - 1) < 1e-9);
    // (d(u + iv) / dz)^2 along side 0 is the square of the difference there over its length.
    for (let t = 0; t < triangleCount; t += 97) {
        const [a, b] = [3 * triangles[3 * t], 3 * triangles[3 * t + 1]], uv = result.cornerUv.subarray(6 * t, 6 * t + 6);
        // Exact for a conformal map only: allow for the dilatation of the triangle.
        const side = Math.hypot(...[0, 1, 2].map(k => positions[b + k] - positions[a + k]));
        const [re, im] = [(uv[2] - uv[0]) / side, (uv[3] - uv[1]) / side], size = re * re + im * im;
        const off = Math.hypot(re * re - im * im - result.differential[2 * t], 2 * re * im - result.differential[2 * t + 1]);
        assert.ok(off < 3 * (result.dilatation[t] - 1) * size + 1e-6 * size, `triangle ${t}: ${off / size}, dilatation ${result.dilatation[t]}`);
    }
    assert.ok(result.linearIterations > 0 && result.seconds > 0);
    assert.ok(result.dilatationMedian <= result.dilatationP99);

    // Where edges are free on one side of the plate, the seams run there.
    const below = e => [0, 1].every(end => positions[3 * vertices[2 * e + end] + 2] < 0);
    const seamEdges = [...result.seam.keys()].filter(below), free = foliation.parameterize({ seamEdges });
    const above = ({ seam }) => seam.reduce((sum, cut, e) => sum + (cut && !below(e) ? lengths[e] : 0), 0);
    assert.ok(above(free) < 0.8 * above(result), `${above(free)} and ${above(result)}`);
    assert.equal(checkTransitions(free, sides), free.seamEdgeCount);
    hierarchy.dispose();
});

test('what cannot be parameterized', () => {
    const { positions, triangles } = torus(24, 16);
    const hierarchy = new hmf.Hierarchy(positions, triangles), start = hierarchy.initialize(hierarchy.loops({ level: 0 })), foliation = hierarchy.solve();
    assert.throws(() => start.parameterize(), error => error.statusName === 'HMF_ERROR_VALUE_NOT_HARMONIC' && error.status === 503);
    assert.throws(() => foliation.parameterize({ seamEdges: [99999] }), error => error.name === 'HmfError' && error.status < 500);
    assert.throws(() => foliation.parameterize({ seamEdges: [-1] }), /seamEdges\[0\] is number -1/);
    assert.throws(() => foliation.parameterize({ seams: [] }), /no option 'seams'/);
    assert.throws(() => foliation.parameterize({ progress: () => 'cancel' }), error => error.statusName === 'HMF_CANCELLED');
    const reason = new Error('enough');
    assert.throws(() => foliation.parameterize({ progress: () => { throw reason; } }), error => error === reason);
    foliation.parameterize(); // what it finds out about the minimum stays with the foliation
    const { inUse } = hmf.memory;
    for (let i = 0; i < 100; ++i) assert.throws(() => start.parameterize());
    foliation.parameterize();
    assert.equal(hmf.memory.inUse, inUse);
    hierarchy.dispose();
    assert.equal(hmf.memory.inUse, 0);
});
