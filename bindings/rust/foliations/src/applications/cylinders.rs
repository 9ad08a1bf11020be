//! The cylinders that the critical leaves cut the surface into.

use crate::error::Result;
#[cfg(doc)]
use crate::error::Status;
use crate::foliation::Foliation;
use crate::loops::Loops;
use crate::owned::{make, slice, Owned};
use crate::progress::unwatched;
use crate::records::{record, Read};
use foliations_sys as sys;
use std::ptr;

record! {
    /// A cylinder of a harmonic foliation, filled with closed leaves of one class.
    #[derive(Copy)]
    Cylinder from hmf_cylinder {
        /// Its loop; `None` if the loops of the foliation are not known.
        loop_index: Option<u32> = |raw: &sys::hmf_cylinder| raw.loop_.read(),
        /// The weight of the loop, exactly.
        height: f64,
        /// In the flat metric du^2 + dv^2, in the unit of the values.
        circumference: f64,
        /// Height divided by circumference.
        modulus: f64,
        /// In the flat metric; the areas add up to the energy.
        area: f64,
    }
}

/// The cylinders of a harmonic foliation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Cylinders {
    /// In the order of [`Line::cylinder`](crate::Line::cylinder).
    pub list: Vec<Cylinder>,
    /// The leaf in the middle of each as a loop of triangles of the level; weights: the heights.
    pub leaves: Loops,
    /// Relative difference of the sum of height * circumference and the energy.
    pub area_error: f64,
    /// From the point opposite to the base of the first side to the base of the second side, along
    /// the leaves, with the second side on the right; in `0..circumference`. NaN where there is none.
    pub twists: Vec<f64>,
    /// Corners of side s (0 or 1) of cylinder k: from entry 2 k + s to the next entry, the base first.
    pub corner_offsets: Vec<u64>,
    /// For each corner the vertex of its zero, or the vertex of the triangle with the zero that lies
    /// ahead of the zero inside the cylinder. The base is the corner with the lowest one.
    pub corner_vertices: Vec<u32>,
    /// For each corner its distance from the base of the first side, in `0..circumference`. For other
    /// bases subtract their places.
    pub corner_places: Vec<f64>,
}

impl Foliation {
    /// The cylinders of a harmonic foliation: the critical leaves cut the surface into
    /// one for each loop, filled with closed leaves of its class.
    ///
    /// `loops` are those that the foliation belongs to, on any level; `None`: those of [`Foliation::loops`]. If that
    /// has none, [`Cylinder::loop_index`] is `None`. Heights are those of the leaves. Circumference, modulus and
    /// area are those of the minimum, where energy = sum of height * circumference = sum
    /// of areas. Matching takes about as long as two solves on the coarsest level.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_VALUE_CLASS`] if the values do not belong to the loops,
    /// [`Status::ERROR_VALUE_NOT_HARMONIC`] if their energy is 1 % above the minimum,
    /// others of class 500, [`Status::CANCELLED`], and classes 100, 200, 400.
    pub fn cylinders(&self, loops: Option<&Loops>) -> Result<Cylinders> {
        let own = if loops.is_none() { unwatched(|| self.loops())? } else { None };
        let set = loops.or(own.as_ref()).map(Loops::as_raw);
        let set = set.as_ref().map_or(ptr::null(), ptr::from_ref);
        // SAFETY: the handle is valid, and the set borrows from `loops`.
        let block: Owned<sys::hmf_cylinder_set> =
            make(|out, control, error| unsafe { sys::hmf_cylinders(self.as_ptr(), set, control, out, error) })?;
        // SAFETY: the list has so many entries, and the leaves are part of the block.
        let (list, leaves) = unsafe { (slice(block.list, block.count), Loops::copy(&*block.leaves)) };
        // SAFETY: arrays of the block; the last offset counts the corners.
        let (twists, corner_offsets) =
            unsafe { (slice(block.twists, block.count), slice(block.corner_offsets, 2 * block.count + 1)) };
        let corners = corner_offsets[corner_offsets.len() - 1];
        let (vertices, places) =
            // SAFETY: as above.
            unsafe { (slice(block.corner_vertices, corners), slice(block.corner_places, corners)) };
        Ok(Cylinders {
            list: list.iter().map(Read::read).collect(),
            leaves,
            area_error: block.area_error,
            twists: twists.to_vec(),
            corner_offsets: corner_offsets.to_vec(),
            corner_vertices: vertices.to_vec(),
            corner_places: places.to_vec(),
        })
    }
}
