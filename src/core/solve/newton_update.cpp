#include "newton_update.hpp"

#include "parameters.hpp"

namespace hmf {

Done NewtonUpdate::allocate() {
    Memory& memory = call_.memory;
    const size_t n = f_.mesh.vertex_count;
    candidate_.start(memory);
    return before_.allocate(memory, f_.mesh.edge_count) && step_.allocate(memory, n) && expected_.allocate(memory, n)
        && candidate_.reserve(n);
}

void NewtonUpdate::begin() { call_.parallel.copy(before_.data(), f_.value, f_.mesh.edge_count); }

void NewtonUpdate::restore() { call_.parallel.copy(f_.value, before_.data(), f_.mesh.edge_count); }

// Bounds are integers, so rounding does not leave them; those that a double does not hold are looked up.
int64_t NewtonUpdate::rounded(uint32_t k, double factor) const {
    const double x = model_.d[k] * factor;
    if (!(x > -LARGEST_STEP && x < LARGEST_STEP)) return 0;
    if (factor == 1 && model_.at_bound(k)) return model_.bound_at(k);
    return static_cast<int64_t>(x < 0 ? x - 0.5 : x + 0.5);
}

void NewtonUpdate::set_value(uint32_t e) {
    const Mesh& mesh = f_.mesh;
    const uint32_t h = 2 * e;
    const int64_t x =
        before_[e] - model_.sign[h] * step_[mesh.origin[h]] - model_.sign[h + 1] * step_[mesh.origin[h + 1]];
    f_.value[e] = x < 0 ? -x : x;
}

void NewtonUpdate::set_values(double factor) {
    call_.parallel.for_blocks(f_.mesh.vertex_count, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) step_[v] = rounded(static_cast<uint32_t>(v), factor);
    });
    call_.parallel.for_blocks(f_.mesh.edge_count, [&](size_t begin, size_t end) {
        for (size_t e = begin; e < end; ++e) set_value(static_cast<uint32_t>(e));
    });
}

double NewtonUpdate::energy_change() const {
    return call_.parallel.sum_blocks<double>(f_.mesh.edge_count, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t e = begin; e < end; ++e) {
            const double change = static_cast<double>(f_.value[e] - before_[e]);
            sum += weight_[e] * change * static_cast<double>(f_.value[e] + before_[e]);
        }
        return sum;
    });
}

// As walk_plain_star; NONE also where a monogon hangs on v.
template <class Visit>
uint32_t NewtonUpdate::count_closed(uint32_t v, Visit visit) const {
    if (rings_.is(v, Monogons::HOST)) return NONE;
    const uint32_t begin = rings_.offset[v];
    return walk_plain_star(f_.value, &rings_.side[begin], rings_.offset[v + 1] - begin, visit);
}

// Of a vertex without zero edges.
int32_t NewtonUpdate::index_of(uint32_t v, uint32_t closed) const {
    return 2 - static_cast<int32_t>(f_.mesh.is_marked(v)) - static_cast<int32_t>(closed);
}

// kept: as regular, or as singular, as before the step.
HMF_INLINE NewtonUpdate::Shape NewtonUpdate::shape(uint32_t v) const {
    const Rings::Side* side = &rings_.side[rings_.offset[v]];
    const uint32_t degree = rings_.offset[v + 1] - rings_.offset[v];
    bool broken = false;
    const uint32_t closed = count_closed(v, [&](uint32_t, uint32_t, int64_t here, int64_t ahead, int64_t opposite) {
        broken |= here + ahead < opposite;
    });
    if (broken) return Shape::broken;
    if (closed != NONE)
        return index_of(v, closed) > 0                ? Shape::extremum
             : index_of(v, closed) == model_.index[v] ? Shape::kept
                                                      : Shape::misplaced;
    for (uint32_t t = 0; t < degree; ++t)
        if (f_.corner2(side[t].half_edge) < 0) return Shape::broken;
    return Shape::has_zero;
}

uint64_t NewtonUpdate::find_candidates() {
    candidate_.clear();
    check_all_ = false;
    if (!work_.go_on()) return 0;
    // Each block lists its own where it lies; then the lists move together.
    struct Found {
        uint32_t candidates = 0;
        uint64_t extrema = 0;
    };
    const size_t n = f_.mesh.vertex_count, size = Parallel::pass_block(n);
    Found found[Parallel::MOST_PARTS];
    uint32_t* const list = candidate_.data(); // room for all
    call_.parallel.for_blocks(n, [&](size_t begin, size_t end) {
        Found here;
        for (size_t i = begin; i < end; ++i) {
            const uint32_t v = static_cast<uint32_t>(i);
            const Shape s = shape(v);
            if (s == Shape::kept) continue;
            list[begin + here.candidates++] = v;
            here.extrema += s == Shape::extremum;
        }
        found[begin / size] = here;
    });
    uint64_t extrema = 0;
    for (size_t k = 0; k * size < n; ++k) {
        for (uint32_t i = 0; i < found[k].candidates; ++i) candidate_.add(list[k * size + i]);
        extrema += found[k].extrema;
    }
    return extrema;
}

void NewtonUpdate::list_invalid(Array<uint32_t>& invalid) const {
    invalid.clear();
    for (const uint32_t v : candidate_) {
        const Shape s = shape(v);
        if (s != Shape::kept && s != Shape::has_zero) invalid.add(v);
    }
}

void NewtonUpdate::add_candidate(uint32_t v) {
    if (candidate_.size() < f_.mesh.vertex_count) candidate_.add(v);
    else check_all_ = true;
}

// Calls check(v) for all vertices that may be invalid, until it fails.
template <class Check>
bool NewtonUpdate::check_candidates(Check check) {
    const size_t count = check_all_ ? f_.mesh.vertex_count : candidate_.size();
    for (size_t i = 0; i < count; ++i) {
        const uint32_t v = check_all_ ? static_cast<uint32_t>(i) : candidate_[i];
        if ((i % 65536 == 0 && !work_.go_on()) || !call_.work(8 * f_.take_walked())) return false;
        if (check(v)) continue;
        too_far_ = v;
        return false;
    }
    return true;
}

bool NewtonUpdate::remove_extrema() {
    const uint32_t before = f_.epoch; // clusters with a later stamp have been examined
    bool moved = false;
    const bool removed = check_candidates([&](uint32_t v) {
        const Shape s = shape(v);
        if (s == Shape::broken) return false;
        if (s == Shape::kept || s == Shape::misplaced || (s == Shape::has_zero && f_.stamp[v] > before)) return true;
        if (s == Shape::has_zero && !explore_cluster(f_, v).is_pole()) return true;
        moved = true;
        return remove_extremum(f_, v, &call_);
    });
    check_all_ |= moved;
    return removed;
}

bool NewtonUpdate::zeros_are_in_place() {
    const Mesh& mesh = f_.mesh;
    int32_t* expected = expected_.data();
    std::memcpy(expected, model_.index.data(), mesh.vertex_count * sizeof(int32_t));
    for (uint32_t h : model_.tripod) {
        uint32_t at = h;
        for (uint32_t turn = 0; turn < 3 && f_.corner2(at) != 0; ++turn) at = mesh.next[at];
        if (f_.corner2(at) != 0) continue;
        --expected[mesh.origin[at]];
        add_candidate(mesh.origin[at]);
    }
    const uint32_t before = f_.epoch;
    return check_candidates([&](uint32_t v) {
        const uint32_t closed = count_closed(v, [](uint32_t, uint32_t, int64_t, int64_t, int64_t) {});
        if (closed != NONE) return index_of(v, closed) == expected[v];
        if (f_.stamp[v] > before) return true;
        const Cluster cluster = explore_cluster(f_, v);
        int64_t sum = 0;
        for (uint32_t u : f_.members) sum += expected[u];
        return cluster.index() == sum;
    });
}

} // namespace hmf
