//! The harmonic foliation of loops, and the report of a run.

use crate::error::{call, Error, Result, Status};
use crate::foliation::Foliation;
use crate::hierarchy::Hierarchy;
use crate::loops::Loops;
use crate::progress::{boxed, with_progress, Closure, Progress};
use hmf_sys as sys;
use std::fmt;
use std::mem::size_of;
use std::time::Duration;

/// How the energy is minimised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Method {
    /// Newton steps on the twisted Laplacian, level by level.
    #[default]
    Newton,
    /// Whitehead moves, level by level.
    Whitehead,
    /// Whitehead moves on the input mesh alone.
    SingleLevel,
}

/// Options for solving on a hierarchy; see [`Hierarchy::solver`].
///
/// What is not set has its default.
///
/// ```
/// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
/// # fn main() -> hmf::Result<()> {
/// # let (positions, triangles) = plate(2, 1, 2, 1);
/// # let hierarchy = hmf::Hierarchy::build(&positions, &triangles)?;
/// use std::time::Duration;
///
/// let loops = hierarchy.loops(0, hmf::LoopsKind::Cut)?.with_weights(&[1.0, 2.5])?;
/// let solution = hierarchy.solver().loops(&loops).time_limit(Duration::from_secs(60)).solve()?;
/// assert_eq!(solution.status(), hmf::Status::OK);
/// assert!(solution.report.residual_max < 1e-8);
/// # Ok(())
/// # }
/// ```
#[must_use = "a solver does nothing until `solve` or `relax` is called"]
pub struct Solver<'a> {
    hierarchy: Hierarchy,
    loops: Option<&'a Loops>,
    start: Option<&'a Foliation>,
    method: Method,
    tolerance: f64,
    time_limit: Duration,
    iteration_limit: u64,
    stop_level: usize,
    history_capacity: usize,
    progress: Option<Closure<'a>>,
}

impl<'a> Solver<'a> {
    pub(crate) fn new(hierarchy: Hierarchy) -> Solver<'a> {
        Solver {
            hierarchy,
            loops: None,
            start: None,
            method: Method::default(),
            tolerance: 0.0,
            time_limit: Duration::ZERO,
            iteration_limit: 0,
            stop_level: 0,
            history_capacity: 4096,
            progress: None,
        }
    }

    /// The class of the foliation: loops on any level. Default: those of
    /// [`LoopsKind::Cut`](crate::LoopsKind::Cut) on the coarsest level (on level 0
    /// with [`Method::SingleLevel`]), weights 1.
    pub fn loops(mut self, loops: &'a Loops) -> Self {
        self.loops = Some(loops);
        self
    }

    /// A foliation to start from instead of loops; the class is its class. It may be
    /// of another hierarchy with the same triangles at other positions, as the last
    /// frame of an animation. Only for [`solve`](Solver::solve).
    ///
    /// Its values are restricted to the coarsest level, and solved from there. Where they
    /// are close to the minimum, [`relax`](Solver::relax) is faster.
    pub fn start(mut self, foliation: &'a Foliation) -> Self {
        self.start = Some(foliation);
        self
    }

    /// How the energy is minimised. Default: [`Method::Newton`].
    pub fn method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// When to stop. [`Method::Newton`]: the largest residual, default 1e-8; the
    /// others: the relative change of the energy in a sweep, default 1e-6.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// After this time the best foliation so far is the result. Default: no limit.
    pub fn time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = limit;
        self
    }

    /// Most sweeps on each level. Default: 100 000.
    pub fn iteration_limit(mut self, sweeps: u64) -> Self {
        self.iteration_limit = sweeps;
        self
    }

    /// The finest level to solve, for a preview. Default: 0, the input mesh.
    pub fn stop_level(mut self, level: usize) -> Self {
        self.stop_level = level;
        self
    }

    /// Most entries of [`Report::history`]. Default: 4096.
    pub fn history_capacity(mut self, entries: usize) -> Self {
        self.history_capacity = entries;
        self
    }

    /// A closure that is called on this thread with a fraction rising from 0 to
    /// 1, and that may end the call. If it panics, the call is cancelled and the
    /// panic goes on.
    pub fn progress<R: Into<Progress>>(mut self, closure: impl FnMut(f64) -> R + 'a) -> Self {
        self.progress = Some(boxed(closure));
        self
    }

    /// The harmonic foliation in the class of the loops.
    ///
    /// If a limit or the progress closure ended the optimisation and there is a
    /// foliation, it is the result, closed and without poles;
    /// [`Solution::stopped`] tells why.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`] if there is no foliation yet, or a status of the
    /// classes 100, 200, 400.
    pub fn solve(&mut self) -> Result<Solution> {
        let loops = self.loops.map(Loops::as_raw);
        let loops = loops.as_ref().map_or(std::ptr::null(), |loops| loops as *const _);
        let level = self.stop_level;
        let values = vec![0.0; self.hierarchy.level(level)?.edge_count];
        self.run(level, values, |hierarchy, options, values, report, error| {
            // SAFETY: the values are given with their number; the rest lives in `run`,
            // and the loops in `self`.
            unsafe { sys::hmf_solve(hierarchy, loops, options, values.as_mut_ptr(), values.len(), report, error) }
        })
    }

    /// Optimises a foliation on its level; otherwise as [`solve`](Solver::solve).
    /// Loops, `start` and `stop_level` are not used.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`] if nothing was written, [`Status::ERROR_OPTIONS`] if
    /// the foliation is of another hierarchy, class 500 if it is not closed or has
    /// a pole, classes 100 and 200.
    pub fn relax(&mut self, foliation: &Foliation) -> Result<Solution> {
        if foliation.hierarchy().as_ptr() != self.hierarchy.as_ptr() {
            let message = "The foliation is of another hierarchy. Take the solver of foliation.hierarchy().";
            return Err(Error::new(Status::ERROR_OPTIONS, message.into()));
        }
        let level = foliation.level();
        self.run(level, foliation.values().to_vec(), |hierarchy, options, values, report, error| {
            // SAFETY: the values are given with their number; the rest lives in `run`.
            unsafe { sys::hmf_relax(hierarchy, level, options, values.as_mut_ptr(), values.len(), report, error) }
        })
    }

    fn run(
        &mut self,
        level: usize,
        mut values: Vec<f64>,
        optimise: impl FnOnce(
            *const sys::hmf_hierarchy,
            &sys::hmf_solve_options,
            &mut [f64],
            &mut sys::hmf_report,
            *mut sys::hmf_error,
        ) -> sys::hmf_status,
    ) -> Result<Solution> {
        let mut levels = vec![NO_LEVEL; self.hierarchy.level_count()];
        let mut history = vec![NO_ENTRY; self.history_capacity];
        let mut report = sys::hmf_report {
            struct_size: size_of::<sys::hmf_report>() as u32,
            method: sys::HMF_METHOD_DEFAULT,
            converged: 0,
            values_written: 0,
            energy: 0.0,
            residual_max: 0.0,
            residual_mean: 0.0,
            poles: 0,
            zeros: 0,
            index_sum: 0,
            bad_flips: 0,
            bad_flips_left: 0,
            solve_seconds: 0.0,
            peak_memory_bytes: 0,
            levels: levels.as_mut_ptr(),
            level_capacity: levels.len() as u64,
            level_count: 0,
            history: history.as_mut_ptr(),
            history_capacity: history.len() as u64,
            history_count: 0,
        };
        let mut options = self.options();
        let result = with_progress(self.progress.as_mut(), |progress, user| {
            options.progress = progress;
            options.progress_user = user;
            call(|error| optimise(self.hierarchy.as_ptr(), &options, &mut values, &mut report, error))
        });
        let stopped = match result {
            Ok(()) => None,
            Err(error) if error.status().is_stopped() && report.values_written != 0 => Some(error),
            Err(error) => return Err(error),
        };
        Ok(Solution {
            foliation: Foliation::new(self.hierarchy.clone(), level, values),
            report: Report::from_raw(&report, &levels, &history),
            stopped,
        })
    }

    fn options(&self) -> sys::hmf_solve_options {
        sys::hmf_solve_options {
            struct_size: size_of::<sys::hmf_solve_options>() as u32,
            method: match self.method {
                Method::Newton => sys::HMF_METHOD_NEWTON,
                Method::Whitehead => sys::HMF_METHOD_WHITEHEAD,
                Method::SingleLevel => sys::HMF_METHOD_SINGLE_LEVEL,
            },
            tolerance: self.tolerance,
            time_limit: self.time_limit.as_secs_f64(),
            iteration_limit: self.iteration_limit,
            stop_level: self.stop_level as u64,
            progress: None,
            progress_user: std::ptr::null_mut(),
            initial_values: self.start.map_or(std::ptr::null(), |start| start.values().as_ptr()),
            initial_count: self.start.map_or(0, |start| start.values().len() as u64),
            initial_level: self.start.map_or(0, |start| start.level() as u64),
        }
    }
}

impl fmt::Debug for Solver<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Solver")
            .field("hierarchy", &self.hierarchy)
            .field("loops", &self.loops)
            .field("start", &self.start.map(Foliation::level))
            .field("method", &self.method)
            .field("tolerance", &self.tolerance)
            .field("time_limit", &self.time_limit)
            .field("iteration_limit", &self.iteration_limit)
            .field("stop_level", &self.stop_level)
            .finish_non_exhaustive()
    }
}

/// What a run gives.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solution {
    /// Closed and without poles, even if the optimisation was stopped.
    pub foliation: Foliation,
    /// How the run went.
    pub report: Report,
    /// Why the optimisation was stopped before it converged: a limit
    /// (`Status::LIMIT_*`) or [`Status::CANCELLED`]. `None`: it converged.
    pub stopped: Option<Error>,
}

impl Solution {
    /// [`Status::OK`], or that of [`stopped`](Solution::stopped).
    pub fn status(&self) -> Status {
        self.stopped.as_ref().map_or(Status::OK, Error::status)
    }
}

/// How a run went.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// The method that ran.
    pub method: Method,
    /// Whether the tolerance was reached.
    pub converged: bool,
    /// Energy of the result, on the finest level solved; on level 0 on the intrinsic
    /// triangulation, before the values are carried to your edges.
    pub energy: f64,
    /// Largest residual of a vertex, as in [`Foliation::residuals`].
    pub residual_max: f64,
    /// Mean residual.
    pub residual_mean: f64,
    /// Poles of the result, as in [`Foliation::singularities`].
    pub poles: u64,
    /// Zeros of the result, each as often as its order.
    pub zeros: u64,
    /// Sum of all indices, 4 - 4 genus.
    pub index_sum: i64,
    /// Flips that would have made a pole.
    pub bad_flips: u64,
    /// Flips that did.
    pub bad_flips_left: u64,
    /// Time of the call.
    pub solve_time: Duration,
    /// Most memory of the call, without the hierarchy.
    pub peak_memory_bytes: u64,
    /// The levels that were used, finest first.
    pub levels: Vec<LevelReport>,
    /// Events in order of time, the first [`Solver::history_capacity`].
    pub history: Vec<HistoryEntry>,
    /// Number of events, also of those that `history` has no room for.
    pub history_count: u64,
}

/// How a run went on one level.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LevelReport {
    /// Vertices.
    pub vertices: u64,
    /// Edges.
    pub edges: u64,
    /// Edges with a raised weight.
    pub non_delaunay: u64,
    /// Sweeps of Whitehead moves.
    pub iterations: u64,
    /// Linear systems.
    pub linear_solves: u64,
    /// Time of the optimisation.
    pub optimize_time: Duration,
    /// Time of the way from the next coarser level to this one.
    pub interpolate_time: Duration,
}

/// What an entry of the history comes after.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum HistoryKind {
    /// The way from the next coarser level.
    Interpolation,
    /// A sweep of Whitehead moves.
    Sweep,
    /// A linear system.
    LinearSolve,
}

/// One line of the history.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct HistoryEntry {
    /// Since the start of the call.
    pub time: Duration,
    /// Energy on the level.
    pub energy: f64,
    /// Largest residual, where it was evaluated.
    pub residual_max: Option<f64>,
    /// The level.
    pub level: usize,
    /// What came before.
    pub kind: HistoryKind,
}

const NO_LEVEL: sys::hmf_level_report = sys::hmf_level_report {
    vertices: 0,
    edges: 0,
    nld: 0,
    iterations: 0,
    linear_solves: 0,
    optimize_seconds: 0.0,
    interpolate_seconds: 0.0,
};

const NO_ENTRY: sys::hmf_history_entry =
    sys::hmf_history_entry { seconds: 0.0, energy: 0.0, residual_max: 0.0, level: 0, kind: 0 };

/// Seconds of a clock; never negative, but a panic here would be worse than a zero.
fn duration(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

impl Report {
    fn from_raw(raw: &sys::hmf_report, levels: &[sys::hmf_level_report], history: &[sys::hmf_history_entry]) -> Report {
        Report {
            method: match raw.method {
                sys::HMF_METHOD_WHITEHEAD => Method::Whitehead,
                sys::HMF_METHOD_SINGLE_LEVEL => Method::SingleLevel,
                _ => Method::Newton,
            },
            converged: raw.converged != 0,
            energy: raw.energy,
            residual_max: raw.residual_max,
            residual_mean: raw.residual_mean,
            poles: raw.poles,
            zeros: raw.zeros,
            index_sum: raw.index_sum,
            bad_flips: raw.bad_flips,
            bad_flips_left: raw.bad_flips_left,
            solve_time: duration(raw.solve_seconds),
            peak_memory_bytes: raw.peak_memory_bytes,
            levels: written(levels, raw.level_count).map(LevelReport::from_raw).collect(),
            history: written(history, raw.history_count).map(HistoryEntry::from_raw).collect(),
            history_count: raw.history_count,
        }
    }
}

/// The entries that the library has written of `count`.
fn written<T>(entries: &[T], count: u64) -> impl Iterator<Item = &T> {
    entries.iter().take(usize::try_from(count).unwrap_or(usize::MAX))
}

impl LevelReport {
    fn from_raw(raw: &sys::hmf_level_report) -> LevelReport {
        LevelReport {
            vertices: raw.vertices,
            edges: raw.edges,
            non_delaunay: raw.nld,
            iterations: raw.iterations,
            linear_solves: raw.linear_solves,
            optimize_time: duration(raw.optimize_seconds),
            interpolate_time: duration(raw.interpolate_seconds),
        }
    }
}

impl HistoryEntry {
    fn from_raw(raw: &sys::hmf_history_entry) -> HistoryEntry {
        HistoryEntry {
            time: duration(raw.seconds),
            energy: raw.energy,
            residual_max: (raw.residual_max >= 0.0).then_some(raw.residual_max),
            level: raw.level as usize,
            kind: match raw.kind {
                0 => HistoryKind::Interpolation,
                1 => HistoryKind::Sweep,
                _ => HistoryKind::LinearSolve,
            },
        }
    }
}
