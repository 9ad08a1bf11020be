#![doc = include_str!("../README.md")]
#![warn(rust_2018_idioms)]

mod cylinders;
mod error;
mod foliation;
mod hierarchy;
mod loops;
mod memory;
mod parameterize;
mod progress;
mod quads;
mod solve;
mod trace;

pub use cylinders::Cylinder;
pub use error::{Element, Error, Result, Status};
pub use foliation::{Foliation, Singularities, Singularity, SingularityKind};
pub use hierarchy::{Builder, Collapse, Hierarchy, LevelInfo};
pub use loops::{LoopElements, Loops, LoopsKind};
pub use parameterize::{Parameterization, Parameterizer};
pub use progress::Progress;
pub use quads::QuadMesh;
pub use solve::{HistoryEntry, HistoryKind, LevelReport, Method, Report, Solution, Solver};
pub use trace::{Leaves, Line, LineEnd, LineKind, Tracer};

/// Version of the library that is linked: major, minor, patch.
pub fn version() -> (u32, u32, u32) {
    // SAFETY: the function has no preconditions.
    let version = unsafe { hmf_sys::hmf_version() };
    (version / 10000, version / 100 % 100, version % 100)
}
