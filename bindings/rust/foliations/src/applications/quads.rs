//! Quad meshes along the leaves.

use crate::error::Result;
#[cfg(doc)]
use crate::error::Status;
use crate::foliation::Foliation;
use crate::owned::{arrays, make, Owned};
use crate::ranges::Refusal;
use crate::records::options;
use foliations_sys as sys;

/// A closed quad mesh, oriented and manifold, of the same genus.
///
/// In quad (a, b, c, d) the sides a-d and b-c lie on leaves. All edges are about
/// equally long in the metric du^2 + dv^2: longer in space where the foliation is thin.
#[derive(Debug)]
pub struct QuadMesh {
    block: Owned<sys::hmf_quad_mesh>,
}

arrays! {
    QuadMesh {
        /// Points of the surface. The first are the zeros, in the order of
        /// [`Singularities::list`](crate::Singularities::list). Zeros that only discretization
        /// keeps apart can become one, with the sum of their orders. A zero of order m has
        /// 2 m + 4 edges, every other vertex has 4.
        positions: [[f64; 3]; vertex_count],
        /// Four vertices each, oriented as the triangles.
        quads: [[u32; 4]; quad_count],
    }
}

impl QuadMesh {
    /// Vertices with another number of edges than 4.
    pub fn irregular_count(&self) -> u64 {
        self.block.irregular_count
    }

    /// Quads with a corner of 0, or of 180 degrees or more, seen from outside the surface where
    /// they lie.
    pub fn inverted_count(&self) -> u64 {
        self.block.inverted_count
    }

    /// Root of the area of the surface / number of quads.
    pub fn edge_length(&self) -> f64 {
        self.block.edge_length
    }

    /// Area of the quads / area of the surface.
    pub fn area_ratio(&self) -> f64 {
        self.block.area_ratio
    }

    /// Greatest distance of a vertex of the surface from the quads near it.
    pub fn distance(&self) -> f64 {
        self.block.distance
    }
}

/// What quads are wished for; see [`Foliation::quads_with`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct QuadOptions {
    /// Mean length of an edge, in the unit of the positions; `None`: about half as many quads as
    /// triangles.
    pub edge_length: Option<f64>,
    /// How many quads instead; `None`: by the length. The result is as near as the grids allow.
    pub count: Option<u64>,
    /// A critical leaf shorter than half an edge gets no quad, and its zeros become one vertex.
    pub merge: bool,
    /// A pole stays a vertex with two edges; else one quad lies over it, between two vertices
    /// with 3.
    pub keep_poles: bool,
    /// Steps in which vertices move on the surface to even out angles and sides.
    pub relax: u64,
}

impl Foliation {
    /// A closed quad mesh along the leaves of a harmonic foliation: a grid on each
    /// cylinder, glued along the critical leaves.
    ///
    /// `edge_length` is the wished mean length of an edge, in the unit of the positions.
    /// With `None` there are about half as many quads as triangles. Numbers are rounded so
    /// that the grids match, with at least 3 quads across a cylinder and 2 along a
    /// critical leaf.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_QUADS`] if a zero goes around a part of the surface that no
    /// leaf crosses, or if no numbers of columns match on all cylinders, for edges so
    /// long or on a mesh so coarse; [`Status::CANCELLED`];
    /// classes 100, 200, 500.
    pub fn quads(&self, edge_length: Option<f64>) -> Result<QuadMesh> {
        self.quads_with(&QuadOptions { edge_length, ..Default::default() })
    }

    /// The same with all options.
    ///
    /// # Errors
    ///
    /// As for [`Foliation::quads`], and [`Status::ERROR_OPTIONS`] if there would be more than
    /// 2^28 quads.
    pub fn quads_with(&self, wish: &QuadOptions) -> Result<QuadMesh> {
        let mut refusal = Refusal::default();
        wish.edge_length.iter().for_each(|&length| refusal.check("edge_length", length, "(0, inf)"));
        wish.count.iter().for_each(|&count| refusal.check("count", count as f64, "[1, inf)"));
        refusal.result()?;
        let options = options!(hmf_quad_options
            edge_length: wish.edge_length.unwrap_or(0.0), count: wish.count.unwrap_or(0),
            merge: i32::from(wish.merge), keep_poles: i32::from(wish.keep_poles), relax: wish.relax);
        // SAFETY: the handle is valid.
        let block =
            make(|out, control, error| unsafe { sys::hmf_quads(self.as_ptr(), &options, control, out, error) })?;
        Ok(QuadMesh { block })
    }
}
