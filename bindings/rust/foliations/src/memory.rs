//! The library takes its memory from Rust's global allocator.

use std::alloc::{alloc, dealloc, Layout};
use std::ffi::c_void;

/// Alignment that suits any type, as the C interface asks.
const ALIGNMENT: usize = 16;

fn layout(size: usize) -> Option<Layout> {
    Layout::from_size_align(size.max(1), ALIGNMENT).ok()
}

/// `hmf_allocate_fn`.
pub(crate) unsafe extern "C" fn allocate(_user: *mut c_void, size: usize) -> *mut c_void {
    match layout(size) {
        // SAFETY: the size is not 0.
        Some(layout) => unsafe { alloc(layout) }.cast(),
        None => std::ptr::null_mut(),
    }
}

/// `hmf_release_fn`.
pub(crate) unsafe extern "C" fn release(_user: *mut c_void, block: *mut c_void, size: usize) {
    if let Some(layout) = layout(size) {
        // SAFETY: the library gives back blocks of `allocate` with their size.
        unsafe { dealloc(block.cast(), layout) }
    }
}
