//! What a user meets first: holes, vertices without a triangle, zeros of options.

use foliations::{DesignOptions, Element, Error, Hierarchy, QuadOptions, Status};

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
