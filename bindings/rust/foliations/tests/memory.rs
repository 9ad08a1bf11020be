//! Nothing leaks: the library takes its memory from the global allocator, which
//! this program counts. One test, so that no other thread allocates.

use foliations::{Hierarchy, Loops, Progress};
use std::alloc::{GlobalAlloc, Layout, System};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::atomic::{AtomicIsize, Ordering};

include!("support/mesh.rs");

struct Counting;
static LIVE: AtomicIsize = AtomicIsize::new(0);

// SAFETY: all calls go to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LIVE.fetch_add(layout.size() as isize, Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size() as isize, Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Resident memory in bytes, where the system tells it.
fn resident() -> Option<usize> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(text.split(' ').nth(1)?.parse::<usize>().ok()? * 4096)
}

#[test]
fn calls_leave_nothing() {
    let (positions, triangles) = plate(2, 1, 3, 2);
    let mut turned = triangles.clone();
    turned[0].swap(0, 1);
    let held = LIVE.load(Ordering::Relaxed);
    let hierarchy = Hierarchy::build(&positions, &triangles).unwrap();
    // The hierarchy is counted by both sides; the reference to it is Rust's.
    let kept = LIVE.load(Ordering::Relaxed) - held;
    assert!(kept >= hierarchy.memory() as isize && kept < hierarchy.memory() as isize + 100);

    let mut open = vec![0.0; hierarchy.level(0).unwrap().edge_count];
    open[0] = 1.0;
    let solution = hierarchy.solver().solve().unwrap();
    let foliation = &solution.foliation;
    let trivial = Loops::vertices(0).with(&triangles[0], 1.0);
    std::panic::set_hook(Box::new(|_| ())); // silent
    let fail = || {
        let mut calls = 0;
        let cancel = |_: f64| {
            calls += 1;
            [Progress::Continue, Progress::Cancel][usize::from(calls > 10)]
        };
        assert!(Hierarchy::build(&positions, &turned).is_err());
        assert!(hierarchy.solver().progress(cancel).solve().is_err());
        assert!(hierarchy.solver().loops(&trivial).solve().is_err());
        assert!(hierarchy.foliation(0, &open).is_err());
        assert!(foliation.tracer().point(u32::MAX, [1.0, 0.0, 0.0]).trace().is_err());
        assert!(foliations::with_progress(|_| Progress::Cancel, || foliation.cylinders(None)).is_err());
        let panics = |_: f64| -> Progress { panic!("on purpose") };
        assert!(catch_unwind(AssertUnwindSafe(|| hierarchy.solver().progress(panics).solve().is_ok())).is_err());
    };
    for _ in 0..50 {
        fail();
    }
    let work = || {
        let again = hierarchy.foliation(0, foliation.values()).unwrap();
        drop((again.singularities().unwrap(), again.quads(None).unwrap(), again.cylinders(None).unwrap()));
        drop((again.tracer().trace().unwrap(), again.parameterizer().parameterize().unwrap()));
        // Panics in the last call of all, when the foliation is there already.
        let late = |fraction: f64| assert!(fraction < 1.0);
        assert!(catch_unwind(AssertUnwindSafe(|| hierarchy.solver().progress(late).solve().is_ok())).is_err());
    };
    work();
    let (live, size) = (LIVE.load(Ordering::Relaxed), resident());
    for _ in 0..1000 {
        fail();
    }
    for _ in 0..10 {
        work();
    }
    assert_eq!(LIVE.load(Ordering::Relaxed), live);
    match (size, resident()) {
        (Some(before), Some(after)) => assert!(after < before + (1 << 20), "{before} bytes became {after}"),
        _ => println!("skipped: no /proc/self/statm"),
    }
    // The foliation keeps its hierarchy alive.
    drop((hierarchy, open, trivial));
    assert!(LIVE.load(Ordering::Relaxed) > held + kept);
    assert_eq!(foliation.energy().unwrap(), solution.report.energy);
    drop(solution);
    assert!(LIVE.load(Ordering::Relaxed) < held + 10_000);
}
