//! A plate with two holes: the energy of a harmonic foliation, and its zeros.

fn main() -> foliations::Result<()> {
    let (positions, triangles) = plate();
    let hierarchy = foliations::Hierarchy::build(&positions, &triangles)?;
    let solution = hierarchy.solver().solve()?;
    println!("energy {:.6}", solution.report.energy);
    for zero in solution.foliation.singularities()?.list() {
        println!("{:?} {}, order {}", zero.kind, zero.element, -zero.index);
    }
    Ok(())
}

/// The surface of 5 x 3 unit cubes of which two are missing; (x, y, z) is vertex 24 z + 4 x + y.
fn plate() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let solid = |x: u32, y: u32| x < 5 && y < 3 && (y != 1 || x % 2 == 0);
    let positions = (0..48).map(|i| [i % 24 / 4, i % 4, i / 24].map(f64::from)).collect();
    let mut triangles = Vec::new();
    let mut square = |corners: [[u32; 3]; 4]| {
        let [a, b, c, d] = corners.map(|[x, y, z]| 24 * z + 4 * x + y);
        triangles.extend([[a, b, c], [a, c, d]]);
    };
    for (x, y) in (0..15).map(|i| (i / 3, i % 3)).filter(|&(x, y)| solid(x, y)) {
        let (u, v) = (x + 1, y + 1);
        square([[x, y, 1], [u, y, 1], [u, v, 1], [x, v, 1]]);
        square([[x, y, 0], [x, v, 0], [u, v, 0], [u, y, 0]]);
        if !solid(u, y) {
            square([[u, y, 0], [u, v, 0], [u, v, 1], [u, y, 1]]);
        }
        if !solid(x.wrapping_sub(1), y) {
            square([[x, y, 0], [x, y, 1], [x, v, 1], [x, v, 0]]);
        }
        if !solid(x, v) {
            square([[x, v, 0], [x, v, 1], [u, v, 1], [u, v, 0]]);
        }
        if !solid(x, y.wrapping_sub(1)) {
            square([[x, y, 0], [u, y, 0], [u, y, 1], [x, y, 1]]);
        }
    }
    (positions, triangles)
}
