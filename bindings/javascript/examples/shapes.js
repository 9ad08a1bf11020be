// Meshes made by formula, for the examples and the tests.

/** Torus of 2 n m triangles around the z axis. */
export function torus(n, m, R = 3, r = 1) {
    const positions = new Float64Array(3 * n * m), triangles = new Uint32Array(6 * n * m);
    for (let i = 0; i < n; ++i) {
        for (let j = 0; j < m; ++j) {
            const u = (2 * Math.PI * i) / n, v = (2 * Math.PI * j) / m;
            positions.set([(R + r * Math.cos(v)) * Math.cos(u), (R + r * Math.cos(v)) * Math.sin(u), r * Math.sin(v)], 3 * (i * m + j));
            const at = (a, b) => ((i + a) % n) * m + ((j + b) % m);
            triangles.set([at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)], 6 * (i * m + j));
        }
    }
    return { positions, triangles };
}

/**
 * A rounded plate with a row of holes: a surface of genus `holes`, refined
 * `refinements` times (each makes four triangles of one) and smoothed.
 */
export function pretzel(holes, refinements, smoothings = 4) {
    const nx = 2 * holes + 1, ny = 3;
    const filled = (i, j) => i >= 0 && j >= 0 && i < nx && j < ny && !(j === 1 && i % 2 === 1);
    let positions = [], triangles = [];
    const numbers = new Map();
    const vertex = (x, y, z) => {
        const key = `${x},${y},${z}`;
        if (!numbers.has(key)) {
            numbers.set(key, positions.length / 3);
            positions.push(x - nx / 2, y - ny / 2, z - 0.5);
        }
        return numbers.get(key);
    };
    const square = corners => {
        const [a, b, c, d] = corners.map(corner => vertex(...corner));
        triangles.push(a, b, c, a, c, d);
    };
    for (let i = 0; i < nx; ++i) {
        for (let j = 0; j < ny; ++j) {
            if (!filled(i, j)) continue;
            square([[i, j, 1], [i + 1, j, 1], [i + 1, j + 1, 1], [i, j + 1, 1]]);
            square([[i, j, 0], [i, j + 1, 0], [i + 1, j + 1, 0], [i + 1, j, 0]]);
            if (!filled(i - 1, j)) square([[i, j, 0], [i, j, 1], [i, j + 1, 1], [i, j + 1, 0]]);
            if (!filled(i + 1, j)) square([[i + 1, j, 0], [i + 1, j + 1, 0], [i + 1, j + 1, 1], [i + 1, j, 1]]);
            if (!filled(i, j - 1)) square([[i, j, 0], [i + 1, j, 0], [i + 1, j, 1], [i, j, 1]]);
            if (!filled(i, j + 1)) square([[i, j + 1, 0], [i, j + 1, 1], [i + 1, j + 1, 1], [i + 1, j + 1, 0]]);
        }
    }
    for (let round = 0; round < refinements; ++round) {
        ({ positions, triangles } = subdivide(positions, triangles));
        for (let k = 0; k < smoothings; ++k) positions = smooth(positions, triangles);
    }
    return { positions: Float64Array.from(positions), triangles: Uint32Array.from(triangles) };
}

/** Each triangle into four, with new vertices at the midpoints of the edges. */
function subdivide(positions, triangles) {
    const refined = Array.from(positions), result = [], midpoints = new Map(), n = positions.length / 3;
    const midpoint = (a, b) => {
        const key = a < b ? a * n + b : b * n + a;
        if (!midpoints.has(key)) {
            midpoints.set(key, refined.length / 3);
            for (let k = 0; k < 3; ++k) refined.push((positions[3 * a + k] + positions[3 * b + k]) / 2);
        }
        return midpoints.get(key);
    };
    for (let t = 0; t < triangles.length; t += 3) {
        const [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]];
        const ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
        result.push(a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca);
    }
    return { positions: refined, triangles: result };
}

/** Each vertex half way to the mean of its neighbors. */
function smooth(positions, triangles) {
    const sum = new Float64Array(positions.length), count = new Float64Array(positions.length / 3);
    for (let t = 0; t < triangles.length; t += 3) {
        for (let s = 0; s < 3; ++s) {
            const a = triangles[t + s], b = triangles[t + ((s + 1) % 3)];
            for (let k = 0; k < 3; ++k) sum[3 * a + k] += positions[3 * b + k];
            ++count[a];
        }
    }
    return Array.from(positions, (x, i) => 0.5 * x + (0.5 * sum[i]) / count[Math.floor(i / 3)]);
}
