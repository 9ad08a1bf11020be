// The direct method: Newton steps on the twisted Laplacian, globalised by
// Whitehead moves.
//
// One round on a level:
//   1. sweeps of Whitehead moves: singularities walk, clusters open
//   2. the quadratic model of the signs as they are (twisted_model.hpp),
//      solved by conjugate gradients with signed multigrid
//   3. the solution, brought into its bounds, is rounded and applied to all
//      vertices at once; extrema that rounding or a loose solve left are
//      settled; kept if every zero is where it was or at the branch point of
//      its triangle (so the class is kept) and the energy falls; else the
//      place where it fails is held fast, or the whole step is halved
//   4. moves near the singularities, where the model is not smooth
// Far from the singularities one round is exact, so a few rounds reach the
// minimum.  The certificate is the residual of [W] Eq. 4 at every vertex.
#include "signed_multigrid.hpp"
#include "solve.hpp"
#include "twisted_model.hpp"

namespace hmf {

namespace {

class Newton {
public:
    explicit Newton(LevelWork& work) : w_(work), f_(work.state.foliation), weight_(work.level.weight) {}

    bool allocate() {
        Memory& memory = w_.call.memory;
        const Mesh& mesh = f_.mesh;
        patch_.start(memory);
        near_.start(memory);
        suspect_.start(memory);
        return model_.allocate(mesh, memory) && backup_.allocate(memory, mesh.edge_count) && step_.allocate(memory, mesh.vertex_count) && expected_.allocate(memory, mesh.vertex_count)
            && distance_.allocate(memory, mesh.vertex_count) && patch_.reserve(mesh.vertex_count) && near_.reserve(mesh.vertex_count)
            && suspect_.reserve(mesh.vertex_count);
    }

    double residual() {
        const ResidualResult r = residuals(f_, w_.rings, weight_, w_.star, nullptr, w_.call);
        return r.max;
    }

    void sweeps(uint32_t n) {
        for (uint32_t i = 0; i < n && w_.call.tick(0, true); ++i) {
            SweepResult result;
            sweep(f_, w_.rings, weight_, backward_, w_.star, result, w_.call, 0);
            backward_ = !backward_;
            ++w_.statistics.iterations;
        }
    }

    // HMF_OK, or memory, or HMF_CANCELLED.  tight: the tolerance where the
    // model is exact, so that no other step follows.  close: near the minimum, where more
    // effort for a whole step pays.  accepted: the share of the step that was
    // taken, 0 if none would do.
    hmf_status step(double tolerance, double tight, bool close, double& accepted) {
        accepted = 0;
        std::memcpy(backup_.data(), f_.value, f_.mesh.edge_count * sizeof(int64_t));
        const hmf_status status = try_step(tolerance, tight, close, accepted);
        if (accepted == 0) restore();
        return status;
    }

    // Between two passes over the mesh; false: cancelled or asked to finish.
    bool go_on() { return w_.call.tick(0, true) && !w_.call.finishing(); }

    // Moves at the vertices within a few rings of the zeros.
    void relax_near_zeros(uint32_t rounds) {
        const Mesh& mesh = f_.mesh;
        near_.clear();
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) distance_[v] = NONE;
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
            if (w_.rings.is(v, Monogons::INSIDE)) continue;
            bool singular = model_.rests[v];
            for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1] && !singular; ++t) {
                const uint32_t h = w_.rings.side[t].half_edge;
                singular = f_.at(h) > 0 && f_.corner2(h) > 0 && f_.corner2(mesh.next[h]) > 0 && f_.corner2(mesh.prev(h)) > 0;
            }
            if (!singular) continue;
            distance_[v] = 0;
            near_.push(v);
        }
        constexpr uint32_t rings_around = 3;
        for (size_t i = 0; i < near_.size(); ++i) {
            const uint32_t v = near_[i];
            if (distance_[v] == rings_around) continue;
            for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t) {
                const uint32_t u = mesh.target(w_.rings.side[t].half_edge);
                if (distance_[u] != NONE) continue;
                distance_[u] = distance_[v] + 1;
                near_.push(u);
            }
        }
        SweepResult result;
        for (uint32_t r = 0; r < rounds; ++r)
            for (size_t i = 0; i < near_.size(); ++i)
                relax_vertex(f_, w_.rings, weight_, near_[r % 2 ? near_.size() - 1 - i : i], w_.star, result);
    }

private:
    void restore() { std::memcpy(f_.value, backup_.data(), f_.mesh.edge_count * sizeof(int64_t)); }

    hmf_status stopped() { return f_.out_of_memory || (!w_.call.cancelled() && !w_.call.finishing()) ? w_.call.out_of_memory() : HMF_CANCELLED; }

    // Leaves the values changed where it is not accepted.
    hmf_status try_step(double tolerance, double tight, bool close, double& accepted) {
        model_.assemble(f_, w_.rings, weight_, &w_.call);
        if (f_.out_of_memory || !go_on()) return stopped();
        const uint32_t n = model_.count;
        const SignedMatrix matrix{n, model_.offset.data(), model_.column.data(), model_.entry.data(), model_.diagonal.data()};
        const double before = energy(f_, weight_);
        if (tight < tolerance && model_.is_exact()) tolerance = tight;
        ++w_.statistics.linear_solves;
        // On limbs that no loop goes round the values decay below the error of
        // a loose solve: then it is continued.
        for (double accuracy = tolerance;; accuracy *= 1e-4) {
            if (!solve_linear(matrix, accuracy)) return stopped();
            restore();
            model_.project(f_, w_.rings, patch_, distance_);
            if (!go_on()) return stopped();
            set_values(1);
            if (!go_on()) return stopped();
            if (count_extrema() <= 16 + n / 2000 || accuracy < 1e-13) break;
        }
        // Where the step went too far, the neighbourhood stays as it is.  If the
        // energy rises, the bounds hold back too much: the others are solved
        // for once more.  If nothing helps, all take a shorter step.
        double factor = 1;
        uint32_t radius = 2, solves = 0;
        for (uint32_t attempt = 0; attempt < 24 && factor > 0.02; ++attempt) {
            too_far_ = NONE;
            const bool sound = apply(factor);
            if (f_.out_of_memory || !go_on()) return stopped();
            if (sound) energy_change_ = energy_change();
            if (sound && energy_change_ <= 1e-17 * before) {
                accepted = factor;
                return HMF_OK;
            }
            restore();
            if (sound && (close || energy_change_ < 1e-5 * before) && solves < 2) {
                ++solves;
                if (!solve_between_bounds(tolerance)) return stopped();
            } else if (too_far_ != NONE && attempt < 16) {
                if (attempt % 4 == 3) ++radius;
                model_.freeze(f_, w_.rings, too_far_, radius, patch_, distance_);
            } else {
                factor *= 0.5;
            }
        }
        return HMF_OK;
    }

    // Continues from model_.d.  The matrix of a level changes by signs near the
    // zeros only: one setup serves for all its steps unless iterations tell otherwise.
    bool solve_linear(const SignedMatrix& matrix, double accuracy) {
        constexpr uint32_t with_old_setup = 50, with_new_setup = 200;
        if (multigrid_ready_) {
            const LinearResult result = multigrid_.solve(matrix, model_.right.data(), model_.d.data(), accuracy, with_old_setup, w_.call);
            if (w_.call.cancelled() || w_.call.finishing()) return false;
            if (result.converged) return true;
        }
        multigrid_ready_ = multigrid_.setup(matrix, w_.call.memory, &w_.call);
        if (!multigrid_ready_) return false;
        multigrid_.solve(matrix, model_.right.data(), model_.d.data(), accuracy, with_new_setup, w_.call);
        return !w_.call.cancelled() && !w_.call.finishing();
    }

    // The unknowns at a bound keep their value, the others are solved for.
    bool solve_between_bounds(double accuracy) {
        if (fixed_entry_.empty()
            && (!fixed_entry_.allocate(w_.call.memory, size_t{2} * f_.mesh.edge_count)
                || !fixed_right_.allocate(w_.call.memory, f_.mesh.vertex_count)))
            return false;
        model_.fix_active(fixed_entry_, fixed_right_);
        const SignedMatrix fixed{model_.count, model_.offset.data(), model_.column.data(), fixed_entry_.data(), model_.diagonal.data()};
        multigrid_.solve(fixed, fixed_right_.data(), model_.d.data(), accuracy, 100, w_.call);
        ++w_.statistics.linear_solves;
        if (w_.call.cancelled() || w_.call.finishing()) return false;
        model_.project(f_, w_.rings, patch_, distance_);
        return true;
    }

    int64_t rounded(uint32_t k, double factor) const {
        const double x = model_.d[k] * factor;
        if (!(x > -9e15 && x < 9e15)) return 0;
        int64_t i = static_cast<int64_t>(x < 0 ? x - 0.5 : x + 0.5);
        if (i < model_.lower[k]) i = model_.lower[k];
        if (i > model_.upper[k]) i = model_.upper[k];
        return i;
    }

    void set_value(const Mesh& mesh, uint32_t e) {
        const uint32_t h = 2 * e;
        const int64_t x = backup_[e] - model_.sign[h] * step_[mesh.origin[h]] - model_.sign[h + 1] * step_[mesh.origin[h + 1]];
        f_.value[e] = x < 0 ? -x : x;
    }

    void set_values(double factor) {
        const Mesh& mesh = f_.mesh;
        for (uint32_t v = 0; v < mesh.vertex_count; ++v)
            step_[v] = model_.rests[v] ? 0 : rounded(v, factor);
        for (uint32_t e = 0; e < mesh.edge_count; ++e) set_value(mesh, e);
    }

    // From the backup to the values, without the cancellation of two energies.
    double energy_change() const {
        double sum = 0;
        for (uint32_t e = 0; e < f_.mesh.edge_count; ++e) {
            const double change = static_cast<double>(f_.value[e] - backup_[e]);
            sum += weight_[e] * change * static_cast<double>(f_.value[e] + backup_[e]);
        }
        return sum;
    }

    uint64_t count_extrema() const {
        uint64_t count = 0;
        for (uint32_t v = 0; v < f_.mesh.vertex_count; ++v) count += shape(v) == Shape::extremum;
        return count;
    }

    // Applies factor * d; false if the result is not a foliation of the class.
    bool apply(double factor) {
        const Mesh& mesh = f_.mesh;
        const uint32_t n = mesh.vertex_count;
        set_values(factor);
        if (!go_on()) return false;
        // Vertices that have become extrema go to the mean of their neighbours.
        suspect_.clear();
        for (uint32_t v = 0; v < n; ++v)
            if (shape(v) == Shape::extremum) suspect_.push(v);
        for (uint32_t round = 0; round < 8 && !suspect_.empty() && factor == 1; ++round) {
            const size_t had = suspect_.size();
            for (size_t i = 0; i < had; ++i) {
                const uint32_t v = suspect_[i];
                if (model_.rests[v]) continue;
                model_.d[v] = model_.relaxed(v);
                step_[v] = rounded(v, 1);
                for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t) set_value(mesh, edge_of(w_.rings.side[t].half_edge));
            }
            size_t end = had;
            for (size_t i = 0; i < had; ++i) {
                const uint32_t v = suspect_[i];
                for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1] && end < n; ++t) {
                    const uint32_t u = mesh.target(w_.rings.side[t].half_edge);
                    if (shape(u) == Shape::extremum) { suspect_.push(u); ++end; }
                }
            }
            for (size_t i = had; i < end; ++i) suspect_[i - had] = suspect_[i];
            while (suspect_.size() > end - had) suspect_.pop();
        }
        return settle() && zeros_are_in_place();
    }

    bool fail_at(uint32_t v) {
        too_far_ = v;
        return false;
    }

    enum class Shape : uint8_t { sound, extremum, has_zero, broken };

    Shape shape(uint32_t v) const {
        const Rings::Side* side = &w_.rings.side[w_.rings.offset[v]];
        const uint32_t degree = w_.rings.offset[v + 1] - w_.rings.offset[v];
        uint32_t closed = 0;
        const int64_t first = f_.value[edge_of(side[0].half_edge)];
        int64_t here = first;
        bool zero = w_.rings.is(v, Monogons::HOST);
        for (uint32_t t = 0; t < degree; ++t) {
            const int64_t ahead = t + 1 < degree ? f_.value[edge_of(side[t + 1].half_edge)] : first;
            const int64_t corner2 = here + ahead - f_.value[side[t].opposite];
            if (corner2 < 0) return Shape::broken;
            zero |= here == 0;
            closed += here != 0 && ahead != 0 && corner2 == 0;
            here = ahead;
        }
        return closed >= 2 ? Shape::sound : zero ? Shape::has_zero : Shape::extremum;
    }

    // Settles the extrema that are left; false if the step went too far.
    bool settle() {
        const uint32_t before = f_.epoch; // clusters with a later stamp have been looked at
        for (uint32_t v = 0; v < f_.mesh.vertex_count; ++v) {
            if (v % 65536 == 0 && !go_on()) return false;
            const Shape s = shape(v);
            if (s == Shape::broken) return fail_at(v);
            if (s == Shape::sound || (s == Shape::has_zero && f_.stamp[v] > before)) continue;
            if (s == Shape::has_zero && !explore_cluster(f_, v, NONE, NONE, NONE, 0, 0).is_pole()) continue;
            if (!settle_extremum(f_, v)) return fail_at(v);
        }
        return true;
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
            if (f_.corner2(at) == 0) --expected[mesh.origin[at]];
        }
        const uint32_t before = f_.epoch;
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
            if (v % 65536 == 0 && !go_on()) return false;
            const Rings::Side* side = &w_.rings.side[w_.rings.offset[v]];
            const uint32_t degree = w_.rings.offset[v + 1] - w_.rings.offset[v];
            int32_t closed = 0;
            const int64_t first = f_.value[edge_of(side[0].half_edge)];
            int64_t here = first;
            bool zero = w_.rings.is(v, Monogons::HOST);
            for (uint32_t t = 0; t < degree; ++t) {
                const int64_t ahead = t + 1 < degree ? f_.value[edge_of(side[t + 1].half_edge)] : first;
                zero |= here == 0;
                closed += here + ahead == f_.value[side[t].opposite];
                here = ahead;
            }
            if (!zero) {
                if (2 - closed != expected[v]) return fail_at(v);
                continue;
            }
            if (f_.stamp[v] > before) continue;
            const Cluster cluster = explore_cluster(f_, v, NONE, NONE, NONE, 0, 0);
            if (f_.out_of_memory) return false;
            int64_t sum = 0;
            for (uint32_t u : f_.members) sum += expected[u];
            if (2 * cluster.euler - static_cast<int64_t>(cluster.closed_corners) != sum) return fail_at(v);
        }
        return true;
    }

    LevelWork& w_;
    Foliation& f_;
    const double* weight_;
    TwistedModel model_;
    SignedMultigrid multigrid_;
    bool multigrid_ready_ = false;
    Array<int64_t> backup_, step_;
    Array<int32_t> expected_;
    Array<double> fixed_entry_, fixed_right_; // made when first needed
    Array<uint32_t> patch_, near_, suspect_, distance_;
    bool backward_ = false;
    double energy_change_ = 0; // of the last step that was sound
    uint32_t too_far_ = NONE; // vertex where the last step could not be taken
};

} // namespace

hmf_status newton_level(LevelWork& work, double tolerance) {
    Newton newton(work);
    if (!newton.allocate()) return work.call.out_of_memory();
    const bool finest = work.state.level == work.options.stop_level;
    const bool coarsest = work.state.level + 1 == work.state.hierarchy->level_count;
    const double goal = finest ? tolerance : coarsest ? 1e-4 : 1e-2;
    const uint32_t most_rounds = finest ? 60 : coarsest ? 40 : 3;
    newton.sweeps(coarsest ? 20 : 1);
    double best = 1e300, lowest = 1e300;
    uint32_t without_progress = 0;
    for (uint32_t round = 0; round < most_rounds; ++round) {
        // The first step of a level needs no reason but on the last level.
        const double before = round == 0 && !finest ? 1 : newton.residual();
        if (work.call.cancelled() || work.call.finishing()) return HMF_CANCELLED; // the residual may be unfinished
        const double D = energy(work.state.foliation, work.level.weight);
        work.record(2, D, before);
        if (before <= goal) return HMF_OK;
        if (before < 0.5 * best || D < lowest * (1 - 1e-9)) without_progress = 0;
        else if (++without_progress > 12) break;
        if (before < best) best = before;
        if (D < lowest) lowest = D;
        if (work.call.out_of_time()) return HMF_LIMIT_TIME;
        // As long as zeros move, the next model is another one: a tight solve
        // of this one would be wasted.
        double tight = 0.03 * goal / before;
        if (tight < 1e-11) tight = 1e-11;
        if (tight > 1e-2 || !finest) tight = 1e-2;
        const double loose = round == 0 ? 1e-2 : before > 1e-2 ? 1e-3 : tight;
        const double linear = tight > loose ? tight : loose;
        double accepted = 0;
        if (const hmf_status status = newton.step(linear, tight, before < 1e-2, accepted)) return status;
        newton.relax_near_zeros(40);
        // Levels in between only provide a start.
        if (accepted == 1 && !finest && !coarsest) return HMF_OK;
        newton.sweeps(accepted < 1 ? 10 : round > 1 ? 2 : 0);
    }
    if (work.call.cancelled() || work.call.finishing()) return HMF_CANCELLED;
    return finest ? HMF_LIMIT_STALLED : HMF_OK;
}

} // namespace hmf
