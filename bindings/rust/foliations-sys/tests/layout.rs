//! The library and the bindings agree on the layout, with the compiler in use: each
//! result has the size that the bindings know.

use foliations_sys::*;
use std::mem::size_of;
use std::ptr::{null, null_mut};

#[rustfmt::skip]
const POSITIONS: [f64; 21] = [
    3., -3., 0., -3., 3., 0., -3., -3., 1., 3., 3., 1., -1., -2., 3., 1., 2., 3., 0., 0., 15.,
];
#[rustfmt::skip]
const TRIANGLES: [u32; 42] = [
    0, 1, 3, 0, 3, 2, 1, 2, 4, 1, 4, 3, 2, 3, 5, 2, 5, 4, 3, 4, 6, 3, 6, 5,
    4, 5, 0, 4, 0, 6, 5, 6, 1, 5, 1, 0, 6, 0, 2, 6, 2, 1,
];

/// The size that a result of a call says it has.
macro_rules! size {
    ($type:ident, $call:ident($($argument:expr),*)) => {{
        let mut out: *mut $type = null_mut();
        assert_eq!($call($($argument,)* null(), &mut out, null_mut()), HMF_OK);
        let size = (*out).struct_size as usize;
        hmf_free(out.cast());
        (stringify!($type), size, size_of::<$type>())
    }};
}

#[test]
fn sizes_agree() {
    // SAFETY: the arrays are given with their lengths, the objects are valid and freed once.
    let sizes = unsafe {
        let (mut hierarchy, mut foliation) = (null_mut(), null_mut());
        let (positions, triangles) = (POSITIONS.as_ptr(), TRIANGLES.as_ptr());
        assert_eq!(
            hmf_hierarchy_create(positions, 7, triangles, 14, null(), null(), &mut hierarchy, null_mut()),
            HMF_OK
        );
        assert_eq!(hmf_solve_cut_system(hierarchy, null(), null(), &mut foliation, null_mut()), HMF_OK);
        let sizes = [
            size!(hmf_component_set, hmf_components(positions, 7, triangles, 14, null())),
            size!(hmf_mark_set, hmf_suggest_marks(positions, 7, triangles, 14, null())),
            size!(hmf_design, hmf_even_design(positions, 7, triangles, 14, null())),
            size!(hmf_loop_set, hmf_loops(hierarchy, 0, HMF_LOOPS_CUT)),
            size!(hmf_singularity_set, hmf_singularities(foliation)),
            size!(hmf_parameterization, hmf_parameterize(foliation, null())),
            size!(hmf_lines, hmf_trace(foliation, null())),
            size!(hmf_cylinder_set, hmf_cylinders(foliation, null())),
            size!(hmf_quad_mesh, hmf_quads(foliation, null())),
            size!(hmf_chart_set, hmf_atlas(foliation, null())),
            ("hmf_report", (*hmf_foliation_report(foliation)).struct_size as usize, size_of::<hmf_report>()),
        ];
        hmf_foliation_destroy(foliation);
        hmf_hierarchy_destroy(hierarchy);
        sizes
    };
    for (name, library, bindings) in sizes {
        assert_eq!(library, bindings, "{name}");
    }
}
