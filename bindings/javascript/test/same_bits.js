// Prints the three lines of bindings/same_bits/README.md, which every binding
// must print alike.
import { load } from '../lib/index.js';

const directions = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];
const corners = [
    [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
    [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
    [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]], [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
];

/** A plate of unit cubes with holesX x holesY holes. */
function plate(holesX, holesY, side, height) {
    const width = (2 * holesX + 1) * side, depth = (2 * holesY + 1) * side;
    const solid = (x, y, z) => x >= 0 && x < width && y >= 0 && y < depth && z >= 0 && z < height
        && !(Math.floor(x / side) % 2 === 1 && Math.floor(y / side) % 2 === 1);
    const positions = [], triangles = [], numbers = new Map();
    const vertex = (i, j, k) => {
        const point = (k * (depth + 1) + j) * (width + 1) + i;
        if (!numbers.has(point)) {
            numbers.set(point, positions.length / 3);
            positions.push(16 * i + (3 * i + 5 * j + 6 * k + i * j) % 7 - 3,
                16 * j + (5 * i + 2 * j + 3 * k + j * k) % 7 - 3,
                16 * k + (2 * i + 3 * j + 5 * k + k * i) % 7 - 3);
        }
        return numbers.get(point);
    };
    for (let z = 0; z < height; ++z)
        for (let y = 0; y < depth; ++y)
            for (let x = 0; x < width; ++x)
                for (let d = 0; solid(x, y, z) && d < 6; ++d) {
                    if (solid(x + directions[d][0], y + directions[d][1], z + directions[d][2])) continue;
                    const [a, b, c, e] = corners[d].map(([i, j, k]) => vertex(x + i, y + j, z + k));
                    triangles.push(a, b, c, a, c, e);
                }
    return { positions: Float64Array.from(positions), triangles: Uint32Array.from(triangles) };
}

/** FNV-1a with 64 bits, over the bytes of little-endian doubles. */
function fnv1a64(values) {
    const view = new DataView(new ArrayBuffer(8));
    let hash = 14695981039346656037n;
    for (const value of values) {
        view.setFloat64(0, value, true);
        for (let i = 0; i < 8; ++i) hash = BigInt.asUintN(64, (hash ^ BigInt(view.getUint8(i))) * 1099511628211n);
    }
    return hash.toString(16).padStart(16, '0');
}

const hmf = await load();
for (const [name, ...shape] of [['genus1', 1, 1, 4, 4], ['genus2', 2, 1, 8, 7], ['genus6', 3, 2, 15, 10]]) {
    const { positions, triangles } = plate(...shape);
    const hierarchy = new hmf.Hierarchy(positions, triangles);
    console.log(name, positions.length / 3, triangles.length / 3, fnv1a64(hierarchy.solve().values));
    hierarchy.dispose();
}
