// What a mesh has that nobody may have meant: holes, and vertices without a triangle.
import { constants } from '../dist/layout.js';
import { HmfError } from './error.js';

const fewEdges = 4; // a boundary of so many is rarely meant
const shortBoundary = 0.01; // of the diagonal of the box

const counted = (count, one, several) => `${count} ${count === 1 ? one : several}`;

/** The vertices of each boundary curve of a level, in their order along it. */
export function boundaryCurves(level) {
    const edges = level.triangleEdges(), corners = level.triangleVertices(), uses = new Uint8Array(level.edgeCount);
    for (const edge of edges) ++uses[edge];
    const following = new Map();
    edges.forEach((edge, side) => {
        // The surface lies on the left of its sides, and on the right of its boundary.
        if (uses[edge] === 1) following.set(corners[side % 3 === 2 ? side - 2 : side + 1], corners[side]);
    });
    const curves = [];
    for (const [start] of following) {
        const curve = [];
        for (let vertex = start; following.has(vertex);) {
            curve.push(vertex);
            const next = following.get(vertex);
            following.delete(vertex);
            vertex = next;
        }
        if (curve.length) curves.push(Uint32Array.from(curve));
    }
    return curves;
}

function lengthOf(curve, positions) {
    const apart = (a, b) => Math.hypot(...[0, 1, 2].map(k => positions[3 * a + k] - positions[3 * b + k]));
    return curve.reduce((sum, vertex, i) => sum + apart(vertex, curve[(i + 1) % curve.length]), 0);
}

export function diagonalOf(positions) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    positions.forEach((x, i) => {
        low[i % 3] = Math.min(low[i % 3], x);
        high[i % 3] = Math.max(high[i % 3], x);
    });
    return Math.hypot(...low.map((x, k) => high[k] - x));
}

/** A sentence about curves that look like holes by accident; undefined: none does. */
export function holeWarning(curves, positions) {
    const short = shortBoundary * diagonalOf(positions);
    const holes = curves.filter(curve => curve.length <= fewEdges || lengthOf(curve, positions) < short);
    if (holes.length === 0) return undefined;
    const edges = Math.min(...holes.map(curve => curve.length));
    return `${counted(holes.length, 'boundary looks like a hole', 'boundaries look like holes')} by accident, the smallest with ${edges} edges; `
        + 'a hole changes the answer: close it in the mesh, or give closed: true to refuse such meshes.';
}

/** What closed: true throws. */
export function notClosed(module, curves) {
    return new HmfError(constants.HMF_ERROR_MESH_BOUNDARY, module.statusText(constants.HMF_ERROR_MESH_BOUNDARY), constants.HMF_ELEMENT_VERTEX, curves[0][0],
        `The mesh has ${counted(curves.length, 'boundary', 'boundaries')}, the first with ${curves[0].length} edges, and closed: true was given. Close it, or leave that out.`);
}

/** The mesh without vertices that no triangle has: positions, triangles, the vertices that are kept, and a sentence. */
export function withoutUnused(positions, triangles) {
    const number = new Map([...new Set(triangles)].sort((a, b) => a - b).map((vertex, i) => [vertex, i]));
    const kept = Uint32Array.from(number.keys()), dropped = positions.length / 3 - kept.length;
    const points = new Float64Array(3 * kept.length);
    kept.forEach((vertex, i) => { for (let k = 0; k < 3; ++k) points[3 * i + k] = positions[3 * vertex + k]; });
    return {
        positions: points, triangles: Uint32Array.from(triangles, vertex => number.get(vertex)), kept, number,
        note: `dropped ${counted(dropped, 'vertex', 'vertices')} without a triangle; the others are numbered without them, keptVertices has their numbers in the mesh that was given.`,
    };
}
