// Loops through picked vertices or points: shortest paths along edges.
import { constants } from '../dist/layout.js';
import { HmfError } from './error.js';
import { indices, numbers, optionsOf, realNumber } from './arguments.js';
import { diagonalOf } from './boundaries.js';

const near = 0.1; // of the diagonal of the box: points further from the surface are of another one

const minus = (a, b) => a.map((x, k) => x - b[k]);
const dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const cross = (a, b) => a.map((_, k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);

/** Of a point from a triangle. */
function distance(point, corners) {
    const sides = corners.map((corner, k) => minus(corners[(k + 1) % 3], corner)), away = corners.map(corner => minus(point, corner));
    const normal = cross(sides[0], sides[1]), size = dot(normal, normal);
    if (size > 0 && sides.every((side, k) => dot(cross(side, away[k]), normal) > 0)) return Math.abs(dot(away[0], normal)) / Math.sqrt(size);
    return Math.min(...sides.map((side, k) => {
        const along = Math.min(Math.max(dot(away[k], side) / Math.max(dot(side, side), Number.MIN_VALUE), 0), 1);
        return Math.hypot(...away[k].map((x, i) => x - along * side[i]));
    }));
}

/** The vertex next to a point that lies within a distance of the surface. */
function nearest(mesh, given, name, within) {
    const point = Array.from(numbers(given, name, { count: 3 })), limit = within ?? near * diagonalOf(mesh.positions);
    const at = vertex => Array.from(mesh.positions.subarray(3 * vertex, 3 * vertex + 3));
    let least = Infinity, best = 0, height = Infinity;
    for (let vertex = 0; vertex < mesh.first.length - 1; ++vertex) {
        const away = Math.hypot(...minus(point, at(vertex)));
        if (away < least) [least, best] = [away, vertex];
    }
    for (let t = 0; t < mesh.triangles.length; t += 3)
        height = Math.min(height, distance(point, Array.from(mesh.triangles.subarray(t, t + 3), at)));
    if (!(height <= limit))
        throw new HmfError(constants.HMF_ERROR_OPTIONS, 'an option is out of range', constants.HMF_ELEMENT_OPTION, 0,
            `${name}, [${point}], is ${height.toPrecision(3)} from the surface, more than within: ${limit.toPrecision(3)}. Check its unit and axes, or give a larger distance within.`);
    return best;
}

/** Positions, triangles, and the neighbors of vertex v with their distances: entries first[v] to first[v + 1]. */
function graphOf(level) {
    const positions = level.positions(), ends = level.edgeVertices(), first = new Uint32Array(level.vertexCount + 1);
    for (const vertex of ends) ++first[vertex + 1];
    for (let vertex = 0; vertex < level.vertexCount; ++vertex) first[vertex + 1] += first[vertex];
    const at = first.slice(), targets = new Uint32Array(ends.length), lengths = new Float64Array(ends.length);
    for (let i = 0; i < ends.length; ++i) {
        const from = ends[i], to = ends[i ^ 1], place = at[from]++;
        targets[place] = to;
        lengths[place] = Math.hypot(...[0, 1, 2].map(k => positions[3 * from + k] - positions[3 * to + k]));
    }
    return { positions, triangles: level.triangleVertices(), first, targets, lengths };
}

/** Dijkstra's: the vertices of a shortest path without its end. */
function path(mesh, start, goal) {
    const away = new Float64Array(mesh.first.length - 1).fill(Infinity), previous = new Uint32Array(away.length), heap = [];
    const before = (a, b) => a[0] < b[0] || (a[0] === b[0] && a[1] < b[1]);
    const push = entry => {
        let at = heap.push(entry) - 1;
        for (let up; at > 0 && before(entry, heap[up = (at - 1) >> 1]); at = up) heap[at] = heap[up];
        heap[at] = entry;
    };
    const pop = () => {
        const top = heap[0], last = heap.pop();
        if (heap.length === 0) return top;
        let at = 0;
        for (let down; (down = 2 * at + 1) < heap.length; at = down) {
            if (down + 1 < heap.length && before(heap[down + 1], heap[down])) ++down;
            if (!before(heap[down], last)) break;
            heap[at] = heap[down];
        }
        heap[at] = last;
        return top;
    };
    away[goal] = 0; // backwards, so that the path comes out in its order
    push([0, goal]);
    while (heap.length) {
        const [length, vertex] = pop();
        if (vertex === start) break;
        if (length > away[vertex]) continue; // a shorter path was found since
        for (let i = mesh.first[vertex]; i < mesh.first[vertex + 1]; ++i) {
            const next = mesh.targets[i], more = length + mesh.lengths[i];
            if (more >= away[next]) continue;
            [away[next], previous[next]] = [more, vertex];
            push([more, next]);
        }
    }
    const found = [];
    for (let vertex = start; vertex !== goal; vertex = previous[vertex]) found.push(vertex);
    return found;
}

export function loopsThrough(hierarchy, picked, options) {
    const given = optionsOf(options, 'options', ['within', 'weights']), mesh = graphOf(hierarchy.levels[0]), count = mesh.first.length - 1;
    if (given.within !== undefined) realNumber(given.within, 'within');
    if (!Array.isArray(picked)) throw new TypeError('picked is not an array; give one array of vertices or points for each loop.');
    const loops = picked.map((stops, i) => {
        const name = `picked[${i}]`, isPoints = Array.isArray(stops) && typeof stops[0] === 'object';
        const found = isPoints ? stops.map((point, k) => nearest(mesh, point, `${name}[${k}]`, given.within)) : Array.from(indices(stops, name));
        const outside = found.find(vertex => vertex >= count);
        if (outside !== undefined) throw new TypeError(`${name} has vertex ${outside}; the mesh has ${count}, counted from 0.`);
        if (found.length < 3) throw new TypeError(`${name} has ${found.length} entries; give at least three vertices or points.`);
        return Uint32Array.from(found.flatMap((vertex, k) => path(mesh, vertex, found[(k + 1) % found.length])));
    });
    return { elementKind: 'vertices', level: 0, loops, ...(given.weights === undefined ? {} : { weights: given.weights }) };
}
