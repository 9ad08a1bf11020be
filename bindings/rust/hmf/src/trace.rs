//! Leaves of a foliation as polylines.

use crate::error::{call, Result};
use crate::foliation::Foliation;
use hmf_sys as sys;
use std::mem::size_of;
use std::ops::Range;
use std::ptr;

/// Which leaves of a foliation to follow; see [`Foliation::tracer`].
///
/// Where nothing is set, the critical ones are.
#[derive(Clone, Debug)]
#[must_use = "a tracer does nothing until `trace` is called"]
pub struct Tracer<'a> {
    foliation: &'a Foliation,
    critical: bool,
    spacing: f64,
    length_limit: f64,
    conjugate: bool,
    point_triangles: Vec<u32>,
    point_barycentrics: Vec<[f64; 3]>, // as many
}

impl<'a> Tracer<'a> {
    pub(crate) fn new(foliation: &'a Foliation) -> Tracer<'a> {
        Tracer {
            foliation,
            critical: false,
            spacing: 0.0,
            length_limit: 0.0,
            conjugate: false,
            point_triangles: Vec::new(),
            point_barycentrics: Vec::new(),
        }
    }

    /// All leaves out of zeros. Genus 1 has none.
    pub fn critical(mut self) -> Self {
        self.critical = true;
        self
    }

    /// Level sets, about so far apart, in the unit of the values.
    ///
    /// A cylinder gets round(height / spacing) of them, at least one, evenly spaced
    /// with half a space at either side: so they match across critical leaves.
    pub fn spacing(mut self, spacing: f64) -> Self {
        self.spacing = spacing;
        self
    }

    /// Where a leaf stops, in each direction from where it starts, in the unit of
    /// the positions. Default: no limit; for conjugate leaves ten times the root of the
    /// area of the surface.
    pub fn length_limit(mut self, length: f64) -> Self {
        self.length_limit = length;
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
        self.conjugate = true;
        self
    }

    /// The leaf through a point of a triangle, given by its barycentric coordinates
    /// for the corners of the triangle: not negative, sum 1. May be called for many points.
    pub fn point(mut self, triangle: u32, barycentric: [f64; 3]) -> Self {
        self.point_triangles.push(triangle);
        self.point_barycentrics.push(barycentric);
        self
    }

    /// Follows the leaves, in exact integers: no two cross, each closes exactly, and
    /// only critical leaves end, at zeros. The values need not be harmonic, but for
    /// conjugate leaves.
    ///
    /// # Errors
    ///
    /// Classes 100, 200, 500; [`Status::ERROR_OPTIONS`](crate::Status::ERROR_OPTIONS)
    /// for a bad point, where the index is its number.
    pub fn trace(&self) -> Result<Leaves> {
        let options = sys::hmf_trace_options {
            struct_size: size_of::<sys::hmf_trace_options>() as u32,
            critical: self.critical.into(),
            spacing: self.spacing,
            length_limit: self.length_limit,
            point_count: self.point_triangles.len() as u64,
            point_triangles: self.point_triangles.as_ptr(),
            point_barycentrics: self.point_barycentrics.as_ptr().cast(),
            leaves: if self.conjugate { sys::HMF_LEAVES_CONJUGATE } else { sys::HMF_LEAVES_FOLIATION },
            reserved: 0,
        };
        let (hierarchy, values) = (self.foliation.hierarchy().as_ptr(), self.foliation.values());
        let level = self.foliation.level();
        let (mut line_count, mut point_count) = (0, 0);
        let (no_lines, no_offsets, no_points, no_edges) =
            (ptr::null_mut(), ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
        // SAFETY: the values and the points are given with their numbers; NULL arrays only count.
        call(|error| unsafe {
            sys::hmf_trace(
                hierarchy,
                level,
                values.as_ptr(),
                values.len(),
                &options,
                no_lines,
                0,
                no_offsets,
                0,
                no_points,
                no_edges,
                0,
                &mut line_count,
                &mut point_count,
                error,
            )
        })?;
        let mut lines = vec![EMPTY; line_count];
        let mut offsets = vec![0; line_count + 1];
        let mut points = vec![[0.0; 3]; point_count];
        let mut edges = vec![sys::HMF_NONE; point_count];
        // SAFETY: as above, and each array is given with its length.
        call(|error| unsafe {
            sys::hmf_trace(
                hierarchy,
                level,
                values.as_ptr(),
                values.len(),
                &options,
                lines.as_mut_ptr(),
                lines.len(),
                offsets.as_mut_ptr(),
                offsets.len(),
                points.as_mut_ptr().cast(),
                edges.as_mut_ptr(),
                points.len(),
                &mut line_count,
                &mut point_count,
                error,
            )
        })?;
        Ok(Leaves {
            lines: lines.iter().zip(offsets.windows(2)).map(|(line, ends)| Line::from_raw(line, ends)).collect(),
            points,
            point_edges: edges.into_iter().map(element).collect(),
        })
    }
}

const EMPTY: sys::hmf_line = sys::hmf_line {
    kind: 0,
    closed: 0,
    begin: 0,
    end: 0,
    begin_zero: sys::HMF_NONE,
    end_zero: sys::HMF_NONE,
    cylinder: sys::HMF_NONE,
    source: 0,
    height: 0.0,
    length: 0.0,
};

/// An index that may be `HMF_NONE`.
pub(crate) fn element(index: u32) -> Option<u32> {
    (index != sys::HMF_NONE).then_some(index)
}

/// Leaves as polylines; consecutive points of a line lie in one triangle.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Leaves {
    /// First the level sets, cylinder by cylinder, then the critical leaves, then
    /// those through points.
    pub lines: Vec<Line>,
    /// The points of all lines, one after the other, in the unit of the positions.
    pub points: Vec<[f64; 3]>,
    /// For each point the edge of the level that it lies on; `None` for the middle of
    /// a zero in a triangle.
    pub point_edges: Vec<Option<u32>>,
}

/// Why a line was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LineKind {
    /// A closed leaf at a given height of its cylinder.
    Level,
    /// A leaf out of a zero.
    Critical,
    /// The leaf through a given point.
    Point,
}

/// How a line ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LineEnd {
    /// It does not: the last point joins the first.
    Closed,
    /// At a zero, an index into [`Singularities::list`](crate::Singularities::list);
    /// `None` for conjugate leaves.
    Zero(Option<u32>),
    /// At the length limit.
    Limit,
    /// Of a conjugate line: on a critical leaf, where its cylinder ends.
    Critical,
    /// The given point lies where the foliation is 0: the line has no points.
    Nowhere,
}

/// One leaf.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Line {
    /// Why it was made.
    pub kind: LineKind,
    /// Its points in [`Leaves::points`].
    pub points: Range<usize>,
    /// Whether the last point joins the first, which is not repeated.
    pub closed: bool,
    /// Where it begins.
    pub begin: LineEnd,
    /// Where it ends.
    pub end: LineEnd,
    /// The cylinder that it lies in, an index into [`Foliation::cylinders`]; `None` for critical leaves.
    pub cylinder: Option<u32>,
    /// Number of the given point; of the level, from the lower side of its cylinder;
    /// of the critical leaf.
    pub source: u32,
    /// Above the lower side of the cylinder, in the unit of the values; 0 for critical leaves.
    pub height: f64,
    /// In the unit of the positions.
    pub length: f64,
}

impl Line {
    fn from_raw(raw: &sys::hmf_line, ends: &[u64]) -> Line {
        let end = |end, zero| match end {
            sys::HMF_END_ZERO => LineEnd::Zero(element(zero)),
            sys::HMF_END_CRITICAL => LineEnd::Critical,
            sys::HMF_END_LIMIT => LineEnd::Limit,
            sys::HMF_END_NOWHERE => LineEnd::Nowhere,
            _ => LineEnd::Closed,
        };
        Line {
            kind: match raw.kind {
                sys::HMF_LINE_CRITICAL => LineKind::Critical,
                sys::HMF_LINE_POINT => LineKind::Point,
                _ => LineKind::Level,
            },
            points: ends[0] as usize..ends[1] as usize,
            closed: raw.closed != 0,
            begin: end(raw.begin, raw.begin_zero),
            end: end(raw.end, raw.end_zero),
            cylinder: element(raw.cylinder),
            source: raw.source,
            height: raw.height,
            length: raw.length,
        }
    }
}
