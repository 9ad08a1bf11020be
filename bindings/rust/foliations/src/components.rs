//! Meshes of several components: each is built and solved on its own.

use crate::error::{Element, Error, Result, Status};
use crate::hierarchy::{Builder, Hierarchy};
use crate::loops::{LoopElements, Loops};
use crate::owned::{arrays, slice, Owned};
use crate::records::Read;
use crate::solve::Solution;
use foliations_sys as sys;
use std::fmt;

/// A mesh divided into its connected components; see [`Builder::components`].
///
/// ```
/// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
/// # fn main() -> foliations::Result<()> {
/// # let (positions, triangles) = plate(2, 1, 2, 1);
/// let components = foliations::Hierarchy::builder().components(&positions, &triangles)?;
/// let whole = components.solve(|_, hierarchy| hierarchy.solver().solve())?;
/// assert_eq!(whole.values.len(), components.edge_count());
/// for row in &whole.components {
///     println!("{:?}: {}", row.status, row.message);
/// }
/// # Ok(())
/// # }
/// ```
pub struct Components {
    block: Owned<sys::hmf_component_set>,
}

/// One component of a mesh, with numbers of its own.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Component<'s> {
    /// [`Status::OK`], [`Status::ERROR_MESH_GENUS`] if it carries no foliation, or its defect.
    pub status: Status,
    /// What the defect is about, by its number in the whole mesh.
    pub defect: Option<(Element, u64)>,
    /// 0 where the status is a defect.
    pub genus: usize,
    /// Number of closed curves that its boundary consists of; 0 where the status is a defect.
    pub boundary_count: usize,
    /// For [`Builder::build`], like the next two.
    pub positions: &'s [[f64; 3]],
    /// Three vertices each.
    pub triangles: &'s [[u32; 3]],
    /// Those marked vertices that lie on it.
    pub marked_vertices: &'s [u32],
    /// Number in the whole mesh of each vertex.
    pub whole_vertices: &'s [u32],
    /// Number in the whole mesh of each edge of level 0.
    pub whole_edges: &'s [u32],
    /// Number in the whole mesh of each triangle.
    pub whole_triangles: &'s [u32],
}

arrays!(Components {
    /// Component of each vertex of the whole mesh; [`NONE`](crate::NONE): it has no triangle.
    vertex_component: [u32; vertex_count],
    /// Its number there.
    vertex_part: [u32; vertex_count],
    /// Component of each triangle.
    triangle_component: [u32; triangle_count],
    /// Its number there.
    triangle_part: [u32; triangle_count],
});

impl Builder<'_> {
    /// Divides a mesh into its connected components, each with numbers of its own.
    ///
    /// A defect of a component is its status, not an error of this call. Vertices
    /// without a triangle are in none. Of the options,
    /// [`marked_vertices`](Builder::marked_vertices) (of the whole mesh), `mollify` and
    /// `memory_limit` count.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`], classes 100 and 200, [`Status::ERROR_MESH_COUNTS`] and
    /// [`Status::ERROR_MESH_INDEX`].
    pub fn components(&mut self, positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Components> {
        Ok(Components { block: self.call(positions, triangles, sys::hmf_components)? })
    }
}

impl Components {
    /// Number of components.
    pub fn len(&self) -> usize {
        self.block.count as usize
    }

    /// Whether there is none; never, for a mesh without triangles is an error.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of edges of the whole mesh.
    pub fn edge_count(&self) -> usize {
        self.block.edge_count as usize
    }

    /// One component.
    pub fn get(&self, index: usize) -> Option<Component<'_>> {
        let set: &sys::hmf_component_set = &self.block;
        // SAFETY: the header gives each array so many elements of these layouts.
        let (list, positions, triangles, marks, vertices, edges, faces) = unsafe {
            (
                slice(set.list, set.count),
                slice(set.part_positions.cast::<[f64; 3]>(), set.used_vertex_count),
                slice(set.part_triangles.cast::<[u32; 3]>(), set.triangle_count),
                slice(set.part_marks, set.marked_count),
                slice(set.whole_vertices, set.used_vertex_count),
                slice(set.whole_edges, set.edge_count),
                slice(set.whole_triangles, set.triangle_count),
            )
        };
        let c = list.get(index)?;
        let range = |first: u64, count: u64| first as usize..(first + count) as usize;
        let own_vertices = range(c.first_vertex, c.vertex_count);
        let own_triangles = range(c.first_triangle, c.triangle_count);
        Some(Component {
            status: Status::from_code(c.status),
            defect: (c.element != sys::HMF_ELEMENT_NONE).then(|| (c.element.read(), c.index)),
            genus: c.genus as usize,
            boundary_count: c.boundary_count as usize,
            positions: &positions[own_vertices.clone()],
            triangles: &triangles[own_triangles.clone()],
            marked_vertices: &marks[range(c.first_mark, c.marked_count)],
            whole_vertices: &vertices[own_vertices],
            whole_edges: &edges[range(c.first_edge, c.edge_count)],
            whole_triangles: &faces[own_triangles],
        })
    }

    /// All of them, in the order of their first triangles.
    pub fn iter(&self) -> impl Iterator<Item = Component<'_>> {
        (0..self.len()).filter_map(|k| self.get(k))
    }

    /// Loops of the whole mesh, on its level 0: for each component those on it, in its numbers.
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_LOOP_INDEX`] where an element does not exist,
    /// [`Status::ERROR_LOOP_NOT_CLOSED`] where a loop lies on several components.
    pub fn split(&self, whole: &Loops) -> Result<Vec<Loops>> {
        let (component, number) = match whole.element_kind() {
            LoopElements::Triangles => (self.triangle_component(), self.triangle_part()),
            LoopElements::Vertices => (self.vertex_component(), self.vertex_part()),
        };
        let mut parts = vec![Loops::empty(0, whole.element_kind()); self.len()];
        for (c, elements) in whole.iter().enumerate() {
            let mut own = Vec::with_capacity(elements.len());
            let mut on = None;
            for &element in elements {
                let k = component.get(element as usize).copied().unwrap_or(crate::NONE);
                if k == crate::NONE {
                    let message = format!("Loop {c} names element {element}, which no component has.");
                    return Err(Error::new(Status::ERROR_LOOP_INDEX, message));
                }
                if *on.get_or_insert(k) != k {
                    let message = format!("Loop {c} lies on several components. Give a loop on one of them.");
                    return Err(Error::new(Status::ERROR_LOOP_NOT_CLOSED, message));
                }
                own.push(number[element as usize]);
            }
            if let Some(k) = on {
                parts[k as usize].push_as(&own, whole.weights()[c], whole.arcs()[c], whole.arc_sides()[c]);
            }
        }
        Ok(parts)
    }

    /// One foliation over all components: builds each with its marked vertices, and `solve` solves
    /// component k on its hierarchy, up to level 0.
    ///
    /// What is wrong with a component, or with its loops, is said in its row.
    ///
    /// # Errors
    ///
    /// Other errors of `solve` and of the builds: [`Status::CANCELLED`], classes 100 (but
    /// [`Status::ERROR_UNSUPPORTED`]) and 200.
    pub fn solve(&self, mut solve: impl FnMut(usize, Hierarchy) -> Result<Solution>) -> Result<ComponentSolutions> {
        let mut values = vec![0.0; self.edge_count()];
        let mut rows = Vec::with_capacity(self.len());
        for (k, part) in self.iter().enumerate() {
            let made = if part.status == Status::OK {
                Hierarchy::builder()
                    .marked_vertices(part.marked_vertices)
                    .build(part.positions, part.triangles)
                    .and_then(|hierarchy| solve(k, hierarchy))
            } else {
                Err(Error::new(part.status, part.status.to_string()))
            };
            rows.push(match made {
                Ok(solution) => {
                    for (&edge, &value) in part.whole_edges.iter().zip(solution.foliation.values()) {
                        values[edge as usize] = value;
                    }
                    let message = solution.stopped.as_ref().map_or(String::new(), |error| error.message().into());
                    ComponentSolution { status: solution.status(), message, solution: Some(solution) }
                }
                Err(error) if error.status().code() >= 300 || error.status() == Status::ERROR_UNSUPPORTED => {
                    ComponentSolution { status: error.status(), message: error.message().into(), solution: None }
                }
                Err(error) => return Err(error),
            });
        }
        Ok(ComponentSolutions { values, components: rows })
    }
}

impl fmt::Debug for Components {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Components").field("len", &self.len()).field("edge_count", &self.edge_count()).finish()
    }
}

/// One foliation over all components; see [`Components::solve`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ComponentSolutions {
    /// One for each edge of the whole mesh; 0 where a component has no foliation.
    pub values: Vec<f64>,
    /// One for each component.
    pub components: Vec<ComponentSolution>,
}

/// What became of one component.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ComponentSolution {
    /// That of the solution; without one, why there is none.
    pub status: Status,
    /// Likewise; empty if it was solved.
    pub message: String,
    /// Of this component alone.
    pub solution: Option<Solution>,
}
