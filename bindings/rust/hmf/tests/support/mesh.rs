// Meshes for the tests and the examples in the documentation.

/// Points and triangles.
#[allow(dead_code)]
type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// A torus of n by m vertices; vertex i * m + j lies at angle 2 pi i / n around the
/// axis and 2 pi j / m around the tube.
#[allow(dead_code)]
fn torus(n: u32, m: u32) -> Mesh {
    let angle = |k: u32, of: u32| f64::from(k) / f64::from(of) * std::f64::consts::TAU;
    let at = |i: u32, j: u32| i % n * m + j % m;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (i, j) in (0..n * m).map(|k| (k / m, k % m)) {
        let (u, v) = (angle(i, n), angle(j, m));
        let r = 3.0 + v.cos();
        positions.push([r * u.cos(), r * u.sin(), v.sin()]);
        triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
        triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
    }
    (positions, triangles)
}

/// The surface of (2 holes + 1) x 3 unit cubes with holes in the middle row, each square
/// cut into fine x fine, so that the genus is the number of holes.
#[allow(dead_code)]
fn plate(holes: u32, fine: u32) -> Mesh {
    let solid = |p: [u32; 3]| {
        let [x, y, z] = p.map(|k| k / fine);
        x <= 2 * holes && y < 3 && z == 0 && (y != 1 || x % 2 == 0)
    };
    let mut numbers = std::collections::HashMap::new();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let [nx, ny, nz] = [(2 * holes + 1) * fine, 3 * fine, fine];
    for cell in (0..nx * ny * nz).map(|k| [k / (ny * nz), k / nz % ny, k % nz]).filter(|&cell| solid(cell)) {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut outside = cell;
                outside[axis] = if side == 0 { cell[axis].wrapping_sub(1) } else { cell[axis] + 1 };
                if solid(outside) {
                    continue;
                }
                // Seen from outside, the axes u and v change places with the side.
                let (u, v) = if side == 1 { (axis + 1, axis + 2) } else { (axis + 2, axis + 1) };
                let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[du, dv]| {
                    let mut p = cell;
                    p[axis] += side;
                    p[u % 3] += du;
                    p[v % 3] += dv;
                    *numbers.entry(p).or_insert_with(|| {
                        positions.push(p.map(|k| f64::from(k) / f64::from(fine)));
                        positions.len() as u32 - 1
                    })
                });
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (positions, triangles)
}
