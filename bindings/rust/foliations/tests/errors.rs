//! Every way to fail is a native error that says what to do.

use foliations::{DesignOptions, Element, Error, Hierarchy, Loops, LoopsKind, Progress, Status};
use std::cell::Cell;
use std::ops::ControlFlow;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::time::Duration;

include!("support/mesh.rs");

#[track_caller]
fn expect<T>(result: foliations::Result<T>, status: Status, element: Option<Element>) -> Error {
    let error = result.err().expect("the call should fail");
    assert_eq!((error.status(), error.element()), (status, element), "{error}");
    assert!(error.message().ends_with('.') && error.message().contains(' '), "{error}");
    assert_eq!(error.to_string(), error.message());
    error
}

#[test]
fn wrong_lengths() {
    let (positions, triangles) = plate(1, 1, 2, 1);
    let (flat, corners) = (positions.concat(), triangles.concat());
    let error = expect(Hierarchy::builder().build_flat(&flat[1..], &corners), Status::ERROR_COUNT, None);
    assert!(error.message().contains("positions"));
    let error = expect(Hierarchy::builder().build_flat(&flat, &corners[..7]), Status::ERROR_COUNT, None);
    assert!(error.message().contains("triangles has 7"));

    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    let edges = hierarchy.level(0).unwrap().edge_count;
    let error = expect(hierarchy.foliation(0, vec![0.0; edges - 1]), Status::ERROR_COUNT, None);
    assert!(error.message().contains(&edges.to_string()));
    let loops = hierarchy.loops(0, LoopsKind::Cut).unwrap();
    expect(loops.with_weights(&[1.0, 2.0]), Status::ERROR_COUNT, None);
}

#[test]
fn bad_meshes() {
    let (positions, triangles) = plate(1, 1, 2, 1);
    let n = positions.len() as u32;

    expect(Hierarchy::build(&[], &[]), Status::ERROR_MESH_COUNTS, None);
    let hole = Hierarchy::build(&positions, &triangles[1..]).unwrap();
    assert_eq!((hole.genus(), hole.boundary_count()), (1, 1));
    expect(hole.loops(0, LoopsKind::Handle), Status::ERROR_MESH_BOUNDARY, None);
    let loops = hole.loops(0, LoopsKind::Cut).unwrap();
    assert_eq!(loops.arcs(), [0, 0]);
    let mut arcs = loops.clone();
    arcs.push_arc(&[0], 1.0);
    assert_eq!(arcs.arcs(), [0, 0, 1]);
    assert!(hole.solver().loops(&loops).solve().is_ok());

    let twice: Vec<_> = positions.iter().chain(&positions).copied().collect();
    let two: Vec<_> = triangles.iter().copied().chain(triangles.iter().map(|t| t.map(|v| v + n))).collect();
    expect(Hierarchy::build(&twice, &two), Status::ERROR_MESH_COMPONENTS, Some(Element::Triangle));

    let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    let bare = Hierarchy::builder().marked_vertices(&[]).build(&corners, &tetrahedron);
    expect(bare, Status::ERROR_MESH_GENUS, None);

    let mut outside = triangles.clone();
    outside[7][1] = n;
    let error = expect(Hierarchy::build(&positions, &outside), Status::ERROR_MESH_INDEX, Some(Element::Triangle));
    assert_eq!(error.index(), 7);

    let mut infinite = positions.clone();
    infinite[3][0] = f64::NAN;
    let error = expect(Hierarchy::build(&infinite, &triangles), Status::ERROR_MESH_NOT_FINITE, Some(Element::Vertex));
    assert_eq!(error.index(), 3);
}

#[test]
fn bad_options() {
    let (positions, triangles) = plate(1, 1, 2, 1);
    let build = Hierarchy::builder().ratio(2.0).build(&positions, &triangles);
    expect(build, Status::ERROR_OPTIONS, Some(Element::Option));
    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    expect(hierarchy.solver().tolerance(f64::NAN).solve(), Status::ERROR_OPTIONS, Some(Element::Option));
    expect(hierarchy.solver().stop_level(99).solve(), Status::ERROR_LEVEL, Some(Element::Level));
    expect(hierarchy.level(99), Status::ERROR_LEVEL, Some(Element::Level));
    expect(hierarchy.weights(99), Status::ERROR_LEVEL, Some(Element::Level));

    let other = Hierarchy::build(&positions, &triangles).unwrap();
    let foliation = other.solver().solve().unwrap().foliation;
    expect(hierarchy.solver().relax(&foliation), Status::ERROR_OPTIONS, None);
}

#[test]
fn bad_loops() {
    let (positions, triangles) = plate(1, 1, 2, 1);
    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    let fails = |loops: Loops, status| {
        let error = expect(hierarchy.initialize(&loops), status, Some(Element::Loop));
        let same = expect(hierarchy.solver().loops(&loops).solve(), status, Some(Element::Loop));
        assert_eq!(error.index(), same.index());
    };
    fails(Loops::triangles(0), Status::ERROR_LOOP_COUNT);
    fails(Loops::vertices(0).with(&[0, 1, u32::MAX], 1.0), Status::ERROR_LOOP_INDEX);
    fails(Loops::vertices(0).with(&triangles[0], 1.0), Status::ERROR_LOOP_TRIVIAL);
    let cut = hierarchy.loops(0, LoopsKind::Cut).unwrap();
    fails(cut.clone().with_weights(&[-1.0]).unwrap(), Status::ERROR_LOOP_WEIGHT);
    let elements = cut.get(0).unwrap();
    assert_eq!(cut.get(1), None);
    assert_eq!(cut.get(usize::MAX), None);
    fails(cut.clone().with(elements, 1.0), Status::ERROR_LOOP_PARALLEL);
    assert!(expect(
        hierarchy.initialize(&Loops::vertices(7).with(elements, 1.0)),
        Status::ERROR_LEVEL,
        Some(Element::Level)
    )
    .message()
    .contains('7'));
}

/// Values are checked once, when a foliation is made of them.
#[test]
fn bad_values() {
    let (positions, triangles) = plate(1, 1, 2, 1);
    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    let mut values = vec![0.0; hierarchy.level(0).unwrap().edge_count];
    values[5] = 1.0;
    expect(hierarchy.foliation(0, &values), Status::ERROR_VALUE_NOT_CLOSED, Some(Element::Edge));
    values[5] = f64::NAN;
    let error = expect(hierarchy.foliation(0, &values), Status::ERROR_VALUE_NOT_FINITE, Some(Element::Edge));
    assert_eq!(error.index(), 5);
    expect(hierarchy.foliation(9, &values), Status::ERROR_LEVEL, Some(Element::Level));
}

/// More zeros and poles than 4 genus - 4: the loop around one vertex makes a pole there.
#[test]
fn values_with_poles() {
    let (positions, triangles) = plate(1, 1, 2, 1);
    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    let values: Vec<f64> =
        hierarchy.edge_vertices(0).unwrap().iter().map(|ends| if ends.contains(&0) { 1.0 } else { 0.0 }).collect();
    let foliation = hierarchy.foliation(0, values).unwrap();
    let all = foliation.singularities().unwrap();
    assert_eq!(all.list().iter().map(|at| at.index).sum::<i32>(), 0);
    assert!(all.list().iter().any(|at| at.index > 0 && at.element == 0 && at.position == positions[0]));
    assert!(all.list().len() > 1);
    assert!(foliation.energy().unwrap() > 0.0);
    for error in [
        foliation.residuals().unwrap_err(),
        foliation.interpolate(0).unwrap_err(),
        foliation.quads(None).unwrap_err(),
        hierarchy.solver().relax(&foliation).unwrap_err(),
        hierarchy.solver().start(&foliation).solve().unwrap_err(),
    ] {
        assert_eq!(error.status(), Status::ERROR_VALUE_POLE, "{error}");
    }
}

#[test]
fn progress_rises_to_one() {
    let (positions, triangles) = plate(2, 1, 6, 5);
    let mut fractions = Vec::new();
    let hierarchy = Hierarchy::builder().progress(|f| fractions.push(f)).build(&positions, &triangles).unwrap();
    let mut solved = Vec::new();
    hierarchy.solver().progress(|f| solved.push(f)).solve().unwrap();
    for fractions in [&fractions, &solved] {
        assert!(fractions.len() > 5);
        assert!(fractions.windows(2).all(|pair| pair[0] <= pair[1]));
        assert_eq!(fractions.last(), Some(&1.0));
    }
}

#[test]
fn cancelling_and_finishing() {
    let (positions, triangles) = plate(2, 1, 6, 5);
    let cancelled = Hierarchy::builder().progress(|_| Progress::Cancel).build(&positions, &triangles);
    assert_eq!(cancelled.unwrap_err().status(), Status::CANCELLED);
    let broken = Hierarchy::builder().progress(|_| ControlFlow::<()>::Break(())).build(&positions, &triangles);
    assert_eq!(broken.unwrap_err().status(), Status::CANCELLED);

    let hierarchy = Hierarchy::builder().coarsest(200).build(&positions, &triangles).unwrap();
    let error = hierarchy.solver().progress(|_| Progress::Cancel).solve().unwrap_err();
    assert_eq!(error.status(), Status::CANCELLED);
    let mut calls = 0;
    let mut finish = |_| {
        calls += 1;
        if calls > 20 {
            Progress::Finish
        } else {
            Progress::Continue
        }
    };
    let solution = hierarchy.solver().progress(&mut finish).solve().unwrap();
    assert_eq!(solution.status(), Status::CANCELLED);
    assert_eq!((solution.report.poles, solution.foliation.level()), (0, 0));
    assert!(solution.foliation.energy().unwrap() >= hierarchy.solver().solve().unwrap().report.energy);
}

/// Each call that can be long reports to `with_progress`, and can be cancelled there.
#[test]
fn every_call_is_watched() {
    let (positions, triangles) = plate(2, 1, 6, 5);
    let hierarchy = Hierarchy::builder().coarsest(200).build(&positions, &triangles).unwrap();
    let loops = hierarchy.loops(0, LoopsKind::Tunnel).unwrap();
    let foliation = hierarchy.solver().loops(&loops).solve().unwrap().foliation;
    let start = hierarchy.initialize(&loops).unwrap();
    type Call<'c> = (&'static str, Box<dyn Fn() -> foliations::Result<()> + 'c>);
    let calls: [Call<'_>; 17] = [
        ("build", Box::new(|| Hierarchy::build(&positions, &triangles).map(drop))),
        (
            "even_design",
            Box::new(|| Hierarchy::builder().even_design(&positions, &triangles, DesignOptions::default()).map(drop)),
        ),
        ("suggest_marks", Box::new(|| Hierarchy::builder().suggest_marks(&positions, &triangles).map(drop))),
        ("loops", Box::new(|| hierarchy.loops(0, LoopsKind::Tunnel).map(drop))),
        ("initialize", Box::new(|| hierarchy.initialize(&loops).map(drop))),
        ("foliation", Box::new(|| hierarchy.foliation(0, foliation.values()).map(drop))),
        ("solve", Box::new(|| hierarchy.solver().solve().map(drop))),
        ("relax", Box::new(|| hierarchy.solver().relax(&start).map(drop))),
        ("interpolate", Box::new(|| foliation.interpolate(1).map(drop))),
        ("energy", Box::new(|| foliation.energy().map(drop))),
        ("residuals", Box::new(|| foliation.residuals().map(drop))),
        ("singularities", Box::new(|| foliation.singularities().map(drop))),
        ("parameterize", Box::new(|| foliation.parameterizer().parameterize().map(drop))),
        ("trace", Box::new(|| foliation.tracer().spacing(0.1).trace().map(drop))),
        ("cylinders", Box::new(|| foliation.cylinders(Some(&loops)).map(drop))),
        ("quads", Box::new(|| foliation.quads(None).map(drop))),
        ("atlas", Box::new(|| foliation.atlas(None).map(drop))),
    ];
    for (name, call) in &calls {
        let mut fractions = Vec::new();
        foliations::with_progress(|fraction| fractions.push(fraction), call).unwrap();
        assert!(fractions.windows(2).all(|pair| pair[0] <= pair[1]), "{name}: {fractions:?}");
        assert!(fractions.iter().all(|f| (0.0..=1.0).contains(f)), "{name}: {fractions:?}");
        assert_eq!(fractions.last(), Some(&1.0), "{name}: {fractions:?}");
        // The energy of a small mesh is there before the first report.
        if *name == "energy" && fractions.len() == 1 {
            continue;
        }
        let cancelled = foliations::with_progress(|_| Progress::Cancel, call).expect_err(name);
        assert_eq!(cancelled.status(), Status::CANCELLED, "{name}");
        let panics = |_: f64| -> Progress { std::panic::panic_any(*name) };
        let caught = catch_unwind(AssertUnwindSafe(|| foliations::with_progress(panics, call)));
        assert_eq!(caught.unwrap_err().downcast_ref(), Some(name));
        call().expect("nobody watches any more");
    }
    // The innermost closure watches; the closure of a builder is one.
    let (outer, inner) = (Cell::new(0), Cell::new(0));
    let count = |counter: &Cell<i32>| counter.set(counter.get() + 1);
    foliations::with_progress(|_| count(&outer), || hierarchy.solver().progress(|_| count(&inner)).solve().map(drop))
        .unwrap();
    assert!(outer.get() == 0 && inner.get() > 0);
}

/// A closure may use the hierarchy, which is immutable.
#[test]
fn calls_inside_a_closure() {
    let (positions, triangles) = plate(2, 1, 6, 5);
    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    let expected = hierarchy.solver().solve().unwrap().foliation;
    let inner = Cell::new(0);
    let outer = hierarchy
        .solver()
        .progress(|_| {
            if inner.get() < 3 {
                inner.set(inner.get() + 1);
                assert_eq!(hierarchy.solver().solve().unwrap().foliation.values(), expected.values());
            }
        })
        .solve()
        .unwrap();
    assert_eq!(inner.get(), 3);
    assert_eq!(outer.foliation.values(), expected.values());
}

/// A panic in the closure cancels the call, goes on behind it, and leaves all usable.
#[test]
fn panics_cross_the_boundary_safely() {
    let (positions, triangles) = plate(2, 1, 6, 5);
    let calls = Cell::new(0);
    let panics = |_: f64| {
        calls.set(calls.get() + 1);
        if calls.get() == 3 {
            std::panic::panic_any("the third call");
        }
    };
    let caught = catch_unwind(AssertUnwindSafe(|| Hierarchy::builder().progress(panics).build(&positions, &triangles)));
    assert_eq!(caught.unwrap_err().downcast_ref(), Some(&"the third call"));
    assert_eq!(calls.get(), 3);

    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    calls.set(0);
    let mut solver = hierarchy.solver().progress(panics);
    let caught = catch_unwind(AssertUnwindSafe(|| solver.solve().map(|_| ())));
    assert_eq!(caught.unwrap_err().downcast_ref(), Some(&"the third call"));
    // The same solver works once the closure does.
    let solution = solver.time_limit(Duration::from_secs(600)).solve().unwrap();
    assert_eq!(solution.status(), Status::OK);
}

/// Every function and constant of the C headers is used, so that nothing is out of reach.
#[test]
fn nothing_of_the_headers_is_missing() {
    let crates = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let Ok(bindings) = std::fs::read_to_string(format!("{crates}/foliations-sys/src/bindings.rs")) else {
        println!("skipped: the bindings are only in the repository");
        return;
    };
    let mut own = String::new();
    let sources = |folder| std::fs::read_dir(format!("{crates}/foliations/src/{folder}")).unwrap();
    for file in
        sources("").chain(sources("applications")).map(|file| file.unwrap().path()).filter(|path| path.is_file())
    {
        own += &std::fs::read_to_string(file).unwrap();
    }
    let words: std::collections::HashSet<_> = own.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    // Defaults: structures of zeros have them.
    let not_needed =
        |name: &str| name.ends_with("_DEFAULT") || name.ends_with("_init") || name.starts_with("HMF_VERSION_");
    let mut count = 0;
    for line in bindings.lines().map(str::trim_start) {
        let Some(rest) = line.strip_prefix("pub const ").or(line.strip_prefix("pub fn ")) else { continue };
        let name = rest.split([':', '(']).next().unwrap();
        assert!(not_needed(name) || words.contains(name), "{name} is not used by this crate");
        count += 1;
    }
    assert!(count > 90, "{count}");
    assert_eq!(format!("{:?} {}", Status::ERROR_MESH_GENUS, Status::ERROR_MESH_GENUS.code()), "ERROR_MESH_GENUS 311");
    assert_eq!(Status::ERROR_MESH_GENUS.to_string(), "the mesh has genus 0");
    for limit in [Status::LIMIT_TIME, Status::CANCELLED, Status::LIMIT_CLASS] {
        assert!(limit.is_stopped());
    }
    assert!(!Status::OK.is_stopped() && !Status::ERROR_NULL.is_stopped());
}
