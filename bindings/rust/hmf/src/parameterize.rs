//! Conformal parameterisation of a harmonic foliation.

#[cfg(doc)]
use crate::error::Status;
use crate::error::{call, Result};
use crate::foliation::Foliation;
use crate::progress::{boxed, with_progress, Closure, Progress};
use hmf_sys as sys;
use std::fmt;
use std::mem::size_of;
use std::time::Duration;

/// Options for the parameterisation of a foliation; see [`Foliation::parameterizer`].
///
/// What is not set has its default.
#[must_use = "a parameterizer does nothing until `parameterize` is called"]
pub struct Parameterizer<'a> {
    foliation: &'a Foliation,
    tolerance: f64,
    seam_edges: &'a [u32],
    progress: Option<Closure<'a>>,
}

impl<'a> Parameterizer<'a> {
    pub(crate) fn new(foliation: &'a Foliation) -> Parameterizer<'a> {
        Parameterizer { foliation, tolerance: 0.0, seam_edges: &[], progress: None }
    }

    /// The largest residual that the values may have. Default: 1e-2.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
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
    /// panic goes on.
    pub fn progress<R: Into<Progress>>(mut self, closure: impl FnMut(f64) -> R + 'a) -> Self {
        self.progress = Some(boxed(closure));
        self
    }

    /// The global conformal parameterisation of the foliation: |du| is the
    /// foliation, v its harmonic conjugate. The surface is cut along short seams
    /// through the zeros; in the cut surface every corner has one (u, v).
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_VALUE_NOT_HARMONIC`] if the residual is above the
    /// tolerance, [`Status::ERROR_UNSUPPORTED`] if the mesh is so coarse that two
    /// zeros need the same vertex, [`Status::CANCELLED`], or a status of the
    /// classes 100, 200, 500.
    pub fn parameterize(&mut self) -> Result<Parameterization> {
        let foliation = self.foliation;
        let info = foliation.hierarchy().level(foliation.level())?;
        let mut corner_uv = vec![[[0.0; 2]; 3]; info.triangle_count];
        let mut transition = vec![[0.0; 3]; info.edge_count];
        let mut seam = vec![0_u8; info.edge_count];
        let mut cone = vec![0_i32; info.vertex_count];
        let mut dilatation = vec![0.0; info.triangle_count];
        let mut differential = vec![[0.0; 2]; info.triangle_count];
        let mut out = sys::hmf_parameterization {
            struct_size: size_of::<sys::hmf_parameterization>() as u32,
            reserved: 0,
            vertex_capacity: info.vertex_count as u64,
            edge_capacity: info.edge_count as u64,
            triangle_capacity: info.triangle_count as u64,
            corner_uv: corner_uv.as_mut_ptr().cast(),
            transition: transition.as_mut_ptr().cast(),
            seam: seam.as_mut_ptr(),
            cone: cone.as_mut_ptr(),
            dilatation: dilatation.as_mut_ptr(),
            differential: differential.as_mut_ptr().cast(),
            dilatation_mean: 0.0,
            dilatation_median: 0.0,
            dilatation_p99: 0.0,
            flipped_triangles: 0,
            degenerate_triangles: 0,
            seam_edge_count: 0,
            seam_length: 0.0,
            area: 0.0,
            linear_iterations: 0,
            seconds: 0.0,
        };
        let mut options = sys::hmf_parameterize_options {
            struct_size: size_of::<sys::hmf_parameterize_options>() as u32,
            reserved: 0,
            tolerance: self.tolerance,
            seam_edges: self.seam_edges.as_ptr(),
            seam_edge_count: self.seam_edges.len() as u64,
            progress: None,
            progress_user: std::ptr::null_mut(),
        };
        with_progress(self.progress.as_mut(), |progress, user| {
            options.progress = progress;
            options.progress_user = user;
            let (hierarchy, values) = (foliation.hierarchy().as_ptr(), foliation.values());
            // SAFETY: the capacities are the counts that all arrays of `out` were made
            // with; options, edges and closure live through the call.
            call(|error| unsafe {
                sys::hmf_parameterize(
                    hierarchy,
                    foliation.level(),
                    values.as_ptr(),
                    values.len(),
                    &options,
                    &mut out,
                    error,
                )
            })
        })?;
        Ok(Parameterization {
            corner_uv,
            transition,
            seam: seam.into_iter().map(|seam| seam != 0).collect(),
            cone,
            dilatation,
            differential,
            dilatation_mean: out.dilatation_mean,
            dilatation_median: out.dilatation_median,
            dilatation_p99: out.dilatation_p99,
            flipped_triangles: out.flipped_triangles,
            degenerate_triangles: out.degenerate_triangles,
            seam_edge_count: out.seam_edge_count,
            seam_length: out.seam_length,
            area: out.area,
            linear_iterations: out.linear_iterations,
            time: Duration::try_from_secs_f64(out.seconds).unwrap_or_default(),
        })
    }
}

impl fmt::Debug for Parameterizer<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Parameterizer")
            .field("tolerance", &self.tolerance)
            .field("seam_edges", &self.seam_edges.len())
            .finish_non_exhaustive()
    }
}

/// A conformal parameterisation: coordinates (u, v) of the corners of all triangles.
///
/// The linear parts of the transitions are +-1, so (du + i dv)^2 has no seams: it is
/// the holomorphic quadratic differential. Zeros in triangles move to a corner.
/// Where the foliation is 0 (limbs that no loop goes round) triangles are degenerate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Parameterization {
    /// (u, v) of the three corners of each triangle, in the unit of the values.
    pub corner_uv: Vec<[[f64; 2]; 3]>,
    /// Sign, du, dv of each edge: where a point of it has (u, v) in the first of its
    /// two triangles, the one with the lower number, it has sign * (u, v) + (du, dv) in
    /// the second, exactly. Edges off the seams have (1, 0, 0).
    pub transition: Vec<[f64; 3]>,
    /// For each edge whether the layout is cut there.
    pub seam: Vec<bool>,
    /// Cone angle of each vertex as a multiple of pi; 2 is regular. The sum of
    /// 2 - cone is 4 - 4 genus.
    pub cone: Vec<i32>,
    /// For each triangle the ratio of the singular values of the map, at least 1;
    /// negative where the image is flipped, infinite where it is degenerate (above 1000).
    pub dilatation: Vec<f64>,
    /// The quadratic differential of each triangle, real and imaginary part, in the frame
    /// of the triangle: x along its side 0, y to the left of it.
    pub differential: Vec<[f64; 2]>,
    /// Mean absolute dilatation, weighted by area, without degenerate triangles.
    pub dilatation_mean: f64,
    /// Median of the dilatation, by area, of all triangles.
    pub dilatation_median: f64,
    /// The dilatation that 99 % of the area stay below.
    pub dilatation_p99: f64,
    /// Triangles with a flipped image.
    pub flipped_triangles: u64,
    /// Triangles with a dilatation above 1000, or an image too small to tell.
    pub degenerate_triangles: u64,
    /// Edges of the seams.
    pub seam_edge_count: u64,
    /// Length of the seams, in the unit of the positions.
    pub seam_length: f64,
    /// Area of the image: the energy, up to discretisation.
    pub area: f64,
    /// Iterations of the linear solver.
    pub linear_iterations: u64,
    /// Time of the call.
    pub time: Duration,
}
