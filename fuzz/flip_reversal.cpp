// Flips and their reversal on random foliations, also flips that make several
// edges between two vertices and edges from a vertex to itself: no pole, exact
// triangle inequalities, index sum and class kept, connectivity restored
// exactly, values restored wherever no end point had to be moved.
#include "random_foliation.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace fuzz;
    Bytes bytes(data, size);
    RandomFoliation random(bytes);
    Foliation& f = random.f;
    const std::vector<uint32_t> connectivity = random.connectivity();
    const std::vector<int64_t> values = random.values();
    TransportStatistics statistics;
    struct Done {
        uint32_t edge;
        bool reverse;
    };
    std::vector<Done> log;
    bool moved = false;
    for (uint32_t i = 0; i < 60 && !bytes.empty(); ++i) {
        const uint32_t edge = bytes.wide_below(f.mesh.edge_count), h = 2 * edge;
        if (bytes.byte() % 32 == 0) {
            random.shake(bytes, 1);
            moved = true;
        }
        // An edge with the same triangle on both sides cannot be flipped.
        if (f.mesh.face[h] == f.mesh.face[twin(h)]) continue;
        const bool reverse = bytes.byte() % 2 != 0;
        const std::vector<int64_t> before = random.values();
        const uint64_t repairs = statistics.bad_flips;
        flip_foliation(f, edge, reverse, statistics);
        random.assert_valid();
        // There and back at once.
        const std::vector<uint32_t> here = random.connectivity();
        flip_foliation(f, edge, !reverse, statistics);
        random.assert_valid();
        if (statistics.bad_flips == repairs) FUZZ_ASSERT(random.values() == before);
        flip_foliation(f, edge, reverse, statistics);
        random.assert_valid();
        FUZZ_ASSERT(random.connectivity() == here);
        log.push_back({edge, reverse});
    }
    while (!log.empty()) {
        flip_foliation(f, log.back().edge, !log.back().reverse, statistics);
        random.assert_valid();
        log.pop_back();
    }
    FUZZ_ASSERT(random.connectivity() == connectivity);
    random.assert_class();
    FUZZ_ASSERT(statistics.bad_flips_left == 0);
    if (statistics.bad_flips == 0 && !moved) FUZZ_ASSERT(random.values() == values);
    return 0;
}
