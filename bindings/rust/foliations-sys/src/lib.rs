//! Raw bindings to the C library hmf, harmonic measured foliations on triangle meshes.
//! Most programs want the safe crate [foliations](https://docs.rs/foliations).
//!
//! This crate compiles the library from its C++ sources, with the C++ compiler
//! that the `cc` crate finds. The items are those of the C headers `hmf.h` and
//! `applications.h`, under the same names; the headers are their manual:
//!
#![doc = concat!("```c\n", include_str!(concat!(env!("HMF_HEADERS"), "/hmf/hmf.h")), "```")]
//!
#![doc = concat!("```c\n", include_str!(concat!(env!("HMF_HEADERS"), "/hmf/applications.h")), "```")]
//!
#![no_std]
#![allow(non_camel_case_types)]

// Written by bindgen; tests/bindings_match_header.rs tells when it is out of date.
#[allow(missing_docs, clippy::undocumented_unsafe_blocks)]
mod bindings {
    include!("bindings.rs");
}
pub use bindings::*;
