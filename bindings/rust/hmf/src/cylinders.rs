//! The cylinders that the critical leaves cut the surface into.

use crate::error::{call, Result};
use crate::foliation::Foliation;
use crate::loops::Loops;
use crate::trace::element;
use hmf_sys as sys;
use std::ptr;

/// A cylinder of a harmonic foliation, filled with closed leaves of one class.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Cylinder {
    /// Its loop; `None` if no loops were given.
    pub loop_index: Option<u32>,
    /// The weight of the loop, exactly.
    pub height: f64,
    /// In the flat metric du^2 + dv^2, in the unit of the values.
    pub circumference: f64,
    /// Height divided by circumference.
    pub modulus: f64,
    /// In the flat metric; the areas add up to the energy.
    pub area: f64,
    /// The leaf in its middle as a loop of triangles of the level.
    pub leaf: Vec<u32>,
}

pub(crate) fn cylinders(foliation: &Foliation, loops: Option<&Loops>) -> Result<Vec<Cylinder>> {
    let set = loops.map(Loops::as_raw);
    let set = set.as_ref().map_or(ptr::null(), |set| set as *const _);
    let (hierarchy, level, values) = (foliation.hierarchy().as_ptr(), foliation.level(), foliation.values());
    let (mut count, mut triangle_count) = (0, 0);
    let (no_list, no_offsets, no_triangles) = (ptr::null_mut(), ptr::null_mut(), ptr::null_mut());
    // The classes are compared in the second call only: that is the slow part.
    // SAFETY: the values are given with their number; NULL arrays only count.
    call(|error| unsafe {
        sys::hmf_cylinders(
            hierarchy,
            level,
            values.as_ptr(),
            values.len(),
            ptr::null(),
            no_list,
            0,
            no_offsets,
            0,
            no_triangles,
            0,
            &mut count,
            &mut triangle_count,
            error,
        )
    })?;
    let mut list = vec![EMPTY; count];
    let mut offsets = vec![0_u64; count + 1];
    let mut triangles = vec![0_u32; triangle_count];
    // SAFETY: as above, each array is given with its length, and the loops are borrowed.
    call(|error| unsafe {
        sys::hmf_cylinders(
            hierarchy,
            level,
            values.as_ptr(),
            values.len(),
            set,
            list.as_mut_ptr(),
            list.len(),
            offsets.as_mut_ptr(),
            offsets.len(),
            triangles.as_mut_ptr(),
            triangles.len(),
            &mut count,
            &mut triangle_count,
            error,
        )
    })?;
    let cylinder = |(raw, ends): (&sys::hmf_cylinder, &[u64])| Cylinder {
        loop_index: element(raw.loop_),
        height: raw.height,
        circumference: raw.circumference,
        modulus: raw.modulus,
        area: raw.area,
        leaf: triangles[ends[0] as usize..ends[1] as usize].to_vec(),
    };
    Ok(list.iter().zip(offsets.windows(2)).map(cylinder).collect())
}

const EMPTY: sys::hmf_cylinder =
    sys::hmf_cylinder { loop_: sys::HMF_NONE, reserved: 0, height: 0.0, circumference: 0.0, modulus: 0.0, area: 0.0 };
