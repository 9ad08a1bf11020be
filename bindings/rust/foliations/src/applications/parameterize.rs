//! Conformal parameterization of a harmonic foliation.

use crate::error::Result;
#[cfg(doc)]
use crate::error::Status;
use crate::foliation::Foliation;
use crate::owned::{arrays, make, Owned};
use crate::progress::{Closure, Progress};
use crate::ranges::Refusal;
use crate::records::{options, record, Read};
use foliations_sys as sys;
use std::ops::Deref;

/// Options for the parameterization of a foliation; see [`Foliation::parameterizer`].
///
/// What is not set has its default.
#[derive(Debug)]
#[must_use = "a parameterizer does nothing until `parameterize` is called"]
pub struct Parameterizer<'a> {
    foliation: &'a Foliation,
    seam_edges: &'a [u32],
    options: sys::hmf_parameterize_options,
    refusal: Refusal,
    progress: Option<Closure<'a>>,
}

impl Foliation {
    /// Options for a conformal parameterization of this foliation, all at their defaults.
    ///
    /// ```
    /// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
    /// # fn main() -> foliations::Result<()> {
    /// # let (positions, triangles) = plate(2, 1, 3, 2);
    /// # let hierarchy = foliations::Hierarchy::build(&positions, &triangles)?;
    /// let foliation = hierarchy.solver().solve()?.foliation;
    /// let map = foliation.parameterizer().parameterize()?;
    /// assert_eq!(map.corner_uv().len(), triangles.len());
    /// println!("mean dilatation {:.2}, {} seam edges", map.dilatation_mean, map.seam_edge_count);
    /// # Ok(())
    /// # }
    /// ```
    pub fn parameterizer(&self) -> Parameterizer<'_> {
        let options = options!(hmf_parameterize_options);
        Parameterizer { foliation: self, seam_edges: &[], options, refusal: Refusal::default(), progress: None }
    }
}

impl<'a> Parameterizer<'a> {
    /// The largest residual that the values may have. Default: 1e-2.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.refusal.check("tolerance", tolerance, "(0, 1)");
        self.options.tolerance = tolerance;
        self
    }

    /// Edges where seams cost nothing, so that they run there if they can.
    /// Default: none.
    pub fn seam_edges(mut self, edges: &'a [u32]) -> Self {
        self.seam_edges = edges;
        self
    }

    /// A closure that is called on this thread with a fraction rising from 0 to
    /// 1, and that may end the call. If it panics, the call is cancelled and the
    /// panic continues.
    pub fn progress<R: Into<Progress>>(mut self, closure: impl FnMut(f64) -> R + 'a) -> Self {
        self.progress = Closure::new(closure);
        self
    }

    /// The global conformal parameterization of the foliation: |du| is the
    /// foliation, v its harmonic conjugate. The surface is cut along short seams
    /// through the zeros; in the cut surface every corner has one (u, v).
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_VALUE_NOT_HARMONIC`] if the residual is above the
    /// tolerance, [`Status::ERROR_UNSUPPORTED`] if the mesh is so coarse that it
    /// has no vertex for each zero, [`Status::CANCELLED`], or a status of the
    /// classes 100, 200, 500.
    pub fn parameterize(&mut self) -> Result<Parameterization> {
        self.refusal.result()?;
        let options = sys::hmf_parameterize_options {
            seam_edges: self.seam_edges.as_ptr(),
            seam_edge_count: self.seam_edges.len() as u64,
            ..self.options
        };
        let foliation = self.foliation.as_ptr();
        let block: Owned<sys::hmf_parameterization> = Closure::watch(&mut self.progress, || {
            // SAFETY: the handle is valid, and the edges are given with their number.
            make(|out, control, error| unsafe { sys::hmf_parameterize(foliation, &options, control, out, error) })
        })?;
        Ok(Parameterization { quality: block.read(), block })
    }
}

/// A conformal parameterization: coordinates (u, v) of the corners of all triangles.
///
/// The linear parts of the transitions are +-1, so (du + i dv)^2 has no seams: it is
/// the holomorphic quadratic differential. Zeros in triangles move to a corner.
/// Where the foliation is 0 (limbs that no loop goes around) triangles are degenerate.
#[derive(Debug)]
pub struct Parameterization {
    block: Owned<sys::hmf_parameterization>,
    quality: MapQuality,
}

impl Deref for Parameterization {
    type Target = MapQuality;

    fn deref(&self) -> &MapQuality {
        &self.quality
    }
}

arrays! {
    Parameterization {
        /// (u, v) of the three corners of each triangle, in the unit of the values.
        corner_uv: [[[f64; 2]; 3]; triangle_count],
        /// Sign, du, dv of each edge: where a point of it has (u, v) in the first of its
        /// two triangles, the one with the lower number, it has sign * (u, v) + (du, dv) in
        /// the second, exactly. Edges off the seams have (1, 0, 0).
        transition: [[f64; 3]; edge_count],
        /// For each edge 1 where the layout is cut, else 0.
        seam: [u8; edge_count],
        /// Cone angle of each vertex as a multiple of pi; 2 is regular. The sum of
        /// 2 - cone is 4 - 4 genus.
        cone: [i32; vertex_count],
        /// For each triangle the ratio of the singular values of the map, at least 1;
        /// negative where the image is flipped, infinite where it is degenerate (above 1000).
        dilatation: [f64; triangle_count],
        /// The quadratic differential of each triangle, real and imaginary part, in the frame
        /// of the triangle: x along its side 0, y to the left of it.
        differential: [[f64; 2]; triangle_count],
    }
}

record! {
    /// The numbers of a [`Parameterization`], which are its fields as well.
    #[derive(Copy)]
    MapQuality from hmf_parameterization {
        /// Mean absolute dilatation, weighted by area, without degenerate triangles.
        dilatation_mean: f64,
        /// Median of the dilatation, by area, of all triangles.
        dilatation_median: f64,
        /// The dilatation that 99 % of the area stay below.
        dilatation_p99: f64,
        /// Triangles with a flipped image.
        flipped_count: u64,
        /// Triangles with a dilatation above 1000, or an image too small to tell.
        degenerate_count: u64,
        /// Edges of the seams.
        seam_edge_count: u64,
        /// Length of the seams, in the unit of the positions.
        seam_length: f64,
        /// Area of the image: the energy, up to discretization.
        area: f64,
        /// Iterations of the linear solver.
        linear_iterations: u64,
        /// Time of the call.
        seconds: f64,
        /// Energy of du / energy of the foliation; not 1 where zeros move to vertices.
        energy_ratio: f64,
        /// Relative difference of the area of the image and the energy of du.
        area_error: f64,
        /// Circumference of a cylinder by du / by the foliation, the smallest of all.
        circumference_least: f64,
        /// And the largest.
        circumference_most: f64,
    }
}
