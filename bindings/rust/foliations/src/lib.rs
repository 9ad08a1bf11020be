#![doc = include_str!("../README.md")]
#![warn(rust_2018_idioms)]

// Each module uses those above it only.
mod error;
mod memory;
mod owned;
mod progress;
mod ranges;
mod records;
mod threads;
// What hmf.h has: a hierarchy, loops, foliations, solving.
mod boundaries;
mod components;
mod foliation;
mod hierarchy;
mod loops;
mod picked;
mod solve;
// What applications.h has.
mod applications;

pub use applications::atlas::Atlas;
pub use applications::cylinders::{Cylinder, Cylinders};
pub use applications::forms::HarmonicForms;
pub use applications::parameterize::{MapQuality, Parameterization, Parameterizer};
pub use applications::quads::{QuadMesh, QuadOptions};
pub use applications::trace::{Leaves, Line, LineEnd, LineKind, Tracer};
pub use components::{Component, ComponentSolution, ComponentSolutions, Components};
pub use error::{Element, Error, Result, Status};
pub use foliation::{Foliation, Singularities, Singularity, SingularityKind};
pub use hierarchy::{Builder, Collapse, Design, DesignOptions, Hierarchy, LevelInfo};
pub use loops::{LoopElements, Loops, LoopsKind};
pub use progress::{with_progress, Progress};
pub use solve::{ClassState, HistoryEntry, HistoryKind, LevelReport, Method, Report, Solution, Solver};
pub use threads::with_threads;

/// No element, in arrays where an index is expected.
pub const NONE: u32 = foliations_sys::HMF_NONE;

/// Version of the library that is linked: major, minor, patch.
pub fn version() -> (u32, u32, u32) {
    // SAFETY: the function has no preconditions.
    let version = unsafe { foliations_sys::hmf_version() };
    (version / 10000, version / 100 % 100, version % 100)
}
