//! Building a hierarchy, and what its levels are.

use crate::boundaries::{curves, hole_warning, Used};
use crate::error::{Error, Result, Status};
use crate::loops::Loops;
use crate::memory;
use crate::owned::{make, slice, Made, Owned};
use crate::progress::{Closure, Progress};
use crate::ranges::Refusal;
use crate::records::{codes, options, record, Read};
use foliations_sys as sys;
use std::fmt;
use std::sync::Arc;

codes! {
    /// Which edges are collapsed, and where the vertices go.
    #[derive(Default)]
    Collapse: i32 {
        /// The shortest edge, to its midpoint.
        #[default]
        Midpoint = sys::HMF_COLLAPSE_MIDPOINT,
        /// The shortest edge, to one of its ends.
        Endpoint = sys::HMF_COLLAPSE_ENDPOINT,
        /// The edge of least quadric error, to its best point.
        Qslim = sys::HMF_COLLAPSE_QSLIM,
    }
}

/// Options for building a [`Hierarchy`]; see [`Hierarchy::builder`].
///
/// What is not set has its default.
#[derive(Debug)]
#[must_use = "a builder does nothing until `build` is called"]
pub struct Builder<'a> {
    options: sys::hmf_hierarchy_options,
    marked_vertices: Option<&'a [u32]>,
    closed: bool,
    refusal: Refusal,
    progress: Option<Closure<'a>>,
}

impl Default for Builder<'_> {
    fn default() -> Self {
        let options = options!(hmf_hierarchy_options allocate: Some(memory::allocate), release: Some(memory::release));
        Builder { options, marked_vertices: None, closed: false, refusal: Refusal::default(), progress: None }
    }
}

impl<'a> Builder<'a> {
    /// How edges are collapsed. Default: [`Collapse::Midpoint`].
    pub fn collapse(mut self, collapse: Collapse) -> Self {
        self.options.collapse = collapse as i32;
        self
    }

    /// Edges of a level divided by the edges of the next finer one, in
    /// [0.05, 0.95]. Default: 0.5.
    pub fn ratio(mut self, ratio: f64) -> Self {
        self.refusal.check("ratio", ratio, "[0.05, 0.95]");
        self.options.ratio = ratio;
        self
    }

    /// Vertices of the coarsest level to aim for. Default: a sixteenth of all,
    /// and 1000 at most. At least 40 for each unit of the genus and 10 for each marked vertex.
    pub fn coarsest(mut self, vertices: usize) -> Self {
        self.refusal.check("coarsest", vertices as f64, "[1, inf)");
        self.options.coarsest = vertices as u64;
        self
    }

    /// Most bytes in use at any time, by this call and by each later call on the
    /// hierarchy. Default: no limit.
    pub fn memory_limit(mut self, bytes: u64) -> Self {
        self.refusal.check("memory_limit", bytes as f64, "[1, inf)");
        self.options.memory_limit = bytes;
        self
    }

    /// Accepts triangles without area and edges without length: in [0, 0.1], try 1e-5.
    /// Default: 0, off.
    ///
    /// The edges of level 0 get longer by the least amount, the same for all, with which
    /// every triangle inequality holds by a margin of `mollify` times the mean length.
    /// Only the weights of level 0 change; meshes that keep the margin anyway stay as they are.
    pub fn mollify(mut self, margin: f64) -> Self {
        self.refusal.check("mollify", margin, "[0, 0.1]");
        self.options.mollify = margin;
        self
    }

    /// Vertices that may carry a pole; a sphere needs four or more. Default: those of
    /// [`suggest_marks`](Builder::suggest_marks) where the mesh needs some; an empty slice: none.
    ///
    /// They never move and are no poles of the report; indices add up to
    /// 4 - 4 genus - marked vertices.
    pub fn marked_vertices(mut self, vertices: &'a [u32]) -> Self {
        self.marked_vertices = Some(vertices);
        self
    }

    /// Refuses a mesh with a boundary, with [`Status::ERROR_MESH_BOUNDARY`]. Default: false.
    pub fn closed(mut self, closed: bool) -> Self {
        self.closed = closed;
        self
    }

    /// A closure that is called on this thread with a fraction rising from 0 to
    /// 1, and that may end the call. If it panics, the call is cancelled and the
    /// panic continues.
    pub fn progress<R: Into<Progress>>(mut self, closure: impl FnMut(f64) -> R + 'a) -> Self {
        self.progress = Closure::new(closure);
        self
    }

    /// Checks a mesh, makes it intrinsically Delaunay and builds the hierarchy.
    ///
    /// * `positions`: one point for each vertex, in any unit
    /// * `triangles`: three vertices each, all counter-clockwise or all clockwise
    ///
    /// The mesh must be connected (else see [`components`](Builder::components)), oriented and manifold; a sphere needs four or more
    /// [marked vertices](Builder::marked_vertices), a disk four on its boundary or two inside.
    /// Both arrays are copied. Time is linear, about 0.3 s per million edges.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`], or a status of the classes 100, 200, 300: each
    /// defect of a mesh has its own, and the error names the element.
    pub fn build(&mut self, positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Hierarchy> {
        let given = self.marked_vertices;
        let (mut parts, mut used) = (self.build_marked(positions, triangles, given), None);
        if matches!(&parts, Err(error) if error.status() == Status::ERROR_MESH_UNUSED_VERTEX) {
            let mesh = Used::of(positions, triangles);
            let number = |&vertex: &u32| {
                let message = || format!("Marked vertex {vertex} belongs to no triangle.");
                mesh.number(vertex).ok_or_else(|| Error::option(message()))
            };
            let marks = given.map(|marks| marks.iter().map(number).collect::<Result<Vec<u32>>>()).transpose()?;
            parts = self.build_marked(&mesh.positions, &mesh.triangles, marks.as_deref());
            used = Some(mesh);
        }
        let (handle, marked_vertices) = parts?;
        let warnings = used.iter().map(Used::note).collect();
        let kept_vertices = used.map(|mesh| mesh.kept);
        let mut hierarchy = Hierarchy { parts: Arc::new(Parts { handle, marked_vertices, kept_vertices, warnings }) };
        if hierarchy.boundary_count() > 0 {
            let curves = hierarchy.boundaries();
            if self.closed {
                return Err(Error::not_closed(&curves));
            }
            let warning = hole_warning(&curves, &hierarchy.positions(0)?);
            Arc::get_mut(&mut hierarchy.parts).expect("not shared yet").warnings.extend(warning);
        }
        Ok(hierarchy)
    }

    /// A hierarchy and its marked vertices; a sphere or disk that is given none gets those of the library.
    fn build_marked(
        &mut self,
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
        given: Option<&[u32]>,
    ) -> Result<(Owned<sys::hmf_hierarchy>, Vec<u32>)> {
        let with = |marks: &[u32], options: sys::hmf_hierarchy_options| sys::hmf_hierarchy_options {
            marked_vertices: marks.as_ptr(),
            marked_count: marks.len() as u64,
            ..options
        };
        let marks = given.unwrap_or(&[]);
        match self.call_with(&with(marks, self.options), positions, triangles, sys::hmf_hierarchy_create) {
            Err(error) if error.status() == Status::ERROR_MESH_GENUS && given.is_none() => {
                let marks = self.suggest_marks(positions, triangles)?;
                if marks.is_empty() {
                    return Err(error);
                }
                let made =
                    self.call_with(&with(&marks, self.options), positions, triangles, sys::hmf_hierarchy_create)?;
                Ok((made, marks))
            }
            made => Ok((made?, marks.to_vec())),
        }
    }

    /// [`build`](Builder::build) for flat arrays: `positions` holds x, y, z of one
    /// vertex after the other, `triangles` three vertices each.
    ///
    /// # Errors
    ///
    /// Also [`Status::ERROR_COUNT`] if a length is not a multiple of 3.
    pub fn build_flat(&mut self, positions: &[f64], triangles: &[u32]) -> Result<Hierarchy> {
        self.build(triples(positions, "positions")?, triples(triangles, "triangles")?)
    }

    /// Marked vertices for a mesh of genus 0, where you name none: two at the tip of
    /// each limb, so that loops go around the limbs, at least four and at most 24.
    /// None for genus 1 and more. Of several components each gets its own.
    ///
    /// Of the options, `mollify` and `memory_limit` count.
    ///
    /// ```
    /// let positions = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 3.], [0., 0., -3.]];
    /// let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    /// let marks = foliations::Hierarchy::builder().suggest_marks(&positions, &triangles)?;
    /// let hierarchy = foliations::Hierarchy::builder().marked_vertices(&marks).build(&positions, &triangles)?;
    /// assert_eq!(hierarchy.genus(), 0);
    /// # Ok::<(), foliations::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`build`](Builder::build).
    pub fn suggest_marks(&mut self, positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Vec<u32>> {
        let set = self.call(positions, triangles, sys::hmf_suggest_marks)?;
        // SAFETY: the library made so many.
        Ok(unsafe { slice(set.marked_vertices, set.marked_count) }.to_vec())
    }

    /// Marked vertices, loops and weights for which stripes and quads are about
    /// equally wide everywhere. The [marked vertices](Builder::marked_vertices) of
    /// this builder are part of the design; `mollify` and `memory_limit` count as well.
    ///
    /// # Errors
    ///
    /// Those of [`build`](Builder::build), and [`Status::ERROR_UNSUPPORTED`] if no
    /// loops were found.
    pub fn even_design(
        &mut self,
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
        options: DesignOptions,
    ) -> Result<Design> {
        if let Some(solves) = options.solve_limit {
            self.refusal.check("solve_limit", solves as f64, "[1, inf)");
        }
        self.refusal.result()?;
        let build = self.raw();
        let all = options!(hmf_design_options
            no_poles: i32::from(options.no_poles), build: &build, solve_limit: options.solve_limit.unwrap_or(0));
        let made: Owned<sys::hmf_design> = Closure::watch(&mut self.progress, || {
            let (points, corners) = (positions.as_ptr().cast(), triangles.as_ptr().cast());
            // SAFETY: the slices hold three numbers for each vertex and each triangle.
            make(|out, control, error| unsafe {
                sys::hmf_even_design(points, positions.len(), corners, triangles.len(), &all, control, out, error)
            })
        })?;
        // SAFETY: the library made so many.
        let (marks, loops) =
            unsafe { (slice(made.marked_vertices, made.marked_count).to_vec(), Loops::copy(&*made.loops)) };
        Ok(Design {
            marked_vertices: marks,
            loops,
            unevenness: made.unevenness,
            unevenness_before: made.unevenness_before,
            solves: made.solves,
        })
    }

    /// Upper bound of the bytes that [`build`](Builder::build) uses at its peak.
    /// `None` if the counts or the options are unusable.
    pub fn memory_estimate(&self, vertex_count: usize, triangle_count: usize) -> Option<u64> {
        // SAFETY: the options live through the call.
        let bytes = unsafe { sys::hmf_hierarchy_memory_estimate(vertex_count, triangle_count, &self.raw()) };
        (bytes > 0).then_some(bytes)
    }

    /// For calls during which `self` is borrowed.
    fn raw(&self) -> sys::hmf_hierarchy_options {
        let marks = self.marked_vertices.unwrap_or(&[]);
        sys::hmf_hierarchy_options { marked_vertices: marks.as_ptr(), marked_count: marks.len() as u64, ..self.options }
    }

    /// What `hmf_hierarchy_create`, `hmf_suggest_marks` or `hmf_components` makes of a mesh.
    pub(crate) fn call<T: Made>(
        &mut self,
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
        make_it: OfMesh<T>,
    ) -> Result<Owned<T>> {
        let options = self.raw();
        self.call_with(&options, positions, triangles, make_it)
    }

    fn call_with<T: Made>(
        &mut self,
        options: &sys::hmf_hierarchy_options,
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
        make_it: OfMesh<T>,
    ) -> Result<Owned<T>> {
        self.refusal.result()?;
        Closure::watch(&mut self.progress, || {
            let (points, corners) = (positions.as_ptr().cast(), triangles.as_ptr().cast());
            // SAFETY: the slices hold three numbers for each vertex and each triangle.
            make(|out, control, error| unsafe {
                make_it(points, positions.len(), corners, triangles.len(), options, control, out, error)
            })
        })
    }
}

/// For [`Builder::even_design`].
#[derive(Clone, Copy, Debug, Default)]
pub struct DesignOptions {
    /// No marked vertices but those of the builder, where that can be.
    pub no_poles: bool,
    /// Budget of the search in solves of a coarse mesh; `None`: about ten solves of the whole mesh.
    pub solve_limit: Option<u64>,
}

/// What [`Builder::even_design`] finds.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// For [`Builder::marked_vertices`].
    pub marked_vertices: Vec<u32>,
    /// With weights, to solve for on a hierarchy with these marked vertices.
    pub loops: Loops,
    /// On the coarse mesh of the search.
    pub unevenness: f64,
    /// There, of default loops with weights 1.
    pub unevenness_before: f64,
    /// Of the search.
    pub solves: u64,
}

/// `hmf_hierarchy_create` and its like.
pub(crate) type OfMesh<T> = unsafe extern "C" fn(
    *const f64,
    usize,
    *const u32,
    usize,
    *const sys::hmf_hierarchy_options,
    *const sys::hmf_control,
    *mut *mut T,
    *mut sys::hmf_error,
) -> sys::hmf_status;

/// A flat slice as triples.
fn triples<'s, T>(flat: &'s [T], what: &str) -> Result<&'s [[T; 3]]> {
    if flat.len() % 3 != 0 {
        let message = format!("{what} has {} numbers. Give three for each element.", flat.len());
        return Err(Error::new(Status::ERROR_COUNT, message));
    }
    // SAFETY: an array has the layout of its elements, and the length fits.
    Ok(unsafe { std::slice::from_raw_parts(flat.as_ptr().cast(), flat.len() / 3) })
}

record! {
    /// Counts of one level.
    #[derive(Copy, Eq, Hash)]
    LevelInfo from hmf_level_info {
        /// Vertices.
        vertex_count: usize,
        /// Edges.
        edge_count: usize,
        /// Triangles.
        triangle_count: usize,
        /// Edges whose weight was below the floor and was raised to it; 0 on level 0, the
        /// intrinsic Delaunay triangulation.
        raised_count: usize,
    }
}

/// An immutable hierarchy of triangle meshes.
///
/// Level 0 is your mesh, higher levels are coarser. Edges of level 0 are numbered
/// by their first appearance in the triangles (sides 0-1, 1-2, 2-0 of triangle 0,
/// then of triangle 1, and so on); vertices and triangles keep your numbers.
///
/// A clone is another reference to the same hierarchy. Any number of threads may
/// use it. It keeps about 140 bytes for each edge of your mesh.
#[derive(Clone)]
pub struct Hierarchy {
    parts: Arc<Parts>,
}

struct Parts {
    handle: Owned<sys::hmf_hierarchy>,
    marked_vertices: Vec<u32>,
    kept_vertices: Option<Vec<u32>>,
    warnings: Vec<String>,
}

impl Hierarchy {
    /// Builds a hierarchy with the default options: see [`Builder::build`].
    ///
    /// # Errors
    ///
    /// Those of [`Builder::build`].
    pub fn build(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Hierarchy> {
        Builder::default().build(positions, triangles)
    }

    /// Builds a hierarchy with options.
    ///
    /// ```
    /// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
    /// # fn main() -> foliations::Result<()> {
    /// # let (positions, triangles) = plate(2, 1, 2, 1);
    /// let hierarchy = foliations::Hierarchy::builder()
    ///     .coarsest(500)
    ///     .progress(|fraction| println!("{:3.0} %", 100.0 * fraction))
    ///     .build(&positions, &triangles)?;
    /// # assert_eq!(hierarchy.genus(), 2);
    /// # Ok(())
    /// # }
    /// ```
    pub fn builder<'a>() -> Builder<'a> {
        Builder::default()
    }

    pub(crate) fn as_ptr(&self) -> *const sys::hmf_hierarchy {
        self.parts.handle.as_ptr()
    }

    fn info(&self) -> &sys::hmf_hierarchy_info {
        // SAFETY: the handle is valid, and what it says of itself lives as long.
        unsafe { &*sys::hmf_hierarchy_describe(self.as_ptr()) }
    }

    /// Bytes held by the hierarchy.
    pub fn memory(&self) -> u64 {
        self.info().memory_bytes
    }

    /// Number of levels, at least 1.
    pub fn level_count(&self) -> usize {
        self.info().level_count as usize
    }

    /// The coarsest level, `level_count() - 1`.
    pub fn coarsest_level(&self) -> usize {
        self.level_count() - 1
    }

    /// Genus of the surface; 0 only with marked vertices.
    pub fn genus(&self) -> usize {
        self.info().genus as usize
    }

    /// Number of closed curves that the boundary consists of.
    pub fn boundary_count(&self) -> usize {
        self.info().boundary_count as usize
    }

    /// The vertices of each boundary curve, in their order along it.
    pub fn boundaries(&self) -> Vec<Vec<u32>> {
        match (self.triangle_vertices(0), self.triangle_edges(0), self.level(0)) {
            (Ok(triangles), Ok(edges), Ok(level)) => curves(&triangles, &edges, level.edge_count),
            _ => Vec::new(), // there is always a level 0
        }
    }

    /// The marked vertices that were given or suggested.
    pub fn marked_vertices(&self) -> &[u32] {
        &self.parts.marked_vertices
    }

    /// Vertices without a triangle are dropped, and the others numbered without them: the numbers
    /// that these had. `None`: none was dropped.
    pub fn kept_vertices(&self) -> Option<&[u32]> {
        self.parts.kept_vertices.as_deref()
    }

    /// A sentence for each thing about the mesh that looks wrong: small holes, vertices without a triangle.
    pub fn warnings(&self) -> &[String] {
        &self.parts.warnings
    }

    /// Counts of one level.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`].
    pub fn level(&self, level: usize) -> Result<LevelInfo> {
        let info = self.info();
        // SAFETY: the header gives so many rows.
        let levels = unsafe { slice(info.levels, info.level_count) };
        match levels.get(level) {
            Some(found) => Ok(Read::read(found)),
            None => self.mesh(level).map(|_| unreachable!("the library has no such level either")),
        }
    }

    fn mesh(&self, level: usize) -> Result<Owned<sys::hmf_level_mesh>> {
        // SAFETY: the handle is valid.
        make(|out, control, error| unsafe { sys::hmf_level(self.as_ptr(), level, control, out, error) })
    }

    /// The two vertices of each edge. On coarse levels two vertices may have
    /// several edges.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`].
    pub fn edge_vertices(&self, level: usize) -> Result<Vec<[u32; 2]>> {
        let mesh = self.mesh(level)?;
        // SAFETY: the array has so many entries of this layout.
        Ok(unsafe { slice(mesh.edge_vertices.cast::<[u32; 2]>(), mesh.edge_count) }.to_vec())
    }

    /// The three edges of each triangle; side s joins its corners s and s + 1.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`].
    pub fn triangle_edges(&self, level: usize) -> Result<Vec<[u32; 3]>> {
        let mesh = self.mesh(level)?;
        // SAFETY: the array has so many entries of this layout.
        Ok(unsafe { slice(mesh.triangle_edges.cast::<[u32; 3]>(), mesh.triangle_count) }.to_vec())
    }

    /// The three vertices of each triangle, corners in the order of the sides of
    /// [`triangle_edges`](Hierarchy::triangle_edges).
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`].
    pub fn triangle_vertices(&self, level: usize) -> Result<Vec<[u32; 3]>> {
        let mesh = self.mesh(level)?;
        // SAFETY: the array has so many entries of this layout.
        Ok(unsafe { slice(mesh.triangle_vertices.cast::<[u32; 3]>(), mesh.triangle_count) }.to_vec())
    }

    /// The weight of each edge, half the sum of the two opposite cotangents,
    /// without unit. On level 0 it is that of your triangulation and may be
    /// negative (the solver uses the intrinsic Delaunay triangulation instead).
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`].
    pub fn weights(&self, level: usize) -> Result<Vec<f64>> {
        let mesh = self.mesh(level)?;
        // SAFETY: the array has so many entries of this layout.
        Ok(unsafe { slice(mesh.weights.cast::<f64>(), mesh.edge_count) }.to_vec())
    }

    /// The position of each vertex, in the unit of the input.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LEVEL`].
    pub fn positions(&self, level: usize) -> Result<Vec<[f64; 3]>> {
        let mesh = self.mesh(level)?;
        // SAFETY: the array has so many entries of this layout.
        Ok(unsafe { slice(mesh.positions.cast::<[f64; 3]>(), mesh.vertex_count) }.to_vec())
    }
}

impl fmt::Debug for Hierarchy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Hierarchy")
            .field("genus", &self.genus())
            .field("boundary_count", &self.boundary_count())
            .field("level_count", &self.level_count())
            .finish()
    }
}
