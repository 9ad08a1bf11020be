//! What this crate costs above the C interface: both solve the same mesh of about
//! 100 000 vertices, by turns. `cargo bench`

use foliations_sys as sys;
use std::hint::black_box;
use std::ptr;
use std::time::Instant;

include!("../tests/support/mesh.rs");

type Run = fn(&[[f64; 3]], &[[u32; 3]]) -> f64;

fn raw(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    let (mut hierarchy, mut foliation) = (ptr::null_mut(), ptr::null_mut());
    // SAFETY: the arrays are given with their lengths, and the objects are freed once.
    unsafe {
        let (x, t) = (positions.as_ptr().cast(), triangles.as_ptr().cast());
        let (all, none, no_error) = (ptr::null(), ptr::null(), ptr::null_mut());
        let built =
            sys::hmf_hierarchy_create(x, positions.len(), t, triangles.len(), all, none, &mut hierarchy, no_error);
        assert_eq!(built, sys::HMF_OK);
        let solved = sys::hmf_solve_cut_system(hierarchy, ptr::null(), none, &mut foliation, no_error);
        assert_eq!(solved, sys::HMF_OK);
        let first = *sys::hmf_foliation_values(foliation, ptr::null_mut());
        sys::hmf_foliation_destroy(foliation);
        sys::hmf_hierarchy_destroy(hierarchy);
        first
    }
}

fn safe(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    let hierarchy =
        foliations::Hierarchy::builder().progress(|f| _ = black_box(f)).build(positions, triangles).unwrap();
    let solution = hierarchy.solver().progress(|f| _ = black_box(f)).solve().unwrap();
    solution.foliation.values()[0]
}

fn main() {
    let (positions, triangles) = plate(3, 2, 34, 22);
    println!("{} vertices, {} triangles", positions.len(), triangles.len());
    let time = |run: Run| {
        let start = Instant::now();
        let value = black_box(run(&positions, &triangles));
        (start.elapsed().as_secs_f64(), value)
    };
    let (mut best_raw, mut best_safe) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..7 {
        let (raw_time, expected) = time(raw);
        let (safe_time, value) = time(safe);
        assert_eq!(value, expected);
        best_raw = best_raw.min(raw_time);
        best_safe = best_safe.min(safe_time);
    }
    println!("C interface {best_raw:.3} s, this crate with progress closures {best_safe:.3} s");
    println!("overhead {:+.1} %", 100.0 * (best_safe / best_raw - 1.0));
}
