//! Loops through picked points: the vertices next to them, and shortest paths along edges.

use crate::boundaries::diagonal;
use crate::error::{Error, Result};
use crate::hierarchy::Hierarchy;
use crate::loops::Loops;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

type Point = [f64; 3];

/// Of the diagonal of the box: points further from the surface are of another one.
const NEAR: f64 = 0.1;

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Of a point from a triangle.
fn distance(point: Point, corners: [Point; 3]) -> f64 {
    let sides = [0, 1, 2].map(|k| minus(corners[(k + 1) % 3], corners[k]));
    let away = corners.map(|corner| minus(point, corner));
    let normal = cross(sides[0], sides[1]);
    let size = dot(normal, normal);
    if size > 0.0 && (0..3).all(|k| dot(cross(sides[k], away[k]), normal) > 0.0) {
        return dot(away[0], normal).abs() / size.sqrt();
    }
    let to_side = |k: usize| {
        let along = (dot(away[k], sides[k]) / dot(sides[k], sides[k]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let off = minus(away[k], sides[k].map(|x| along * x));
        dot(off, off).sqrt()
    };
    (0..3).map(to_side).fold(f64::INFINITY, f64::min)
}

/// Vertices joined by edges, with their lengths.
struct Graph {
    neighbors: Vec<Vec<(u32, f64)>>,
}

impl Graph {
    /// Dijkstra's: the vertices of a shortest path without its end.
    fn path(&self, start: u32, goal: u32) -> Vec<u32> {
        // Backwards, so that the path comes out in its order.  Lengths are not negative: their bits have their order.
        let mut away = vec![f64::INFINITY; self.neighbors.len()];
        let mut previous = vec![goal; self.neighbors.len()];
        let mut heap = BinaryHeap::from([Reverse((0, goal))]);
        away[goal as usize] = 0.0;
        while let Some(Reverse((bits, vertex))) = heap.pop() {
            let length = f64::from_bits(bits);
            if vertex == start {
                break;
            }
            if length > away[vertex as usize] {
                continue; // a shorter path was found since
            }
            for &(next, edge) in &self.neighbors[vertex as usize] {
                if length + edge < away[next as usize] {
                    away[next as usize] = length + edge;
                    previous[next as usize] = vertex;
                    heap.push(Reverse(((length + edge).to_bits(), next)));
                }
            }
        }
        let mut path = Vec::new();
        let mut vertex = start;
        while vertex != goal {
            path.push(vertex);
            vertex = previous[vertex as usize];
        }
        path
    }
}

impl Hierarchy {
    /// The vertices of your mesh that lie next to points, such as picked ones.
    ///
    /// * `within`: points further from the surface are refused, in the unit of the positions; `None`: a tenth of
    ///   the diagonal of its box
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_OPTIONS`](crate::Status::ERROR_OPTIONS) for a point that is further away or not finite.
    pub fn vertices_near(&self, points: &[[f64; 3]], within: Option<f64>) -> Result<Vec<u32>> {
        let (positions, triangles) = (self.positions(0)?, self.triangle_vertices(0)?);
        let limit = within.unwrap_or_else(|| NEAR * diagonal(&positions));
        let next_to = |(number, &point): (usize, &Point)| {
            let corners = triangles.iter().map(|vertices| vertices.map(|vertex| positions[vertex as usize]));
            let height = corners.map(|corners| distance(point, corners)).fold(f64::INFINITY, f64::min);
            if !(height <= limit && point.iter().all(|x| x.is_finite())) {
                let message = format!(
                    "Point {number}, {point:?}, is {height:.3e} from the surface, more than within, {limit:.3e}. \
                     Check its unit and axes, or give a larger distance within."
                );
                return Err(Error::option(message));
            }
            let square = |vertex: &u32| {
                dot(minus(positions[*vertex as usize], point), minus(positions[*vertex as usize], point))
            };
            let nearest = (0..positions.len() as u32).min_by(|a, b| square(a).total_cmp(&square(b)));
            Ok(nearest.expect("a mesh has vertices"))
        };
        points.iter().enumerate().map(next_to).collect()
    }

    /// Loops through vertices of your mesh: for each loop at least three, in order and on all sides of what it goes
    /// around. It is the shortest path along edges to each next one, and back. All weights are 1.
    ///
    /// ```
    /// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
    /// # fn main() -> foliations::Result<()> {
    /// # let (positions, triangles) = plate(1, 1, 2, 1);
    /// # let hierarchy = foliations::Hierarchy::build(&positions, &triangles)?;
    /// # let ring = hierarchy.loops_through(&[&[0, 1, 2]])?;
    /// # assert_eq!(ring.len(), 1);
    /// # let points = [positions[0], positions[1], positions[2]];
    /// let picked = hierarchy.vertices_near(&points, None)?;
    /// let loops = hierarchy.loops_through(&[&picked])?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// [`Status::ERROR_OPTIONS`](crate::Status::ERROR_OPTIONS) for fewer than three vertices, and for one that does
    /// not exist.
    pub fn loops_through(&self, picked: &[&[u32]]) -> Result<Loops> {
        let positions = self.positions(0)?;
        let mut neighbors = vec![Vec::new(); positions.len()];
        for [a, b] in self.edge_vertices(0)? {
            let side = minus(positions[a as usize], positions[b as usize]);
            let length = dot(side, side).sqrt();
            neighbors[a as usize].push((b, length));
            neighbors[b as usize].push((a, length));
        }
        let graph = Graph { neighbors };
        let mut loops = Loops::vertices(0);
        for (number, stops) in picked.iter().enumerate() {
            if stops.len() < 3 {
                let message = format!("Loop {number} has {} picked vertices. Pick at least three.", stops.len());
                return Err(Error::option(message));
            }
            if let Some(vertex) = stops.iter().find(|&&vertex| vertex as usize >= positions.len()) {
                let message = format!("Vertex {vertex} does not exist. The mesh has {}, from 0.", positions.len());
                return Err(Error::option(message));
            }
            let following = stops.iter().cycle().skip(1);
            let path: Vec<u32> = stops.iter().zip(following).flat_map(|(&a, &b)| graph.path(a, b)).collect();
            loops.push(&path, 1.0);
        }
        Ok(loops)
    }
}
