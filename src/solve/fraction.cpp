#include "fraction.hpp"

#include "signed_multigrid.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// What the change of the neighbours' places does to the edge of side h of a vertex that rests.
double change_beyond(const Foliation& f, const TwistedModel& model, const double* part, uint32_t h) {
    return -model.sign[twin(h)] * part[f.mesh.target(h)];
}

// At a vertex that rests: by the directions of the integers.
double residual_at_rest(Foliation& f, const Rings& rings, const double* weight, const TwistedModel& model,
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
    const double excess = 2 * best - pull, scale = std::max(floor, pull);
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
Done measure(Foliation& f, const Rings& rings, const double* weight, const TwistedModel& model, const double* part,
             Star& star, double* residual, Call& call, ResidualResult& found) {
    const double floor = floor_of(f, weight, call);
    found = {};
    double sum = 0;
    for (uint32_t v = 0; v < model.count; ++v) {
        if (v % 65536 == 0 && !call.tick(0, true)) return false;
        double r = 0;
        if (model.rests[v]) {
            r = residual_at_rest(f, rings, weight, model, part, v, floor, star);
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

// The vertices that may move: those within some rings of the ones where the residual is too large, clusters as a
// whole.  The others keep their integers.
class Region {
public:
    Region(LevelWork& work, const TwistedModel& model) : f_(work.state.foliation), rings_(work.rings), model_(model) {}

    Done allocate(Memory& memory) {
        list_.start(memory);
        return list_.reserve(model_.count) && outside.reserve(model_.count)
            && distance_.allocate_filled(memory, model_.count, NONE);
    }
    Array<uint32_t> outside; // all others

    void start(Memory& memory) { outside.start(memory); }
    void add_centre(uint32_t v) { add(v, 0); }
    void grow(uint32_t rings_around) {
        for (size_t i = 0; i < list_.size(); ++i) {
            const uint32_t v = list_[i];
            if (distance_[v] >= rings_around) continue;
            for (uint32_t t = rings_.offset[v]; t < rings_.offset[v + 1]; ++t)
                add(rings_.neighbour[t], distance_[v] + 1);
        }
        outside.clear();
        for (uint32_t v = 0; v < model_.count; ++v)
            if (distance_[v] == NONE) outside.add(v);
    }

private:
    void add(uint32_t v, uint32_t ring) {
        constexpr uint32_t largest_cluster = 64;
        if (distance_[v] != NONE || model_.rests[v]) return;
        const Cluster cluster = explore_cluster(f_, v, ClusterSearch().up_to_vertices(largest_cluster));
        if (!cluster.complete) return;
        for (const uint32_t u : f_.members) {
            if (distance_[u] != NONE) continue;
            distance_[u] = ring;
            list_.add(u);
        }
    }

    Foliation& f_;
    const Rings& rings_;
    const TwistedModel& model_;
    Array<uint32_t> list_, distance_;
};

} // namespace

bool keeps_class(const Foliation& f, const Rings& rings, const TwistedModel& model, const double* part) {
    const Mesh& mesh = f.mesh;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const uint32_t h = 2 * e;
        const double change = model.sign[h] * part[mesh.origin[h]] + model.sign[h + 1] * part[mesh.origin[h + 1]];
        if (f.value[e] > 0 && !(static_cast<double>(f.value[e]) - change >= 0)) return false;
    }
    for (uint32_t v = 0; v < model.count; ++v) {
        if (model.rests[v]) continue;
        bool opens = false, ahead = false, behind = false;
        for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) {
            const uint32_t h = rings.side[t].half_edge, k = twin(h);
            const double change = model.sign[h] * part[v] + model.sign[k] * part[mesh.origin[k]];
            const double signed_value = model.sign[h] * (static_cast<double>(f.at(h)) - change);
            opens |= f.at(h) == 0 && change != 0;
            ahead |= signed_value > 0;
            behind |= signed_value < 0;
        }
        if (opens && !(ahead && behind)) return false;
    }
    return true;
}

hmf_status find_fractions(LevelWork& work, double goal, Array<double>& part, ResidualResult& found) {
    constexpr double accuracy = 1e-12, share = 0.25; // of the goal, from which on a vertex is a centre
    constexpr uint32_t most_iterations = 300, least_rings = 2, most_rings = 16;
    Call& call = work.call;
    Memory& memory = call.memory;
    Foliation& f = work.state.foliation;
    const double* const weight = work.level.weight;
    const uint32_t n = f.mesh.vertex_count;
    found.max = HUGE_VAL;
    TwistedModel model;
    SignedMultigrid multigrid;
    Array<double> residual;
    if (!model.allocate(f.mesh, memory) || !part.allocate_filled(memory, n, 0) || !residual.allocate(memory, n))
        return call.out_of_memory();
    if (!model.look(f, work.rings, weight, work.star, call)) return call.stopped();
    model.assemble(f, work.rings, weight, call);
    const SignedMatrix matrix = model.matrix();
    if (!multigrid.setup(matrix, memory, &call)
        || !measure(f, work.rings, weight, model, part.data(), work.star, residual.data(), call, found))
        return call.stopped();
    Region region(work, model);
    region.start(memory);
    if (!region.allocate(memory)) return call.out_of_memory();
    for (uint32_t v = 0; v < n; ++v)
        if (residual[v] > share * goal) region.add_centre(v);
    for (uint32_t rings_around = least_rings; rings_around <= most_rings && found.max > goal; rings_around *= 2) {
        region.grow(rings_around);
        LinearOptions options;
        options.fixed = region.outside.data();
        options.fixed_count = region.outside.size();
        for (double& x : part) x = 0;
        multigrid.solve(matrix, model.right.data(), part.data(), accuracy, most_iterations, call, options);
        if (call.cancelled() || call.finishing()) return HMF_CANCELLED;
        for (const uint32_t v : model.bounded)
            if (part[v] < static_cast<double>(model.lower[v]) || part[v] > static_cast<double>(model.upper[v]))
                part[v] = 0;
        found.max = HUGE_VAL;
        if (keeps_class(f, work.rings, model, part.data())
            && !measure(f, work.rings, weight, model, part.data(), work.star, nullptr, call, found))
            return call.stopped();
    }
    return HMF_OK;
}

hmf_status residuals_with_fractions(Foliation& f, const Rings& rings, const double* weight, const double* part,
                                    Star& star, double* residual, Call& call, ResidualResult& found) {
    TwistedModel model;
    if (!model.allocate(f.mesh, call.memory)) return call.out_of_memory();
    if (!model.look(f, rings, weight, star, call)) return call.stopped();
    model.assemble(f, rings, weight, call);
    return measure(f, rings, weight, model, part, star, residual, call, found) ? HMF_OK : call.stopped();
}

} // namespace hmf
