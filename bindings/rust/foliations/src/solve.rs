//! The harmonic foliation of loops, and the report of a run.

use crate::error::{Error, Result, Status};
use crate::foliation::{Class, Foliation};
use crate::hierarchy::{DesignOptions, Hierarchy};
use crate::loops::{Loops, LoopsKind};
use crate::owned::{attempt, slice, Owned};
use crate::progress::{unwatched, Closure, Progress};
use crate::ranges::Refusal;
use crate::records::{codes, options, record, Read};
use foliations_sys as sys;
use std::ptr;
use std::sync::Arc;
use std::time::Duration;

codes! {
    /// How the energy is minimized.
    #[derive(Default)]
    Method: i32 {
        /// Newton steps on the twisted Laplacian, level by level.
        #[default]
        Newton = sys::HMF_METHOD_NEWTON,
        /// Whitehead moves, level by level.
        Whitehead = sys::HMF_METHOD_WHITEHEAD,
        /// Whitehead moves on the input mesh alone.
        SingleLevel = sys::HMF_METHOD_SINGLE_LEVEL,
        /// Whitehead moves, level by level, with flips as printed in the paper: they may leave poles.
        Paper = sys::HMF_METHOD_PAPER,
    }
}

/// Options for solving on a hierarchy; see [`Hierarchy::solver`].
///
/// What is not set has its default.
///
/// ```
/// # include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/support/mesh.rs"));
/// # fn main() -> foliations::Result<()> {
/// # let (positions, triangles) = plate(2, 1, 2, 1);
/// # let hierarchy = foliations::Hierarchy::build(&positions, &triangles)?;
/// use std::time::Duration;
///
/// let loops = hierarchy.loops(0, foliations::LoopsKind::Cut)?.with_weights(&[1.0, 2.5])?;
/// let solution = hierarchy.solver().loops(&loops).time_limit(Duration::from_secs(60)).solve()?;
/// assert_eq!(solution.status(), foliations::Status::OK);
/// assert!(solution.report.residual_max < 1e-8);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
#[must_use = "a solver does nothing until `solve` or `relax` is called"]
pub struct Solver<'a> {
    hierarchy: Hierarchy,
    loops: Option<&'a Loops>,
    kind: Option<LoopsKind>,
    even: bool,
    start: Option<&'a Foliation>,
    options: sys::hmf_solve_options,
    refusal: Refusal,
    progress: Option<Closure<'a>>,
}

impl Hierarchy {
    /// Options for solving on this hierarchy, all at their defaults.
    pub fn solver<'a>(&self) -> Solver<'a> {
        let options = options!(hmf_solve_options method: Method::default() as i32);
        let (refusal, hierarchy) = (Refusal::default(), self.clone());
        Solver { hierarchy, loops: None, kind: None, even: false, start: None, options, refusal, progress: None }
    }
}

impl<'a> Solver<'a> {
    /// The class of the foliation: loops on any level. Default: those of
    /// [`LoopsKind::Cut`](crate::LoopsKind::Cut) on the coarsest level (on level 0
    /// with [`Method::SingleLevel`]), weights 1.
    pub fn loops(mut self, loops: &'a Loops) -> Self {
        self.loops = Some(loops);
        self
    }

    /// Instead of own loops those of the library, of a kind and with weights 1.
    pub fn library_loops(mut self, kind: LoopsKind) -> Self {
        self.kind = Some(kind);
        self
    }

    /// Instead of own loops those of [`Builder::even_design`](crate::Builder::even_design) for the marked vertices of
    /// the hierarchy, with their weights.
    pub fn even_loops(mut self) -> Self {
        self.even = true;
        self
    }

    /// A foliation to start from instead of loops; the class is its class. It may be
    /// of another hierarchy with the same triangles at other positions, as the last
    /// frame of an animation. Only for [`solve`](Solver::solve).
    ///
    /// It is restricted to the coarsest level and solved from there, which takes as long as from loops. Where it is
    /// close to the minimum, as after a small deformation, [`relax`](Solver::relax) of
    /// [`Hierarchy::foliation`] with its values takes 0.4 to 0.8 of that.
    pub fn start(mut self, foliation: &'a Foliation) -> Self {
        self.start = Some(foliation);
        self
    }

    /// How the energy is minimized. Default: [`Method::Newton`].
    pub fn method(mut self, method: Method) -> Self {
        self.options.method = method as i32;
        self
    }

    /// The largest residual to reach, up to which a result counts as converged. Default:
    /// 1e-8; the other methods than [`Method::Newton`] stop by
    /// [`energy_tolerance`](Self::energy_tolerance) if none is given.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.refusal.check("tolerance", tolerance, "(0, 1)");
        self.options.tolerance = tolerance;
        self
    }

    /// Other methods than [`Method::Newton`]: sweeps end when one lowers the energy by
    /// less than this part of it. Default: 1e-6. It says nothing of the residual.
    pub fn energy_tolerance(mut self, tolerance: f64) -> Self {
        self.refusal.check("energy_tolerance", tolerance, "(0, 1)");
        self.options.energy_tolerance = tolerance;
        self
    }

    /// After this time the best foliation so far is the result. Default: no limit.
    pub fn time_limit(mut self, limit: Duration) -> Self {
        // For the library 0 is no limit.
        self.options.time_limit = limit.as_secs_f64().max(1e-9);
        self
    }

    /// Most sweeps on each level. Default: 100 000.
    pub fn iteration_limit(mut self, sweeps: u64) -> Self {
        self.refusal.check("iteration_limit", sweeps as f64, "[1, inf)");
        self.options.iteration_limit = sweeps;
        self
    }

    /// Most steps of [`Method::Newton`] on the finest level, each of them one linear solve or
    /// a few. Unlike [`time_limit`](Solver::time_limit) the same result on every machine.
    /// Default: as many as it takes.
    pub fn step_limit(mut self, steps: u64) -> Self {
        self.refusal.check("step_limit", steps as f64, "[1, inf)");
        self.options.step_limit = steps;
        self
    }

    /// The finest level to solve. Default: 0, the input mesh. [`Hierarchy::coarsest_level`] gives a preview: energy
    /// and values of the coarsest level.
    pub fn stop_level(mut self, level: usize) -> Self {
        self.options.stop_level = level as u64;
        self
    }

    /// A closure that is called on this thread with a fraction rising from 0 to
    /// 1, and that may end the call. If it panics, the call is cancelled and the
    /// panic continues.
    pub fn progress<R: Into<Progress>>(mut self, closure: impl FnMut(f64) -> R + 'a) -> Self {
        self.progress = Closure::new(closure);
        self
    }

    /// The harmonic foliation in the class of the loops.
    ///
    /// If a limit or the progress closure ended the optimization and there is a
    /// foliation, it is the result, closed and without poles;
    /// [`Solution::stopped`] tells why.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`] if there is no foliation yet, or a status of the
    /// classes 100, 200, 400.
    pub fn solve(&mut self) -> Result<Solution> {
        self.refusal.result()?;
        let made = match self.kind {
            _ if self.even && self.loops.is_none() && self.start.is_none() => Some(self.even_design()?),
            Some(kind) if self.loops.is_none() && self.start.is_none() => {
                // They are found fastest on the coarsest level.
                let single = self.options.method == Method::SingleLevel as i32;
                let fine = single || self.hierarchy.boundary_count() > 0;
                let level = if fine { 0 } else { self.hierarchy.level_count() - 1 };
                Some(self.hierarchy.loops(level, kind)?)
            }
            _ => None,
        };
        let set = self.loops.or(made.as_ref()).map(Loops::as_raw);
        let set = set.as_ref().map_or(ptr::null(), ptr::from_ref);
        let options =
            sys::hmf_solve_options { start: self.start.map_or(ptr::null(), Foliation::as_ptr), ..self.options };
        let hierarchy = self.hierarchy.as_ptr();
        let solved = Closure::watch(&mut self.progress, || {
            // SAFETY: the handles are valid, and `self` borrows loops and start.
            attempt(|out, control, error| unsafe {
                if set.is_null() && options.start.is_null() {
                    sys::hmf_solve_cut_system(hierarchy, &options, control, out, error)
                } else {
                    sys::hmf_solve(hierarchy, set, &options, control, out, error)
                }
            })
        });
        let class = match (self.start, self.loops, self.kind) {
            (Some(start), ..) => start.class(),
            (_, Some(loops), _) => Class::Loops(Arc::new(loops.clone())),
            _ if self.even => Class::Loops(Arc::new(made.expect("the loops of the design"))),
            (.., kind) => Class::Kind(kind.unwrap_or_default()),
        };
        self.solution(solved, class)
    }

    fn even_design(&self) -> Result<Loops> {
        let (marks, options) =
            (self.hierarchy.marked_vertices(), DesignOptions { no_poles: true, ..Default::default() });
        let (positions, triangles) = (self.hierarchy.positions(0)?, self.hierarchy.triangle_vertices(0)?);
        let design = Hierarchy::builder().marked_vertices(marks).even_design(&positions, &triangles, options)?;
        Ok(design.loops)
    }

    /// Optimizes a foliation on its level alone, for values near the minimum; otherwise as [`solve`](Solver::solve).
    /// Loops, `start` and `stop_level` are not used.
    ///
    /// # Errors
    ///
    /// [`Status::CANCELLED`] if there is no foliation yet, [`Status::ERROR_OPTIONS`] if
    /// the foliation is of another hierarchy, [`Status::ERROR_VALUE_POLE`], classes
    /// 100 and 200.
    pub fn relax(&mut self, foliation: &Foliation) -> Result<Solution> {
        self.refusal.result()?;
        if foliation.hierarchy().as_ptr() != self.hierarchy.as_ptr() {
            let message = "The foliation is of another hierarchy. Take the solver of foliation.hierarchy().";
            return Err(Error::new(Status::ERROR_OPTIONS, message.into()));
        }
        let options = sys::hmf_solve_options { stop_level: 0, ..self.options };
        let start = foliation.as_ptr();
        let made = Closure::watch(&mut self.progress, || {
            // SAFETY: the handle is valid.
            attempt(|out, control, error| unsafe { sys::hmf_relax(start, &options, control, out, error) })
        });
        self.solution(made, foliation.class())
    }

    fn solution(
        &self,
        (result, made): (Result<()>, Option<Owned<sys::hmf_foliation>>),
        class: Class,
    ) -> Result<Solution> {
        let stopped = match (result, &made) {
            (Ok(()), _) => None,
            (Err(error), Some(_)) if error.status().is_stopped() => Some(error),
            (Err(error), _) => return Err(error),
        };
        let defect = || Error::new(Status::ERROR_INTERNAL, "The library gave no foliation with a report.".into());
        let foliation = Foliation::new(&self.hierarchy, made.ok_or_else(defect)?).of_class(class);
        let report = foliation.report().ok_or_else(defect)?;
        Ok(Solution { foliation, report, stopped })
    }
}

/// What a run gives.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solution {
    /// Closed and without poles, even if the optimization was stopped.
    pub foliation: Foliation,
    /// How the run went.
    pub report: Report,
    /// Why the optimization was stopped before it converged: a limit
    /// (`Status::LIMIT_*`) or [`Status::CANCELLED`]. `None`: it converged.
    pub stopped: Option<Error>,
}

impl Solution {
    /// [`Status::OK`], or that of [`stopped`](Solution::stopped).
    pub fn status(&self) -> Status {
        self.stopped.as_ref().map_or(Status::OK, Error::status)
    }
}

record! {
    /// How a run went.
    Report from hmf_report {
        /// The method that ran.
        method: Method,
        /// Whether the tolerance was reached.
        converged: bool,
        /// Energy of the result, on the finest level solved; on level 0 on the intrinsic
        /// triangulation, before the values are carried to your edges.
        energy: f64,
        /// Largest residual of a vertex, as in [`Foliation::residuals`]; negative where it was
        /// not evaluated, as the call was cancelled before.
        residual_max: f64,
        /// Mean residual.
        residual_mean: f64,
        /// Poles of the result, as in [`Foliation::singularities`].
        poles: u64,
        /// Zeros of the result, counted with their orders; with boundary those of the surface.
        zeros: u64,
        /// Sum of all indices, 4 - 4 genus - marked vertices; with boundary the sum over the surface.
        index_sum: i64,
        /// Closed curves that the boundary of the surface consists of.
        boundaries: usize = |_: &sys::hmf_report| 0,
        /// Flips that would have made a pole.
        bad_flips: u64,
        /// Flips that did.
        bad_flips_left: u64,
        /// Time of the call.
        solve_seconds: f64,
        /// Most memory of the call, without the hierarchy.
        peak_memory_bytes: u64,
        /// The levels that were used, finest first.
        levels: Vec<LevelReport> = |raw: &sys::hmf_report| {
            // SAFETY: there are so many, and they live as long as `raw`.
            unsafe { slice(raw.levels, raw.level_count) }.iter().map(Read::read).collect()
        },
        /// Events in order of time.
        history: Vec<HistoryEntry> = |raw: &sys::hmf_report| {
            // SAFETY: as above.
            unsafe { slice(raw.history, raw.history_count) }.iter().map(Read::read).collect()
        },
        /// Whether the values belong to the loops.
        class_state: ClassState,
        /// Levels that were solved once more, as the first result had left the class.
        class_repeats: u32,
        /// Time for the certificate of the class, part of `solve_seconds`.
        class_seconds: f64,
    }
}

codes! {
    /// What is known of the class of a result.
    ///
    /// Proven, exactly and from the integers of the result alone: one cylinder of closed
    /// leaves for each loop, as high as the weight of the loop, and freely homotopic to it.
    ClassState: i32 {
        /// Not checked: `relax`, a cancelled call, or a start with values that belong to no loops.
        Unknown = sys::HMF_CLASS_UNKNOWN,
        /// The values belong to the loops.
        Proven = sys::HMF_CLASS_PROVEN,
        /// They do not; never with [`Status::OK`].
        Lost = sys::HMF_CLASS_LOST,
    }
}

record! {
    /// How a run went on one level.
    #[derive(Copy)]
    LevelReport from hmf_level_report {
        /// Vertices.
        vertex_count: u64,
        /// Edges.
        edge_count: u64,
        /// Edges with a raised weight.
        raised_count: u64,
        /// Sweeps of Whitehead moves.
        sweep_count: u64,
        /// Linear systems.
        linear_solve_count: u64,
        /// Time of the optimization.
        optimize_seconds: f64,
        /// Time of the way from the next coarser level to this one.
        interpolate_seconds: f64,
    }
}

codes! {
    /// What an entry of the history comes after.
    HistoryKind: u32 {
        /// The way from the next coarser level.
        Interpolation = sys::HMF_HISTORY_INTERPOLATION as u32,
        /// A sweep of Whitehead moves.
        Sweep = sys::HMF_HISTORY_SWEEP as u32,
        /// A linear system.
        LinearSolve = sys::HMF_HISTORY_LINEAR_SOLVE as u32,
    }
}

record! {
    /// One line of the history.
    #[derive(Copy)]
    HistoryEntry from hmf_history_entry {
        /// Since the start of the call.
        seconds: f64,
        /// Energy on the level.
        energy: f64,
        /// Largest residual, where it was evaluated.
        residual_max: Option<f64>,
        /// The level.
        level: usize,
        /// What came before.
        kind: HistoryKind,
    }
}

impl Foliation {
    /// How the run went that made it; `None` where neither `solve` nor `relax` did.
    pub fn report(&self) -> Option<Report> {
        // SAFETY: the report, where there is one, lives as long as the foliation.
        let mut report: Report = unsafe { sys::hmf_foliation_report(self.as_ptr()).as_ref() }?.read();
        report.boundaries = self.hierarchy().boundary_count();
        if report.boundaries > 0 {
            // The library counts on the closed double.
            if let Ok(found) = unwatched(|| self.singularities()) {
                let indices = || found.list().iter().map(|one| i64::from(one.index));
                report.zeros = indices().filter(|&index| index < 0).map(i64::unsigned_abs).sum();
                report.poles = indices().filter(|&index| index > 0).map(i64::unsigned_abs).sum();
                report.index_sum = indices().sum();
            }
        }
        Some(report)
    }
}
