//! A walk through the errors of the library: each that safe Rust can reach is raised, and says nothing in words of C.

use foliations::{
    Builder, DesignOptions, Error, Foliation, Hierarchy, Loops, LoopsKind, Method, Progress, QuadOptions, Result,
    Solution, Status,
};
use std::collections::HashSet;
use std::time::Duration;

include!("support/mesh.rs");

type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// No call of the crate raises these.
const UNREACHABLE: &[Status] = &[
    Status::ERROR_NULL,               // no pointer is null
    Status::ERROR_MEMORY,             // the allocator has to fail
    Status::ERROR_MESH_UNUSED_VERTEX, // such vertices are dropped
    Status::ERROR_MESH_NOT_DELAUNAY,  // no mesh is known
    Status::ERROR_INTERNAL,           // a defect of the library
    Status::LIMIT_CLASS,              // no small mesh is known
];

fn octahedron() -> Mesh {
    let positions = vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 3.], [0., 0., -3.]];
    let triangles = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    (positions, triangles)
}

/// A torus that goes around twice, through itself.
fn wound_torus() -> Mesh {
    const N: u32 = 12;
    let at = |i: u32, j: u32| N * (i % N) + j % N;
    let angle = |k: f64| std::f64::consts::TAU * k / f64::from(N);
    let point = |k: u32| {
        let (a, b) = (angle(f64::from(k / N)), angle(f64::from(k % N) + 0.3));
        let r = 3.0 + 0.5 * a.cos() + 0.6 * b.cos();
        [r * (2.0 * a).cos(), r * (2.0 * a).sin(), 0.6 * b.sin() + 0.15 * a.sin()]
    };
    let square = |k: u32| {
        let (i, j) = (k / N, k % N);
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    };
    ((0..N * N).map(point).collect(), (0..N * N).flat_map(square).collect())
}

/// What the calls said.
#[derive(Default)]
struct Walk {
    found: HashSet<Status>,
    said: HashSet<String>,
}

impl Walk {
    #[track_caller]
    fn fails<T>(&mut self, result: Result<T>) {
        let Err(error) = result else { panic!("the call should fail") };
        self.hear(&error);
    }

    #[track_caller]
    fn stops(&mut self, result: Result<Solution>) {
        self.hear(&result.unwrap().stopped.expect("the solve should stop early"));
    }

    #[track_caller]
    fn hear(&mut self, error: &Error) {
        let text = error.to_string();
        for word in [
            "hmf_",
            "HMF_",
            "NULL",
            "struct_size",
            "sizeof",
            "->",
            "build options",
            "stride",
            "element_kind",
            "_count",
            "offsets[",
            "%",
        ] {
            assert!(!text.contains(word), "{text}");
        }
        assert!(text.len() > 20 && text.ends_with('.'), "{text}");
        self.found.insert(error.status());
        self.said.insert(text.chars().filter(|c| !c.is_ascii_digit()).collect());
    }
}

#[test]
fn every_error_is_in_words_of_rust() {
    let mut walk = Walk::default();
    meshes(&mut walk);
    let (positions, triangles) = plate(2, 1, 6, 5);
    let hierarchy = Hierarchy::builder().coarsest(100).build(&positions, &triangles).unwrap();
    let foliation = hierarchy.solver().solve().unwrap().foliation;
    options(&mut walk, &hierarchy);
    loops(&mut walk, &hierarchy, &triangles);
    values(&mut walk, &hierarchy, &foliation);
    applications(&mut walk, &hierarchy, &foliation);
    boundary(&mut walk, &positions, &triangles[1..]);
    assert!(walk.said.len() > 60, "{}", walk.said.len());
    let bindings = concat!(env!("CARGO_MANIFEST_DIR"), "/../foliations-sys/src/bindings.rs");
    let Ok(bindings) = std::fs::read_to_string(bindings) else {
        println!("skipped: the list of all statuses is only in the repository");
        return;
    };
    let names = bindings.split_whitespace().filter_map(|word| word.strip_prefix("HMF_")?.strip_suffix(':'));
    let is_status = |name: &&str| name.starts_with("ERROR_") || name.starts_with("LIMIT_") || *name == "CANCELLED";
    let all: HashSet<String> = names.filter(is_status).map(String::from).collect();
    let raised: HashSet<String> = walk.found.iter().chain(UNREACHABLE).map(|status| format!("{status:?}")).collect();
    assert!(UNREACHABLE.iter().all(|status| !walk.found.contains(status)));
    assert_eq!(all.difference(&raised).collect::<Vec<_>>(), Vec::<&String>::new());
}

fn meshes(walk: &mut Walk) {
    let mut defect = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = plate(1, 1, 2, 1);
        change(&mut mesh);
        walk.fails(Hierarchy::build(&mesh.0, &mesh.1));
    };
    defect(&|mesh| mesh.1.clear());
    defect(&|mesh| *mesh = (Vec::new(), Vec::new()));
    defect(&|mesh| mesh.1[4][2] = 9999);
    defect(&|mesh| mesh.0[3][1] = f64::NAN);
    defect(&|mesh| mesh.1[4][1] = mesh.1[4][0]);
    defect(&|mesh| mesh.0[mesh.1[0][1] as usize] = mesh.0[mesh.1[0][0] as usize]);
    defect(&|mesh| mesh.1.push(mesh.1[0]));
    defect(&|mesh| mesh.1[5].swap(0, 1));
    let twice = |mesh: &mut Mesh, shared: bool| {
        let n = mesh.0.len() as u32;
        let more = mesh.1.iter().map(|t| t.map(|v| if shared && v == 0 { 0 } else { v + n - u32::from(shared) }));
        mesh.1 = mesh.1.iter().copied().chain(more.collect::<Vec<_>>()).collect();
        mesh.0.extend(mesh.0[usize::from(shared)..].to_vec());
    };
    defect(&|mesh| twice(mesh, false));
    defect(&|mesh| twice(mesh, true));
    let (positions, triangles) = octahedron();
    for marks in [&[][..], &[0, 1, 2], &[0, 1, 2, 4, 2], &[0, 1, 2, 6]] {
        walk.fails(Hierarchy::builder().marked_vertices(marks).build(&positions, &triangles));
    }
    walk.fails(Hierarchy::builder().marked_vertices(&[]).build(&positions, &triangles[..7]));
    walk.fails(Hierarchy::builder().closed(true).build(&positions, &triangles[..7]));
    walk.fails(Hierarchy::builder().mollify(1e-5).build(&[[0.0; 3]; 6], &triangles));
    walk.fails(Hierarchy::builder().build_flat(&[0.0; 4], &[0, 1, 2]));
    walk.fails(Hierarchy::builder().components(&positions[1..], &triangles));
    walk.fails(Hierarchy::build(&positions, &triangles).unwrap().loops(0, LoopsKind::Handle));
    let (positions, triangles) = wound_torus();
    walk.fails(Hierarchy::build(&positions, &triangles).unwrap().loops(0, LoopsKind::Handle));
}

fn options(walk: &mut Walk, hierarchy: &Hierarchy) {
    let (positions, triangles) = plate(1, 1, 2, 1);
    let mut refuse = |mut builder: Builder<'_>| walk.fails(builder.build(&positions, &triangles));
    refuse(Hierarchy::builder().ratio(2.0));
    refuse(Hierarchy::builder().mollify(-1.0));
    refuse(Hierarchy::builder().coarsest(0));
    refuse(Hierarchy::builder().memory_limit(10_000));
    refuse(Hierarchy::builder().progress(|_| Progress::Cancel));
    for tolerance in [0.0, 1.0, -1.0, f64::NAN] {
        walk.fails(hierarchy.solver().tolerance(tolerance).solve());
        walk.fails(hierarchy.solver().energy_tolerance(tolerance).solve());
    }
    walk.fails(hierarchy.solver().iteration_limit(0).solve());
    walk.fails(hierarchy.solver().step_limit(0).solve());
    walk.fails(hierarchy.solver().stop_level(99).solve());
    walk.fails(hierarchy.solver().method(Method::SingleLevel).stop_level(1).solve());
    walk.fails(hierarchy.solver().progress(|_| Progress::Cancel).solve());
    walk.stops(hierarchy.solver().progress(|_| Progress::Finish).solve());
    walk.stops(hierarchy.solver().time_limit(Duration::ZERO).solve());
    walk.stops(hierarchy.solver().step_limit(1).tolerance(1e-12).solve());
    walk.stops(hierarchy.solver().method(Method::Whitehead).iteration_limit(1).tolerance(1e-12).solve());
    walk.stops(hierarchy.solver().tolerance(1e-300).solve());
}

fn loops(walk: &mut Walk, hierarchy: &Hierarchy, triangles: &[[u32; 3]]) {
    let kind = |kind| hierarchy.loops(0, kind).unwrap();
    let cut = kind(LoopsKind::Cut);
    let first = cut.get(0).unwrap();
    let (vertices, strips) = (|path: &[u32]| Loops::vertices(0).with(path, 1.0), Loops::triangles(0).with(first, 1.0));
    let mut arc = Loops::triangles(0);
    arc.push_arc(first, 1.0);
    let sets = [
        Loops::vertices(0),
        vertices(&[]),
        vertices(&[0, 1, 99_999]),
        vertices(&[0, triangles[triangles.len() / 2][0], triangles[triangles.len() - 1][0]]),
        vertices(&triangles[0]),
        strips.clone().with(first, 1.0),
        arc,
        cut.clone().with_weights(&[1.0, -1.0]).unwrap(),
        cut.clone().with_weights(&[1.0, 1e9]).unwrap(),
        Loops::triangles(0).with(&[first, first].concat(), 1.0),
        strips.with(kind(LoopsKind::Tunnel).get(0).unwrap(), 1.0).with(kind(LoopsKind::Handle).get(0).unwrap(), 1.0),
        Loops::vertices(99).with(&triangles[0], 1.0),
    ];
    for set in &sets {
        walk.fails(hierarchy.solver().loops(set).solve());
        walk.fails(hierarchy.initialize(set));
    }
    walk.fails(cut.with_weights(&[1.0]));
    let (positions, triangles) = plate(1, 1, 2, 1);
    let marked = Hierarchy::builder().marked_vertices(&triangles[0]).build(&positions, &triangles).unwrap();
    walk.fails(marked.solver().loops(&vertices(&triangles[0])).solve());
    walk.fails(hierarchy.loops_through(&[&[0]]));
    walk.fails(hierarchy.vertices_near(&[[1e6; 3]], None));
}

fn values(walk: &mut Walk, hierarchy: &Hierarchy, foliation: &Foliation) {
    let values = foliation.values();
    let other = |at: usize, x: f64| {
        let mut other = values.to_vec();
        other[at] = x;
        other
    };
    let scaled = |factor: f64| values.iter().map(|x| factor * x).collect::<Vec<_>>();
    let large = 2f64.powf(values.iter().sum::<f64>().log2().ceil());
    for given in [
        other(5, -1.0),
        other(5, f64::INFINITY),
        other(5, large),
        scaled(0.0),
        scaled(1e-280),
        scaled(std::f64::consts::PI),
        values[1..].to_vec(),
    ] {
        walk.fails(hierarchy.foliation(0, given));
    }
    let is_at = |ends: &[u32; 2]| if ends.contains(&0) { 1.0 } else { 0.0 };
    let pole = hierarchy.edge_vertices(0).unwrap().iter().map(is_at).collect::<Vec<_>>();
    let pole = hierarchy.foliation(0, pole).unwrap();
    walk.fails(pole.residuals());
    walk.fails(pole.cylinders(None));
    walk.fails(hierarchy.solver().start(&pole).solve());
    let (pants, cut) = (hierarchy.loops(0, LoopsKind::Pants).unwrap(), hierarchy.loops(0, LoopsKind::Cut).unwrap());
    let start = hierarchy.initialize(&cut).unwrap();
    walk.fails(start.parameterizer().parameterize());
    walk.fails(start.cylinders(None));
    walk.fails(start.quads(None));
    walk.fails(foliation.cylinders(Some(&pants)));
    walk.fails(hierarchy.solver().start(foliation).loops(&cut).solve());
    let (positions, triangles) = plate(1, 1, 2, 1);
    let small = Hierarchy::build(&positions, &triangles).unwrap();
    walk.fails(small.solver().start(foliation).solve());
    walk.fails(small.solver().relax(foliation));
    walk.fails(small.solver().start(&foliation.interpolate(1).unwrap()).solve());
    walk.fails(foliation.interpolate(99));
}

fn applications(walk: &mut Walk, hierarchy: &Hierarchy, foliation: &Foliation) {
    let quads = |edge_length, count, relax| {
        foliation.quads_with(&QuadOptions { edge_length, count, relax, ..Default::default() })
    };
    for length in [1e-9, 1e-300, 1e300, f64::NAN] {
        walk.fails(quads(Some(length), None, 0));
    }
    walk.fails(quads(Some(1.0), Some(500), 0));
    walk.fails(quads(None, Some(1 << 40), 0));
    walk.fails(quads(None, Some(500), 1_000_000));
    walk.fails(foliation.atlas(Some(0.5)));
    walk.fails(foliation.parameterizer().tolerance(-1.0).parameterize());
    walk.fails(foliation.parameterizer().seam_edges(&[1_000_000]).parameterize());
    walk.fails(foliation.tracer().spacing(1e-12).trace());
    walk.fails(foliation.tracer().conjugate().spacing(1e-12).trace());
    walk.fails(foliation.tracer().critical().length_limit(-1.0).trace());
    let design = DesignOptions { solve_limit: Some(0), ..Default::default() };
    let (positions, triangles) = (hierarchy.positions(0).unwrap(), hierarchy.triangle_vertices(0).unwrap());
    walk.fails(Hierarchy::builder().even_design(&positions, &triangles, design));
}

fn boundary(walk: &mut Walk, positions: &[[f64; 3]], triangles: &[[u32; 3]]) {
    let hierarchy = Hierarchy::builder().coarsest(100).build(positions, triangles).unwrap();
    let foliation = hierarchy.solver().solve().unwrap().foliation;
    let upper = foliation.interpolate(1).unwrap();
    walk.fails(hierarchy.loops(0, LoopsKind::Handle));
    walk.fails(hierarchy.loops(1, LoopsKind::Cut));
    walk.fails(hierarchy.harmonic_forms(0));
    walk.fails(upper.quads(None));
    walk.fails(upper.atlas(None));
    walk.fails(upper.cylinders(None));
    walk.fails(hierarchy.foliation(0, foliation.values()).unwrap().cylinders(None));
    walk.fails(hierarchy.solver().loops(&Loops::vertices(1).with(&[0, 1, 2], 1.0)).solve());
    let inner = hierarchy.edge_vertices(0).unwrap().pop().unwrap();
    for path in [&inner[..1], &inner] {
        let mut arc = Loops::vertices(0);
        arc.push_arc(path, 1.0);
        walk.fails(hierarchy.solver().loops(&arc).solve());
    }
}
