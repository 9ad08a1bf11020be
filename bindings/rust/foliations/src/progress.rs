//! Progress closures, and how their answers and panics pass through C.

use crate::records::options;
use foliations_sys as sys;
use std::any::Any;
use std::cell::Cell;
use std::ffi::c_void;
use std::fmt;
use std::ops::ControlFlow;
use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};
use std::ptr;

/// What a progress closure wants.
///
/// A closure may also return `()`, which continues, or a [`ControlFlow`], whose
/// `Break` cancels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Progress {
    /// Go on.
    Continue,
    /// End the call at once, without a result.
    Cancel,
    /// Stop improving, and give the foliation that there is. Where there is none
    /// (in all but `solve` and `relax`), as `Cancel`.
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

/// Watches all calls of this crate that `work` makes on this thread.
///
/// During each call that can be long the closure is called on this thread with a
/// fraction rising from 0 to 1, and may end the call. If it panics, the call is
/// cancelled and the panic continues. The closure may use this crate itself: its own
/// calls are not watched.
///
/// ```
/// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
/// # fn main() -> foliations::Result<()> {
/// # let (positions, triangles) = plate(2, 1, 3, 2);
/// # let hierarchy = foliations::Hierarchy::build(&positions, &triangles)?;
/// # let foliation = hierarchy.solver().solve()?.foliation;
/// let quads = foliations::with_progress(|fraction| println!("{:3.0} %", 100.0 * fraction), || foliation.quads(None))?;
/// # assert!(quads.quads().len() > 10);
/// # Ok(())
/// # }
/// ```
pub fn with_progress<T, R: Into<Progress>>(mut closure: impl FnMut(f64) -> R, work: impl FnOnce() -> T) -> T {
    watched(&mut |fraction| closure(fraction).into(), work)
}

/// The closure of an options builder.
pub(crate) struct Closure<'a>(Box<dyn FnMut(f64) -> Progress + 'a>);

impl<'a> Closure<'a> {
    pub(crate) fn new<R: Into<Progress>>(mut closure: impl FnMut(f64) -> R + 'a) -> Option<Closure<'a>> {
        Some(Closure(Box::new(move |fraction| closure(fraction).into())))
    }

    /// `with_progress` of the closure that may be there.
    pub(crate) fn watch<T>(closure: &mut Option<Closure<'a>>, work: impl FnOnce() -> T) -> T {
        match closure {
            Some(Closure(closure)) => watched(closure, work),
            None => work(),
        }
    }
}

impl fmt::Debug for Closure<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("closure")
    }
}

struct Reporter<'r> {
    closure: &'r mut dyn FnMut(f64) -> Progress,
    panic: Option<Box<dyn Any + Send>>,
}

thread_local! {
    /// The `Reporter` of the innermost `watched` on this thread, or null.
    static CURRENT: Cell<*mut c_void> = const { Cell::new(ptr::null_mut()) };
}

/// Puts the one before back when it is dropped.
struct Installed(*mut c_void);

impl Installed {
    fn new(reporter: *mut c_void) -> Installed {
        Installed(CURRENT.replace(reporter))
    }
}

impl Drop for Installed {
    fn drop(&mut self) {
        CURRENT.set(self.0);
    }
}

fn watched<T>(closure: &mut dyn FnMut(f64) -> Progress, work: impl FnOnce() -> T) -> T {
    let mut reporter = Reporter { closure, panic: None };
    let _installed = Installed::new(ptr::addr_of_mut!(reporter).cast());
    work()
}

/// Runs work that is part of a call whose end has been reported.
pub(crate) fn unwatched<T>(work: impl FnOnce() -> T) -> T {
    let _unwatched = Installed::new(ptr::null_mut());
    work()
}

/// `hmf_progress_fn`; `user` is a `Reporter`.
unsafe extern "C" fn report(user: *mut c_void, fraction: f64) -> i32 {
    let _unwatched = Installed::new(ptr::null_mut());
    // SAFETY: a reporter lives as long as it is installed, thus during the calls that it
    // is given to; while this reference lives, it is not found by others.
    let reporter = unsafe { &mut *user.cast::<Reporter<'_>>() };
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

/// Makes a call with the control of this thread; NULL where nobody watches and nothing is lent.
pub(crate) fn with_control<T>(call: impl FnOnce(*const sys::hmf_control) -> T) -> T {
    let user = CURRENT.get();
    let (workers, parallel_for, parallel_user) = crate::threads::lent();
    if user.is_null() && parallel_for.is_none() {
        return call(ptr::null());
    }
    let progress: sys::hmf_progress_fn = if user.is_null() { None } else { Some(report) };
    call(
        &options!(hmf_control progress: progress, progress_user: user, workers: workers, parallel_for: parallel_for, parallel_user: parallel_user),
    )
}

/// A panic of the closure continues here, after the call.
pub(crate) fn go_on_with_panic() {
    let user = CURRENT.get();
    if user.is_null() {
        return;
    }
    // SAFETY: it is installed, and the closure does not run.
    let panic = unsafe { (*user.cast::<Reporter<'_>>()).panic.take() };
    if let Some(panic) = panic {
        resume_unwind(panic);
    }
}
