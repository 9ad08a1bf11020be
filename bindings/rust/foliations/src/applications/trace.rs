//! Leaves of a foliation as polylines.

use crate::error::Result;
use crate::foliation::Foliation;
use crate::owned::{arrays, make, slice, Owned};
use crate::progress::{Closure, Progress};
use crate::ranges::Refusal;
use crate::records::{codes, options, record, Read};
use foliations_sys as sys;
use std::ops::Range;

/// Which leaves of a foliation to follow; see [`Foliation::tracer`].
///
/// Where nothing is set, the critical ones are.
#[derive(Debug)]
#[must_use = "a tracer does nothing until `trace` is called"]
pub struct Tracer<'a> {
    foliation: &'a Foliation,
    options: sys::hmf_trace_options,
    refusal: Refusal,
    point_triangles: Vec<u32>,
    point_barycentrics: Vec<[f64; 3]>, // as many
    progress: Option<Closure<'a>>,
}

impl Foliation {
    /// Which leaves of this foliation to follow.
    ///
    /// ```
    /// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
    /// # fn main() -> foliations::Result<()> {
    /// # let (positions, triangles) = plate(2, 1, 3, 2);
    /// # let hierarchy = foliations::Hierarchy::build(&positions, &triangles)?;
    /// let foliation = hierarchy.solver().solve()?.foliation;
    /// let leaves = foliation.tracer().critical().spacing(0.2).trace()?;
    /// for line in leaves.lines() {
    ///     let points: &[[f64; 3]] = &leaves.points()[line.points.clone()];
    ///     println!("{:?} of {} points, length {:.3}", line.kind, points.len(), line.length);
    /// }
    /// # assert!(leaves.lines().len() > 6);
    /// # Ok(())
    /// # }
    /// ```
    pub fn tracer(&self) -> Tracer<'_> {
        let options = options!(hmf_trace_options leaves: sys::HMF_LEAVES_FOLIATION);
        let (point_triangles, point_barycentrics) = (Vec::new(), Vec::new());
        let refusal = Refusal::default();
        Tracer { foliation: self, options, refusal, point_triangles, point_barycentrics, progress: None }
    }
}

impl<'a> Tracer<'a> {
    /// All leaves out of zeros. Genus 1 has none.
    pub fn critical(mut self) -> Self {
        self.options.critical = 1;
        self
    }

    /// Level sets, about so far apart, in the unit of the values.
    ///
    /// A cylinder gets round(height / spacing) of them, at least one, evenly spaced
    /// with half a space at either side: so they match across critical leaves.
    pub fn spacing(mut self, spacing: f64) -> Self {
        self.refusal.check("spacing", spacing, "(0, inf)");
        self.options.spacing = spacing;
        self
    }

    /// Where a leaf stops, in each direction from where it starts, in the unit of
    /// the positions. Default: no limit; for conjugate leaves ten times the root of the
    /// area of the surface.
    pub fn length_limit(mut self, length: f64) -> Self {
        self.refusal.check("length_limit", length, "(0, inf)");
        self.options.length_limit = length;
        self
    }

    /// The leaves of the conjugate foliation, across those of the foliation, which must be
    /// harmonic.
    ///
    /// They do not close in general. Level sets are then lines across each cylinder from
    /// one side to the other, round(circumference / spacing) of them. Leaves out of zeros
    /// end at another zero or at the length limit, those through points close or end at the
    /// limit. [`Line::height`] and, but for level sets, [`Line::cylinder`] are not set.
    pub fn conjugate(mut self) -> Self {
        self.options.leaves = sys::HMF_LEAVES_CONJUGATE;
        self
    }

    /// The leaf through a point of a triangle, given by its barycentric coordinates
    /// for the corners of the triangle: not negative, sum 1. May be called for many points.
    pub fn point(mut self, triangle: u32, barycentric: [f64; 3]) -> Self {
        self.point_triangles.push(triangle);
        self.point_barycentrics.push(barycentric);
        self
    }

    /// A closure that is called on this thread with a fraction rising from 0 to
    /// 1, and that may end the call. If it panics, the call is cancelled and the
    /// panic continues.
    pub fn progress<R: Into<Progress>>(mut self, closure: impl FnMut(f64) -> R + 'a) -> Self {
        self.progress = Closure::new(closure);
        self
    }

    /// Follows the leaves, in exact integers: no two cross, each closes exactly, and
    /// only critical leaves end, at zeros. The foliation need not be harmonic, but for
    /// conjugate leaves.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`](crate::Status::CANCELLED), classes 100, 200, 500;
    /// [`Status::ERROR_OPTIONS`](crate::Status::ERROR_OPTIONS) for a bad point, where the
    /// index is its number.
    pub fn trace(&mut self) -> Result<Leaves> {
        self.refusal.result()?;
        let options = sys::hmf_trace_options {
            point_count: self.point_triangles.len() as u64,
            point_triangles: self.point_triangles.as_ptr(),
            point_barycentrics: self.point_barycentrics.as_ptr().cast(),
            ..self.options
        };
        let foliation = self.foliation.as_ptr();
        let block: Owned<sys::hmf_lines> = Closure::watch(&mut self.progress, || {
            // SAFETY: the handle is valid, and the points are given with their number.
            make(|out, control, error| unsafe { sys::hmf_trace(foliation, &options, control, out, error) })
        })?;
        // SAFETY: the header gives the arrays so many elements.
        let (raw, offsets) =
            unsafe { (slice(block.lines, block.line_count), slice(block.offsets, block.line_count + 1)) };
        let line =
            |(raw, ends): (&sys::hmf_line, &[u64])| Line { points: ends[0].read()..ends[1].read(), ..raw.read() };
        let lines = raw.iter().zip(offsets.windows(2)).map(line).collect();
        Ok(Leaves { block, lines })
    }
}

/// Leaves as polylines; consecutive points of a line lie in one triangle.
#[derive(Debug)]
pub struct Leaves {
    block: Owned<sys::hmf_lines>,
    lines: Vec<Line>,
}

impl Leaves {
    /// First the level sets, cylinder by cylinder, then the critical leaves, then
    /// those through points.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// Pairs of points that were checked: whether both lie on one leaf.
    pub fn compared_count(&self) -> u64 {
        self.block.compared_count
    }

    /// Largest difference of the values at both points of a pair.
    pub fn deviation(&self) -> f64 {
        self.block.deviation
    }
}

arrays! {
    Leaves {
        /// The points of all lines, one after the other, in the unit of the positions.
        points: [[f64; 3]; point_count],
        /// For each point the edge of the level that it lies on; [`NONE`](crate::NONE) for
        /// the middle of a zero in a triangle.
        point_edges: [u32; point_count],
    }
}

codes! {
    /// Why a line was made.
    LineKind: i32 {
        /// A closed leaf at a given height of its cylinder.
        Level = sys::HMF_LINE_LEVEL,
        /// A leaf out of a zero.
        Critical = sys::HMF_LINE_CRITICAL,
        /// The leaf through a given point.
        Point = sys::HMF_LINE_POINT,
    }
}

codes! {
    /// How a line begins or ends.
    LineEnd: i32 {
        /// It does not: the last point joins the first.
        Closed = sys::HMF_END_CLOSED,
        /// At a zero.
        Zero = sys::HMF_END_ZERO,
        /// At the length limit.
        Limit = sys::HMF_END_LIMIT,
        /// The given point lies where the foliation is 0: the line has no points.
        Nowhere = sys::HMF_END_NOWHERE,
        /// Of a conjugate line: on a critical leaf, where its cylinder ends.
        Critical = sys::HMF_END_CRITICAL,
        /// At the boundary of the surface.
        Boundary = sys::HMF_END_BOUNDARY,
    }
}

record! {
    /// One leaf.
    Line from hmf_line {
        /// Why it was made.
        kind: LineKind,
        /// Its points in [`Leaves::points`].
        points: Range<usize> = |_: &sys::hmf_line| 0..0,
        /// Whether the last point joins the first, which is not repeated.
        closed: bool,
        /// Where it begins.
        begin: LineEnd,
        /// Where it ends.
        end: LineEnd,
        /// The zero where it begins, an index into
        /// [`Singularities::list`](crate::Singularities::list); `None` for conjugate leaves.
        begin_zero: Option<u32>,
        /// The zero where it ends.
        end_zero: Option<u32>,
        /// The cylinder that it lies in, an index into
        /// [`Cylinders::list`](crate::Cylinders::list); `None` for critical leaves.
        cylinder: Option<u32>,
        /// Number of the given point; of the level, from the lower side of its cylinder;
        /// of the critical leaf.
        source: u32,
        /// Above the lower side of the cylinder, in the unit of the values; 0 for critical leaves.
        height: f64,
        /// In the unit of the positions.
        length: f64,
    }
}
