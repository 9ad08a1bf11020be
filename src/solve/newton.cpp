// The direct method: Newton steps on the twisted Laplacian, globalised by
// Whitehead moves.
//
// One round on a level:
//   1. sweeps of Whitehead moves: singularities walk, clusters open
//   2. the quadratic model of the signs as they are (twisted_model.hpp),
//      solved by conjugate gradients with signed multigrid: loosely as long as
//      zeros move.  Once the vertices that come to a bound rest there, they
//      are held, and the same solve goes on to the end
//   3. the solution, brought into its bounds, is rounded and applied to all
//      vertices at once; extrema that rounding or a loose solve left are
//      settled; kept if every zero is where it was or at the branch point of
//      its triangle (so the class is kept) and the energy falls; else the
//      place where it fails is held fast, or the whole step is halved
//   4. moves near the singularities, where the model is not smooth
// Where the residual is large in a part of the mesh only, 2 and 3 are done for the unknowns there (part_system.hpp).
// Far from the singularities one round is exact, so a few rounds reach the
// minimum.  The certificate is the residual of [W] Eq. 4 at every vertex.
#include "fraction.hpp"
#include "part_system.hpp"
#include "signed_multigrid.hpp"
#include "solve.hpp"
#include "steering.hpp"
#include "twisted_model.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// How well to solve for a step.
struct Effort {
    double loose;    // relative tolerance of a solve after which zeros move
    double tight;    // and of one where they hardly do
    double residual; // of [W] Eq. 4, with which any solve may stop; 0: none
    bool go_on;      // to a tight solve, where the zeros stay
    bool close;      // near the minimum: more effort for a whole step pays
    bool part;       // only what Newton::is_in_part has picked moves
};

class Newton {
public:
    // smooth_only: a few digits of the short waves are enough for the linear solves.
    Newton(LevelWork& work, bool smooth_only) :
        w_(work), f_(work.state.foliation), weight_(work.level.weight), smooth_only_(smooth_only) {}

    Done allocate() {
        Memory& memory = w_.call.memory;
        const Mesh& mesh = f_.mesh;
        const size_t n = mesh.vertex_count;
        patch_.start(memory);
        picked_.start(memory);
        suspect_.start(memory);
        return model_.allocate(mesh, memory, w_.call.parallel) && backup_.allocate(memory, mesh.edge_count)
            && step_.allocate(memory, n) && expected_.allocate(memory, n) && unbounded_.allocate(memory, n)
            && distance_.allocate(memory, n) && patch_.reserve(n) && picked_.reserve(n + size_t{1})
            && suspect_.reserve(n);
    }

    // Signs, energy and residual of the foliation as it is.
    Done look() { return model_.look(f_, w_.rings, weight_, w_.star, w_.call); }
    const TwistedModel& model() const { return model_; }

    // The zeros that the last look has seen.
    Done hand_over(ZeroList& zeros) {
        zeros.vertices.clear();
        zeros.tripods.clear();
        for (uint32_t v : model_.resting)
            if (!zeros.vertices.push(v)) return false;
        for (uint32_t h : model_.tripod)
            if (!zeros.tripods.push(h)) return false;
        return zeros.known = true;
    }

    void sweeps(uint32_t n) {
        for (uint32_t i = 0; i < n && go_on(); ++i) {
            SweepResult result;
            w_.sweeps.sweep(f_, w_.rings, weight_, backward_, w_.star, result, w_.call, 0);
            backward_ = !backward_;
            ++w_.statistics.iterations;
        }
    }

    // HMF_OK, or memory, or HMF_CANCELLED.  accepted: the share of the step that
    // was taken, 0 if none would do.  tight: it was solved for tightly.
    hmf_status step(const Effort& effort, double& accepted, bool& tight) {
        accepted = 0;
        w_.call.parallel.copy(backup_.data(), f_.value, f_.mesh.edge_count);
        const hmf_status status = try_step(effort, accepted, tight);
        if (accepted == 0) restore();
        return status;
    }

    // Between two passes over the mesh; false: cancelled or asked to finish.
    Done go_on() { return w_.call.tick(0, true) && !w_.call.finishing(); }

    // Moves at the vertices within some rings of the zeros.
    void relax_after_step(bool far) {
        pick_near_zeros(far ? steering::far_rings : steering::near_rings);
        const size_t n = f_.mesh.vertex_count, most = size_t{steering::moves_per_vertex} * n / (picked_.size() + 1);
        const size_t wanted = far ? steering::far_passes : steering::near_passes;
        // Not on a double, where what fades along a strip is found by these moves (tests/test_weight_search.cpp).
        zeros_everywhere_ = !w_.state.hierarchy->is_double()
                         && static_cast<double>(picked_.size()) > steering::everywhere * static_cast<double>(n);
        const size_t passes = zeros_everywhere_ ? steering::least_passes
                                                : std::min(wanted, std::max(size_t{steering::least_passes}, most));
        // The last pass in which a vertex has a reason to move; NONE: not picked.
        Array<uint32_t>& due = distance_;
        for (uint32_t v : picked_) due[v] = 0;
        const double at_rest = steering::share_at_rest * model_.residual_max;
        for (uint32_t pass = 0; pass < passes && go_on(); ++pass)
            for (size_t i = 0; i < picked_.size(); ++i) {
                const uint32_t v = picked_[pass % 2 ? picked_.size() - 1 - i : i];
                if (due[v] < pass) continue;
                SweepResult result;
                if (!relax_vertex(f_, w_.rings, weight_, v, w_.star, result) || result.largest <= at_rest) continue;
                due[v] = pass + 1;
                for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t) {
                    uint32_t& neighbour = due[w_.rings.neighbour[t]];
                    if (neighbour != NONE) neighbour = pass + 1;
                }
            }
    }

    // Most vertices are near a zero; as of the last relax_after_step.
    bool zeros_are_everywhere() const { return zeros_everywhere_; }
    // The last step came to none of its bounds: the model was that of the minimum, and what is left is the solve's error.
    bool was_within_bounds() const { return bounds_met_ == 0; }
    // The first solution of the last step, brought into its bounds, made extrema: values on limbs were wrong in front.
    bool limbs_were_wrong() const { return limbs_were_wrong_; }

    // Picks the vertices with a residual above this in the last look, those near zeros, and some rings round all of
    // them, for a step of the part; false: they are more than this share of all.
    bool is_in_part(double residual, double share) {
        pick_near_zeros(0);
        for (uint32_t v = 0; v < model_.count; ++v)
            if (distance_[v] == NONE && !model_.rests[v]
                && std::fabs(model_.right[v]) * static_cast<double>(model_.row_scale[v]) > residual) {
                distance_[v] = 0;
                picked_.add(v);
            }
        const size_t most = static_cast<size_t>(share * model_.count);
        if (picked_.size() > most) return false;
        grow_picked(steering::part_rings);
        return picked_.size() <= most;
    }

private:
    // The vertices within some rings of the zeros of the last look, nearest first, with their distances.
    void pick_near_zeros(uint32_t rings_around) {
        const Mesh& mesh = f_.mesh;
        picked_.clear();
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) distance_[v] = NONE;
        const auto add = [&](uint32_t v, uint32_t ring) {
            if (distance_[v] != NONE) return;
            distance_[v] = ring;
            picked_.add(v);
        };
        // Every zero is where it was before the step, or at a vertex next to that.
        for (uint32_t v : model_.resting) add(v, 0);
        for (uint32_t h : model_.tripod) {
            const uint32_t corners[3] = {h, mesh.next[h], mesh.prev(h)};
            for (uint32_t g : corners) add(mesh.origin[g], 0);
        }
        grow_picked(rings_around);
    }

    // By so many rings.
    void grow_picked(uint32_t rings_around) {
        for (size_t i = 0; i < picked_.size(); ++i) {
            const uint32_t v = picked_[i];
            if (distance_[v] == rings_around) continue;
            for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t) {
                const uint32_t u = w_.rings.neighbour[t];
                if (distance_[u] != NONE) continue;
                distance_[u] = distance_[v] + 1;
                picked_.add(u);
            }
        }
    }

    void restore() { w_.call.parallel.copy(f_.value, backup_.data(), f_.mesh.edge_count); }

    // Solves the model and sets the values of the whole step; false: see interrupted().
    Done propose(const Effort& effort, bool& tight) {
        model_.assemble(f_, w_.rings, weight_, w_.call);
        if (!go_on()) return false;
        part_step_ = effort.part;
        if (part_step_) {
            multigrid_.release_vectors();
            if (!part_.take(model_, distance_, w_.call)) return false;
        } else {
            ++w_.statistics.linear_solves;
        }
        tight = model_.is_exact();
        // On limbs that no loop goes round the values decay below the error of
        // a loose solve: then it is continued, as long as there are fewer extrema for it.
        const uint64_t few_extrema = w_.state.hierarchy->is_double() ? steering::few_extrema_on_double : 0;
        uint64_t had = UINT64_MAX;
        for (double accuracy = tight ? effort.tight : effort.loose;; accuracy *= steering::continued) {
            if (!solve_linear(accuracy, effort.residual)) return false;
            if (had != UINT64_MAX) restore(); // else they are there
            std::memcpy(unbounded_.data(), model_.d.data(), model_.count * sizeof(double));
            set_bounded_values();
            if (!go_on()) return false;
            if (effort.go_on && !model_.is_exact() && (tight || zeros_stay())) {
                if (!tight) accuracy = effort.tight;
                tight = true;
                restore();
                if (!solve_between_bounds(accuracy, effort.residual)) return false;
                set_values(1);
            }
            if (!go_on()) return false;
            uint64_t extrema = find_suspects();
            if (had == UINT64_MAX) limbs_were_wrong_ = extrema > few_extrema;
            if (extrema > few_extrema && !tight) {
                // What came to rest at its bound bounds its neighbours: now from the beginning.
                restore();
                std::memcpy(model_.d.data(), unbounded_.data(), model_.count * sizeof(double));
                set_bounded_values();
                extrema = find_suspects();
            }
            if (extrema <= few_extrema || extrema >= had || accuracy < steering::end_of_doubles) return true;
            had = extrema;
            if (smooth_only_) multigrid_ready_ = smooth_only_ = false;
            std::memcpy(model_.d.data(), unbounded_.data(), model_.count * sizeof(double));
        }
    }

    void set_bounded_values() {
        bounds_met_ = model_.project(f_, w_.rings, patch_, distance_);
        set_values(1);
    }

    // For tests of the guard: the step so many times, within its bounds.
    void lengthen(double factor) {
        for (uint32_t v = 0; v < f_.mesh.vertex_count; ++v) {
            double& d = model_.d[v];
            d *= factor;
            if (d < static_cast<double>(model_.lower[v])) d = static_cast<double>(model_.lower[v]);
            if (d > static_cast<double>(model_.upper[v])) d = static_cast<double>(model_.upper[v]);
        }
        set_values(1);
        find_suspects();
    }

    // Leaves the values changed where it is not accepted.
    hmf_status try_step(const Effort& effort, double& accepted, bool& tight) {
        if (!propose(effort, tight)) return interrupted(w_.call);
        // Where the step went too far, and wherever else it made extrema or moved zeros, the
        // neighbourhood stays as it is.  If the energy rises, the bounds hold back too much: the others
        // are solved for once more.  If nothing helps, all take a shorter step.
        double factor = 1;
        uint32_t radius = steering::first_rings_held, solves = 0;
        const bool unchecked = w_.options.unchecked > 0 && !w_.gated;
        if (unchecked) lengthen(w_.options.unchecked);
        for (uint32_t attempt = 0; attempt < steering::attempts && factor > steering::least_factor; ++attempt) {
            too_far_ = NONE;
            if (attempt > 0) {
                bounds_met_ = UINT64_MAX; // some are held
                set_values(factor);
                if (!go_on()) return interrupted(w_.call);
                find_suspects();
            }
            list_unsound();
            const bool sound = settle(factor) && (unchecked || zeros_are_in_place());
            if (!go_on()) return interrupted(w_.call);
            if (sound) energy_change_ = energy_change();
            if (sound && (unchecked || energy_change_ <= steering::rounding_of_energy * model_.energy)) {
                bool kept = true;
                if (w_.gated) {
                    if (const hmf_status status = w_.watch->look(w_.state, w_.recorder.unit(), w_.call)) return status;
                    kept = w_.watch->holds();
                }
                if (kept) {
                    accepted = factor;
                    return HMF_OK;
                }
                restore();
                bool held = false;
                if (!hold_overturned(held)) return w_.call.out_of_memory();
                if (!held) factor *= 0.5;
                continue;
            }
            restore();
            if (!tight && effort.close) {
                // The error of the solve may be what went wrong.
                tight = true;
                if (!solve_linear(effort.tight, effort.residual)) return interrupted(w_.call);
                model_.project(f_, w_.rings, patch_, distance_);
            } else if (sound && !part_step_ && solves < steering::solves_of_a_step
                       && (effort.close || energy_change_ < steering::curable_rise * model_.energy)) {
                ++solves;
                ++w_.statistics.linear_solves;
                // Far from the minimum this model does not last, and the setup is for one without these bounds.
                const double accuracy = effort.close ? effort.tight : steering::first_accuracy;
                if (!solve_between_bounds(accuracy, effort.residual)) return interrupted(w_.call);
            } else if (too_far_ != NONE && attempt < steering::mending_attempts) {
                if ((attempt + 1) % steering::widen_every == 0) ++radius;
                // Where the certificate judges, zeros may move: there one place at a time is held.
                if (w_.gated || unchecked) picked_.clear();
                picked_.add(too_far_);
                model_.freeze(f_, w_.rings, picked_, radius, patch_, distance_);
            } else {
                factor *= 0.5;
            }
        }
        return HMF_OK;
    }

    // The values before the step are back, the step is not.  A step keeps the class if
    // each vertex has in each of its directions an edge that the step does not
    // reverse: the others stay where they are from now on.  any: there are some, and not too many.
    Done hold_overturned(bool& any) {
        const auto reversed = [&](uint32_t h) {
            const uint32_t e = edge_of(h);
            return backup_[e] - model_.sign[2 * e] * step_[f_.mesh.origin[2 * e]]
                     - model_.sign[2 * e + 1] * step_[f_.mesh.origin[2 * e + 1]]
                 < 0;
        };
        Array<uint32_t> held;
        held.start(w_.call.memory);
        for (uint32_t v = 0; v < f_.mesh.vertex_count && held.size() < steering::most_overturned; ++v) {
            const Rings::Side* side = &w_.rings.side[w_.rings.offset[v]];
            const uint32_t degree = w_.rings.offset[v + 1] - w_.rings.offset[v];
            // Runs between closed corners; the first one goes on at the end.
            uint32_t closed = 0;
            bool here = false, first = false, overturned = false;
            for (uint32_t t = 0; t < degree; ++t) {
                const uint32_t h = side[t].half_edge;
                if (f_.at(h) != 0) here |= !reversed(h);
                if (f_.corner2(h) != 0 || f_.at(h) == 0) continue;
                if (closed++ == 0) first = here;
                else overturned |= !here;
                here = false;
            }
            if (closed > 0) overturned |= !(here || first);
            if (overturned && !held.push(v)) return false;
        }
        any = !held.empty() && held.size() < steering::most_overturned;
        if (!any) return true;
        model_.freeze(f_, w_.rings, held, 1, patch_, distance_);
        return true;
    }

    LinearOptions stop_at(double residual) const {
        LinearOptions options;
        options.unchecked = true; // the next look tells what a step is worth
        if (residual > 0) options.row_scale = model_.row_scale.data();
        options.row_tolerance = residual;
        return options;
    }

    // So many rows that the old setup would be found to be too slow.
    bool has_changed_much() const {
        const size_t rows = w_.call.parallel.sum_blocks<size_t>(model_.count, [&](size_t begin, size_t end) {
            size_t sum = 0;
            for (size_t v = begin; v < end; ++v) sum += model_.changed[v];
            return sum;
        });
        return static_cast<double>(rows) > steering::changed_share * static_cast<double>(model_.count);
    }

    // Continues from model_.d.  The matrix of a level changes by signs near the
    // zeros only: one setup serves for all its steps unless iterations tell otherwise.
    Done solve_linear(double accuracy, double residual) {
        if (part_step_) return part_.solve(model_, accuracy, w_.call);
        part_.release(); // which may have been most of the mesh
        const SignedMatrix matrix = model_.matrix();
        LinearOptions options = stop_at(residual);
        if (multigrid_ready_ && !has_changed_much()) {
            options.hopeless_ends = true;
            if (!multigrid_.claim_vectors(w_.call.memory)) return false;
            multigrid_.refresh(matrix, model_.changed.data(), w_.call.parallel);
            model_.forget_changes(w_.call.parallel);
            const LinearResult result = multigrid_.solve(matrix, model_.right.data(), model_.d.data(), accuracy,
                                                         steering::iterations_with_old_setup, w_.call, options);
            if (w_.call.cancelled() || w_.call.finishing()) return false;
            if (result.converged) return true;
            options.hopeless_ends = false;
        }
        multigrid_ready_ = false;
        if (!multigrid_.setup(matrix, w_.call.memory, &w_.call, smooth_only_ ? 1 : SignedMultigrid::max_levels))
            return false;
        multigrid_ready_ = true;
        model_.forget_changes(w_.call.parallel);
        multigrid_.solve(matrix, model_.right.data(), model_.d.data(), accuracy,
                         smooth_only_ ? steering::iterations_with_smoother : steering::iterations_with_new_setup,
                         w_.call, options);
        return !w_.call.cancelled() && !w_.call.finishing();
    }

    // The unknowns at a bound keep their value, the others are solved for.
    Done solve_between_bounds(double accuracy, double residual) {
        for (uint32_t pass = 0; pass < steering::passes_between_bounds; ++pass) {
            model_.fix_active();
            LinearOptions options = stop_at(residual);
            options.fixed = model_.fixed.data();
            options.fixed_count = model_.fixed.size();
            const LinearResult result =
                multigrid_.solve(model_.matrix(), model_.right.data(), model_.d.data(), accuracy,
                                 steering::iterations_between_bounds, w_.call, options);
            w_.statistics.linear_solves += pass > 0 && result.iterations > 0;
            if (w_.call.cancelled() || w_.call.finishing()) return false;
            const bool released = model_.release();
            if (model_.project(f_, w_.rings, patch_, distance_) == 0 && !released) break;
        }
        return true;
    }

    // After a step: do the vertices that came to a bound rest there?  Then the
    // model lasts.  Else they go on past it in the next step.
    bool zeros_stay() {
        model_.fix_active();
        for (uint32_t v : model_.fixed)
            if (residual_at(f_, w_.rings, weight_, v, 0, w_.star) > steering::resting_share) return false;
        return true;
    }

    // Bounds are integers, so rounding does not leave them; those that a double does not hold are looked up.
    int64_t rounded(uint32_t k, double factor) const {
        const double x = model_.d[k] * factor;
        if (!(x > -largest_step && x < largest_step)) return 0;
        if (factor == 1 && model_.at_bound(k)) return model_.bound_at(k);
        return static_cast<int64_t>(x < 0 ? x - 0.5 : x + 0.5);
    }

    void set_value(const Mesh& mesh, uint32_t e) {
        const uint32_t h = 2 * e;
        const int64_t x =
            backup_[e] - model_.sign[h] * step_[mesh.origin[h]] - model_.sign[h + 1] * step_[mesh.origin[h + 1]];
        f_.value[e] = x < 0 ? -x : x;
    }

    void set_values(double factor) {
        const Mesh& mesh = f_.mesh;
        w_.call.parallel.for_blocks(mesh.vertex_count, [&](size_t begin, size_t end) {
            for (size_t v = begin; v < end; ++v) step_[v] = rounded(static_cast<uint32_t>(v), factor);
        });
        w_.call.parallel.for_blocks(mesh.edge_count, [&](size_t begin, size_t end) {
            for (size_t e = begin; e < end; ++e) set_value(mesh, static_cast<uint32_t>(e));
        });
    }

    // From the backup to the values, without the cancellation of two energies.
    double energy_change() const {
        return w_.call.parallel.sum_blocks<double>(f_.mesh.edge_count, [&](size_t begin, size_t end) {
            double sum = 0;
            for (size_t e = begin; e < end; ++e) {
                const double change = static_cast<double>(f_.value[e] - backup_[e]);
                sum += weight_[e] * change * static_cast<double>(f_.value[e] + backup_[e]);
            }
            return sum;
        });
    }

    // As walk_plain_star; NONE also where a monogon hangs on v.
    template <class Visit>
    uint32_t count_closed(uint32_t v, Visit visit) const {
        if (w_.rings.is(v, Monogons::HOST)) return NONE;
        const uint32_t begin = w_.rings.offset[v];
        return walk_plain_star(f_.value, &w_.rings.side[begin], w_.rings.offset[v + 1] - begin, visit);
    }

    // Of a vertex without zero edges.
    int32_t index_of(uint32_t v, uint32_t closed) const {
        return 2 - static_cast<int32_t>(f_.mesh.is_marked(v)) - static_cast<int32_t>(closed);
    }

    enum class Shape : uint8_t { sound, misplaced, extremum, has_zero, broken };

    // sound: as regular, or as singular, as before the step.
    Shape shape(uint32_t v) const {
        const Rings::Side* side = &w_.rings.side[w_.rings.offset[v]];
        const uint32_t degree = w_.rings.offset[v + 1] - w_.rings.offset[v];
        bool broken = false;
        const uint32_t closed = count_closed(v, [&](uint32_t, uint32_t, int64_t here, int64_t ahead, int64_t opposite) {
            broken |= here + ahead < opposite;
        });
        if (broken) return Shape::broken;
        if (closed != NONE)
            return index_of(v, closed) > 0                ? Shape::extremum
                 : index_of(v, closed) == model_.index[v] ? Shape::sound
                                                          : Shape::misplaced;
        for (uint32_t t = 0; t < degree; ++t)
            if (f_.corner2(side[t].half_edge) < 0) return Shape::broken;
        return Shape::has_zero;
    }

    // Collects the vertices that are not sound; returns the number of extrema.
    uint64_t find_suspects() {
        suspect_.clear();
        check_all_ = false;
        if (!go_on()) return 0;
        // Each block lists its own where it lies; then the lists move together.
        struct Found {
            uint32_t suspects = 0;
            uint64_t extrema = 0;
        };
        const size_t n = f_.mesh.vertex_count, size = Parallel::pass_block(n);
        Found found[Parallel::most_parts];
        uint32_t* const list = suspect_.data(); // room for all
        w_.call.parallel.for_blocks(n, [&](size_t begin, size_t end) {
            Found here;
            for (size_t i = begin; i < end; ++i) {
                const uint32_t v = static_cast<uint32_t>(i);
                const Shape s = shape(v);
                if (s == Shape::sound) continue;
                list[begin + here.suspects++] = v;
                here.extrema += s == Shape::extremum;
            }
            found[begin / size] = here;
        });
        uint64_t extrema = 0;
        for (size_t k = 0; k * size < n; ++k) {
            for (uint32_t i = 0; i < found[k].suspects; ++i) suspect_.add(list[k * size + i]);
            extrema += found[k].extrema;
        }
        return extrema;
    }

    // Of the suspects those that nothing but a move can make sound.
    void list_unsound() {
        picked_.clear();
        for (const uint32_t v : suspect_) {
            const Shape s = shape(v);
            if (s != Shape::sound && s != Shape::has_zero) picked_.add(v);
        }
    }

    void suspect(uint32_t v) {
        if (suspect_.size() < f_.mesh.vertex_count) suspect_.add(v);
        else check_all_ = true;
    }

    // Calls check(v) for all vertices that may be unsound, until it fails.
    template <class Check>
    bool check_suspects(Check check) {
        const size_t count = check_all_ ? f_.mesh.vertex_count : suspect_.size();
        for (size_t i = 0; i < count; ++i) {
            const uint32_t v = check_all_ ? static_cast<uint32_t>(i) : suspect_[i];
            if (i % 65536 == 0 && !go_on()) return false;
            if (check(v)) continue;
            too_far_ = v;
            return false;
        }
        return true;
    }

    // Settles the extrema among the suspects; false if the step went too far.
    bool settle(double factor) {
        if (factor == 1) relax_extrema();
        const uint32_t before = f_.epoch; // clusters with a later stamp have been looked at
        bool moved = false;
        const bool settled = check_suspects([&](uint32_t v) {
            const Shape s = shape(v);
            if (s == Shape::broken) return false;
            if (s == Shape::sound || s == Shape::misplaced || (s == Shape::has_zero && f_.stamp[v] > before))
                return true;
            if (s == Shape::has_zero && !explore_cluster(f_, v).is_pole()) return true;
            moved = true;
            return settle_extremum(f_, v);
        });
        check_all_ |= moved;
        return settled;
    }

    // Vertices that have become extrema go to the mean of their neighbours.
    void relax_extrema() {
        const Mesh& mesh = f_.mesh;
        patch_.clear();
        for (uint32_t v : suspect_)
            if (shape(v) == Shape::extremum) patch_.add(v);
        for (uint32_t round = 0; round < steering::rounds_for_extrema && !patch_.empty(); ++round) {
            const size_t had = patch_.size();
            for (size_t i = 0; i < had; ++i) {
                const uint32_t v = patch_[i];
                if (model_.rests[v]) continue;
                model_.d[v] = model_.relaxed(v);
                step_[v] = rounded(v, 1);
                for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t)
                    set_value(mesh, edge_of(w_.rings.side[t].half_edge));
            }
            size_t end = had;
            for (size_t i = 0; i < had; ++i) {
                const uint32_t v = patch_[i];
                for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t) {
                    const uint32_t u = w_.rings.neighbour[t];
                    suspect(u);
                    if (end < mesh.vertex_count && shape(u) == Shape::extremum) {
                        patch_.add(u);
                        ++end;
                    }
                }
            }
            for (size_t i = had; i < end; ++i) patch_[i - had] = patch_[i];
            while (patch_.size() > end - had) patch_.pop();
        }
    }

    // Every zero is where it was, or at the vertex that stopped at its branch
    // point.  Anything else means that a zero and an extremum have come and
    // gone in between, and with them perhaps the class.
    bool zeros_are_in_place() {
        const Mesh& mesh = f_.mesh;
        int32_t* expected = expected_.data();
        std::memcpy(expected, model_.index.data(), mesh.vertex_count * sizeof(int32_t));
        for (uint32_t h : model_.tripod) {
            uint32_t at = h;
            for (uint32_t turn = 0; turn < 3 && f_.corner2(at) != 0; ++turn) at = mesh.next[at];
            if (f_.corner2(at) != 0) continue;
            --expected[mesh.origin[at]];
            suspect(mesh.origin[at]);
        }
        const uint32_t before = f_.epoch;
        return check_suspects([&](uint32_t v) {
            const uint32_t closed = count_closed(v, [](uint32_t, uint32_t, int64_t, int64_t, int64_t) {});
            if (closed != NONE) return index_of(v, closed) == expected[v];
            if (f_.stamp[v] > before) return true;
            const Cluster cluster = explore_cluster(f_, v);
            int64_t sum = 0;
            for (uint32_t u : f_.members) sum += expected[u];
            return cluster.index() == sum;
        });
    }

    LevelWork& w_;
    Foliation& f_;
    const double* weight_;
    TwistedModel model_;
    SignedMultigrid multigrid_;
    bool multigrid_ready_ = false;
    bool zeros_everywhere_ = false, limbs_were_wrong_ = false;
    uint64_t bounds_met_ = UINT64_MAX; // by the last step
    PartSystem part_;
    bool part_step_ = false; // the step in hand is one of the part
    bool smooth_only_;
    Array<int64_t> backup_, step_;
    Array<int32_t> expected_;
    Array<double> unbounded_; // the solution of the model before it was brought into its bounds
    Array<uint32_t> patch_, distance_;
    Array<uint32_t> picked_;  // vertices near zeros, or those that a step has made unsound
    Array<uint32_t> suspect_; // vertices that may be unsound after a step,
    bool check_all_ = false;  // unless all may be
    // Two steps and a value, and two of these sums, have no more than 63 bits.
    static constexpr double largest_step = 2 * static_cast<double>(largest_inner_value);
    bool backward_ = false;
    double energy_change_ = 0; // of the last step that was sound
    uint32_t too_far_ = NONE;  // vertex where the last step could not be taken
};

// Does a level get better?
class Progress {
public:
    // False: not for so many rounds.
    bool goes_on(double residual, double energy, uint32_t patience) {
        if (residual < steering::less_residual * least_residual_
            || energy < least_energy_ * (1 - steering::less_energy))
            without_ = 0;
        else if (++without_ > patience) return false;
        least_residual_ = std::min(least_residual_, residual);
        least_energy_ = std::min(least_energy_, energy);
        return true;
    }
    void forget_least() { least_residual_ = least_energy_ = none; }

private:
    static constexpr double none = 1e300;
    double least_residual_ = none, least_energy_ = none;
    uint32_t without_ = 0;
};

// Is it the rounding that so many steps have not been enough?  Looked at once.
struct UnitOfLevel {
    bool known;
    uint32_t patience = steering::patience; // less where the unit cannot be as fine as it should

    bool is_refined(LevelWork& work, double goal, Progress& progress) {
        if (known) return false;
        known = true;
        const Fineness fineness = work.refine_unit(goal);
        if (!fineness.enough) patience = steering::patience_when_rounded;
        if (fineness.changed) progress.forget_least();
        return fineness.changed;
    }
};

// Steps of a part, between those of the whole level: zeros that have far to go through a limb, where values fall by
// decades, and what they leave behind, for which the rest of the mesh has nothing to do.
struct Parts {
    uint32_t in_a_row = 0, shortened = 0;
    double before = 0; // residual before the last step

    bool are_worth_it(uint32_t round, double residual) {
        const bool gains = residual < steering::part_gain * before;
        before = residual;
        return round > 0 && shortened < steering::parts_shortened && (in_a_row == 0 || gains)
            && in_a_row < steering::parts_in_a_row;
    }
    void next(bool part) { in_a_row = part ? in_a_row + 1 : 0; }
};

Effort effort_for_part(Effort effort) {
    effort.go_on = false;
    effort.tight = effort.loose = steering::part_accuracy;
    return effort;
}

// residual: before the step.  goal: the tolerance on the finest level.
Effort effort_for(uint32_t round, double residual, double goal, bool finest) {
    Effort effort{};
    effort.close = residual < steering::close_residual;
    effort.tight = steering::first_accuracy;
    if (finest) {
        effort.tight = std::max(steering::tight_share * goal / residual, steering::tightest);
        effort.tight = std::min(effort.tight, steering::first_accuracy);
        effort.residual = goal
                        * (residual > steering::large_residual ? steering::residual_share_after_large_step
                                                               : steering::residual_share);
    }
    effort.loose = round == 0                                      ? steering::first_accuracy
                 : round < steering::loose_rounds || !effort.close ? steering::next_accuracy
                                                                   : effort.tight;
    effort.loose = std::max(effort.loose, effort.tight);
    // As long as zeros move, the next model is another one: a tight solve
    // of this one would be wasted.
    effort.go_on = finest && round > 0;
    return effort;
}

// What a level asks of the method: minima on the last, starts for the next on the others.
struct LevelPlan {
    bool finest, coarsest, middle, next_to_double, cheap = false;
    double goal;
    uint32_t rounds;
    bool smooth_only; // long waves are left to other levels
    // A torus without marks has no zeros, so one step is exact, wherever it starts: the levels in between
    // only take apart what splits have left together.
    bool sweep_only;

    LevelPlan(const LevelWork& work, double tolerance) {
        const size_t above = work.state.level - work.options.stop(); // levels that are still to come
        finest = above == 0;
        coarsest = work.state.level + 1 == work.state.hierarchy->level_count;
        middle = !finest && !coarsest;
        next_to_double = middle && work.state.hierarchy->is_double() && above <= steering::double_levels;
        const Level& last = work.state.hierarchy->levels[work.options.stop()];
        cheap = coarsest && steering::coarsest_share * work.level.mesh.vertex_count <= last.mesh.vertex_count;
        goal = finest ? tolerance : cheap ? steering::coarsest_residual : steering::middle_residual;
        rounds = finest ? steering::finest_rounds : coarsest ? steering::coarsest_rounds : steering::middle_rounds;
        smooth_only = middle && !next_to_double && above % steering::long_waves_every != 0;
        sweep_only = middle && work.state.hierarchy->genus == 1 && work.level.mesh.marked_count == 0;
    }
    // Its work counts.
    bool is_long_coarsest() const { return coarsest && !finest && !cheap; }
    // A coarsest level ends early where zeros are nearly everywhere, or known to be in place.
    bool is_good_start(const Newton& newton, double residual) const {
        return (is_long_coarsest() && newton.zeros_are_everywhere() && residual <= steering::coarsest_residual_of_many)
            || (cheap && newton.was_within_bounds() && residual <= steering::coarsest_residual_in_place);
    }
};

// For the whole level, or a part of it.
Effort next_effort(const LevelWork& work, const LevelPlan& plan, Newton& newton, Parts& parts, uint32_t round,
                   double residual) {
    Effort effort = effort_for(round, residual, plan.goal, plan.finest);
    if (plan.finest && !work.gated && parts.are_worth_it(round, residual))
        effort.part =
            newton.is_in_part(std::max(steering::part_residual * residual, 0.5 * plan.goal),
                              round < steering::early_part_rounds ? steering::early_part_share : steering::part_share);
    parts.next(effort.part);
    return effort.part ? effort_for_part(effort) : effort;
}

} // namespace

hmf_status newton_level(LevelWork& work, double tolerance) {
    const LevelPlan plan(work, tolerance);
    const bool finest = plan.finest;
    const double goal = plan.goal;
    Newton newton(work, plan.smooth_only);
    if (!newton.allocate()) return work.call.out_of_memory();
    newton.sweeps(plan.coarsest ? steering::coarsest_sweeps : steering::finer_sweeps);
    if (plan.sweep_only) return work.call.cancelled() || work.call.finishing() ? HMF_CANCELLED : HMF_OK;
    Progress progress;
    uint64_t steps_left = finest && work.options.step_limit ? work.options.step_limit : plan.rounds;
    UnitOfLevel unit{!finest};
    Parts parts;
    bool moves_wait = false;
    for (uint32_t round = 0; round < plan.rounds; ++round) {
        if (!newton.look()) return interrupted(work.call);
        const TwistedModel& model = newton.model();
        // After a step that was solved for to the end moves are made only if it has not reached the goal.
        if (moves_wait && model.residual_max > goal) {
            newton.relax_after_step(finest && round > steering::far_after + 1);
            if (round > steering::late_after_tight + 1) newton.sweeps(steering::late_sweeps);
            if (!newton.look()) return interrupted(work.call);
        }
        moves_wait = false;
        if (work.call.finishing()) return HMF_CANCELLED;
        // The first step of a level needs no reason but on the last level.
        const double residual = round == 0 && !finest ? 1 : model.residual_max;
        if (plan.next_to_double && residual < steering::double_residual) return HMF_OK;
        if (!work.record(2, model.energy, residual)) return work.call.out_of_memory();
        if (residual <= goal || plan.is_good_start(newton, residual)) {
            work.recorder.certificate = {true, model.energy, residual, model.residual_sum / model.count};
            if (work.watch && !newton.hand_over(work.watch->zeros)) return work.call.out_of_memory();
            return HMF_OK;
        }
        if (!parts.in_a_row && !progress.goes_on(residual, model.energy, unit.patience)) break;
        if (work.call.out_of_time()) return HMF_LIMIT_TIME;
        if (steps_left == 0) return HMF_LIMIT_ITERATIONS;
        if (round >= steering::rounds_before_finer && residual < steering::close_residual
            && unit.is_refined(work, goal, progress))
            continue;
        --steps_left;
        double accepted = 0;
        bool tight = false;
        const Effort effort = next_effort(work, plan, newton, parts, round, residual);
        if (const hmf_status status = newton.step(effort, accepted, tight)) return status;
        if (effort.part) {
            if (accepted < 1) ++parts.shortened;
            newton.relax_after_step(false);
            continue;
        }
        moves_wait = accepted == 1 && tight && !plan.middle;
        if (moves_wait) continue;
        newton.relax_after_step(finest && round > steering::far_after);
        if (accepted == 1 && plan.middle && !(plan.next_to_double && round == 0) && !newton.limbs_were_wrong())
            return HMF_OK; // it only provides a start
        if (accepted < 1) newton.sweeps(steering::sweeps_after_short_step);
        else if (round > steering::late_after) newton.sweeps(steering::late_sweeps);
    }
    if (work.call.cancelled() || work.call.finishing()) return HMF_CANCELLED;
    return finest ? end_beyond_rounding(work, goal) : HMF_OK;
}

} // namespace hmf
