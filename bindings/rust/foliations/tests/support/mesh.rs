// Meshes for the tests and for the examples of the documentation.

/// The plate of `bindings/same_bits/README.md`; its genus is `holes_x * holes_y`.
#[allow(dead_code)] // not every program that includes this file uses it
fn plate(holes_x: i32, holes_y: i32, side: i32, height: i32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    type Point = [i32; 3];
    const CORNERS: [[Point; 4]; 6] = [
        [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
        [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
        [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
        [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
        [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
        [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    ];
    let (width, depth) = ((2 * holes_x + 1) * side, (2 * holes_y + 1) * side);
    let solid = |[x, y, z]: Point| {
        (0..width).contains(&x)
            && (0..depth).contains(&y)
            && (0..height).contains(&z)
            && (x / side % 2 == 0 || y / side % 2 == 0)
    };
    let mut numbers = std::collections::HashMap::new();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let cells = (0..width * depth * height).map(|k| [k % width, k / width % depth, k / width / depth]);
    for cell in cells.filter(|&cell| solid(cell)) {
        for (direction, corners) in CORNERS.iter().enumerate() {
            let mut outside = cell;
            outside[direction / 2] += if direction % 2 == 0 { -1 } else { 1 };
            if solid(outside) {
                continue;
            }
            let [a, b, c, d] = corners.map(|corner| {
                let [i, j, k] = [0, 1, 2].map(|axis| cell[axis] + corner[axis]);
                *numbers.entry([i, j, k]).or_insert_with(|| {
                    let shifts = [3 * i + 5 * j + 6 * k + i * j, 5 * i + 2 * j + 3 * k + j * k, 2 * i + 3 * j + 5 * k + k * i];
                    positions.push([0, 1, 2].map(|axis| f64::from(16 * [i, j, k][axis] + shifts[axis] % 7 - 3)));
                    positions.len() as u32 - 1
                })
            });
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (positions, triangles)
}
