// Cylinders against loops; see class_certificate.hpp.
#include "class_certificate.hpp"

#include <algorithm>

namespace hmf {

namespace {

// Failures but this one only say that the class is another one: the caller does not see them.
bool is_memory(hmf_status status) { return status == HMF_ERROR_MEMORY || status == HMF_ERROR_MEMORY_LIMIT; }

// No pole, and zeros whose indices add up to `whole`.
bool has_all_zeros(const CriticalGraph& graph, int64_t whole) {
    int64_t sum = 0;
    for (const Zero& z : graph.zeros) {
        if (z.index > 0) return false;
        sum += z.index;
    }
    return sum == whole;
}

} // namespace

Done add_boundary(const Mesh& mesh, const CurveWords& words, const CriticalGraph& graph, uint32_t boundary,
                  ClassTable& names) {
    const Boundary& b = graph.boundaries[boundary];
    return names.add(mesh, words, b.begin, b.end - 1, [&](uint64_t i) { return graph.crossings[i].half_edge; });
}

hmf_status ClassCertificate::take(Foliation& f, const CurveWords& words, Call& call) {
    Call quiet(&call);
    Cylinders cylinders;
    height_.start(call.memory);
    names_.start(call.memory);
    if (cylinders.build(f, nullptr, nullptr, quiet)) {
        if (is_memory(quiet.status())) return call.out_of_memory();
        return call.cancelled() ? call.was_cancelled() : HMF_OK;
    }
    const size_t n = cylinders.list.size();
    if (!loop_.allocate(call.memory, n)) return call.out_of_memory();
    for (uint32_t c = 0; c < n; ++c) {
        loop_[c] = c;
        if (!add_boundary(f.mesh, words, cylinders.graph, cylinders.list[c].lower, names_)) return call.out_of_memory();
        if (!height_.push(cylinders.list[c].height)) return call.out_of_memory();
    }
    return HMF_OK;
}

int64_t ClassCertificate::largest_height() const {
    int64_t largest = 0;
    for (const int64_t h : height_) largest = std::max(largest, h);
    return largest;
}

hmf_status ClassCertificate::number_by_class(const Mesh& mesh, const CurveWords& words, const Loops& loops,
                                             Call& call) {
    ClassTable of_loops;
    of_loops.start(call.memory);
    const auto half_edge = [&](uint64_t i) { return loops.crossings[i]; };
    for (uint32_t l = 0; l < loops.count(); ++l)
        if (!of_loops.add(mesh, words, loops.offsets[l], loops.offsets[l + 1], half_edge)) return call.out_of_memory();
    for (size_t c = 0; c < height_.size(); ++c) loop_[c] = names_.find(c, of_loops);
    return HMF_OK;
}

void ClassCertificate::number_by_weight(const Array<int64_t>& weights) {
    // Each the first loop of its weight that is left.
    for (uint32_t& l : loop_) l = NONE;
    for (uint32_t l = 0; l < weights.size(); ++l)
        for (size_t c = 0; c < height_.size(); ++c)
            if (loop_[c] == NONE && height_[c] == weights[l]) {
                loop_[c] = l;
                break;
            }
}

bool ClassCertificate::agrees(const Array<int64_t>& weights) const {
    if (height_.size() != weights.size()) return false;
    for (size_t c = 0; c < height_.size(); ++c)
        if (loop_[c] == NONE || weights[loop_[c]] != height_[c]) return false;
    return true;
}

// The cylinders of a result. complete: they exist with all zeros, the indices of the zeros have the sum of the
// Poincare-Hopf theorem, and there is no pole.
hmf_status ClassCertificate::find_cylinders(Foliation& f, const ZeroList& zeros, Cylinders& cylinders, bool& complete,
                                            Call& call) const {
    const int64_t whole = 2 * f.mesh.euler() - static_cast<int64_t>(f.mesh.marked_count);
    const bool known = zeros.known && f.mesh.marked_count == 0;
    Call quiet(&call);
    hmf_status status = known ? cylinders.build(f, zeros, quiet) : cylinders.build(f, nullptr, nullptr, quiet);
    if (known && !is_memory(status) && !call.cancelled() && !has_all_zeros(cylinders.graph, whole)) {
        Call again(&call);
        status = cylinders.build(f, nullptr, nullptr, again);
    }
    if (is_memory(status)) return call.out_of_memory();
    if (call.cancelled()) return HMF_CANCELLED;
    complete = status == HMF_OK && has_all_zeros(cylinders.graph, whole);
    return HMF_OK;
}

hmf_status ClassCertificate::compare(Foliation& f, const CurveWords& words, const ZeroList& zeros, int64_t finer,
                                     Call& call, ClassCheck& result) const {
    result = {};
    if (!known()) return HMF_OK;
    Cylinders cylinders;
    bool complete = false;
    if (const hmf_status status = find_cylinders(f, zeros, cylinders, complete, call)) return status;
    result.crossings = cylinders.graph.crossings.size();
    result.state = ClassState::lost;
    if (!complete) {
        result.loss = ClassLoss::leaves;
        return HMF_OK;
    }
    // Each loop and its cylinder.
    const size_t n = height_.size(), m = cylinders.list.size();
    Array<uint32_t> of_loop;
    ClassTable found_names;
    found_names.start(call.memory);
    if (!of_loop.allocate_filled(call.memory, n, NONE)) return call.out_of_memory();
    for (uint32_t d = 0; d < m; ++d) {
        if (!add_boundary(f.mesh, words, cylinders.graph, cylinders.list[d].lower, found_names))
            return call.out_of_memory();
        const uint32_t c = found_names.find(d, names_);
        if (c != NONE) of_loop[c] = d;
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
