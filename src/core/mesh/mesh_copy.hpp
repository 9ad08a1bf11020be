// The arrays of a mesh that is to be changed: a copy with room to grow.
#pragma once

#include "mesh.hpp"

namespace hmf {

class MeshCopy {
public:
    // Room for meshes up to the size of `largest`.
    Done allocate(const Mesh& largest, Memory& memory) {
        return allocate_sides(largest, memory) && out_.allocate(memory, largest.vertex_count);
    }
    Done allocate_sides(const Mesh& largest, Memory& memory) {
        const size_t sides = size_t{2} * largest.edge_count;
        return origin_.allocate(memory, sides) && next_.allocate(memory, sides) && face_.allocate(memory, sides);
    }
    bool has_sides() const { return !origin_.empty(); }
    void release() {
        origin_.release();
        next_.release();
        face_.release();
        out_.release();
    }
    // The copy, in arrays of this object.
    Mesh of(const Mesh& from) {
        Mesh mesh = sides_of(from);
        mesh.out = copy(from.out, from.vertex_count, out_, Parallel());
        return mesh;
    }
    // All but `out`, which is that of the other mesh.
    Mesh sides_of(const Mesh& from, const Parallel& parallel = Parallel()) {
        Mesh mesh = from;
        mesh.origin = copy(from.origin, size_t{2} * from.edge_count, origin_, parallel);
        mesh.next = copy(from.next, size_t{2} * from.edge_count, next_, parallel);
        mesh.face = copy(from.face, size_t{2} * from.edge_count, face_, parallel);
        return mesh;
    }

private:
    static uint32_t* copy(const uint32_t* from, size_t n, Array<uint32_t>& to, const Parallel& parallel) {
        parallel.copy(to.data(), from, n);
        return to.data();
    }
    Array<uint32_t> origin_, next_, face_, out_;
};

} // namespace hmf
