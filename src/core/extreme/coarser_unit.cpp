#include "coarser_unit.hpp"

namespace hmf {

namespace {

// Where each vertex lies on its edge of the tree, modulo the coarser unit.
class TreePlaces {
public:
    TreePlaces(Foliation& f, uint32_t bits) : f_(f), multiple_(int64_t{1} << bits) {}

    Done find(Memory& memory) {
        const Mesh& mesh = f_.mesh;
        queue_.start(memory);
        if (!sign_.allocate_filled(memory, size_t{2} * mesh.edge_count, 0)
            || !place_.allocate_filled(memory, mesh.vertex_count, UNKNOWN) || !queue_.reserve(mesh.vertex_count)
            || !read_clusters(memory))
            return false;
        if (queue_.empty()) start_in_triangle();
        if (queue_.empty()) start_at(0, 0); // genus 1: all places are as good
        walk();
        return true;
    }

    // Do the places fit to all values?  Not if zeros are no multiples apart.
    bool are_consistent() const {
        const Mesh& mesh = f_.mesh;
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
            if (place_[mesh.target(h)] != arrival(h)) return false;
        return true;
    }

    // Each vertex to the nearest multiple.
    void round(uint32_t bits) {
        // The way of each vertex in its + direction.
        for (int64_t& p : place_) p = 2 * p < multiple_ ? -p : multiple_ - p;
        for (uint32_t e = 0; e < f_.mesh.edge_count; ++e) {
            const uint32_t h = 2 * e;
            f_.value[e] -= sign_[h] * place_[f_.mesh.origin[h]] + sign_[h + 1] * place_[f_.mesh.origin[h + 1]];
            f_.value[e] >>= bits;
        }
    }

private:
    static constexpr int64_t UNKNOWN = -1;

    int64_t remainder(int64_t x) const { return x & (multiple_ - 1); } // of negative numbers, too
    void start_at(uint32_t vertex, int64_t place) {
        place_[vertex] = place;
        queue_.add(vertex);
    }

    // Signs at regular clusters; the others lie at 0.
    Done read_clusters(Memory& memory) {
        Array<double> weight; // of no use here
        if (!weight.allocate_filled(memory, f_.mesh.edge_count, 0)) return false;
        const uint32_t before = f_.epoch;
        for (uint32_t v = 0; v < f_.mesh.vertex_count; ++v) {
            if (f_.stamp[v] > before) continue;
            const Cluster cluster = explore_cluster(f_, v);
            if (cluster.index() == 0 && cluster.marked == 0) {
                sign_regular_cluster(f_, weight.data(), sign_.data());
                continue;
            }
            for (const uint32_t u : f_.members) start_at(u, 0);
        }
        return true;
    }

    // All zeros are in triangles: their branch points lie at 0.
    void start_in_triangle() {
        const Mesh& mesh = f_.mesh;
        for (uint32_t h = 0; h < 2 * mesh.edge_count && queue_.empty(); ++h) {
            const int64_t corner2 = f_.corner2(h);
            if (corner2 == 0 || f_.corner2(mesh.next[h]) == 0 || f_.corner2(mesh.prev(h)) == 0) continue;
            start_at(mesh.origin[h], remainder(sign_[h] > 0 ? -corner2 / 2 : corner2 / 2));
        }
    }

    // The place of the far end of h, seen from its origin.
    int64_t arrival(uint32_t h) const {
        const int64_t here = place_[f_.mesh.origin[h]];
        const int64_t ahead = remainder((sign_[h] < 0 ? -here : here) + f_.at(h));
        return sign_[twin(h)] > 0 ? remainder(-ahead) : ahead;
    }

    void walk() {
        for (size_t i = 0; i < queue_.size(); ++i) {
            for (const uint32_t h : f_.mesh.around(queue_[i])) {
                const uint32_t w = f_.mesh.target(h);
                if (place_[w] == UNKNOWN) start_at(w, arrival(h));
            }
        }
    }

    Foliation& f_;
    const int64_t multiple_;
    Array<int8_t> sign_; // per half-edge; 0: out of a zero or a marked vertex, which lie at 0
    Array<int64_t> place_;
    Array<uint32_t> queue_;
};

} // namespace

Done to_coarser_unit(Foliation& f, uint32_t bits, Memory& memory, bool& exact) {
    exact = false;
    TreePlaces places(f, bits);
    if (!places.find(memory)) return false;
    exact = places.are_consistent();
    if (exact) places.round(bits);
    return true;
}

} // namespace hmf
