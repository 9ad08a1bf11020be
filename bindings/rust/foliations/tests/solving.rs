//! The whole way from a mesh to a foliation, and what can be asked of it.

use foliations::{
    ClassState, Collapse, Foliation, Hierarchy, HistoryKind, LineEnd, LineKind, Loops, LoopsKind, Method,
};
use foliations::{SingularityKind, Solution, Status};
use std::collections::HashMap;
use std::time::Duration;

include!("support/mesh.rs");

fn genus_2() -> Hierarchy {
    let (positions, triangles) = plate(2, 1, 6, 5);
    Hierarchy::builder().coarsest(200).build(&positions, &triangles).unwrap()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

#[test]
fn threads_may_share() {
    fn shared<T: Send + Sync>() {}
    shared::<Hierarchy>();
    shared::<Foliation>();
    shared::<Solution>();
    shared::<Loops>();
    shared::<foliations::Error>();

    let hierarchy = genus_2();
    let expected = hierarchy.solver().solve().unwrap().foliation.values().to_vec();
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| assert_eq!(hierarchy.solver().solve().unwrap().foliation.values(), expected));
        }
    });
}

#[test]
fn version_is_that_of_the_crate() {
    let (major, minor, patch) = foliations::version();
    assert_eq!(format!("{major}.{minor}.{patch}"), env!("CARGO_PKG_VERSION"));
}

#[test]
fn levels_are_meshes() {
    let (positions, triangles) = plate(2, 1, 6, 5);
    let hierarchy = Hierarchy::builder().coarsest(200).build(&positions, &triangles).unwrap();
    assert_eq!(hierarchy.genus(), 2);
    assert!(hierarchy.level_count() > 2);
    assert!(hierarchy.memory() > 0);
    assert_eq!(hierarchy.positions(0).unwrap(), positions);
    for level in 0..hierarchy.level_count() {
        let info = hierarchy.level(level).unwrap();
        let edges = hierarchy.edge_vertices(level).unwrap();
        let sides = hierarchy.triangle_edges(level).unwrap();
        let corners = hierarchy.triangle_vertices(level).unwrap();
        assert_eq!(info.vertex_count as i64 - info.edge_count as i64 + info.triangle_count as i64, 2 - 2 * 2);
        assert_eq!(hierarchy.positions(level).unwrap().len(), info.vertex_count);
        assert_eq!(hierarchy.weights(level).unwrap().len(), info.edge_count);
        assert_eq!((edges.len(), sides.len()), (info.edge_count, info.triangle_count));
        for (side, corner) in sides.iter().zip(&corners) {
            for s in 0..3 {
                let mut ends = [corner[s], corner[(s + 1) % 3]];
                let mut edge = edges[side[s] as usize];
                ends.sort_unstable();
                edge.sort_unstable();
                assert_eq!(ends, edge);
            }
        }
    }
    assert_eq!(hierarchy.triangle_vertices(0).unwrap(), triangles);
}

#[test]
fn options_of_the_build_count() {
    let (positions, triangles) = plate(2, 1, 6, 5);
    let levels = |ratio, collapse| {
        let mut builder = Hierarchy::builder().coarsest(100).ratio(ratio).collapse(collapse);
        builder.build(&positions, &triangles).unwrap().level_count()
    };
    assert!(levels(0.8, Collapse::Endpoint) > levels(0.3, Collapse::Qslim));

    let estimate = Hierarchy::builder().memory_estimate(positions.len(), triangles.len()).unwrap();
    Hierarchy::builder().memory_limit(estimate).build(&positions, &triangles).unwrap();
    let error = Hierarchy::builder().memory_limit(estimate / 20).build(&positions, &triangles).unwrap_err();
    assert_eq!(error.status(), Status::ERROR_MEMORY_LIMIT);
    assert_eq!(Hierarchy::builder().memory_estimate(0, 0), None);

    let flat = Hierarchy::builder().build_flat(&positions.concat(), &triangles.concat()).unwrap();
    assert_eq!(flat.positions(0).unwrap(), positions);
}

#[test]
fn newton_finds_the_minimum() {
    let hierarchy = genus_2();
    let solution = hierarchy.solver().solve().unwrap();
    assert_eq!(solution.status(), Status::OK);
    assert!(solution.stopped.is_none());
    let report = &solution.report;
    assert_eq!(report.method, Method::Newton);
    assert!(report.converged && report.residual_max < 1e-8 && report.residual_mean <= report.residual_max);
    assert_eq!((report.poles, report.index_sum), (0, -4));
    assert_eq!(report.class_state, ClassState::Proven);
    assert!(report.class_seconds > 0.0 && report.class_seconds < report.solve_seconds);
    assert!((report.class_repeats as usize) < hierarchy.level_count());
    assert_eq!(report.levels.len(), hierarchy.level_count());
    for (level, of) in report.levels.iter().enumerate() {
        assert_eq!(of.vertex_count as usize, hierarchy.level(level).unwrap().vertex_count);
    }
    assert_eq!(solution.foliation.report().as_ref(), Some(report));
    assert!(report.history.windows(2).all(|pair| pair[0].seconds <= pair[1].seconds));
    assert!(report.history.iter().any(|entry| entry.kind == HistoryKind::LinearSolve && entry.residual_max.is_some()));

    let foliation = &solution.foliation;
    assert!(close(foliation.energy().unwrap(), report.energy));
    let largest = foliation.residuals().unwrap().into_iter().fold(0.0, f64::max);
    assert!(largest < 1e-8);

    let all = foliation.singularities().unwrap();
    assert_eq!(all.vertex_index().iter().sum::<i32>() + all.triangle_index().iter().sum::<i32>(), -4);
    assert_eq!(all.vertex_cluster().len(), all.vertex_index().len());
    assert_eq!(all.list().iter().map(|zero| zero.index).sum::<i32>(), -4);
    let (corners, positions) = (hierarchy.triangle_vertices(0).unwrap(), hierarchy.positions(0).unwrap());
    for zero in all.list() {
        let place = match zero.kind {
            SingularityKind::Vertex => positions[zero.element as usize],
            SingularityKind::Triangle => {
                let [a, b, c] = corners[zero.element as usize].map(|corner| positions[corner as usize]);
                [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)
            }
            _ => continue,
        };
        assert!((0..3).all(|k| (place[k] - zero.position[k]).abs() < 1e-9));
    }
    assert_eq!(all.list().iter().filter(|at| at.index < 0).map(|zero| -zero.index as u64).sum::<u64>(), report.zeros);

    // Triangle inequalities hold exactly.
    for sides in hierarchy.triangle_edges(0).unwrap() {
        let [a, b, c] = sides.map(|edge| foliation.values()[edge as usize]);
        assert!(a <= b + c && b <= c + a && c <= a + b);
    }
}

#[test]
fn whitehead_agrees_with_newton() {
    let hierarchy = genus_2();
    let newton = hierarchy.solver().solve().unwrap().report.energy;
    for method in [Method::Whitehead, Method::SingleLevel] {
        let coarsest = if method == Method::SingleLevel { 0 } else { hierarchy.coarsest_level() };
        let loops = hierarchy.loops(coarsest, LoopsKind::Cut).unwrap();
        let report = hierarchy.solver().method(method).loops(&loops).energy_tolerance(1e-7).solve().unwrap().report;
        assert_eq!(report.method, method);
        assert!(report.levels.iter().any(|level| level.sweep_count > 0));
        // Only the loops of the coarsest level are those of the default.
        if method == Method::Whitehead {
            assert!(report.energy >= newton * (1.0 - 1e-9) && report.energy < 1.05 * newton);
        }
    }
}

#[test]
fn loops_start_a_foliation() {
    let hierarchy = genus_2();
    for level in [0, hierarchy.coarsest_level()] {
        let loops = hierarchy.loops(level, LoopsKind::Cut).unwrap();
        assert_eq!((loops.level(), loops.len(), loops.weights()), (level, 2, &[1.0, 1.0][..]));
        // Each pair of neighboring triangles shares the edge that the loop crosses.
        let sides = hierarchy.triangle_edges(level).unwrap();
        let loops = loops.with_weights(&[1.0, 0.25]).unwrap();
        let mut crossings = HashMap::new();
        for (elements, weight) in loops.iter().zip(loops.weights()) {
            for (at, triangle) in elements.iter().enumerate() {
                let next = elements[(at + 1) % elements.len()];
                let shared: Vec<u32> =
                    sides[*triangle as usize].into_iter().filter(|side| sides[next as usize].contains(side)).collect();
                // On coarse levels two triangles may share several edges.
                assert!(!shared.is_empty());
                if level == 0 {
                    assert_eq!(shared.len(), 1);
                    *crossings.entry(shared[0]).or_insert(0.0) += weight;
                }
            }
        }
        let start = hierarchy.initialize(&loops).unwrap();
        if level == 0 {
            for (edge, value) in start.values().iter().enumerate() {
                assert_eq!(*value, *crossings.get(&(edge as u32)).unwrap_or(&0.0));
            }
        }
        // The same class, optimized: from these values and from the loops.
        let relaxed = hierarchy.solver().relax(&start).unwrap();
        let solved = hierarchy.solver().loops(&loops).stop_level(level).solve().unwrap();
        assert_eq!(relaxed.foliation.level(), level);
        assert_eq!(relaxed.report.class_state, ClassState::Proven);
        assert!(relaxed.report.energy < start.energy().unwrap());
        assert!(close(relaxed.report.energy, solved.report.energy));
    }
}

#[test]
fn energy_is_the_weighted_sum_of_squares() {
    let hierarchy = genus_2();
    let level = 1;
    let foliation = hierarchy.solver().stop_level(level).solve().unwrap().foliation;
    let weights = hierarchy.weights(level).unwrap();
    let sum: f64 = weights.iter().zip(foliation.values()).map(|(weight, value)| weight * value * value).sum();
    assert!(close(sum, foliation.energy().unwrap()));
}

#[test]
fn foliations_go_up_and_down() {
    let hierarchy = genus_2();
    let coarse = hierarchy.solver().stop_level(2).solve().unwrap().foliation;
    let fine = coarse.interpolate(0).unwrap();
    assert_eq!((coarse.level(), fine.level()), (2, 0));
    assert_eq!(fine.singularities().unwrap().list().iter().map(|zero| zero.index).sum::<i32>(), -4);
    let back = fine.interpolate(2).unwrap();
    // The same class: the minimum is the same.
    let again = hierarchy.solver().relax(&back).unwrap();
    assert!(close(again.report.energy, coarse.energy().unwrap()));
    assert!(back.report().is_none());
    // Values that are read again make the same foliation.
    let own = hierarchy.foliation(2, coarse.values()).unwrap();
    assert_eq!(own.energy().unwrap(), coarse.energy().unwrap());
    assert!(own.unit() > 0.0 && own.values().iter().all(|value| (value / own.unit()).fract() == 0.0));
}

#[test]
fn limits_give_a_result_with_their_status() {
    let hierarchy = genus_2();
    let solution = hierarchy.solver().time_limit(std::time::Duration::from_nanos(1)).solve().unwrap();
    assert_eq!(solution.status(), Status::LIMIT_TIME);
    assert!(solution.status().is_stopped() && !solution.report.converged);
    assert!(solution.stopped.unwrap().message().contains("time_limit"));
    assert_eq!(solution.report.poles, 0);
    assert!(solution.foliation.energy().unwrap() > 0.0);

    let mut solver = hierarchy.solver().method(Method::Whitehead).tolerance(1e-12).iteration_limit(1);
    assert_eq!(solver.solve().unwrap().status(), Status::LIMIT_ITERATIONS);
}

#[test]
fn parameterization_integrates_the_foliation() {
    let hierarchy = genus_2();
    let foliation = hierarchy.solver().solve().unwrap().foliation;
    let mut last = 0.0;
    let map = foliation.parameterizer().progress(|fraction| last = fraction).parameterize().unwrap();
    assert_eq!(map.cone().iter().map(|cone| 2 - cone).sum::<i32>(), -4);
    assert_eq!(map.seam().iter().filter(|&&seam| seam == 1).count() as u64, map.seam_edge_count);
    assert!((map.area / foliation.energy().unwrap() - 1.0).abs() < 0.1);
    assert!(map.seam_length > 0.0 && map.dilatation_mean >= 1.0);
    assert_eq!(map.differential().len(), map.dilatation().len());

    // The two images of an edge agree through its transition, exactly.
    let (sides, corners) = (hierarchy.triangle_edges(0).unwrap(), hierarchy.triangle_vertices(0).unwrap());
    let mut first: HashMap<(u32, u32), [f64; 2]> = HashMap::new();
    for (t, (side, corner)) in sides.iter().zip(&corners).enumerate() {
        for (s, edge) in side.iter().enumerate() {
            let [sign, du, dv] = map.transition()[*edge as usize];
            assert!(map.seam()[*edge as usize] == 1 || [sign, du, dv] == [1.0, 0.0, 0.0]);
            for c in [s, (s + 1) % 3] {
                let [u, v] = map.corner_uv()[t][c];
                match first.get(&(*edge, corner[c])) {
                    None => _ = first.insert((*edge, corner[c]), [u, v]),
                    Some([u1, v1]) => assert_eq!([sign * u1 + du, sign * v1 + dv], [u, v]),
                }
            }
        }
    }

    // Where all other edges cost nothing, the seams run elsewhere.
    let others: Vec<u32> = (0..map.seam().len() as u32).filter(|&edge| map.seam()[edge as usize] == 0).collect();
    let again = foliation.parameterizer().seam_edges(&others).parameterize().unwrap();
    let same = again.seam().iter().zip(map.seam()).filter(|(new, old)| **new + **old == 2).count();
    assert!((same as u64) < map.seam_edge_count / 4, "{same} of {} seams stayed", map.seam_edge_count);
    let error = foliation.parameterizer().seam_edges(&[u32::MAX]).parameterize().unwrap_err();
    assert_eq!((error.status(), error.index()), (Status::ERROR_OPTIONS, u64::from(u32::MAX)));

    let start = hierarchy.initialize(&hierarchy.loops(0, LoopsKind::Cut).unwrap()).unwrap();
    assert_eq!(start.parameterizer().parameterize().unwrap_err().status(), Status::ERROR_VALUE_NOT_HARMONIC);
    let cancelled = foliation.parameterizer().progress(|_| foliations::Progress::Cancel).parameterize();
    assert_eq!(cancelled.unwrap_err().status(), Status::CANCELLED);
}

#[test]
fn leaves_are_level_sets() {
    let hierarchy = genus_2();
    let loops = hierarchy.loops(0, LoopsKind::Tunnel).unwrap();
    let foliation = hierarchy.solver().loops(&loops).solve().unwrap().foliation;
    let zeros = foliation.singularities().unwrap().list().len();
    let critical = foliation.tracer().trace().unwrap();
    assert!(!critical.lines().is_empty());
    for line in critical.lines() {
        assert_eq!((line.kind, line.closed, line.cylinder), (LineKind::Critical, false, None));
        for (end, zero) in [(line.begin, line.begin_zero), (line.end, line.end_zero)] {
            assert!(end == LineEnd::Zero && (zero.unwrap() as usize) < zeros);
        }
    }

    let leaves = foliation.tracer().critical().spacing(0.1).point(5, [0.5, 0.25, 0.25]).trace().unwrap();
    let of = |kind| leaves.lines().iter().filter(move |line| line.kind == kind);
    assert_eq!(of(LineKind::Critical).count(), critical.lines().len());
    assert_eq!(of(LineKind::Point).map(|line| line.source).collect::<Vec<_>>(), [0]);
    // Heights in one cylinder are evenly spaced, and lengths are those of the polylines.
    let levels: Vec<_> = of(LineKind::Level).collect();
    assert!(levels.len() >= 10);
    for pair in levels.windows(2).filter(|pair| pair[0].cylinder == pair[1].cylinder) {
        assert_eq!(pair[0].source + 1, pair[1].source);
        assert!((pair[1].height - pair[0].height - 0.1).abs() < 0.05);
    }
    let ends = hierarchy.edge_vertices(0).unwrap();
    let positions = hierarchy.positions(0).unwrap();
    let distance = |p: [f64; 3], q: [f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
    for line in levels {
        assert!(line.closed && line.begin == LineEnd::Closed && line.end == LineEnd::Closed);
        let points = &leaves.points()[line.points.clone()];
        let length: f64 = (0..points.len()).map(|k| distance(points[k], points[(k + 1) % points.len()])).sum();
        assert!(close(length, line.length));
        for (point, edge) in points.iter().zip(&leaves.point_edges()[line.points.clone()]) {
            let [a, b] = ends[*edge as usize].map(|end| positions[end as usize]);
            assert!((distance(*point, a) + distance(*point, b) - distance(a, b)).abs() < 1e-9);
        }
    }

    // Conjugate level sets go across their cylinder, from side to side.
    let across = foliation.tracer().conjugate().spacing(0.1).trace().unwrap();
    assert!(across.lines().len() > 10);
    for line in across.lines() {
        assert_eq!((line.closed, line.begin, line.end), (false, LineEnd::Critical, LineEnd::Critical));
    }

    let limited = foliation.tracer().point(5, [0.5, 0.25, 0.25]).length_limit(1e-3).trace().unwrap();
    assert_eq!((limited.lines()[0].begin, limited.lines()[0].end), (LineEnd::Limit, LineEnd::Limit));
    let bad = foliation.tracer().point(5, [1.0, 0.0, 0.0]).point(u32::MAX, [1.0, 0.0, 0.0]).trace().unwrap_err();
    assert_eq!((bad.status(), bad.index()), (Status::ERROR_OPTIONS, 1));
}

#[test]
fn harmonic_forms_are_a_canonical_basis() {
    let hierarchy = genus_2();
    let forms = hierarchy.harmonic_forms(0).unwrap();
    assert_eq!((forms.form_count(), forms.form(3).len()), (4, hierarchy.level(0).unwrap().edge_count));
    assert!(forms.form(4).is_empty());
    assert_eq!(forms.intersections(), [0, 0, 1, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, -1, 0, 0]);
    // The integral of form i ^ *form j is an inner product; a[0] ^ b[0] is 1.
    for j in 0..4 {
        assert!(close(forms.conjugation()[8 + j], forms.inner_products()[j]));
    }
    assert!(close(forms.period_real()[1], forms.period_real()[2]));
    assert!(forms.period_imaginary()[0] > 0.0 && forms.period_imaginary()[3] > 0.0);
    assert!(forms.residual() < 1e-8 && forms.conjugation_error() < 0.3);
    assert_eq!(hierarchy.harmonic_forms(99).unwrap_err().status(), Status::ERROR_LEVEL);
}

#[test]
fn cylinders_fill_the_surface() {
    let hierarchy = genus_2();
    let loops = hierarchy.loops(0, LoopsKind::Tunnel).unwrap().with_weights(&[1.0, 0.5]).unwrap();
    let solution = hierarchy.solver().loops(&loops).solve().unwrap();
    let foliation = &solution.foliation;
    let cylinders = foliation.cylinders(Some(&loops)).unwrap();
    assert_eq!((cylinders.list.len(), cylinders.leaves.len()), (2, 2));
    for (k, &twist) in cylinders.twists.iter().enumerate() {
        let place = |side: usize| cylinders.corner_places[cylinders.corner_offsets[2 * k + side] as usize];
        assert_eq!((place(0), place(1)), (0.0, twist));
    }
    assert_eq!(cylinders.corner_vertices.len(), cylinders.corner_places.len());
    for (cylinder, leaf) in cylinders.list.iter().zip(cylinders.leaves.iter()) {
        assert_eq!(cylinder.height, loops.weights()[cylinder.loop_index.unwrap() as usize]);
        assert!(close(cylinder.modulus * cylinder.circumference, cylinder.height));
        assert!(close(cylinder.area, cylinder.height * cylinder.circumference));
        // The middle leaf is a loop that the library takes.
        hierarchy.initialize(&Loops::triangles(0).with(leaf, 1.0)).unwrap();
    }
    let heights: Vec<f64> = cylinders.list.iter().map(|cylinder| cylinder.height).collect();
    assert_eq!(cylinders.leaves.weights(), heights);
    let area: f64 = cylinders.list.iter().map(|cylinder| cylinder.area).sum();
    assert!((area / solution.report.energy - 1.0).abs() < 1e-6);
    let leaves = foliation.tracer().spacing(0.3).trace().unwrap();
    assert!(leaves.lines().iter().all(|line| line.height < cylinders.list[line.cylinder.unwrap() as usize].height));

    let by_default = foliation.cylinders(None).unwrap();
    assert!(by_default.list.iter().zip(&cylinders.list).all(|(one, other)| one.loop_index == other.loop_index));
    let others = hierarchy.loops(0, LoopsKind::Handle).unwrap();
    assert_eq!(foliation.cylinders(Some(&others)).unwrap_err().status(), Status::ERROR_VALUE_CLASS);
}

#[test]
fn an_atlas_lies_in_the_square() {
    let hierarchy = genus_2();
    let atlas = hierarchy.solver().solve().unwrap().foliation.atlas(Some(0.01)).unwrap();
    assert_eq!(atlas.corner_uv().len(), atlas.triangle_chart().len());
    assert!(atlas.corner_uv().iter().flatten().flatten().all(|x| (0.0..=1.0).contains(x)));
    assert!(atlas.triangle_chart().iter().all(|&c| u64::from(c) < atlas.chart_count()));
    let area = |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    let used: f64 = atlas.corner_uv().iter().map(|&corners| area(corners) / 2.0).sum();
    assert!((used - atlas.used_area()).abs() < 1e-9);
}

#[test]
fn quads_are_regular_but_at_the_zeros() {
    let hierarchy = genus_2();
    let loops = hierarchy.loops(0, LoopsKind::Tunnel).unwrap();
    let foliation = hierarchy.solver().loops(&loops).solve().unwrap().foliation;
    let zeros = foliation.singularities().unwrap();
    let mesh = foliation.quads(None).unwrap();
    let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
    let mut degree = vec![0; mesh.positions().len()];
    for quad in mesh.quads() {
        for s in 0..4 {
            let (a, b) = (quad[s], quad[(s + 1) % 4]);
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { 3 };
            degree[a as usize] += 1;
        }
    }
    // Closed and oriented: once in either direction. The genus is that of the surface.
    assert!(edges.values().all(|&uses| uses == 4));
    assert_eq!(mesh.positions().len() as i64 - edges.len() as i64 + mesh.quads().len() as i64, 2 - 2 * 2);
    for (vertex, degree) in degree.into_iter().enumerate() {
        assert_eq!(degree, zeros.list().get(vertex).map_or(4, |zero| 4 - 2 * zero.index));
    }
    let finer = foliation.quads(Some(5.0)).unwrap();
    let coarser = foliation.quads(Some(20.0)).unwrap();
    assert!(finer.quads().len() > 4 * coarser.quads().len());
    assert_eq!(foliation.quads(Some(f64::NAN)).unwrap_err().status(), Status::ERROR_OPTIONS);
}

/// The last frame of an animation starts the next one.
#[test]
fn solving_starts_from_values() {
    let (mut positions, triangles) = plate(2, 1, 6, 5);
    let build = |positions: &[_]| Hierarchy::builder().coarsest(200).build(positions, &triangles).unwrap();
    let before = build(&positions);
    let loops = before.loops(0, LoopsKind::Tunnel).unwrap();
    let last = before.solver().loops(&loops).solve().unwrap().foliation;
    for point in &mut positions {
        point[0] *= 1.1;
    }
    let after = build(&positions);
    let started = after.solver().start(&last).solve().unwrap();
    let solved = after.solver().loops(&loops).solve().unwrap();
    assert!(started.report.converged && close(started.report.energy, solved.report.energy));
    assert!(after.solver().start(&last).loops(&loops).solve().is_err());
}

/// A plate without holes is a sphere.
#[test]
fn spheres_have_marked_vertices() {
    let (positions, triangles) = plate(0, 0, 10, 4);
    let mut builder = Hierarchy::builder().coarsest(100);
    let bare = Hierarchy::builder().marked_vertices(&[]).build(&positions, &triangles);
    assert_eq!(bare.unwrap_err().status(), Status::ERROR_MESH_GENUS);
    // Those of the library by default, and its loops by their kind.
    let suggested = builder.build(&positions, &triangles).unwrap();
    assert_eq!(suggested.genus(), 0);
    for kind in [LoopsKind::Cut, LoopsKind::Pants] {
        let by_kind = suggested.solver().library_loops(kind).solve().unwrap();
        let loops = suggested.loops(0, kind).unwrap();
        let by_loops = suggested.solver().loops(&loops).solve().unwrap();
        assert!(by_kind.report.converged && close(by_kind.report.energy, by_loops.report.energy));
    }
    // A limit of no time is one.
    let stopped = suggested.solver().time_limit(Duration::ZERO).solve().unwrap();
    assert_eq!(stopped.status(), Status::LIMIT_TIME);
    let marks = builder.suggest_marks(&positions, &triangles).unwrap();
    assert!((4..=24).contains(&marks.len()));
    let hierarchy = builder.marked_vertices(&marks).build(&positions, &triangles).unwrap();
    assert_eq!(hierarchy.genus(), 0);
    assert_eq!(hierarchy.loops(0, LoopsKind::Pants).unwrap().len(), marks.len() - 3);

    let solution = hierarchy.solver().solve().unwrap();
    assert_eq!((solution.status(), solution.report.class_state), (Status::OK, ClassState::Proven));
    assert_eq!((solution.report.poles, solution.report.index_sum), (0, 4 - marks.len() as i64));
    let all = solution.foliation.singularities().unwrap();
    assert_eq!(all.list().iter().map(|at| i64::from(at.index)).sum::<i64>(), solution.report.index_sum);
    // Behind the zeros, the marked vertices that are none.
    let zeros = all.list().iter().take_while(|at| at.index < 0).count();
    assert!(all.list().len() > zeros);
    for mark in &all.list()[zeros..] {
        assert_eq!((mark.kind, mark.index), (SingularityKind::Vertex, 0));
        assert!(marks.contains(&mark.element) && mark.position == positions[mark.element as usize]);
    }

    let (positions, triangles) = plate(2, 1, 2, 1);
    assert!(Hierarchy::builder().suggest_marks(&positions, &triangles).unwrap().is_empty());
    let twice = Hierarchy::builder().marked_vertices(&[5, 5]).build(&positions, &triangles).unwrap_err();
    assert_eq!(
        (twice.status(), twice.element(), twice.index()),
        (Status::ERROR_OPTIONS, Some(foliations::Element::Vertex), 5)
    );
    let none = Hierarchy::builder().marked_vertices(&[u32::MAX]).build(&positions, &triangles).unwrap_err();
    assert_eq!((none.status(), none.index()), (Status::ERROR_MESH_INDEX, 0));
}

/// Plates and their numbers of holes, as one mesh.
fn several(holes: &[i32]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for &count in holes {
        let (own, corners) = plate(count, 1, 2, 1);
        let first = positions.len() as u32;
        positions.extend(own);
        triangles.extend(corners.into_iter().map(|corner| corner.map(|v| first + v)));
    }
    (positions, triangles)
}

#[test]
fn components_are_solved_in_one_call() {
    let (positions, triangles) = several(&[2, 0, 1]);
    let mut builder = Hierarchy::builder();
    assert_eq!(builder.build(&positions, &triangles).unwrap_err().status(), Status::ERROR_MESH_COMPONENTS);
    let components = builder.components(&positions, &triangles).unwrap();
    assert!(components.len() == 3 && !components.is_empty());
    let statuses: Vec<Status> = components.iter().map(|part| part.status).collect();
    assert_eq!(statuses, [Status::OK, Status::ERROR_MESH_GENUS, Status::OK]);
    let whole = components.solve(|_, hierarchy| hierarchy.solver().solve()).unwrap();
    assert!(whole.components[1].solution.is_none() && !whole.components[1].message.is_empty());
    for (k, holes) in [(0, 2), (2, 1)] {
        let (own, corners) = plate(holes, 1, 2, 1);
        let part = components.get(k).unwrap();
        assert_eq!((part.positions, part.triangles, part.genus as i32), (&own[..], &corners[..], holes));
        let alone = Hierarchy::build(&own, &corners).unwrap().solver().solve().unwrap();
        let values: Vec<f64> = part.whole_edges.iter().map(|&e| whole.values[e as usize]).collect();
        assert_eq!(values, alone.foliation.values());
    }
    assert!(components.get(1).unwrap().whole_edges.iter().all(|&e| whole.values[e as usize] == 0.0));
    let marks = builder.suggest_marks(&positions, &triangles).unwrap();
    assert!(marks.iter().all(|&v| components.vertex_component()[v as usize] == 1) && marks.len() >= 4);
    let marked = builder.marked_vertices(&marks).components(&positions, &triangles).unwrap();
    assert_eq!(marked.get(1).unwrap().status, Status::OK);
    let stopped = components.solve(|_, _| Err(Hierarchy::builder().ratio(3.0).build(&[], &[]).unwrap_err()));
    assert_eq!(stopped.unwrap_err().status(), Status::ERROR_OPTIONS);
}

#[test]
fn loops_go_to_their_components() {
    let (positions, triangles) = several(&[1, 2]);
    let components = Hierarchy::builder().components(&positions, &triangles).unwrap();
    let (own, corners) = plate(2, 1, 2, 1);
    let loops = Hierarchy::build(&own, &corners).unwrap().loops(0, LoopsKind::Cut).unwrap();
    let part = components.get(1).unwrap();
    let shift = |path: &[u32]| path.iter().map(|&t| part.whole_triangles[t as usize]).collect::<Vec<_>>();
    let whole = loops.iter().fold(Loops::triangles(0), |all, path| all.with(&shift(path), 1.0));
    let parts = components.split(&whole).unwrap();
    assert!(parts[0].is_empty() && parts[1] == loops);
    let solved = components.solve(|k, hierarchy| hierarchy.solver().loops(&parts[k]).solve()).unwrap();
    assert_eq!(solved.components[0].status, Status::ERROR_LOOP_COUNT);
    assert_eq!(solved.components[1].status, Status::OK);
    let across = Loops::vertices(0).with(&[0, positions.len() as u32 - 1], 1.0);
    assert_eq!(components.split(&across).unwrap_err().status(), Status::ERROR_LOOP_NOT_CLOSED);
    let beyond = Loops::vertices(0).with(&[positions.len() as u32], 1.0);
    assert_eq!(components.split(&beyond).unwrap_err().status(), Status::ERROR_LOOP_INDEX);
}

#[test]
fn mollifying_accepts_triangles_without_area() {
    let (mut positions, triangles) = plate(1, 1, 2, 1);
    let [a, b, _] = triangles[0];
    positions[b as usize] = positions[a as usize];
    let error = Hierarchy::build(&positions, &triangles).unwrap_err();
    assert_eq!(error.status(), Status::ERROR_MESH_DEGENERATE);
    let hierarchy = Hierarchy::builder().mollify(1e-5).build(&positions, &triangles).unwrap();
    assert_eq!(hierarchy.solver().solve().unwrap().report.poles, 0);
}

/// The README shows the example as it is.
#[test]
fn readme_shows_the_example() {
    let block = format!("```rust\n{}```\n", include_str!("../examples/plate.rs"));
    assert!(include_str!("../README.md").contains(&block));
}
