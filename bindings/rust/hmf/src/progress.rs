//! Progress closures, and how their answers and panics pass through C.

use hmf_sys as sys;
use std::any::Any;
use std::ffi::c_void;
use std::ops::ControlFlow;
use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};

/// What a progress closure wants.
///
/// A closure may also return `()`, which goes on, or a [`ControlFlow`], whose
/// `Break` cancels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Progress {
    /// Go on.
    Continue,
    /// End the call at once, without a result.
    Cancel,
    /// Stop improving, and give the foliation that there is. Where there is none
    /// yet (while a hierarchy is built), as `Cancel`.
    Finish,
}

impl From<()> for Progress {
    fn from(_: ()) -> Progress {
        Progress::Continue
    }
}

impl<B, C> From<ControlFlow<B, C>> for Progress {
    fn from(flow: ControlFlow<B, C>) -> Progress {
        match flow {
            ControlFlow::Continue(_) => Progress::Continue,
            ControlFlow::Break(_) => Progress::Cancel,
        }
    }
}

/// The closure of an options builder.
pub(crate) type Closure<'a> = Box<dyn FnMut(f64) -> Progress + 'a>;

pub(crate) fn boxed<'a, R: Into<Progress>>(mut closure: impl FnMut(f64) -> R + 'a) -> Closure<'a> {
    Box::new(move |fraction| closure(fraction).into())
}

struct Reporter<'r, 'a> {
    closure: &'r mut Closure<'a>,
    panic: Option<Box<dyn Any + Send>>,
}

/// `hmf_progress_fn`; `user` is a `Reporter`.
unsafe extern "C" fn report(user: *mut c_void, fraction: f64) -> i32 {
    // SAFETY: `with_progress` passes its own reporter, and only during its call.
    let reporter = unsafe { &mut *user.cast::<Reporter<'_, '_>>() };
    if reporter.panic.is_some() {
        return sys::HMF_PROGRESS_CANCEL;
    }
    match catch_unwind(AssertUnwindSafe(|| (reporter.closure)(fraction))) {
        Ok(Progress::Continue) => sys::HMF_PROGRESS_CONTINUE,
        Ok(Progress::Cancel) => sys::HMF_PROGRESS_CANCEL,
        Ok(Progress::Finish) => sys::HMF_PROGRESS_FINISH,
        Err(panic) => {
            reporter.panic = Some(panic);
            sys::HMF_PROGRESS_CANCEL
        }
    }
}

/// Makes a call with the callback and its `user` pointer. A panic of the closure
/// cancels the call and goes on once the call has returned.
pub(crate) fn with_progress<T>(
    closure: Option<&mut Closure<'_>>,
    call: impl FnOnce(sys::hmf_progress_fn, *mut c_void) -> T,
) -> T {
    let Some(closure) = closure else {
        return call(None, std::ptr::null_mut());
    };
    let mut reporter = Reporter { closure, panic: None };
    let result = call(Some(report), std::ptr::addr_of_mut!(reporter).cast());
    if let Some(panic) = reporter.panic {
        drop(result);
        resume_unwind(panic);
    }
    result
}
