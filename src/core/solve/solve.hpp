// From an initial foliation to the harmonic one: the cascade over the levels
// ([W] section 4) with one of the methods on each of them.
#pragma once

#include "../foliation/sweep.hpp"
#include "class_guard.hpp"

namespace hmf {

// A value of an edge while it is solved for.  Sums of two and steps of twice as much
// leave a bit in an int64_t.  What leaves has to fit into a double: coarser_unit.hpp.
constexpr int64_t LARGEST_INNER_VALUE = int64_t{1} << 59;
// The height of a cylinder; leaves are counted in half units.
constexpr int64_t LARGEST_HEIGHT = int64_t{1} << 60;

// Of the residual.
constexpr double DEFAULT_TOLERANCE = 1e-8;

// The options of the caller with their defaults, available in every stage, and options of the library itself.
struct SolveOptions : hmf_solve_options {
    // cppcheck-suppress uninitDerivedMemberVar
    SolveOptions() : hmf_solve_options() {
        method = HMF_METHOD_NEWTON;
        iteration_limit = 100000;
        energy_tolerance = 1e-6;
    }
    size_t stop() const { return static_cast<size_t>(stop_level); }

    int64_t largest_value = int64_t{1} << 51; // up to which the unit may get finer; a double holds the sum of two
};

// Measures of the foliation at the end of a method.
struct Certificate {
    bool known;
    double energy; // in units
    double residual_max, residual_mean;
    bool fractional = false; // with SolveLog::fraction
};

// Collects the report of a solve, its unit, and the measures of the last level.
class SolveLog {
public:
    // wanted: with rows for levels and events; otherwise only the unit is tracked.
    SolveLog(bool wanted, Call& call, double unit) : report{}, wanted_(wanted), call_(call), unit_(unit) {
        levels.start(call.memory);
        history.start(call.memory);
    }
    [[nodiscard]] hmf_status count_levels(size_t n);
    hmf_level_report* level(size_t index); // row of a level, nullptr if not wanted; index 0 = stop level
    Done event(size_t level, uint32_t kind, double energy_units, double residual_max);
    double unit() const { return unit_; }
    void set_unit(double unit) { unit_ = unit; }

    hmf_report report;
    Array<hmf_level_report> levels; // finest first
    Array<hmf_history_entry> history;
    Certificate certificate{}; // of the last level
    Array<double> fraction;    // see fraction.hpp; only where the certificate says so

private:
    bool wanted_;
    Call& call_;
    double unit_;
};

// What a method needs on one level.
struct LevelWork {
    State& state;
    const Level& level;
    const SolveOptions& options;
    Call& call;
    SolveLog& log;
    ClassGuard* guard; // or NULL
    Rings rings;
    Star star;
    Sweeps sweeps;
    hmf_level_report statistics{};
    // Room for both.
    Done prepare();
    // Each step of all vertices needs a certificate.
    bool checks_class() const { return guard && guard->checks == ClassGuard::Checks::steps; }
    // Between two passes over the mesh; false: cancelled or asked to finish.
    Done go_on() { return call.tick(0, true) && !call.finishing(); }
    // Refines the unit until rounding causes at most half of this residual, or as far as options.largest_value allows;
    // false: it stays.
    bool refine_unit(double residual);
    Done record(uint32_t kind, double energy_units, double residual_max) {
        return log.event(state.level, kind, energy_units, residual_max);
    }
};

// Status of a stage that is not Done: out of memory, or cancelled or finishing. The message is written at the end of
// the solve.
inline hmf_status interrupted(Call& call) { return call.memory.failure() ? call.out_of_memory() : HMF_CANCELLED; }

// Methods on one level: HMF_OK when converged to the tolerance, HMF_LIMIT_*,
// HMF_CANCELLED (also for finishing), or a memory error.
[[nodiscard]] hmf_status whitehead_level(LevelWork& work);
[[nodiscard]] hmf_status newton_level(LevelWork& work, double tolerance);

// Cascade from state.level to options.stop_level.  Ends on the intrinsic side
// of level 0.  Result as above; other than memory errors and a plain
// cancellation (call.cancelled()) it always arrives at the stop level.
[[nodiscard]] hmf_status run_cascade(State& state, const SolveOptions& options, Call& call, SolveLog& log,
                                     ClassGuard* guard = nullptr);

} // namespace hmf
