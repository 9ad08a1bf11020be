//! Values on the edges of a level, and what they are like.

use crate::cylinders::{cylinders, Cylinder};
use crate::error::{call, Result, Status};
use crate::hierarchy::Hierarchy;
use crate::loops::Loops;
use crate::parameterize::Parameterizer;
use crate::quads::{quads, QuadMesh};
use crate::trace::Tracer;
use hmf_sys as sys;
use std::ptr;

/// A measured foliation: one value for each edge of a level.
///
/// The value of an edge is the distance of its ends in a metric tree, in the unit
/// of the weights of the loops. Values of the library are exact multiples of a
/// power of two, and every triangle inequality holds exactly.
///
/// It keeps its hierarchy alive.
#[derive(Clone, Debug)]
pub struct Foliation {
    hierarchy: Hierarchy,
    level: usize,
    values: Vec<f64>, // as many as the level has edges
}

impl Foliation {
    pub(crate) fn new(hierarchy: Hierarchy, level: usize, values: Vec<f64>) -> Foliation {
        Foliation { hierarchy, level, values }
    }

    /// The hierarchy.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The level whose edges have the values.
    pub fn level(&self) -> usize {
        self.level
    }

    /// One value for each edge of the level.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The values, without the rest.
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// The same foliation on another level: exact, in the same class, closed and
    /// without poles. To a finer level the recorded flips and collapses are
    /// undone; to a coarser one, a collapse moves one vertex to the image of the other.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`]; class 500 if the values are not closed or have a
    /// pole; class 200.
    pub fn to_level(&self, level: usize) -> Result<Foliation> {
        let mut values = vec![0.0; self.hierarchy.level(level)?.edge_count];
        // SAFETY: both arrays are given with their lengths.
        call(|error| unsafe {
            sys::hmf_interpolate(
                self.hierarchy.as_ptr(),
                self.level,
                self.values.as_ptr(),
                self.values.len(),
                level,
                values.as_mut_ptr(),
                values.len(),
                error,
            )
        })?;
        Ok(Foliation::new(self.hierarchy.clone(), level, values))
    }

    /// Dirichlet energy: the sum over all edges of weight * value^2, in the
    /// squared unit of the values. On level 0 it is that of the intrinsic Delaunay
    /// triangulation, to which the values are carried exactly.
    ///
    /// # Errors
    ///
    /// Class 500 if the values are not closed or have a pole; class 200.
    pub fn energy(&self) -> Result<f64> {
        let mut energy = 0.0;
        // SAFETY: the values are given with their number.
        call(|error| unsafe {
            sys::hmf_energy(
                self.hierarchy.as_ptr(),
                self.level,
                self.values.as_ptr(),
                self.values.len(),
                &mut energy,
                error,
            )
        })?;
        Ok(energy)
    }

    /// One number for each vertex: how much it violates the balance of the
    /// harmonic foliation, relative to the mean. 0 everywhere means that this is
    /// the unique minimum of the energy.
    ///
    /// # Errors
    ///
    /// Class 500 if the values are not closed or have a pole; class 200.
    pub fn residuals(&self) -> Result<Vec<f64>> {
        let mut residuals = vec![0.0; self.hierarchy.level(self.level)?.vertex_count];
        // SAFETY: both arrays are given with their lengths.
        call(|error| unsafe {
            sys::hmf_residuals(
                self.hierarchy.as_ptr(),
                self.level,
                self.values.as_ptr(),
                self.values.len(),
                residuals.as_mut_ptr(),
                residuals.len(),
                error,
            )
        })?;
        Ok(residuals)
    }

    /// Zeros and poles, and the index of each vertex and triangle. The indices add
    /// up to 4 - 4 genus.
    ///
    /// # Errors
    ///
    /// Class 500 if the values are not closed; class 200.
    pub fn singularities(&self) -> Result<Singularities> {
        let info = self.hierarchy.level(self.level)?;
        let mut all = Singularities {
            vertex_index: vec![0; info.vertex_count],
            triangle_index: vec![0; info.triangle_count],
            vertex_cluster: vec![0; info.vertex_count],
            list: Vec::new(),
        };
        all.list = self.list(Some(&mut all))?;
        Ok(all)
    }

    /// Zeros and poles alone, as in [`singularities`](Foliation::singularities).
    /// A foliation that the library made has no poles.
    ///
    /// # Errors
    ///
    /// Class 500 if the values are not closed; class 200.
    pub fn zeros_and_poles(&self) -> Result<Vec<Singularity>> {
        self.list(None)
    }

    /// Options for a conformal parameterisation of this foliation, all at their defaults.
    ///
    /// ```
    /// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
    /// # fn main() -> hmf::Result<()> {
    /// # let (positions, triangles) = plate(2, 1, 3, 2);
    /// # let hierarchy = hmf::Hierarchy::build(&positions, &triangles)?;
    /// let foliation = hierarchy.solver().solve()?.foliation;
    /// let map = foliation.parameterizer().parameterize()?;
    /// assert_eq!(map.corner_uv.len(), triangles.len());
    /// println!("mean dilatation {:.2}, {} seam edges", map.dilatation_mean, map.seam_edge_count);
    /// # Ok(())
    /// # }
    /// ```
    pub fn parameterizer(&self) -> Parameterizer<'_> {
        Parameterizer::new(self)
    }

    /// Which leaves of this foliation to follow.
    ///
    /// ```
    /// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
    /// # fn main() -> hmf::Result<()> {
    /// # let (positions, triangles) = plate(2, 1, 3, 2);
    /// # let hierarchy = hmf::Hierarchy::build(&positions, &triangles)?;
    /// let foliation = hierarchy.solver().solve()?.foliation;
    /// let leaves = foliation.tracer().critical().spacing(0.2).trace()?;
    /// for line in &leaves.lines {
    ///     let points: &[[f64; 3]] = &leaves.points[line.points.clone()];
    ///     println!("{:?} of {} points, length {:.3}", line.kind, points.len(), line.length);
    /// }
    /// # assert!(leaves.lines.len() > 6);
    /// # Ok(())
    /// # }
    /// ```
    pub fn tracer(&self) -> Tracer<'_> {
        Tracer::new(self)
    }

    /// The cylinders of a harmonic foliation: the critical leaves cut the surface into
    /// one for each loop, filled with closed leaves of its class.
    ///
    /// `loops` are those that the values belong to, on any level; with `None`,
    /// [`Cylinder::loop_index`] is `None`. Heights are exact. Circumference, modulus and
    /// area are those of the minimum, where energy = sum of height * circumference = sum
    /// of areas. Matching takes about as long as two solves on the coarsest level.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_VALUE_CLASS`] if the values do not belong to the loops,
    /// [`Status::ERROR_VALUE_NOT_HARMONIC`] if their energy is 1 % above the minimum,
    /// others of class 500, and classes 100, 200, 400.
    pub fn cylinders(&self, loops: Option<&Loops>) -> Result<Vec<Cylinder>> {
        cylinders(self, loops)
    }

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
    /// [`Status::ERROR_UNSUPPORTED`] if a zero goes round a part of the surface that no
    /// leaf crosses, or if there is no match for edges so long; classes 100, 200, 500.
    pub fn quads(&self, edge_length: Option<f64>) -> Result<QuadMesh> {
        quads(self, edge_length.unwrap_or(0.0))
    }

    fn list(&self, mut arrays: Option<&mut Singularities>) -> Result<Vec<Singularity>> {
        // Without a pole there are at most 4 genus - 4 zeros, so that one call is enough.
        let mut list = vec![EMPTY; 4 * self.hierarchy.genus() - 4];
        let count = match self.raw_singularities(&mut list, arrays.as_deref_mut()) {
            Err(error) if error.status() == Status::ERROR_CAPACITY => {
                list.resize(self.raw_singularities_count()?, EMPTY);
                self.raw_singularities(&mut list, arrays)?
            }
            count => count?,
        };
        list.truncate(count);
        Ok(list.iter().map(Singularity::from_raw).collect())
    }

    /// Fills the list and the arrays; gives the length of the list.
    fn raw_singularities(
        &self,
        list: &mut [sys::hmf_singularity],
        arrays: Option<&mut Singularities>,
    ) -> Result<usize> {
        let mut count = 0;
        let mut vertex = (ptr::null_mut(), 0);
        let mut triangle = (ptr::null_mut(), 0);
        let mut cluster = (ptr::null_mut(), 0);
        if let Some(arrays) = arrays {
            vertex = (arrays.vertex_index.as_mut_ptr(), arrays.vertex_index.len());
            triangle = (arrays.triangle_index.as_mut_ptr(), arrays.triangle_index.len());
            cluster = (arrays.vertex_cluster.as_mut_ptr(), arrays.vertex_cluster.len());
        }
        // SAFETY: each array is given with its length, or is NULL.
        call(|error| unsafe {
            sys::hmf_singularities(
                self.hierarchy.as_ptr(),
                self.level,
                self.values.as_ptr(),
                self.values.len(),
                vertex.0,
                vertex.1,
                triangle.0,
                triangle.1,
                cluster.0,
                cluster.1,
                list.as_mut_ptr(),
                list.len(),
                &mut count,
                error,
            )
        })?;
        Ok(count)
    }

    /// The length of the list.
    fn raw_singularities_count(&self) -> Result<usize> {
        let mut count = 0;
        let none = ptr::null_mut::<i32>();
        // SAFETY: the values are given with their number, all optional arrays are NULL.
        call(|error| unsafe {
            sys::hmf_singularities(
                self.hierarchy.as_ptr(),
                self.level,
                self.values.as_ptr(),
                self.values.len(),
                none,
                0,
                none,
                0,
                ptr::null_mut(),
                0,
                ptr::null_mut(),
                0,
                &mut count,
                error,
            )
        })?;
        Ok(count)
    }
}

const EMPTY: sys::hmf_singularity = sys::hmf_singularity { kind: 0, index: 0, element: 0, size: 0 };

/// Where a zero or a pole is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SingularityKind {
    /// At a vertex.
    Vertex,
    /// In a triangle.
    Triangle,
    /// At several vertices that edges of value 0 join.
    Cluster,
}

/// A zero or a pole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Singularity {
    /// Where it is.
    pub kind: SingularityKind,
    /// Negative: a zero of order `-index`; positive: a pole.
    pub index: i32,
    /// The vertex, the triangle, or the lowest vertex of the cluster.
    pub element: u32,
    /// Vertices of the cluster, else 1.
    pub size: u32,
}

impl Singularity {
    fn from_raw(raw: &sys::hmf_singularity) -> Singularity {
        Singularity {
            kind: match raw.kind {
                sys::HMF_SINGULAR_TRIANGLE => SingularityKind::Triangle,
                sys::HMF_SINGULAR_CLUSTER => SingularityKind::Cluster,
                _ => SingularityKind::Vertex,
            },
            index: raw.index,
            element: raw.element,
            size: raw.size,
        }
    }
}

/// The indices of all vertices and triangles of a level; they add up to 4 - 4 genus.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Singularities {
    /// Index of each vertex. For the vertices of a cluster, that of the cluster at
    /// its lowest vertex and 0 at the others.
    pub vertex_index: Vec<i32>,
    /// Index of each triangle, 0 or -1.
    pub triangle_index: Vec<i32>,
    /// For each vertex the lowest vertex of its cluster.
    pub vertex_cluster: Vec<u32>,
    /// All zeros and poles.
    pub list: Vec<Singularity>,
}
