// Meshes that only the tests need, and checks of foliations that share no code
// with the library.
import { torus } from '../examples/shapes.js';

/** The torus of 7 vertices, 14 triangles and 21 edges. */
export const smallTorus = () => ({
    positions: Float64Array.of(3, -3, 0, -3, 3, 0, -3, -3, 1, 3, 3, 1, -1, -2, 3, 1, 2, 3, 0, 0, 15),
    triangles: Uint32Array.of(0, 1, 3, 0, 3, 2, 1, 2, 4, 1, 4, 3, 2, 3, 5, 2, 5, 4, 3, 4, 6, 3, 6, 5, 4, 5, 0, 4, 0, 6, 5, 6, 1, 5, 1, 0, 6, 0, 2, 6, 2, 1),
});

export const octahedron = () => ({
    positions: Float64Array.of(1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1),
    triangles: Uint32Array.of(0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5),
});

/** Two tori side by side in one mesh. */
export function twoTori() {
    const one = torus(12, 8), n = one.positions.length / 3;
    return {
        positions: Float64Array.from([...one.positions, ...one.positions.map((x, i) => (i % 3 === 0 ? x + 100 : x))]),
        triangles: Uint32Array.from([...one.triangles, ...one.triangles.map(v => v + n)]),
    };
}

/** Edges in the order of their first appearance in the triangles, as the header numbers them. */
export function edgesOf(triangles) {
    const edges = [], triangleEdges = [], numbers = new Map();
    for (let t = 0; t < triangles.length; t += 3) {
        for (let s = 0; s < 3; ++s) {
            const a = triangles[t + s], b = triangles[t + ((s + 1) % 3)], key = `${Math.min(a, b)},${Math.max(a, b)}`;
            if (!numbers.has(key)) {
                numbers.set(key, edges.length);
                edges.push([a, b]);
            }
            triangleEdges.push(numbers.get(key));
        }
    }
    return { edges, triangleEdges };
}

/** Triangles whose longest side is longer than the other two together; exact for values of the library. */
export function brokenTriangles(values, triangleEdges) {
    let broken = 0;
    for (let t = 0; t < triangleEdges.length; t += 3) {
        const [a, b, c] = [values[triangleEdges[t]], values[triangleEdges[t + 1]], values[triangleEdges[t + 2]]];
        if (a > b + c || b > c + a || c > a + b) ++broken;
    }
    return broken;
}

/** Half the sum of the opposite cotangents of each edge. */
export function cotangentWeights(positions, triangles, edgeCount, triangleEdges) {
    const weights = new Float64Array(edgeCount);
    for (let t = 0; t < triangles.length; t += 3) {
        for (let s = 0; s < 3; ++s) {
            const [a, b, c] = [s, (s + 1) % 3, (s + 2) % 3].map(k => positions.subarray(3 * triangles[t + k], 3 * triangles[t + k] + 3));
            const p = [a[0] - c[0], a[1] - c[1], a[2] - c[2]], q = [b[0] - c[0], b[1] - c[1], b[2] - c[2]];
            const cross = Math.sqrt((p[1] * q[2] - p[2] * q[1]) ** 2 + (p[2] * q[0] - p[0] * q[2]) ** 2 + (p[0] * q[1] - p[1] * q[0]) ** 2);
            weights[triangleEdges[t + s]] += (p[0] * q[0] + p[1] * q[1] + p[2] * q[2]) / cross / 2;
        }
    }
    return weights;
}
