//! What a mesh has that nobody may have meant: holes, and vertices without a triangle.

use std::collections::HashMap;

const FEW_EDGES: usize = 4; // a boundary of so many is rarely meant
const SHORT_BOUNDARY: f64 = 0.01; // of the diagonal of the box

/// The vertices of each boundary curve, in their order along it.
pub(crate) fn curves(triangles: &[[u32; 3]], triangle_edges: &[[u32; 3]], edge_count: usize) -> Vec<Vec<u32>> {
    let mut uses = vec![0u8; edge_count];
    for &edge in triangle_edges.iter().flatten() {
        uses[edge as usize] += 1;
    }
    // The surface lies on the left of its sides, and on the right of its boundary.
    let mut following = HashMap::new();
    let mut starts = Vec::new();
    for (corners, edges) in triangles.iter().zip(triangle_edges) {
        for side in 0..3 {
            if uses[edges[side] as usize] == 1 {
                following.insert(corners[(side + 1) % 3], corners[side]);
                starts.push(corners[(side + 1) % 3]);
            }
        }
    }
    let mut curves = Vec::new();
    for start in starts {
        let (mut curve, mut vertex) = (Vec::new(), start);
        while let Some(next) = following.remove(&vertex) {
            curve.push(vertex);
            vertex = next;
        }
        if !curve.is_empty() {
            curves.push(curve);
        }
    }
    curves
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Of the box around points.
pub(crate) fn diagonal(positions: &[[f64; 3]]) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in positions {
        for k in 0..3 {
            low[k] = low[k].min(point[k]);
            high[k] = high[k].max(point[k]);
        }
    }
    distance(low, high)
}

/// A sentence about curves that look like holes by accident.
pub(crate) fn hole_warning(curves: &[Vec<u32>], positions: &[[f64; 3]]) -> Option<String> {
    let short = SHORT_BOUNDARY * diagonal(positions);
    let at = |vertex: u32| positions[vertex as usize];
    let length = |curve: &[u32]| -> f64 {
        (0..curve.len()).map(|i| distance(at(curve[i]), at(curve[(i + 1) % curve.len()]))).sum()
    };
    let is_hole = |curve: &&Vec<u32>| curve.len() <= FEW_EDGES || length(curve) < short;
    let holes: Vec<usize> = curves.iter().filter(is_hole).map(Vec::len).collect();
    let looks = match holes.len() {
        1 => "1 boundary looks like a hole".to_string(),
        count => format!("{count} boundaries look like holes"),
    };
    holes.iter().min().map(|edges| {
        format!(
            "{looks} by accident, the smallest with {edges} edges; a hole changes the answer: \
             close it in the mesh, or refuse such meshes with Builder::closed."
        )
    })
}

/// A mesh without the vertices that no triangle has.
pub(crate) struct Used {
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// The numbers that the vertices had.
    pub kept: Vec<u32>,
    numbers: Vec<u32>, // of all vertices; NONE: dropped
}

impl Used {
    /// All triangles name vertices that exist.
    pub(crate) fn of(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Used {
        let mut numbers = vec![crate::NONE; positions.len()];
        for &vertex in triangles.iter().flatten() {
            numbers[vertex as usize] = 0;
        }
        let mut kept = Vec::new();
        for (vertex, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number == 0) {
            *number = kept.len() as u32;
            kept.push(vertex as u32);
        }
        Used {
            positions: kept.iter().map(|&vertex| positions[vertex as usize]).collect(),
            triangles: triangles.iter().map(|corners| corners.map(|vertex| numbers[vertex as usize])).collect(),
            kept,
            numbers,
        }
    }

    /// The number of a vertex among those that are kept.
    pub(crate) fn number(&self, vertex: u32) -> Option<u32> {
        self.numbers.get(vertex as usize).copied().filter(|&number| number != crate::NONE)
    }

    pub(crate) fn note(&self) -> String {
        let dropped = self.numbers.len() - self.kept.len();
        let vertices = if dropped == 1 { "vertex" } else { "vertices" };
        format!(
            "dropped {dropped} {vertices} without a triangle; the others are numbered without them, \
             Hierarchy::kept_vertices has their numbers in the mesh that was given."
        )
    }
}
