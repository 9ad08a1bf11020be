#include "fraction.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hmf {

namespace {

// The change of the edge of side h of a fixed vertex, caused by the neighbors.
double change_beyond(const Foliation& f, const TwistedModel& model, const double* part, uint32_t h) {
    return -model.sign[twin(h)] * part[f.mesh.target(h)];
}

// At a fixed vertex: by the directions of the integers. At most this, in whichever of them a neighbor of its
// cluster has moved.
double residual_at_fixed(Foliation& f, const Rings& rings, const double* weight, const TwistedModel& model,
                         const double* part, uint32_t v, double floor, Star& star) {
    if (f.mesh.is_marked(v)) return 0; // balanced by the half turn
    const Rings::Side* side = &rings.side[rings.offset[v]];
    const uint32_t budget = star.budget;
    star.budget = NONE;
    read_star(f, side, rings.offset[v + 1] - rings.offset[v], weight, star);
    star.budget = budget;
    double best = 0, pull = star.pull;
    for (uint32_t k = 0; k < star.group_count; ++k) {
        double sum = star.group_pull[k];
        for (uint32_t t = 0; t < star.degree; ++t) {
            const uint32_t h = side[t].half_edge;
            if (star.group[t] != k || f.mesh.target(h) == v) continue;
            const double more = weight[edge_of(h)] * change_beyond(f, model, part, h);
            sum += more;
            pull += more;
        }
        best = std::max(best, sum);
    }
    double opened = 0;
    for (uint32_t t = 0; t < star.degree; ++t)
        if (star.F[t] == 0 && f.mesh.target(side[t].half_edge) != v)
            opened += weight[edge_of(side[t].half_edge)] * std::fabs(change_beyond(f, model, part, side[t].half_edge));
    const double excess = 2 * best - pull + opened, scale = std::max(floor, pull);
    return excess > 0 && scale > 0 ? excess / scale : 0;
}

double floor_of(const Foliation& f, const double* weight, const Call& call) {
    const double total = call.parallel.sum_blocks<double>(f.mesh.edge_count, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t e = begin; e < end; ++e) sum += weight[e] * static_cast<double>(f.value[e]);
        return sum;
    });
    return pull_floor(total, f.mesh.vertex_count);
}

// model: of f, with its matrix.
Done measure_with_part(Foliation& f, const Rings& rings, const double* weight, const TwistedModel& model,
                       const double* part, Star& star, double* residual, Call& call, ResidualResult& found) {
    const double floor = floor_of(f, weight, call);
    found = {};
    double sum = 0;
    for (uint32_t v = 0; v < model.count; ++v) {
        if (v % 65536 == 0 && !call.tick(0, true)) return false;
        double r = 0;
        if (model.is_fixed[v]) {
            r = residual_at_fixed(f, rings, weight, model, part, v, floor, star);
        } else {
            double excess = model.right[v] - model.diagonal[v] * part[v];
            for (uint32_t t = model.offset[v]; t < model.offset[v + 1]; ++t)
                excess -= model.entry[t] * part[model.column[t]];
            r = std::fabs(excess) * static_cast<double>(model.row_scale[v]);
        }
        if (residual) residual[v] = r;
        sum += r;
        if (r > found.max) {
            found.max = r;
            found.worst = v;
        }
    }
    found.mean = sum / model.count;
    return true;
}

// After linearize(): lets a fixed zero move by less than a unit, as plan_move has planned it; step: of its sides.
void free_zero(TwistedModel& model, const Foliation& f, const Rings& rings, const double* weight, uint32_t v,
               const int8_t* step, double floor) {
    model.is_fixed[v] = 0;
    double b = 0, pull = 0;
    for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t, ++step) {
        const uint32_t h = rings.side[t].half_edge;
        model.sign[h] = static_cast<int8_t>(-*step);
        const double p = weight[edge_of(h)] * static_cast<double>(f.at(h));
        b += model.sign[h] * p;
        pull += p;
    }
    model.right[v] = b;
    model.row_scale[v] = static_cast<float>(1 / (pull > floor ? pull : floor));
}

// Vertices at zeros that go into the direction which pulls them, by less than a unit: Whitehead moves that nothing lies
// in the way of.  The same list is found from the parts alone.
class FreeZeros {
public:
    FreeZeros(Foliation& f, const Rings& rings, const double* weight, TwistedModel& model, Star& star) :
        f_(f), rings_(rings), weight_(weight), model_(model), star_(star) {}

    Done allocate(Memory& memory) {
        list.start(memory);
        return list.reserve(model_.fixed_zeros.size()) && cluster_.allocate_filled(memory, model_.count, NONE);
    }
    Array<uint32_t> list;

    // One of each cluster: the search result around it does not hold for the move of another one.
    void add(uint32_t v, double floor) {
        if (cluster_[v] != NONE) return;
        const uint32_t budget = star_.budget;
        star_.budget = NONE;
        const Rings::Side* side = &rings_.side[rings_.offset[v]];
        read_star(f_, side, rings_.offset[v + 1] - rings_.offset[v], weight_, star_);
        const bool moves = 2 * star_.best_pull > star_.pull && plan_move(f_, side, star_) && f_.pushed.empty();
        star_.budget = budget;
        if (!moves) return;
        free_zero(model_, f_, rings_, weight_, v, star_.step.data(), floor);
        list.add(v);
        explore_cluster(f_, v);
        for (const uint32_t u : f_.members) cluster_[u] = v;
    }

private:
    Foliation& f_;
    const Rings& rings_;
    const double* weight_;
    TwistedModel& model_;
    Star& star_;
    Array<uint32_t> cluster_; // per vertex: the one of its cluster that is in the list
};

// The vertices that may move: those within some rings of the vertices whose residual is too large. The others keep
// their integers. A larger set gives better results, because effects spread far along edges of small weight. Vertices
// without an edge above 0 may always move, together with their cluster: at the end of a limb they would become an
// extremum if only their surroundings moved.
class Region {
public:
    Region(const Foliation& f, const Rings& rings, const TwistedModel& model) : f_(f), rings_(rings), model_(model) {}

    Done allocate(Memory& memory) {
        list_.start(memory);
        return list_.reserve(model_.count) && distance.allocate_filled(memory, model_.count, NONE)
            && with.allocate(memory, model_.count);
    }
    Array<uint32_t> distance; // from the nearest center; NONE: outside
    Array<uint32_t> with;     // the first one that it moves with

    // First.
    void join_unpulled() {
        for (uint32_t v = 0; v < model_.count; ++v) with[v] = v;
        for (uint32_t v = 0; v < model_.count; ++v) {
            size_t done = list_.size();
            if (add_unpulled(v)) with[v] = v;
            for (; done < list_.size(); ++done) {
                const uint32_t u = list_[done];
                for (uint32_t t = rings_.offset[u]; t < rings_.offset[u + 1]; ++t)
                    if (add_unpulled(rings_.neighbor[t])) with[rings_.neighbor[t]] = v;
            }
        }
        list_.clear();
    }
    void add_center(uint32_t v) { add(v, 0); }
    // False: it is as large as it was.
    bool grow(uint32_t rings_around) {
        for (size_t i = 0; i < list_.size(); ++i) {
            const uint32_t v = list_[i];
            if (distance[v] >= rings_around) continue;
            for (uint32_t t = rings_.offset[v]; t < rings_.offset[v + 1]; ++t) add(rings_.neighbor[t], distance[v] + 1);
        }
        const bool grows = list_.size() > size_ || rings_around == 0;
        size_ = list_.size();
        return grows;
    }

private:
    bool is_pulled(uint32_t v) const {
        for (uint32_t t = rings_.offset[v]; t < rings_.offset[v + 1]; ++t)
            if (f_.at(rings_.side[t].half_edge) != 0) return true;
        return false;
    }
    bool add_unpulled(uint32_t v) {
        if (distance[v] != NONE || model_.is_fixed[v] || is_pulled(v)) return false;
        distance[v] = 0;
        list_.add(v);
        return true;
    }
    void add(uint32_t v, uint32_t ring) {
        if (distance[v] != NONE || model_.is_fixed[v]) return;
        distance[v] = ring;
        list_.add(v);
    }

    const Foliation& f_;
    const Rings& rings_;
    const TwistedModel& model_;
    Array<uint32_t> list_;
    size_t size_ = 0;
};

// The edges of a vertex, or of vertices joined by edges of value 0, after a step.
struct EdgeChanges {
    bool opens = false, reverses = false;
    bool ahead = false, behind = false; // an edge in each direction that the step does not reverse
    bool are_kept() const { return !(opens || reverses) || (ahead && behind); }
    void operator|=(const EdgeChanges& other) {
        opens |= other.opens;
        reverses |= other.reverses;
        ahead |= other.ahead;
        behind |= other.behind;
    }
};

class ClassTest {
public:
    ClassTest(const Foliation& f, const Rings& rings, const TwistedModel& model, const double* part) :
        f_(f), rings_(rings), model_(model), part_(part) {}

    Done look(Memory& memory, bool& keeps) {
        keeps = false;
        for (const uint32_t v : model_.fixed_zeros)
            if (reverses_any(v)) return true;
        for (uint32_t v = 0; v < model_.count; ++v) {
            if (model_.is_fixed[v]) {
                if (reverses_any(v)) return true;
                continue;
            }
            if (ways_of(v).are_kept()) continue;
            if (seen_.empty() && !allocate(memory)) return false;
            if (!seen_[v] && !closed_together_are_kept(v)) return true;
        }
        return keeps = true;
    }

private:
    Done allocate(Memory& memory) {
        return stack_.allocate(memory, model_.count) && seen_.allocate_filled(memory, model_.count, uint8_t{0});
    }
    double change(uint32_t h) const {
        const uint32_t k = twin(h);
        return model_.sign[h] * part_[f_.mesh.origin[h]] + model_.sign[k] * part_[f_.mesh.origin[k]];
    }
    bool reverses_any(uint32_t v) const {
        for (uint32_t t = rings_.offset[v]; t < rings_.offset[v + 1]; ++t) {
            const uint32_t h = rings_.side[t].half_edge;
            if (f_.at(h) > 0 && !(static_cast<double>(f_.at(h)) - change(h) >= 0)) return true;
        }
        return false;
    }
    EdgeChanges ways_of(uint32_t v) const {
        EdgeChanges changes;
        for (uint32_t t = rings_.offset[v]; t < rings_.offset[v + 1]; ++t) {
            const uint32_t h = rings_.side[t].half_edge;
            const double after = static_cast<double>(f_.at(h)) - change(h);
            const bool keeps_way = f_.at(h) == 0 || after > 0;
            changes.opens |= f_.at(h) == 0 && after != 0;
            changes.reverses |= !keeps_way;
            changes.ahead |= keeps_way && model_.sign[h] * after > 0;
            changes.behind |= keeps_way && model_.sign[h] * after < 0;
        }
        return changes;
    }
    // What edges of value 0, which stay so all the way, hold together is one vertex.
    bool closed_together_are_kept(uint32_t first) {
        EdgeChanges changes;
        size_t found = 0, done = 0;
        seen_[first] = 1;
        for (stack_[found++] = first; done < found; ++done) {
            const uint32_t v = stack_[done];
            if (model_.is_fixed[v]) return false;
            changes |= ways_of(v);
            for (uint32_t t = rings_.offset[v]; t < rings_.offset[v + 1]; ++t) {
                const uint32_t h = rings_.side[t].half_edge, u = rings_.neighbor[t];
                if (f_.at(h) != 0 || change(h) != 0 || seen_[u]) continue;
                seen_[u] = 1;
                stack_[found++] = u;
            }
        }
        return changes.are_kept();
    }

    const Foliation& f_;
    const Rings& rings_;
    const TwistedModel& model_;
    const double* part_;
    Array<uint32_t> stack_;
    Array<uint8_t> seen_; // in something that is kept
};

} // namespace

Done keeps_class(const Foliation& f, const Rings& rings, const TwistedModel& model, const double* part, Memory& memory,
                 bool& keeps) {
    return ClassTest(f, rings, model, part).look(memory, keeps);
}

hmf_status find_fractions(LevelWork& work, double goal, Array<double>& part, ResidualResult& found) {
    constexpr double share = 0.25; // of the goal, from which on a vertex is a center
    constexpr uint32_t all = UINT32_MAX - 1, rings_around[] = {0, 1, 2, 4, 8, 16, all};
    Call& call = work.call;
    Memory& memory = call.memory;
    Foliation& f = work.state.foliation;
    const double* const weight = work.level.weight;
    const uint32_t n = f.mesh.vertex_count;
    found.max = HUGE_VAL;
    TwistedModel model;
    Array<double> residual;
    if (!model.allocate(f.mesh, memory) || !part.allocate_filled(memory, n, 0) || !residual.allocate(memory, n))
        return call.out_of_memory();
    if (!model.linearize(f, work.rings, weight, work.star, call)) return call.stopped();
    model.assemble(f, work.rings, weight, call);
    FreeZeros zeros(f, work.rings, weight, model, work.star);
    Region region(f, work.rings, model);
    if (!zeros.allocate(memory) || !region.allocate(memory)) return call.out_of_memory();
    if (!measure_with_part(f, work.rings, weight, model, part.data(), work.star, residual.data(), call, found))
        return call.stopped();
    const double floor = floor_of(f, weight, call);
    for (const uint32_t v : model.fixed_zeros)
        if (residual[v] > share * goal) zeros.add(v, floor);
    region.join_unpulled();
    for (uint32_t v = 0; v < n; ++v)
        if (residual[v] > share * goal) region.add_center(v);
    model.assemble(f, work.rings, weight, call);
    found.max = HUGE_VAL;
    Array<uint32_t> number;
    if (!number.allocate(memory, n)) return call.out_of_memory();
    for (const uint32_t rings : rings_around) {
        if (!region.grow(rings)) continue;
        for (double& x : model.d) x = 0;
        // Where an edge of its cluster is heavy, a vertex that goes all the way hands its residual on to the other
        // end.  After half of the way each has half of it.
        for (const bool half : {false, true}) {
            if (half && zeros.list.empty()) break;
            std::memcpy(number.data(), region.distance.data(), n * sizeof(uint32_t));
            for (const uint32_t v : zeros.list) {
                model.is_fixed[v] = 0;
                number[v] = half ? NONE : 0;
                if (half) model.d[v] = 0.5 * part[v];
            }
            DirectSolver equations;
            if (!equations.extract(model.system(), number, call, region.with.data())
                || !equations.solve(model.system(), call))
                return call.stopped();
            std::memcpy(part.data(), model.d.data(), n * sizeof(double));
            for (const uint32_t v : model.bounded)
                if (part[v] <= static_cast<double>(model.lower[v]) || part[v] >= static_cast<double>(model.upper[v]))
                    part[v] = 0;
            for (const uint32_t v : zeros.list) model.is_fixed[v] = part[v] == 0;
            bool keeps = false;
            if (!keeps_class(f, work.rings, model, part.data(), memory, keeps)) return call.out_of_memory();
            if (keeps && !measure_with_part(f, work.rings, weight, model, part.data(), work.star, nullptr, call, found))
                return call.stopped();
            if (found.max <= goal) return HMF_OK;
        }
    }
    return HMF_OK;
}

hmf_status correct_below_unit(State& state, const SolveOptions& options, const ClassGuard& guard, Call& call,
                              SolveLog& log) {
    const double goal = options.tolerance;
    LevelWork work{state, state.hierarchy->levels[state.level], options, call, log, nullptr, {}, {}, {}, {}};
    if (!work.prepare()) return call.stopped();
    ResidualResult found;
    if (const hmf_status status = find_fractions(work, goal, log.fraction, found)) return status;
    if (!(found.max <= goal)) return guard.checks == ClassGuard::Checks::steps ? HMF_LIMIT_CLASS : HMF_LIMIT_STALLED;
    const double D = energy(state.foliation, work.level.weight, call.parallel);
    if (!work.record(options.method == HMF_METHOD_NEWTON ? 2 : 1, D, found.max)) return call.out_of_memory();
    log.certificate = {true, D, found.max, found.mean, true};
    return HMF_OK;
}

hmf_status residuals_with_fractions(Foliation& f, const Rings& rings, const double* weight, const double* part,
                                    Star& star, double* residual, Call& call, ResidualResult& found) {
    TwistedModel model;
    if (!model.allocate(f.mesh, call.memory)) return call.out_of_memory();
    if (!model.linearize(f, rings, weight, star, call)) return call.stopped();
    FreeZeros zeros(f, rings, weight, model, star);
    if (!zeros.allocate(call.memory)) return call.out_of_memory();
    const double floor = floor_of(f, weight, call);
    for (const uint32_t v : model.fixed_zeros)
        if (part[v] != 0) zeros.add(v, floor);
    model.assemble(f, rings, weight, call);
    return measure_with_part(f, rings, weight, model, part, star, residual, call, found) ? HMF_OK : call.stopped();
}

} // namespace hmf
