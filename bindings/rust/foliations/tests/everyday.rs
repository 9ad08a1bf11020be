//! What a user meets first: loops by kind, picked points, holes, vertices without a triangle, zeros of options.

use foliations::{DesignOptions, Element, Error, Foliation, Hierarchy, Loops, LoopsKind, QuadOptions, Status};

include!("support/mesh.rs");

#[test]
fn holes_are_said() {
    let (positions, triangles) = plate(2, 1, 2, 1);
    let whole = Hierarchy::builder().closed(true).build(&positions, &triangles).unwrap();
    assert!(whole.boundaries().is_empty() && whole.warnings().is_empty());
    assert_eq!(whole.solver().solve().unwrap().report.boundaries, 0);

    let open = Hierarchy::build(&positions, &triangles[1..]).unwrap();
    let mut curve = open.boundaries();
    assert_eq!(curve.len(), 1);
    curve[0].sort_unstable();
    let mut corners = triangles[0].to_vec();
    corners.sort_unstable();
    assert_eq!(curve[0], corners);
    let [warning] = open.warnings() else { panic!("{:?}", open.warnings()) };
    assert!(warning.starts_with("1 boundary looks like a hole by accident, the smallest with 3 edges;"), "{warning}");
    assert!(format!("{open:?}").contains("boundary_count: 1"));

    let mut fractions = Vec::new();
    let solution = foliations::with_progress(|fraction| fractions.push(fraction), || open.solver().solve()).unwrap();
    assert!(fractions.windows(2).all(|pair| pair[0] <= pair[1]), "{fractions:?}");
    let zeros: i64 = solution.foliation.singularities().unwrap().list().iter().map(|one| i64::from(one.index)).sum();
    let report = &solution.report;
    assert_eq!((report.boundaries, report.zeros as i64, report.index_sum), (1, -zeros, zeros));

    let error = Hierarchy::builder().closed(true).build(&positions, &triangles[1..]).unwrap_err();
    assert_eq!((error.status(), error.element()), (Status::ERROR_MESH_BOUNDARY, Some(Element::Vertex)));
    assert!(error.message().contains("1 boundary, the first with 3 edges"), "{error}");
}

#[test]
fn vertices_without_a_triangle_are_dropped() {
    let positions = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 3.], [0., 0., -3.]];
    let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let alone = Hierarchy::build(&positions, &triangles).unwrap();
    assert_eq!(alone.kept_vertices(), None);
    assert!(alone.marked_vertices().len() >= 4);

    let more = [&[[9., 9., 9.]], &positions[..]].concat();
    let moved = triangles.map(|corners| corners.map(|vertex| vertex + 1));
    let hierarchy = Hierarchy::build(&more, &moved).unwrap();
    assert_eq!(hierarchy.kept_vertices(), Some(&[1, 2, 3, 4, 5, 6][..]));
    assert_eq!(hierarchy.positions(0).unwrap(), positions);
    assert!(hierarchy.warnings()[0].starts_with("dropped 1 vertex without a triangle"));
    let values = |hierarchy: &Hierarchy| hierarchy.solver().solve().unwrap().foliation.values().to_vec();
    assert_eq!(values(&hierarchy), values(&alone));

    let marked = Hierarchy::builder().marked_vertices(&[1, 2, 3, 4]).build(&more, &moved).unwrap();
    assert_eq!(marked.marked_vertices(), [0, 1, 2, 3]);
    let error = Hierarchy::builder().marked_vertices(&[0, 1, 2, 3]).build(&more, &moved).unwrap_err();
    assert!(error.message().contains("Marked vertex 0 belongs to no triangle"), "{error}");
}

#[test]
fn zeros_are_refused() {
    let (positions, triangles) = plate(1, 1, 2, 1);
    let builder = Hierarchy::builder;
    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    let foliation = hierarchy.solver().solve().unwrap().foliation;
    let quads = |edge_length, count| foliation.quads_with(&QuadOptions { edge_length, count, ..Default::default() });
    let design = DesignOptions { solve_limit: Some(0), ..Default::default() };
    let errors: Vec<(&str, Option<Error>)> = vec![
        ("ratio: 2 is not in [0.05, 0.95]", builder().ratio(2.0).build(&positions, &triangles).err()),
        ("coarsest: 0", builder().coarsest(0).build(&positions, &triangles).err()),
        ("memory_limit: 0", builder().memory_limit(0).build(&positions, &triangles).err()),
        ("solve_limit: 0", builder().even_design(&positions, &triangles, design).err()),
        ("tolerance: 0 is not in (0, 1)", hierarchy.solver().tolerance(0.0).solve().err()),
        ("energy_tolerance: 0", hierarchy.solver().energy_tolerance(0.0).relax(&foliation).err()),
        ("iteration_limit: 0", hierarchy.solver().iteration_limit(0).solve().err()),
        ("step_limit: 0", hierarchy.solver().step_limit(0).solve().err()),
        ("edge_length: 0", quads(Some(0.0), None).err()),
        ("count: 0", quads(None, Some(0)).err()),
        ("margin: 0", foliation.atlas(Some(0.0)).err()),
        ("spacing: 0", foliation.tracer().spacing(0.0).trace().err()),
        ("length_limit: 0", foliation.tracer().critical().length_limit(0.0).trace().err()),
        ("tolerance: 0", foliation.parameterizer().tolerance(0.0).parameterize().err()),
    ];
    for (words, error) in errors {
        let error = error.unwrap_or_else(|| panic!("{words}"));
        assert_eq!((error.status(), error.element()), (Status::ERROR_OPTIONS, Some(Element::Option)));
        assert!(error.message().starts_with(words), "{error}");
    }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6 * b.abs()
}

fn energy(hierarchy: &Hierarchy, loops: &Loops) -> f64 {
    hierarchy.solver().loops(loops).solve().unwrap().report.energy
}

/// Cylinders that name each loop once.
fn name_their_loops(foliation: &Foliation, loops: &Loops) -> bool {
    let mut named: Vec<_> = foliation.cylinders(None).unwrap().list.iter().map(|one| one.loop_index).collect();
    named.sort_unstable();
    named == (0..loops.len() as u32).map(Some).collect::<Vec<_>>()
}

#[test]
fn loops_by_kind_and_the_loops_of_a_foliation() {
    let (positions, triangles) = plate(2, 1, 6, 5);
    let hierarchy = Hierarchy::builder().coarsest(100).build(&positions, &triangles).unwrap();
    assert!(hierarchy.level_count() > 1);
    for kind in [LoopsKind::Cut, LoopsKind::Handle, LoopsKind::Tunnel, LoopsKind::Pants] {
        let solution = hierarchy.solver().library_loops(kind).solve().unwrap();
        let (foliation, loops) = (&solution.foliation, solution.foliation.loops().unwrap().unwrap());
        assert_eq!(loops, hierarchy.loops(0, kind).unwrap());
        assert!(close(energy(&hierarchy, &loops), solution.report.energy));
        assert!(name_their_loops(foliation, &loops), "{kind:?}");
        let relaxed = hierarchy.solver().relax(&foliation.interpolate(1).unwrap()).unwrap().foliation;
        assert_eq!(relaxed.loops().unwrap().as_ref(), Some(&loops));
        let started = hierarchy.solver().start(foliation).solve().unwrap().foliation;
        assert_eq!(started.loops().unwrap().as_ref(), Some(&loops));
        assert_eq!(hierarchy.foliation(0, foliation.values()).unwrap().loops().unwrap(), None);
    }
    let default = hierarchy.solver().solve().unwrap().foliation;
    assert_eq!(default.loops().unwrap(), Some(hierarchy.loops(0, LoopsKind::Cut).unwrap()));

    let even = hierarchy.solver().even_loops().solve().unwrap();
    let options = DesignOptions { no_poles: true, ..Default::default() };
    let design = Hierarchy::builder().even_design(&positions, &triangles, options).unwrap();
    assert_eq!(even.foliation.loops().unwrap().as_ref(), Some(&design.loops));
    assert!(close(even.report.energy, energy(&hierarchy, &design.loops)));
    assert!(name_their_loops(&even.foliation, &design.loops));

    let own = hierarchy.loops(0, LoopsKind::Pants).unwrap().with_weights(&[1.0, 2.0, 3.0]).unwrap();
    let foliation = hierarchy.solver().loops(&own).solve().unwrap().foliation;
    assert_eq!(foliation.loops().unwrap().as_ref(), Some(&own));
    assert_eq!(hierarchy.initialize(&own).unwrap().loops().unwrap().as_ref(), Some(&own));
}

#[test]
fn spheres_and_disks_solve_by_default() {
    let positions = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 3.], [0., 0., -3.]];
    let triangles = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for mesh in [&triangles[..], &triangles[..7]] {
        let hierarchy = Hierarchy::build(&positions, mesh).unwrap();
        assert_eq!(hierarchy.marked_vertices(), Hierarchy::builder().suggest_marks(&positions, mesh).unwrap());
        for kind in [LoopsKind::Cut, LoopsKind::Pants] {
            let solution = hierarchy.solver().library_loops(kind).solve().unwrap();
            assert!(solution.report.converged && solution.report.energy > 0.0);
        }
        assert!(hierarchy.solver().even_loops().solve().unwrap().report.converged);
        let bare = Hierarchy::builder().marked_vertices(&[]).build(&positions, mesh).unwrap_err();
        assert_eq!(bare.status(), Status::ERROR_MESH_GENUS);
    }
}

#[test]
fn loops_through_picked_points() {
    let (positions, triangles) = plate(2, 1, 4, 3);
    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    let edges = hierarchy.edge_vertices(0).unwrap();
    let length = |a: u32, b: u32| {
        let (a, b) = (positions[a as usize], positions[b as usize]);
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    let sum = |path: &[u32]| -> f64 { (0..path.len()).map(|i| length(path[i], path[(i + 1) % path.len()])).sum() };
    let lengths: Vec<f64> = edges.iter().map(|&[a, b]| length(a, b)).collect();
    // Of all vertices from one; Bellman and Ford.
    let distances = |start: u32| {
        let mut away = vec![f64::INFINITY; positions.len()];
        away[start as usize] = 0.0;
        let mut changed = true;
        while changed {
            changed = false;
            for (&[a, b], &side) in edges.iter().zip(&lengths) {
                for (from, to) in [(a as usize, b as usize), (b as usize, a as usize)] {
                    if away[from] + side < away[to] {
                        (away[to], changed) = (away[from] + side, true);
                    }
                }
            }
        }
        away
    };
    for one in hierarchy.loops(0, LoopsKind::Handle).unwrap().iter() {
        // Points above the loop, a little away from one corner of every third triangle.
        let corners: Vec<u32> = one.iter().step_by(3).map(|&t| triangles[t as usize][0]).collect();
        let points: Vec<[f64; 3]> = corners.iter().map(|&v| positions[v as usize].map(|x| x + 1e-3)).collect();
        let picked = hierarchy.vertices_near(&points, Some(0.01)).unwrap();
        assert_eq!(picked, corners);
        let loops = hierarchy.loops_through(&[&picked]).unwrap();
        let path = loops.get(0).unwrap();
        let shortest: f64 =
            (0..picked.len()).map(|i| distances(picked[i])[picked[(i + 1) % picked.len()] as usize]).sum();
        assert!((sum(path) - shortest).abs() < 1e-9 && picked.iter().all(|stop| path.contains(stop)));
        let given = Loops::triangles(0).with(one, 1.0);
        assert!(close(energy(&hierarchy, &loops), energy(&hierarchy, &given)));
    }
    let far = [[100.0; 3]];
    let refused = |error: Error, words: &str| {
        assert_eq!((error.status(), error.element()), (Status::ERROR_OPTIONS, Some(Element::Option)));
        assert!(error.message().contains(words), "{error}");
    };
    refused(hierarchy.vertices_near(&far, None).unwrap_err(), "Point 0, [100.0, 100.0, 100.0], is ");
    assert!(hierarchy.vertices_near(&far, Some(1000.0)).is_ok());
    let above = [positions[0].map(|x| x - 1e-3)];
    refused(hierarchy.vertices_near(&above, Some(1e-6)).unwrap_err(), "more than within, 1.000e-6");
    refused(hierarchy.vertices_near(&[[f64::NAN; 3]], None).unwrap_err(), "from the surface");
    refused(hierarchy.loops_through(&[&[0, 1]]).unwrap_err(), "at least three");
    refused(hierarchy.loops_through(&[&[0, 1, u32::MAX]]).unwrap_err(), "does not exist");
}
