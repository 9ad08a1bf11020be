//! Quad meshes along the leaves.

use crate::error::{call, Result};
use crate::foliation::Foliation;
use hmf_sys as sys;
use std::mem::size_of;
use std::ptr;

/// A closed quad mesh, oriented and manifold, of the same genus.
///
/// In quad (a, b, c, d) the sides a-d and b-c lie on leaves. All edges are about
/// equally long in the metric du^2 + dv^2: longer in space where the foliation is thin.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct QuadMesh {
    /// Points of the surface. The first are the zeros, in the order of
    /// [`Foliation::zeros_and_poles`]. Zeros that only discretisation keeps apart can become
    /// one, with the sum of their orders. A zero of order m has 2 m + 4 edges, every other
    /// vertex has 4.
    pub positions: Vec<[f64; 3]>,
    /// Four vertices each, oriented as the triangles.
    pub quads: Vec<[u32; 4]>,
}

pub(crate) fn quads(foliation: &Foliation, edge_length: f64) -> Result<QuadMesh> {
    let options =
        sys::hmf_quad_options { struct_size: size_of::<sys::hmf_quad_options>() as u32, reserved: 0, edge_length };
    let (hierarchy, level, values) = (foliation.hierarchy().as_ptr(), foliation.level(), foliation.values());
    let (mut vertex_count, mut quad_count) = (0, 0);
    // SAFETY: the values are given with their number; NULL arrays only count.
    call(|error| unsafe {
        sys::hmf_quads(
            hierarchy,
            level,
            values.as_ptr(),
            values.len(),
            &options,
            ptr::null_mut(),
            0,
            ptr::null_mut(),
            0,
            &mut vertex_count,
            &mut quad_count,
            error,
        )
    })?;
    let mut mesh = QuadMesh { positions: vec![[0.0; 3]; vertex_count], quads: vec![[0; 4]; quad_count] };
    // SAFETY: as above, and each array is given with its number of rows.
    call(|error| unsafe {
        sys::hmf_quads(
            hierarchy,
            level,
            values.as_ptr(),
            values.len(),
            &options,
            mesh.positions.as_mut_ptr().cast(),
            mesh.positions.len(),
            mesh.quads.as_mut_ptr().cast(),
            mesh.quads.len(),
            &mut vertex_count,
            &mut quad_count,
            error,
        )
    })?;
    Ok(mesh)
}
