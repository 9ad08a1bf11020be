// Stripes along the leaves of a foliation, painted without WebGL.
//
// In a triangle the values are distances in a tree.  Where one side is the sum
// of the others, the corners lie on a segment, and a function u with
// |u_i - u_j| = F_ij is linear; it is carried from triangle to triangle.  The
// sign and the constant are free, but u = 0 at the zeros and all zeros lie
// multiples of the weights apart: an even pattern of u whose period divides
// the weights fits together everywhere.

/** u at the three corners of each triangle. */
export function potential(triangles, triangleEdges, values, singularities) {
    const count = triangles.length / 3, u = new Float64Array(3 * count), seen = new Uint8Array(count);
    const direction = new Int8Array(count).fill(1); // of triangles without leaves: the way that led there
    const neighbors = new Int32Array(2 * values.length).fill(-1);
    for (let k = 0; k < 3 * count; ++k) {
        const e = triangleEdges[k];
        neighbors[2 * e + (neighbors[2 * e] < 0 ? 0 : 1)] = Math.floor(k / 3);
    }
    const side = (t, s) => values[triangleEdges[3 * t + (s % 3)]];
    const isTripod = t => {
        const longest = Math.max(side(t, 0), side(t, 1), side(t, 2));
        return side(t, 0) + side(t, 1) + side(t, 2) - 2 * longest > 1e-12 * longest;
    };
    // A triangle on a segment, from the value at corner c and the way to corner c + 1.
    const fill = (t, c, value, sign) => {
        const next = side(t, c), last = side(t, c + 2), opposite = side(t, c + 1);
        u[3 * t + c] = value;
        u[3 * t + ((c + 1) % 3)] = value + sign * next;
        u[3 * t + ((c + 2) % 3)] = value + (opposite > next && opposite > last ? -sign : sign) * last;
        seen[t] = 1;
    };
    const ready = [], waiting = [];
    const flood = () => {
        for (let next = 0, later = 0; next < ready.length || later < waiting.length;) {
            // Edges of value 0 carry no sign: they wait until nothing else is left.
            const certain = next < ready.length, t = certain ? ready[next++] : waiting[later++];
            if (certain) waiting.push(t);
            for (let s = 0; s < 3; ++s) {
                const e = triangleEdges[3 * t + s], n = neighbors[2 * e] === t ? neighbors[2 * e + 1] : neighbors[2 * e];
                if (seen[n] || (values[e] > 0) !== certain) continue;
                const r = [0, 1, 2].find(k => triangleEdges[3 * n + k] === e);
                // Neighbors run through their edge in opposite senses.
                let start = u[3 * t + ((s + 1) % 3)], end = u[3 * t + s];
                if (isTripod(t)) start = -start; // measured from its branch point
                if (values[e] > 0) {
                    fill(n, r, start, end > start ? 1 : -1);
                } else {
                    const inside = Math.sign(u[3 * t + ((s + 2) % 3)] - end) || direction[t];
                    u[3 * n + r] = u[3 * n + ((r + 1) % 3)] = start;
                    u[3 * n + ((r + 2) % 3)] = start - inside * side(n, r + 2);
                    direction[n] = inside;
                    seen[n] = 1;
                }
                ready.push(n);
            }
        }
    };
    const zeros = new Set(singularities.filter(zero => zero.kind !== 'triangle').map(zero => zero.element));
    for (let t = 0; t < count; ++t) {
        if (isTripod(t)) {
            const [ab, bc, ca] = [side(t, 0), side(t, 1), side(t, 2)];
            u.set([(ab + ca - bc) / 2, (ab + bc - ca) / 2, (bc + ca - ab) / 2], 3 * t);
            seen[t] = 1;
        } else {
            const c = [0, 1, 2].find(k => zeros.has(triangles[3 * t + k]));
            if (c !== undefined) fill(t, c, 0, 1);
        }
        if (seen[t]) ready.push(t);
    }
    flood();
    // Genus 1 has no zeros: any start will do.
    for (let t = 0; t < count; ++t) {
        if (seen[t] || side(t, 0) + side(t, 1) === 0) continue;
        fill(t, 0, 0, 1);
        ready.length = waiting.length = 0;
        ready.push(t);
        flood();
    }
    return u;
}

/** Outward normals at the vertices. */
export function vertexNormals(positions, triangles) {
    const normals = new Float64Array(positions.length);
    let volume = 0;
    for (let t = 0; t < triangles.length; t += 3) {
        const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]], p = [], q = [];
        for (let k = 0; k < 3; ++k) {
            p.push(positions[b + k] - positions[a + k]);
            q.push(positions[c + k] - positions[a + k]);
        }
        const n = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        for (let k = 0; k < 3; ++k) {
            for (const v of [a, b, c]) normals[v + k] += n[k];
            volume += n[k] * positions[a + k];
        }
    }
    const outward = volume < 0 ? -1 : 1;
    for (let v = 0; v < normals.length; v += 3) {
        const length = outward * Math.hypot(normals[v], normals[v + 1], normals[v + 2]) || 1;
        for (let k = 0; k < 3; ++k) normals[v + k] /= length;
    }
    return normals;
}

/** A period of which the step of the weights is a multiple, with about `pairs` pairs of stripes along the object. */
export function stripePeriod({ positions, triangles, u, size }, step = 1, pairs = 44) {
    // Mean square of the gradient, by the heights of each triangle.
    let energy = 0, area = 0;
    for (let t = 0; t < triangles.length; t += 3) {
        const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
        let pp = 0, pq = 0, qq = 0;
        for (let k = 0; k < 3; ++k) {
            const p = positions[b + k] - positions[a + k], q = positions[c + k] - positions[a + k];
            pp += p * p, pq += p * q, qq += q * q;
        }
        const du = u[t + 1] - u[t], dv = u[t + 2] - u[t], square = pp * qq - pq * pq;
        if (!(square > 0)) continue;
        energy += (du * du * qq - 2 * du * dv * pq + dv * dv * pp) / (2 * Math.sqrt(square));
        area += Math.sqrt(square) / 2;
    }
    const wanted = (size * Math.sqrt(energy / area)) / pairs;
    return step / Math.max(1, Math.round(step / wanted));
}

const RED = [168, 32, 38], WHITE = [246, 243, 236], BLUE = [40, 84, 214];
const LIGHT = [-0.45, 0.75, 0.65].map(x => x / Math.hypot(-0.45, 0.75, 0.65));

/**
 * Paints the scene { positions, triangles, normals, u, period, size, center, zeros }
 * into pixels; rotation is a 3 x 3 matrix, row by row.  Without u: plain.
 */
export function paint(image, scene, rotation, zoom = 1) {
    const { width, height, data } = image, { positions, triangles, normals, u, period, size, center } = scene;
    const depth = new Float32Array(width * height).fill(-Infinity), count = positions.length / 3;
    const scale = (zoom * Math.min(width, height)) / size, x = new Float32Array(count), y = new Float32Array(count), z = new Float32Array(count);
    const nx = new Float32Array(count), ny = new Float32Array(count), nz = new Float32Array(count);
    const r = rotation;
    for (let v = 0, k = 0; v < count; ++v, k += 3) {
        const a = positions[k] - center[0], b = positions[k + 1] - center[1], c = positions[k + 2] - center[2];
        x[v] = width / 2 + scale * (r[0] * a + r[1] * b + r[2] * c);
        y[v] = height / 2 - scale * (r[3] * a + r[4] * b + r[5] * c);
        z[v] = scale * (r[6] * a + r[7] * b + r[8] * c);
        nx[v] = r[0] * normals[k] + r[1] * normals[k + 1] + r[2] * normals[k + 2];
        ny[v] = r[3] * normals[k] + r[4] * normals[k + 1] + r[5] * normals[k + 2];
        nz[v] = r[6] * normals[k] + r[7] * normals[k + 1] + r[8] * normals[k + 2];
    }
    for (let row = 0, at = 0; row < height; ++row) {
        for (let column = 0; column < width; ++column, at += 4) {
            const fall = Math.min(1, 1.3 * ((column / width - 0.5) ** 2 + (row / height - 0.42) ** 2));
            data[at] = 248 - 44 * fall, data[at + 1] = 249 - 40 * fall, data[at + 2] = 251 - 34 * fall, data[at + 3] = 255;
        }
    }
    const put = (at, color, a, b, c) => {
        const length = Math.sqrt(a * a + b * b + c * c) || 1, facing = c / length;
        const lit = Math.max(0, (a * LIGHT[0] + b * LIGHT[1] + c * LIGHT[2]) / length);
        const shade = 0.55 + 0.12 * (b / length) + 0.42 * lit, shine = 46 * Math.pow(Math.max(0, 0.35 * lit + 0.65 * facing), 60);
        for (let k = 0; k < 3; ++k) data[4 * at + k] = color(k) * shade + shine;
    };
    for (let t = 0; t < triangles.length; t += 3) {
        const [i, j, k] = [triangles[t], triangles[t + 1], triangles[t + 2]];
        const area = (x[j] - x[i]) * (y[k] - y[i]) - (x[k] - x[i]) * (y[j] - y[i]);
        if (area === 0) continue;
        const top = Math.max(0, Math.ceil(Math.min(y[i], y[j], y[k]) - 0.5)), bottom = Math.min(height - 1, Math.floor(Math.max(y[i], y[j], y[k]) - 0.5));
        const left = Math.max(0, Math.ceil(Math.min(x[i], x[j], x[k]) - 0.5)), right = Math.min(width - 1, Math.floor(Math.max(x[i], x[j], x[k]) - 0.5));
        // How fast the pattern runs over the picture: its edges are one pixel soft.
        const u0 = u ? u[t] : 0, u1 = u ? u[t + 1] : 0, u2 = u ? u[t + 2] : 0;
        const ux = (u0 * (y[j] - y[k]) + u1 * (y[k] - y[i]) + u2 * (y[i] - y[j])) / area, uy = (u0 * (x[k] - x[j]) + u1 * (x[i] - x[k]) + u2 * (x[j] - x[i])) / area;
        const soft = Math.max(Math.hypot(ux, uy), 1e-9 * (period || 1)), blur = Math.min(1, Math.max(0, (soft / (period || 1) - 0.3) / 0.4));
        for (let row = top; row <= bottom; ++row) {
            for (let column = left; column <= right; ++column) {
                const px = column + 0.5, py = row + 0.5;
                const b = ((px - x[i]) * (y[k] - y[i]) - (x[k] - x[i]) * (py - y[i])) / area, c = ((x[j] - x[i]) * (py - y[i]) - (px - x[i]) * (y[j] - y[i])) / area, a = 1 - b - c;
                if (a < -1e-6 || b < -1e-6 || c < -1e-6) continue;
                const at = row * width + column, here = a * z[i] + b * z[j] + c * z[k];
                if (here <= depth[at]) continue;
                depth[at] = here;
                let share = 0;
                if (u) {
                    const value = a * u0 + b * u1 + c * u2, folded = Math.abs(value - period * Math.round(value / period));
                    share = Math.min(1, Math.max(0, (period / 4 - folded) / soft + 0.5));
                    share += blur * (0.5 - share);
                }
                put(at, channel => share * RED[channel] + (1 - share) * WHITE[channel], a * nx[i] + b * nx[j] + c * nx[k],
                    a * ny[i] + b * ny[j] + c * ny[k], a * nz[i] + b * nz[j] + c * nz[k]);
            }
        }
    }
    // Zeros as buttons on the surface.
    const radius = 0.0115 * size * scale;
    for (const position of scene.zeros ?? []) {
        const [a, b, c] = position.map((at, k) => scale * (at - center[k]));
        const cx = width / 2 + r[0] * a + r[1] * b + r[2] * c, cy = height / 2 - (r[3] * a + r[4] * b + r[5] * c), cz = r[6] * a + r[7] * b + r[8] * c;
        for (let row = Math.max(0, Math.ceil(cy - radius)); row <= Math.min(height - 1, cy + radius); ++row) {
            for (let column = Math.max(0, Math.ceil(cx - radius)); column <= Math.min(width - 1, cx + radius); ++column) {
                const dx = column + 0.5 - cx, dy = row + 0.5 - cy, square = radius * radius - dx * dx - dy * dy, at = row * width + column;
                if (square <= 0 || cz + Math.sqrt(square) <= depth[at]) continue;
                depth[at] = cz + Math.sqrt(square);
                put(at, channel => BLUE[channel], dx, -dy, Math.sqrt(square));
            }
        }
    }
}
