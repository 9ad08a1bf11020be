//! Calls of the library, and what it makes: objects and results in its own memory.

use crate::error::{error_of, Error, Result, Status};
use crate::progress;
use foliations_sys as sys;
use std::ops::Deref;
use std::ptr::{self, NonNull};

/// What the library makes, and how it takes it back.
pub(crate) trait Made {
    /// # Safety
    ///
    /// The library made it, and nobody uses it any more.
    unsafe fn release(this: *mut Self) {
        // SAFETY: as the caller promises; all but the objects are freed so.
        unsafe { sys::hmf_free(this.cast_const().cast()) }
    }
}

impl Made for sys::hmf_component_set {}
impl Made for sys::hmf_level_mesh {}
impl Made for sys::hmf_residual_set {}
impl Made for sys::hmf_scale {}
impl Made for sys::hmf_form_set {}
impl Made for sys::hmf_mark_set {}
impl Made for sys::hmf_loop_set {}
impl Made for sys::hmf_design {}
impl Made for sys::hmf_singularity_set {}
impl Made for sys::hmf_parameterization {}
impl Made for sys::hmf_lines {}
impl Made for sys::hmf_cylinder_set {}
impl Made for sys::hmf_quad_mesh {}
impl Made for sys::hmf_chart_set {}

impl Made for sys::hmf_hierarchy {
    unsafe fn release(this: *mut Self) {
        // SAFETY: as the caller promises.
        unsafe { sys::hmf_hierarchy_destroy(this) }
    }
}

impl Made for sys::hmf_foliation {
    unsafe fn release(this: *mut Self) {
        // SAFETY: as the caller promises.
        unsafe { sys::hmf_foliation_destroy(this) }
    }
}

/// The owner of one of them.
#[derive(Debug)]
pub(crate) struct Owned<T: Made>(NonNull<T>);

// SAFETY: the library never changes what it has made, any number of threads may use
// it, and its memory comes from the global allocator, which is thread-safe.
unsafe impl<T: Made> Send for Owned<T> {}
// SAFETY: as above.
unsafe impl<T: Made> Sync for Owned<T> {}

impl<T: Made> Owned<T> {
    pub(crate) fn as_ptr(&self) -> *const T {
        self.0.as_ptr()
    }
}

impl<T: Made> Deref for Owned<T> {
    type Target = T;

    fn deref(&self) -> &T {
        // SAFETY: it lives until `self` is dropped.
        unsafe { self.0.as_ref() }
    }
}

impl<T: Made> Drop for Owned<T> {
    fn drop(&mut self) {
        // SAFETY: `self` is the only owner.
        unsafe { T::release(self.0.as_ptr()) }
    }
}

/// An array of the library; NULL without elements.
///
/// # Safety
///
/// There are `count` elements, and their owner outlives the slice.
pub(crate) unsafe fn slice<'s, T>(array: *const T, count: u64) -> &'s [T] {
    if array.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { std::slice::from_raw_parts(array, count as usize) }
}

/// The arrays of a result as methods that borrow from its block.
macro_rules! arrays {
    ($name:ident { $($(#[$doc:meta])* $array:ident: [$item:ty; $count:ident],)* }) => {
        impl $name {
            $($(#[$doc])*
            pub fn $array(&self) -> &[$item] {
                // SAFETY: the header gives each array so many elements of this layout;
                // they lie in the block that `self` owns.
                unsafe { $crate::owned::slice(self.block.$array.cast::<$item>(), self.block.$count) }
            })*
        }
    };
}
pub(crate) use arrays;

/// Makes a call with the progress closure of this thread; `Ok` for success.
pub(crate) fn call(make: impl FnOnce(*const sys::hmf_control, *mut sys::hmf_error) -> sys::hmf_status) -> Result<()> {
    let result = unchecked(make);
    progress::go_on_with_panic();
    result
}

/// Makes a call that makes something, and gives that even if the call was stopped.
pub(crate) fn attempt<T: Made>(
    make: impl FnOnce(*mut *mut T, *const sys::hmf_control, *mut sys::hmf_error) -> sys::hmf_status,
) -> (Result<()>, Option<Owned<T>>) {
    let mut out = ptr::null_mut();
    let result = unchecked(|control, error| make(&mut out, control, error));
    let made = NonNull::new(out).map(Owned);
    progress::go_on_with_panic();
    (result, made)
}

/// Makes a call that makes something.
pub(crate) fn make<T: Made>(
    make: impl FnOnce(*mut *mut T, *const sys::hmf_control, *mut sys::hmf_error) -> sys::hmf_status,
) -> Result<Owned<T>> {
    let (result, made) = attempt(make);
    result?;
    made.ok_or_else(|| Error::new(Status::ERROR_INTERNAL, "The library gave no result.".into()))
}

fn unchecked(make: impl FnOnce(*const sys::hmf_control, *mut sys::hmf_error) -> sys::hmf_status) -> Result<()> {
    let mut error = sys::hmf_error::default();
    let status = progress::with_control(|control| make(control, &mut error));
    error_of(status, &error).map_or(Ok(()), Err)
}
