//! Threads for the calls of this crate: `hmf_parallel_for_fn` on a pool of this crate.

use foliations_sys as sys;
use std::cell::Cell;
use std::ffi::c_void;
use std::ptr;
use std::sync::mpsc::{channel, Sender};
use std::sync::{Arc, Condvar, Mutex};
use std::thread::{available_parallelism, Builder, JoinHandle};

/// Lends threads to all calls of this crate that `work` makes on this thread.
///
/// `count` is their number, this thread included; 0 stands for one for each
/// processor. The results have the same bits with every number of threads, and
/// without. The threads end with `work`.
///
/// ```
/// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
/// # fn main() -> foliations::Result<()> {
/// # let (positions, triangles) = plate(2, 1, 3, 2);
/// let solve = || foliations::Hierarchy::build(&positions, &triangles)?.solver().solve();
/// let solution = foliations::with_threads(0, solve)?;
/// assert_eq!(solution.foliation.values(), solve()?.foliation.values());
/// # Ok(())
/// # }
/// ```
pub fn with_threads<T>(count: usize, work: impl FnOnce() -> T) -> T {
    let count = if count == 0 { available_parallelism().map_or(1, |n| n.get()) } else { count };
    let pool = Pool::new(count.min(256));
    let workers = pool.threads.len() as u32 + 1;
    if workers == 1 {
        let _alone = Lent::new(0, None, ptr::null_mut());
        return work();
    }
    let _lent = Lent::new(workers, Some(run), ptr::addr_of!(pool).cast_mut().cast());
    work()
}

type Lending = (u32, sys::hmf_parallel_for_fn, *mut c_void);

thread_local! {
    /// What the innermost `with_threads` on this thread lends.
    static CURRENT: Cell<Lending> = const { Cell::new((0, None, ptr::null_mut())) };
}

pub(crate) fn lent() -> Lending {
    CURRENT.get()
}

/// Puts what was lent before back when it is dropped.
struct Lent(Lending);

impl Lent {
    fn new(workers: u32, parallel_for: sys::hmf_parallel_for_fn, user: *mut c_void) -> Lent {
        Lent(CURRENT.replace((workers, parallel_for, user)))
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        CURRENT.set(self.0);
    }
}

/// Tasks of C that are under way on other threads.
#[derive(Default)]
struct Latch {
    open: Mutex<usize>,
    closed: Condvar,
}

struct Job {
    task: unsafe extern "C" fn(*mut c_void, u32),
    context: *mut c_void,
    index: u32,
    latch: Arc<Latch>,
}

// SAFETY: a task may run on any thread, by the contract of hmf_parallel_for_fn, and
// `run` returns only after it has ended.
unsafe impl Send for Job {}

impl Job {
    fn run(self) {
        // SAFETY: called once, while `run` waits.
        unsafe { (self.task)(self.context, self.index) };
        let mut open = self.latch.open.lock().unwrap();
        *open -= 1;
        if *open == 0 {
            self.latch.closed.notify_one();
        }
    }
}

struct Pool {
    senders: Vec<Sender<Job>>,
    threads: Vec<JoinHandle<()>>,
}

impl Pool {
    /// Fewer where the system gives no more.
    fn new(count: usize) -> Pool {
        let mut pool = Pool { senders: Vec::new(), threads: Vec::new() };
        while pool.threads.len() + 1 < count {
            let (sender, jobs) = channel::<Job>();
            let Ok(thread) =
                Builder::new().name("foliations".into()).spawn(move || jobs.into_iter().for_each(Job::run))
            else {
                break;
            };
            pool.senders.push(sender);
            pool.threads.push(thread);
        }
        pool
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        self.senders.clear();
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// `hmf_parallel_for_fn`; `user` is a `Pool`.
unsafe extern "C" fn run(user: *mut c_void, task: sys::hmf_task_fn, context: *mut c_void, count: u32) {
    // SAFETY: the pool lives as long as it is lent.
    let pool = unsafe { &*user.cast::<Pool>() };
    let Some(task) = task else { return };
    let shared = (count as usize - 1).min(pool.senders.len());
    let latch = Arc::new(Latch::default());
    *latch.open.lock().unwrap() = shared;
    for (sender, index) in pool.senders.iter().take(shared).zip(1..) {
        // The other end is closed only when the pool is dropped.
        let _ = sender.send(Job { task, context, index, latch: latch.clone() });
    }
    for index in std::iter::once(0).chain(shared as u32 + 1..count) {
        // SAFETY: each index once.
        unsafe { task(context, index) };
    }
    let mut open = latch.open.lock().unwrap();
    while *open > 0 {
        open = latch.closed.wait(open).unwrap();
    }
}
