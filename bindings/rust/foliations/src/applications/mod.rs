//! What one does with a foliation.

pub mod atlas;
pub mod cylinders;
pub mod forms;
pub mod parameterize;
pub mod quads;
pub mod trace;
