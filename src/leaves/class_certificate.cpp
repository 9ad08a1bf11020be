// Cylinders against loops; see class_certificate.hpp.
#include "class_certificate.hpp"

namespace hmf {

namespace {

// Failures but this one only say that the class is another one: the caller does not see them.
bool is_memory(hmf_status status) { return status == HMF_ERROR_MEMORY || status == HMF_ERROR_MEMORY_LIMIT; }

// The edge path on the left of a closed curve that crosses these half-edges;
// half_edge(i) for i in [begin, end), closed behind the last.
template <class HalfEdge>
Done walk_on_the_left(const Mesh& mesh, const EdgeWords& words, uint64_t begin, uint64_t end, HalfEdge half_edge,
                      Walk& walk, Memory& memory) {
    walk.start(memory);
    for (uint64_t i = begin; i < end; ++i) {
        const uint32_t h = half_edge(i), after = half_edge(i + 1 < end ? i + 1 : begin);
        const uint32_t ahead = mesh.next[twin(h)]; // crossed where the curve turns right
        if (after == ahead && !words.append(twin(mesh.next[ahead]), walk)) return false;
    }
    return words.quads().canonical(walk, memory);
}

Done boundary_walk(const Mesh& mesh, const EdgeWords& words, const CriticalGraph& graph, uint32_t boundary, Walk& walk,
                   Memory& memory) {
    const Boundary& b = graph.boundaries[boundary];
    return walk_on_the_left(
        mesh, words, b.begin, b.end - 1, [&](uint64_t i) { return graph.crossings[i].half_edge; }, walk, memory);
}

bool has_pole(const CriticalGraph& graph, int64_t& index_sum) {
    bool pole = false;
    for (const Zero& z : graph.zeros) {
        index_sum += z.index;
        pole |= z.index > 0;
    }
    return pole;
}

bool same(const uint32_t* a, size_t n, const Walk& b) {
    return n == b.size() && (n == 0 || std::memcmp(a, b.data(), n * sizeof(uint32_t)) == 0);
}

} // namespace

hmf_status match_by_cores(const Mesh& mesh, const Cylinders& here, const Cylinders& there, Array<uint32_t>& found,
                          Call& call) {
    EdgeWords words;
    Walk walk;
    Array<uint32_t> spokes;
    Array<size_t> offset;
    spokes.start(call.memory);
    offset.start(call.memory);
    if (!words.start(mesh, mesh.edge_count, call.memory) || !offset.push(0)) return call.out_of_memory();
    for (const Cylinder& cylinder : there.list) {
        if (!call.tick(0, true)) return call.was_cancelled();
        if (!boundary_walk(mesh, words, there.graph, cylinder.lower, walk, call.memory)) return call.out_of_memory();
        for (const uint32_t spoke : walk)
            if (!spokes.push(spoke)) return call.out_of_memory();
        if (!offset.push(spokes.size())) return call.out_of_memory();
    }
    for (size_t c = 0; c < here.list.size(); ++c) {
        found[c] = NONE;
        if (!call.tick(0, true)) return call.was_cancelled();
        if (!boundary_walk(mesh, words, here.graph, here.list[c].lower, walk, call.memory)) return call.out_of_memory();
        for (uint32_t d = 0; d < there.list.size(); ++d)
            if (same(spokes.data() + offset[d], offset[d + 1] - offset[d], walk)) found[c] = d;
    }
    return HMF_OK;
}

hmf_status ClassReference::take(Foliation& f, const EdgeWords& words, Call& call) {
    Call quiet(call.memory, nullptr, nullptr, nullptr);
    Cylinders cylinders;
    Walk walk;
    height_.start(call.memory);
    spoke_.start(call.memory);
    offset_.start(call.memory);
    if (cylinders.build(f, nullptr, nullptr, quiet)) return is_memory(quiet.status()) ? call.out_of_memory() : HMF_OK;
    const size_t n = cylinders.list.size();
    heights_only_ = f.mesh.marked_count > 0;
    if (!loop_.allocate(call.memory, n) || !offset_.push(0)) return call.out_of_memory();
    for (uint32_t c = 0; c < n; ++c) {
        loop_[c] = c;
        if (heights_only_) {
            if (!height_.push(cylinders.list[c].height)) return call.out_of_memory();
            continue;
        }
        if (!boundary_walk(f.mesh, words, cylinders.graph, cylinders.list[c].lower, walk, call.memory))
            return call.out_of_memory();
        for (const uint32_t spoke : walk)
            if (!spoke_.push(spoke)) return call.out_of_memory();
        if (!height_.push(cylinders.list[c].height) || !offset_.push(spoke_.size())) return call.out_of_memory();
    }
    return HMF_OK;
}

hmf_status ClassReference::number_by_class(const Mesh& mesh, const EdgeWords& words, const Loops& loops, Call& call) {
    Walk walk;
    for (uint32_t& l : loop_) l = NONE;
    for (uint32_t l = 0; l < loops.count(); ++l) {
        if (!walk_on_the_left(
                mesh, words, loops.offsets[l], loops.offsets[l + 1], [&](uint64_t i) { return loops.crossings[i]; },
                walk, call.memory))
            return call.out_of_memory();
        for (size_t c = 0; c < height_.size(); ++c)
            if (same(spoke_.data() + offset_[c], offset_[c + 1] - offset_[c], walk)) loop_[c] = l;
    }
    return HMF_OK;
}

void ClassReference::number_by_weight(const Array<int64_t>& weights) {
    // Each the first loop of its weight that is left.
    for (uint32_t& l : loop_) l = NONE;
    for (uint32_t l = 0; l < weights.size(); ++l)
        for (size_t c = 0; c < height_.size(); ++c)
            if (loop_[c] == NONE && height_[c] == weights[l]) {
                loop_[c] = l;
                break;
            }
}

bool ClassReference::agrees(const Array<int64_t>& weights) const {
    if (height_.size() != weights.size()) return false;
    for (size_t c = 0; c < height_.size(); ++c)
        if (loop_[c] == NONE || weights[loop_[c]] != height_[c]) return false;
    return true;
}

// Each height of the reference once; false: out of memory.
bool ClassReference::heights_are_there(const Cylinders& cylinders, int64_t finer, Call& call,
                                       ClassResult& result) const {
    const size_t n = height_.size();
    Array<uint8_t> taken;
    if (!taken.allocate_filled(call.memory, cylinders.list.size(), 0)) return false;
    for (size_t c = 0; c < n; ++c) {
        size_t d = 0;
        while (d < taken.size() && (taken[d] || cylinders.list[d].height != height_[c] * finer)) ++d;
        if (d < taken.size()) {
            taken[d] = 1;
            continue;
        }
        result.loss = ClassLoss::height;
        result.loop = loop_[c];
        result.wanted = static_cast<double>(height_[c]);
        return true;
    }
    if (taken.size() == n) result.state = ClassState::checked;
    else result.loss = ClassLoss::leaves;
    return true;
}

hmf_status ClassReference::compare(Foliation& f, const EdgeWords& words, const ZeroList& zeros, int64_t finer,
                                   Call& call, ClassResult& result) const {
    result = {};
    if (!known()) return HMF_OK;
    Call quiet(call.memory, nullptr, nullptr, nullptr);
    Cylinders cylinders;
    hmf_status status = HMF_OK;
    // All zeros are there if their indices have the sum that Poincare and Hopf ask for.
    const int64_t chi =
        static_cast<int64_t>(f.mesh.vertex_count) - f.mesh.edge_count + static_cast<int64_t>(f.mesh.face_count);
    const int64_t whole = 2 * chi - static_cast<int64_t>(f.mesh.marked_count);
    if (zeros.known && !heights_only_) {
        status = cylinders.build(f, zeros, quiet);
        int64_t sum = 0;
        if (!is_memory(status) && (has_pole(cylinders.graph, sum) || sum != whole)) {
            Call again(call.memory, nullptr, nullptr, nullptr);
            status = cylinders.build(f, nullptr, nullptr, again);
        }
    } else {
        status = cylinders.build(f, nullptr, nullptr, quiet);
    }
    if (is_memory(status)) return call.out_of_memory();
    result.crossings = cylinders.graph.crossings.size();
    result.state = ClassState::lost;
    int64_t sum = 0;
    if (status != HMF_OK || has_pole(cylinders.graph, sum) || sum != whole) {
        result.loss = ClassLoss::leaves;
        return HMF_OK;
    }
    if (heights_only_) return heights_are_there(cylinders, finer, call, result) ? HMF_OK : call.out_of_memory();
    // Each loop and its cylinder.
    const size_t n = height_.size(), m = cylinders.list.size();
    Array<uint32_t> of_loop;
    Walk walk;
    if (!of_loop.allocate_filled(call.memory, n, NONE)) return call.out_of_memory();
    for (uint32_t d = 0; d < m; ++d) {
        if (!boundary_walk(f.mesh, words, cylinders.graph, cylinders.list[d].lower, walk, call.memory))
            return call.out_of_memory();
        for (size_t c = 0; c < n; ++c)
            if (same(spoke_.data() + offset_[c], offset_[c + 1] - offset_[c], walk)) {
                of_loop[c] = d;
                break;
            }
    }
    for (size_t c = 0; c < n; ++c) {
        const int64_t wanted = height_[c] * finer;
        const int64_t found = of_loop[c] == NONE ? 0 : cylinders.list[of_loop[c]].height;
        if (found == wanted) continue;
        bool elsewhere = false;
        for (const Cylinder& cylinder : cylinders.list) elsewhere |= cylinder.height == wanted;
        result.loss = of_loop[c] == NONE && elsewhere ? ClassLoss::core : ClassLoss::height;
        result.loop = loop_[c];
        result.wanted = static_cast<double>(height_[c]);
        result.found = static_cast<double>(found) / static_cast<double>(finer);
        return HMF_OK;
    }
    if (m != n) {
        result.loss = ClassLoss::leaves; // one more than there are loops
        return HMF_OK;
    }
    result.state = ClassState::proven;
    return HMF_OK;
}

} // namespace hmf
