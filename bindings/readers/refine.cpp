#include "refine.hpp"

#include <iterator>
#include <map>
#include <set>
#include <utility>

namespace readers {

namespace {

class Refinement {
public:
    explicit Refinement(TriangleMesh& mesh) : mesh_(mesh), vertex_count_(mesh.vertex_count()) {
        for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
            add(t);
            whole_.push_back(t);
        }
    }
    void tell_origin() {
        std::vector<uint32_t> vertices(mesh_.vertex_count(), Origin::NONE);
        for (uint32_t v = 0; v < vertex_count_; ++v) vertices[v] = v;
        mesh_.origin.renumber(vertices, whole_);
    }

    // False: there is none.
    bool halve_longest_edge() {
        while (!longest_.empty() && !can_be_cut(longest_.rbegin()->second)) longest_.erase(std::prev(longest_.end()));
        if (longest_.empty()) return false;
        const auto [a, b] = longest_.rbegin()->second;
        const std::set<uint32_t> at_edge = edges_.at({a, b});
        const uint32_t middle = static_cast<uint32_t>(mesh_.vertex_count());
        for (size_t k = 0; k < 3; ++k) mesh_.positions.push_back((at(a)[k] + at(b)[k]) / 2);
        for (const uint32_t t : at_edge) {
            remove(t);
            const uint32_t half = static_cast<uint32_t>(mesh_.triangle_count());
            for (size_t c = 0; c < 3; ++c) {
                const uint32_t corner = mesh_.triangles[3 * t + c];
                mesh_.triangles.push_back(corner == a ? middle : corner);
                if (corner == b) mesh_.triangles[3 * t + c] = middle;
            }
            add(t);
            add(half);
            whole_.push_back(whole_[t]);
        }
        return true;
    }

private:
    using Edge = std::pair<uint32_t, uint32_t>; // the lower vertex first

    const double* at(uint32_t v) const { return &mesh_.positions[size_t{3} * v]; }
    std::pair<double, Edge> with_length(Edge edge) const {
        double square = 0;
        for (size_t k = 0; k < 3; ++k) {
            const double d = at(edge.first)[k] - at(edge.second)[k];
            square += d * d;
        }
        return {square, edge};
    }
    Edge side(uint32_t t, size_t s) const {
        const uint32_t v = mesh_.triangles[3 * t + s], w = mesh_.triangles[3 * t + (s + 1) % 3];
        return v < w ? Edge{v, w} : Edge{w, v};
    }
    // Two triangles back to back would get one new edge for both.
    bool can_be_cut(Edge edge) const {
        std::set<uint32_t> opposite;
        for (const uint32_t t : edges_.at(edge))
            for (size_t c = 0; c < 3; ++c) {
                const uint32_t v = mesh_.triangles[3 * t + c];
                if (v != edge.first && v != edge.second && !opposite.insert(v).second) return false;
            }
        return true;
    }
    void add(uint32_t t) {
        for (size_t s = 0; s < 3; ++s) {
            edges_[side(t, s)].insert(t);
            longest_.insert(with_length(side(t, s)));
        }
    }
    void remove(uint32_t t) {
        for (size_t s = 0; s < 3; ++s) {
            const auto edge = edges_.find(side(t, s));
            if (edge == edges_.end()) continue; // a triangle that names a vertex twice
            edge->second.erase(t);
            if (!edge->second.empty()) continue;
            longest_.erase(with_length(edge->first));
            edges_.erase(edge);
        }
    }

    TriangleMesh& mesh_;
    const size_t vertex_count_;                // before
    std::vector<uint32_t> whole_;              // triangle that each one was part of
    std::map<Edge, std::set<uint32_t>> edges_; // and their triangles
    std::set<std::pair<double, Edge>> longest_;
};

} // namespace

void refine(TriangleMesh& mesh, size_t triangles) {
    if (mesh.triangles.empty() || mesh.triangle_count() >= triangles) return;
    Refinement refinement(mesh);
    while (mesh.triangle_count() < triangles && refinement.halve_longest_edge()) {}
    refinement.tell_origin();
}

} // namespace readers
