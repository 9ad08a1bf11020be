//! Applications of a foliation and of a hierarchy.

pub mod atlas;
pub mod cylinders;
pub mod forms;
pub mod parameterize;
pub mod quads;
pub mod trace;
