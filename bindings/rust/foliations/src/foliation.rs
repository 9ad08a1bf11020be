//! Values on the edges of a level, and what they are like.

use crate::error::Result;
#[cfg(doc)]
use crate::error::Status;
use crate::hierarchy::Hierarchy;
use crate::loops::{Loops, LoopsKind};
use crate::owned::{arrays, call, make, slice, Owned};
use crate::records::{codes, record, Read};
use foliations_sys as sys;
use std::fmt;
use std::sync::Arc;

/// A measured foliation: one value for each edge of a level.
///
/// The value of an edge is the distance of its ends in a metric tree, in the unit
/// of the weights of the loops. Values are exact multiples of a power of two, and
/// every triangle inequality holds exactly.
///
/// A clone is another reference to the same foliation, which is immutable: any
/// number of threads may use it. It keeps its hierarchy alive.
#[derive(Clone)]
pub struct Foliation {
    hierarchy: Hierarchy,
    handle: Arc<Owned<sys::hmf_foliation>>,
    class: Class,
}

/// The loops that a foliation belongs to.
#[derive(Clone, Default)]
pub(crate) enum Class {
    /// The values came without loops.
    #[default]
    Unknown,
    /// Those of the library, with weights 1.
    Kind(LoopsKind),
    /// Others.
    Loops(Arc<Loops>),
}

impl Hierarchy {
    /// Closed initial foliation of loops on their level: the value of an edge is
    /// the sum of the weights of the loops that cross it.
    ///
    /// # Errors
    ///
    /// A status of class 400 if a loop is not closed, simple and essential, or if
    /// loops meet or are freely homotopic; the element is the loop. Also
    /// [`Status::ERROR_LEVEL`], [`Status::CANCELLED`] and class 200.
    pub fn initialize(&self, loops: &Loops) -> Result<Foliation> {
        // SAFETY: the set borrows from `loops`.
        let handle = make(|out, control, error| unsafe {
            sys::hmf_foliation_from_loops(self.as_ptr(), &loops.as_raw(), control, out, error)
        })?;
        Ok(Foliation::new(self, handle).of_class(Class::Loops(Arc::new(loops.clone()))))
    }

    /// A foliation from values that you have, one for each edge of a level: results of
    /// the library, also written with 17 digits and read again, or multiplied by a
    /// power of two.
    ///
    /// Other numbers cannot be rounded edge by edge; start from loops instead. Values with
    /// poles are accepted for [`singularities`](Foliation::singularities) and
    /// [`energy`](Foliation::energy).
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`]; [`Status::ERROR_COUNT`] if the number of values is not
    /// the number of edges; class 500 if they are not closed; [`Status::CANCELLED`], class 200.
    pub fn foliation(&self, level: usize, values: impl AsRef<[f64]>) -> Result<Foliation> {
        let values = values.as_ref();
        // SAFETY: the values are given with their number.
        let handle = make(|out, control, error| unsafe {
            sys::hmf_foliation_from_values(self.as_ptr(), level, values.as_ptr(), values.len(), control, out, error)
        })?;
        Ok(Foliation::new(self, handle))
    }
}

impl Foliation {
    pub(crate) fn new(hierarchy: &Hierarchy, handle: Owned<sys::hmf_foliation>) -> Foliation {
        Foliation { hierarchy: hierarchy.clone(), handle: Arc::new(handle), class: Class::Unknown }
    }

    pub(crate) fn of_class(self, class: Class) -> Foliation {
        Foliation { class, ..self }
    }

    pub(crate) fn class(&self) -> Class {
        self.class.clone()
    }

    /// The loops of the solve, with their weights; `None` if the values came without loops. Those of the library
    /// are made on your mesh, level 0, by each call.
    ///
    /// # Errors
    ///
    /// Those of [`Hierarchy::loops`].
    pub fn loops(&self) -> Result<Option<Loops>> {
        match &self.class {
            Class::Unknown => Ok(None),
            Class::Kind(kind) => self.hierarchy.loops(0, *kind).map(Some),
            Class::Loops(loops) => Ok(Some(Loops::clone(loops))),
        }
    }

    pub(crate) fn as_ptr(&self) -> *const sys::hmf_foliation {
        self.handle.as_ptr()
    }

    /// The hierarchy.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The level whose edges have the values.
    pub fn level(&self) -> usize {
        // SAFETY: the handle is valid.
        unsafe { sys::hmf_foliation_level(self.as_ptr()) }
    }

    /// One value for each edge of the level.
    pub fn values(&self) -> &[f64] {
        let mut count = 0;
        // SAFETY: the handle is valid, and the values live as long as it does.
        unsafe {
            let values = sys::hmf_foliation_values(self.as_ptr(), &mut count);
            slice(values, count as u64)
        }
    }

    /// The power of two that all values are multiples of.
    pub fn unit(&self) -> f64 {
        // SAFETY: the handle is valid.
        unsafe { sys::hmf_foliation_unit(self.as_ptr()) }
    }

    /// Bytes held by the foliation, without its hierarchy; more once it was parameterized, say.
    pub fn memory(&self) -> u64 {
        // SAFETY: the handle is valid.
        unsafe { sys::hmf_foliation_memory(self.as_ptr()) }
    }

    /// The same foliation on another level: exact, in the same class, closed and
    /// without poles. To a finer level the recorded flips and collapses are
    /// undone; to a coarser one, a collapse moves one vertex to the image of the other.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`], [`Status::ERROR_VALUE_POLE`], [`Status::CANCELLED`], class 200.
    pub fn interpolate(&self, level: usize) -> Result<Foliation> {
        // SAFETY: the handle is valid.
        let handle =
            make(|out, control, error| unsafe { sys::hmf_interpolate(self.as_ptr(), level, control, out, error) })?;
        Ok(Foliation::new(&self.hierarchy, handle).of_class(self.class()))
    }

    /// Dirichlet energy: the sum over all edges of weight * value^2, in the
    /// squared unit of the values. On level 0 it is that of the intrinsic Delaunay
    /// triangulation, to which the values are carried exactly.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`], class 200.
    pub fn energy(&self) -> Result<f64> {
        let mut energy = 0.0;
        // SAFETY: the handle and the output are valid.
        call(|control, error| unsafe { sys::hmf_energy(self.as_ptr(), control, &mut energy, error) })?;
        Ok(energy)
    }

    /// One number for each vertex: how much it violates the balance of the
    /// harmonic foliation, relative to the mean. 0 everywhere means that this is
    /// the unique minimum of the energy.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_VALUE_POLE`], [`Status::CANCELLED`], class 200.
    pub fn residuals(&self) -> Result<Vec<f64>> {
        // SAFETY: the handle is valid.
        let block: Owned<sys::hmf_residual_set> =
            make(|out, control, error| unsafe { sys::hmf_residuals(self.as_ptr(), control, out, error) })?;
        // SAFETY: the array has so many entries.
        Ok(unsafe { slice(block.values, block.vertex_count) }.to_vec())
    }

    /// Natural logarithm of the length of the gradient on each triangle: by how much
    /// a conformal (u, v) stretches there, in the unit of the values / that of the
    /// positions.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`], class 200.
    pub fn conformal_scale(&self) -> Result<Vec<f64>> {
        let block = self.scale()?;
        // SAFETY: the array has so many entries.
        Ok(unsafe { slice(block.log_scale, block.triangle_count) }.to_vec())
    }

    fn scale(&self) -> Result<Owned<sys::hmf_scale>> {
        // SAFETY: the handle is valid.
        make(|out, control, error| unsafe { sys::hmf_conformal_scale(self.as_ptr(), control, out, error) })
    }

    /// Standard deviation of [`conformal_scale`](Foliation::conformal_scale) over the
    /// surface; 0: the same scale everywhere.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`], class 200.
    pub fn unevenness(&self) -> Result<f64> {
        Ok(self.scale()?.unevenness)
    }

    /// Zeros and poles, and the index of each vertex and triangle. The indices add
    /// up to 4 - 4 genus - marked vertices. A foliation that the library made has no poles.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`], class 200.
    pub fn singularities(&self) -> Result<Singularities> {
        // SAFETY: the handle is valid.
        let block: Owned<sys::hmf_singularity_set> =
            make(|out, control, error| unsafe { sys::hmf_singularities(self.as_ptr(), control, out, error) })?;
        // SAFETY: the list has so many entries.
        let list = unsafe { slice(block.list, block.count) }.iter().map(Read::read).collect();
        Ok(Singularities { block, list })
    }
}

impl fmt::Debug for Foliation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Foliation").field("hierarchy", &self.hierarchy).field("level", &self.level()).finish()
    }
}

codes! {
    /// Where a zero or a pole is.
    SingularityKind: i32 {
        /// At a vertex.
        Vertex = sys::HMF_SINGULAR_VERTEX,
        /// In a triangle.
        Triangle = sys::HMF_SINGULAR_TRIANGLE,
        /// At several vertices that edges of value 0 join.
        Cluster = sys::HMF_SINGULAR_CLUSTER,
    }
}

record! {
    /// A zero or a pole.
    #[derive(Copy)]
    Singularity from hmf_singularity {
        /// Where it is.
        kind: SingularityKind,
        /// Negative: a zero of order `-index`; positive: a pole; 0: a marked vertex that is
        /// no zero.
        index: i32,
        /// The vertex, the triangle, or the lowest vertex of the cluster.
        element: u32,
        /// Vertices of the cluster, else 1.
        size: u32,
        /// Of the vertex; the middle of the triangle; the mean of the cluster, with boundary its vertex
        /// nearest to that.
        position: [f64; 3],
    }
}

/// Zeros and poles, and the indices of all vertices and triangles of a level, which
/// add up to 4 - 4 genus - marked vertices.
#[derive(Debug)]
pub struct Singularities {
    block: Owned<sys::hmf_singularity_set>,
    list: Vec<Singularity>,
}

impl Singularities {
    /// All zeros and poles: vertices and clusters, then triangles, each by number; then the
    /// marked vertices that are no zeros, with index 0.
    pub fn list(&self) -> &[Singularity] {
        &self.list
    }
}

arrays! {
    Singularities {
        /// Index of each vertex. For the vertices of a cluster, that of the cluster at
        /// its lowest vertex and 0 at the others.
        vertex_index: [i32; vertex_count],
        /// For each vertex the lowest vertex of its cluster.
        vertex_cluster: [u32; vertex_count],
        /// Index of each triangle, 0 or -1.
        triangle_index: [i32; triangle_count],
    }
}
