// Splits and their reversal on random foliations: no pole, exact triangle
// inequalities, index sum kept; collapsing again restores the connectivity
// exactly, and the values too.  If the foliation moved in between, it is
// restricted: again no pole.
#include "../src/core/foliation/restriction.hpp"
#include "../tests/support/check_mesh.hpp"
#include "random_foliation.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace fuzz;
    Bytes bytes(data, size);
    RandomFoliation random(bytes);
    Foliation& f = random.f;
    const std::vector<uint32_t> connectivity = random.connectivity();
    const std::vector<int64_t> values = random.values();
    std::vector<Collapse> log;
    bool moved = false;
    for (uint32_t i = 0; i < RandomFoliation::spare_vertices && !bytes.empty(); ++i) {
        Mesh& mesh = f.mesh;
        if (bytes.byte() % 8 == 0) {
            random.shake(bytes, 1); // opens the zero edges that earlier splits made
            moved = true;
        }
        // Vertex i is split between its half-edges to k and to l.
        const uint32_t il = bytes.wide_below(2 * mesh.edge_count);
        uint32_t degree = 0, ik = il;
        do {
            ++degree;
            ik = mesh.rotate_ccw(ik);
        } while (ik != il);
        for (uint32_t turn = 1 + bytes.byte() % (degree - 1); turn > 0; --turn) ik = mesh.rotate_ccw(ik);
        const Collapse c{2 * mesh.edge_count, 2 * mesh.edge_count + 2, 2 * mesh.edge_count + 4, twin(ik), il,
                         mesh.vertex_count,   mesh.face_count,         mesh.face_count + 1};
        mesh.vertex_count += 1;
        mesh.edge_count += 3;
        mesh.face_count += 2;
        split(f.mesh, c);
        split_values(f.value, c);
        FUZZ_ASSERT(check(mesh) == nullptr);
        random.assert_valid();
        log.push_back(c);
    }
    if (!moved) {
        while (!log.empty()) {
            Mesh& mesh = f.mesh;
            const Collapse c = log.back(), again = collapse(mesh, c.h);
            FUZZ_ASSERT(again.jk == c.jk && again.lj == c.lj && again.ki == c.ki && again.il == c.il
                        && again.vertex == c.vertex);
            mesh.vertex_count -= 1;
            mesh.edge_count -= 3;
            mesh.face_count -= 2;
            FUZZ_ASSERT(check(mesh) == nullptr);
            random.assert_valid();
            log.pop_back();
        }
        FUZZ_ASSERT(random.connectivity() == connectivity);
        FUZZ_ASSERT(random.values() == values);
    } else {
        // The foliation has changed in between: it goes down by restriction.
        RestrictionScratch scratch;
        FUZZ_ASSERT(scratch.allocate(random.memory()));
        while (!log.empty()) {
            FUZZ_ASSERT(collapse_foliation(f, log.back(), scratch));
            f.mesh.vertex_count -= 1;
            f.mesh.edge_count -= 3;
            f.mesh.face_count -= 2;
            FUZZ_ASSERT(check(f.mesh) == nullptr);
            random.assert_valid();
            log.pop_back();
        }
        FUZZ_ASSERT(random.connectivity() == connectivity);
    }
    random.assert_class();
    return 0;
}
