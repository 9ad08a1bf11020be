#include "closed_forms.hpp"

#include "../../core/homotopy/tree_cotree.hpp"

#include <algorithm>

namespace hmf {

namespace {

// The value along a half-edge.
int64_t along(const int64_t* value, uint32_t h) { return h & 1 ? -value[edge_of(h)] : value[edge_of(h)]; }

// Rows of the skew symmetric matrix of products are combined until it is canonical.  All principal minors are 0 or 1:
// the curves meet in one polygon, and a part of them cuts it into one disk or does not.  So every product that remains
// is -1, 0 or 1, and every row has a partner.
class CanonicalBasis {
public:
    CanonicalBasis(uint32_t count, Array<int64_t>& row, Array<int64_t>& product, Call& call) :
        count_(count), row_(row), product_(product), call_(call) {}

    // order: pairs of rows with product 1.
    hmf_status run(Array<uint32_t>& order) {
        for (uint32_t first = 0; first < count_; first += 2) {
            uint32_t partner = first + 1;
            while (partner < count_ && at(order[first], order[partner]) == 0) ++partner;
            const int64_t product = partner < count_ ? at(order[first], order[partner]) : 0;
            if (product != 1 && product != -1)
                return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                                  "A closed form has no partner with the product 1. Please report it.");
            std::swap(order[first + 1], order[partner]);
            if (product < 0) std::swap(order[first], order[first + 1]);
            const uint32_t a = order[first], b = order[first + 1];
            for (uint32_t k = first + 2; k < count_; ++k) {
                if (!call_.work(8 * count_)) return call_.was_cancelled();
                const uint32_t i = order[k];
                add(i, a, -at(i, b)); // then the product with b is 0, and with b's multiple the one with a
                add(i, b, at(i, a));
            }
        }
        return HMF_OK;
    }

private:
    int64_t& at(uint32_t i, uint32_t j) { return product_[size_t{count_} * i + j]; }
    // row i += factor * row j, and the products with it.
    void add(uint32_t i, uint32_t j, int64_t factor) {
        if (factor == 0) return;
        for (uint32_t k = 0; k < count_; ++k) {
            row_[size_t{count_} * i + k] += factor * row_[size_t{count_} * j + k];
            at(i, k) += factor * at(j, k);
        }
        for (uint32_t k = 0; k < count_; ++k) at(k, i) = -at(i, k);
        at(i, i) = 0;
    }

    const uint32_t count_;
    Array<int64_t>&row_, &product_;
    Call& call_;
};

} // namespace

Done ClosedForms::find_curves(Call& call) {
    const Mesh& mesh = *mesh_;
    Array<EdgeKind> kind;
    Array<uint32_t> parent, depth, queue; // of each face: the half-edge towards the root, on its side
    offset_.start(call.memory);
    crossed_.start(call.memory);
    if (!find_trees(mesh, kind, call) || !parent.allocate_filled(call.memory, mesh.face_count, NONE)
        || !depth.allocate(call.memory, mesh.face_count) || !queue.allocate(call.memory, mesh.face_count)
        || !offset_.push(0))
        return false;
    uint32_t size = 0;
    depth[mesh.face[0]] = 0;
    queue[size++] = 0; // a half-edge of each triangle
    for (uint32_t i = 0; i < size; ++i) {
        if (!call.work(8)) return false;
        uint32_t h = queue[i];
        for (uint32_t side = 0; side < 3; ++side, h = mesh.next[h]) {
            if (kind[edge_of(h)] != EdgeKind::across || h == parent[mesh.face[h]]) continue;
            parent[mesh.face[twin(h)]] = twin(h);
            depth[mesh.face[twin(h)]] = depth[mesh.face[h]] + 1;
            queue[size++] = twin(h);
        }
    }
    Array<uint32_t> back;
    back.start(call.memory);
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (kind[e] != EdgeKind::side) continue;
        // Across the edge, then from its right to its left through the tree.
        if (!crossed_.push(2 * e)) return false;
        back.clear();
        for (uint32_t right = mesh.face[2 * e + 1], left = mesh.face[2 * e]; right != left;) {
            if (!call.work(8)) return false;
            uint32_t& deeper = depth[right] >= depth[left] ? right : left;
            const uint32_t h = parent[deeper];
            if (!(&deeper == &right ? crossed_.push(h) : back.push(twin(h)))) return false;
            deeper = mesh.face[twin(h)];
        }
        for (size_t n = back.size(); n-- > 0;)
            if (!crossed_.push(back[n])) return false;
        if (!offset_.push(crossed_.size())) return false;
    }
    count_ = static_cast<uint32_t>(offset_.size() - 1);
    return true;
}

// In each triangle that the curve passes, from side h to side g, its form is -1 along h and +1 along g there; the
// integral of two linear forms over a triangle with sides e, next e is half of the determinant of their values on both.
int64_t ClosedForms::intersection_with_curve(const int64_t* value, uint32_t curve) const {
    uint64_t twice = 0; // sums may be large on the way
    for (uint64_t n = offset_[curve]; n < offset_[curve + 1]; ++n) {
        const uint32_t h = twin(crossed_[n]), g = crossed_[n + 1 == offset_[curve + 1] ? offset_[curve] : n + 1];
        const int64_t at_h = along(value, h), at_g = along(value, g);
        twice += static_cast<uint64_t>(mesh_->next[h] == g ? at_h + at_g : -at_h - at_g);
    }
    return static_cast<int64_t>(twice) / 2;
}

hmf_status ClosedForms::make_canonical(Call& call) {
    const size_t size = size_t{count_} * count_;
    Array<int64_t> product, value, unordered;
    Array<uint32_t> order;
    if (!product.allocate(call.memory, size) || !unordered.allocate_filled(call.memory, size, 0)
        || !value.allocate_filled(call.memory, mesh_->edge_count, 0) || !order.allocate(call.memory, count_)
        || !row_.allocate(call.memory, size))
        return call.out_of_memory();
    for (uint32_t i = 0; i < count_; ++i) {
        order[i] = i;
        unordered[size_t{count_} * i + i] = 1;
        for (uint64_t n = offset_[i]; n < offset_[i + 1]; ++n) value[edge_of(crossed_[n])] += crossed_[n] & 1 ? -1 : 1;
        for (uint32_t j = 0; j < count_; ++j) {
            product[size_t{count_} * i + j] = intersection_with_curve(value.data(), j);
            if (!call.work(4 * uint64_t{offset_[j + 1] - offset_[j]})) return call.was_cancelled();
        }
        for (uint64_t n = offset_[i]; n < offset_[i + 1]; ++n) value[edge_of(crossed_[n])] = 0;
    }
    if (CanonicalBasis(count_, unordered, product, call).run(order)) return call.status();
    for (uint32_t i = 0; i < count_; ++i) { // pairs, to the first and the second half
        const int64_t* const from = &unordered[size_t{count_} * order[i]];
        std::copy(from, from + count_, &row_[size_t{count_} * (i % 2 * (count_ / 2) + i / 2)]);
    }
    return HMF_OK;
}

hmf_status ClosedForms::build(const Mesh& mesh, Call& call) {
    mesh_ = &mesh;
    if (!find_curves(call)) return call.stopped();
    return count_ > 0 ? make_canonical(call) : HMF_OK;
}

void ClosedForms::add(uint32_t i, int64_t unit, int64_t* value) const {
    for (uint32_t curve = 0; curve < count_; ++curve) {
        const int64_t factor = row_[size_t{count_} * i + curve] * unit;
        for (uint64_t n = offset_[curve]; n < offset_[curve + 1] && factor != 0; ++n)
            value[edge_of(crossed_[n])] += crossed_[n] & 1 ? -factor : factor;
    }
}

// of_curve(c) once for each curve, then the sums of its multiples.
template <class T, class OfCurve>
Done ClosedForms::sum_rows(T* sum, Memory& memory, OfCurve of_curve) const {
    Array<T> value;
    if (!value.allocate(memory, count_)) return false;
    for (uint32_t curve = 0; curve < count_; ++curve) value[curve] = of_curve(curve);
    for (uint32_t i = 0; i < count_; ++i) {
        sum[i] = 0;
        for (uint32_t curve = 0; curve < count_; ++curve)
            sum[i] += static_cast<T>(row_[size_t{count_} * i + curve]) * value[curve];
    }
    return true;
}

Done ClosedForms::products(const double* weight, const int64_t* other, double* sum, Memory& memory) const {
    return sum_rows(sum, memory, [&](uint32_t curve) {
        double product = 0;
        for (uint64_t n = offset_[curve]; n < offset_[curve + 1]; ++n)
            product += weight[edge_of(crossed_[n])] * static_cast<double>(along(other, crossed_[n]));
        return product;
    });
}

Done ClosedForms::intersections(const int64_t* other, uint64_t* sum, Memory& memory) const {
    return sum_rows(sum, memory,
                    [&](uint32_t curve) { return static_cast<uint64_t>(intersection_with_curve(other, curve)); });
}

} // namespace hmf
