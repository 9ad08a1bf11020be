//! Sets of closed curves on a level.

use crate::error::{Error, Result, Status};
use crate::hierarchy::Hierarchy;
use crate::owned::{make, slice, Owned};
use crate::records::{codes, Read};
use foliations_sys as sys;

codes! {
    /// What the elements of loops are.
    LoopElements: i32 {
        /// Triangles: consecutive ones share an edge, the last and the first as well.
        Triangles = sys::HMF_PATH_TRIANGLES,
        /// Vertices: consecutive ones share an edge, the last and the first as well.
        Vertices = sys::HMF_PATH_VERTICES,
    }
}

codes! {
    /// Which loops to make.
    #[derive(Default)]
    LoopsKind: i32 {
        /// As many as the genus; together they cut the surface into one planar piece.
        /// On a sphere around pairs of marked vertices. With boundary also one along each boundary,
        /// and arcs on a disk.
        #[default]
        Cut = sys::HMF_LOOPS_CUT,
        /// The same, and they bound inside the surface: they go around the handles.
        Handle = sys::HMF_LOOPS_HANDLE,
        /// The same, and they bound outside: they go around the holes.
        Tunnel = sys::HMF_LOOPS_TUNNEL,
        /// 3 genus - 3 + marked vertices (genus 1 without those: one); together they cut the
        /// surface into pairs of pants.
        Pants = sys::HMF_LOOPS_PANTS,
    }
}

/// Disjoint closed curves on a level of a hierarchy, with weights.
///
/// ```
/// // Two loops of vertices on the input mesh, weights 1 and 2.
/// let loops = foliations::Loops::vertices(0).with(&[0, 1, 2, 3], 1.0).with(&[10, 11, 12], 2.0);
/// assert_eq!(loops.len(), 2);
/// assert_eq!(loops.get(1), Some(&[10, 11, 12][..]));
/// assert_eq!(loops.weights(), [1.0, 2.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Loops {
    level: usize,
    element_kind: LoopElements,
    offsets: Vec<u64>, // one more than loops; the first is 0, and they never decrease
    elements: Vec<u32>,
    weights: Vec<f64>,
    arcs: Vec<u8>,
    arc_sides: Vec<[u32; 2]>,
}

/// The first side on the boundary, at both ends.
const ANY_SIDE: [u32; 2] = [crate::NONE; 2];

impl Loops {
    /// No loops yet; their elements will be triangles of `level`.
    pub fn triangles(level: usize) -> Loops {
        Loops::empty(level, LoopElements::Triangles)
    }

    /// No loops yet; their elements will be vertices of `level`.
    pub fn vertices(level: usize) -> Loops {
        Loops::empty(level, LoopElements::Vertices)
    }

    pub(crate) fn empty(level: usize, element_kind: LoopElements) -> Loops {
        let (elements, weights, arcs, arc_sides) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Loops { level, element_kind, offsets: vec![0], elements, weights, arcs, arc_sides }
    }

    /// A copy of loops of the library.
    ///
    /// # Safety
    ///
    /// The library made them.
    pub(crate) unsafe fn copy(set: &sys::hmf_loop_set) -> Loops {
        let count = set.count as usize;
        // SAFETY: the header gives each array so many elements.
        let (offsets, weights) = unsafe { (slice(set.offsets, set.count + 1), slice(set.weights, set.count)) };
        // SAFETY: as above.
        let arcs = unsafe { slice(set.arcs, set.count) };
        // SAFETY: as above.
        let arc_sides = unsafe { slice(set.arc_sides.cast::<[u32; 2]>(), set.count) };
        // SAFETY: as above.
        let elements = unsafe { slice(set.elements, offsets[count]) };
        Loops {
            level: set.level.read(),
            element_kind: set.element_kind.read(),
            offsets: offsets.to_vec(),
            elements: elements.to_vec(),
            weights: if set.weights.is_null() { vec![1.0; count] } else { weights.to_vec() },
            arcs: if set.arcs.is_null() { vec![0; count] } else { arcs.to_vec() },
            arc_sides: if set.arc_sides.is_null() { vec![ANY_SIDE; count] } else { arc_sides.to_vec() },
        }
    }

    /// Adds a loop with its weight.
    pub fn push(&mut self, elements: &[u32], weight: f64) {
        self.elements.extend_from_slice(elements);
        self.offsets.push(self.elements.len() as u64);
        self.weights.push(weight);
        self.arcs.push(0);
        self.arc_sides.push(ANY_SIDE);
    }

    /// Adds an arc from boundary to boundary with its weight, on a surface that has one.
    pub fn push_arc(&mut self, elements: &[u32], weight: f64) {
        self.push_as(elements, weight, 1, ANY_SIDE);
    }

    /// Adds a loop or an arc, with its entries of [`arcs`](Loops::arcs) and [`arc_sides`](Loops::arc_sides).
    pub(crate) fn push_as(&mut self, elements: &[u32], weight: f64, arc: u8, sides: [u32; 2]) {
        self.push(elements, weight);
        let last = self.weights.len() - 1;
        self.arcs[last] = arc;
        self.arc_sides[last] = sides;
    }

    /// The same loops and one more, with its weight.
    #[must_use]
    pub fn with(mut self, elements: &[u32], weight: f64) -> Loops {
        self.push(elements, weight);
        self
    }

    /// The same loops with other weights, all positive, within a factor of 2^20.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_COUNT`] if there is not one weight for each loop. The
    /// weights themselves are checked when the loops are used.
    pub fn with_weights(mut self, weights: &[f64]) -> Result<Loops> {
        if weights.len() != self.len() {
            let message = format!("There are {} weights for {} loops. Give one for each.", weights.len(), self.len());
            return Err(Error::new(Status::ERROR_COUNT, message));
        }
        self.weights.copy_from_slice(weights);
        Ok(self)
    }

    /// Level of the elements.
    pub fn level(&self) -> usize {
        self.level
    }

    /// What the elements are.
    pub fn element_kind(&self) -> LoopElements {
        self.element_kind
    }

    /// Number of loops.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Whether there is no loop.
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// Elements of a loop.
    pub fn get(&self, index: usize) -> Option<&[u32]> {
        let end = *self.offsets.get(index.checked_add(1)?)?;
        Some(&self.elements[self.offsets[index] as usize..end as usize])
    }

    /// The elements of each loop.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.offsets.windows(2).map(|ends| &self.elements[ends[0] as usize..ends[1] as usize])
    }

    /// The weight of each loop.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// For each loop 0, or not 0 if it is an arc from boundary to boundary.
    pub fn arcs(&self) -> &[u8] {
        &self.arcs
    }

    /// For each arc of triangles the sides where it begins and ends, 0 to 2; `u32::MAX`: the first
    /// side on the boundary.
    pub fn arc_sides(&self) -> &[[u32; 2]] {
        &self.arc_sides
    }

    /// For calls during which `self` is borrowed.
    pub(crate) fn as_raw(&self) -> sys::hmf_loop_set {
        sys::hmf_loop_set {
            struct_size: std::mem::size_of::<sys::hmf_loop_set>() as u32,
            element_kind: self.element_kind as i32,
            level: self.level as u64,
            count: self.len() as u64,
            offsets: self.offsets.as_ptr(),
            elements: self.elements.as_ptr(),
            weights: self.weights.as_ptr(),
            arcs: self.arcs.as_ptr(),
            arc_sides: self.arc_sides.as_ptr().cast(),
        }
    }
}

impl Hierarchy {
    /// Loops made by the library on a level, as loops of triangles. Deterministic.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`], [`Status::ERROR_MESH_NOT_EMBEDDED`] for `Handle` and
    /// `Tunnel` on a surface that meets itself, [`Status::CANCELLED`], or a status of class 200.
    pub fn loops(&self, level: usize, kind: LoopsKind) -> Result<Loops> {
        // SAFETY: the handle is valid.
        let set: Owned<sys::hmf_loop_set> = make(|out, control, error| unsafe {
            sys::hmf_loops(self.as_ptr(), level, kind as i32, control, out, error)
        })?;
        // SAFETY: the library made them.
        Ok(unsafe { Loops::copy(&set) })
    }
}
