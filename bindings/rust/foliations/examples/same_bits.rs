//! Prints the lines of `bindings/same_bits/README.md`, which every language must agree on.

include!("../tests/support/mesh.rs");

fn main() -> foliations::Result<()> {
    for (name, holes_x, holes_y, side, height) in
        [("genus1", 1, 1, 4, 4), ("genus2", 2, 1, 8, 7), ("genus6", 3, 2, 15, 10)]
    {
        let (positions, triangles) = plate(holes_x, holes_y, side, height);
        let solution = foliations::Hierarchy::build(&positions, &triangles)?.solver().solve()?;
        if let Some(stopped) = solution.stopped {
            return Err(stopped);
        }
        let bytes = solution.foliation.values().iter().flat_map(|value| value.to_bits().to_le_bytes());
        let hash =
            bytes.fold(14695981039346656037_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(1099511628211));
        println!("{name} {} {} {hash:016x}", positions.len(), triangles.len());
    }
    Ok(())
}
