// Random mixtures of all operations up and down: flips either way, splits and
// moves, and their reversal in any depth of the log; going back over a split
// is a restriction.  After each one: no pole, exact triangle inequalities, index
// sum kept; at the end the connectivity of the start and the class.
#include "../src/core/foliation/restriction.hpp"
#include "random_foliation.hpp"

namespace {

using namespace fuzz;

struct Done {
    bool is_split;
    Collapse collapse;    // of a split
    uint32_t edge = NONE; // of a flip
    bool reverse = false;
    bool simplicial = true; // before it no vertices had two edges, and none an edge to itself
};

class Mixture {
public:
    explicit Mixture(Bytes& bytes) : bytes_(bytes), random_(bytes), f_(random_.f) {
        FUZZ_ASSERT(scratch_.allocate(random_.memory()));
    }

    void run() {
        const std::vector<uint32_t> connectivity = random_.connectivity();
        for (uint32_t step = 0; step < 200 && !bytes_.empty(); ++step) {
            switch (bytes_.byte() % 8) {
            case 0:
            case 1: split(); break;
            case 2: random_.shake(bytes_, 1); break;
            case 3:
            case 4:
                for (uint32_t n = 1 + bytes_.byte() % 8u; n > 0 && !log_.empty(); --n) undo();
                break;
            default: flip(); break;
            }
            FUZZ_ASSERT(check(f_.mesh) == nullptr);
            random_.assert_valid();
        }
        while (!log_.empty()) undo();
        FUZZ_ASSERT(random_.connectivity() == connectivity);
        FUZZ_ASSERT(statistics_.bad_flips_left == 0);
        random_.assert_class();
    }

private:
    // Collapses are made on simplicial meshes only, as in a hierarchy: a split
    // must not follow a flip that gives two vertices a second edge.
    bool joined(uint32_t k, uint32_t l) const {
        if (k == l) return true;
        uint32_t h = f_.mesh.out[k];
        do {
            if (f_.mesh.target(h) == l) return true;
            h = f_.mesh.rotate_ccw(h);
        } while (h != f_.mesh.out[k]);
        return false;
    }

    void flip() {
        const uint32_t edge = bytes_.wide_below(f_.mesh.edge_count), h = 2 * edge;
        if (f_.mesh.face[h] == f_.mesh.face[twin(h)]) return;
        Done done{};
        done.edge = edge;
        done.reverse = bytes_.byte() % 2 != 0;
        done.simplicial = simplicial_;
        simplicial_ = simplicial_ && !joined(f_.mesh.origin[f_.mesh.prev(h)], f_.mesh.origin[f_.mesh.prev(twin(h))]);
        flip_foliation(f_, edge, done.reverse, statistics_);
        log_.push_back(done);
    }

    void split() {
        Mesh& mesh = f_.mesh;
        if (!simplicial_ || splits_ == RandomFoliation::spare_vertices) return;
        const uint32_t il = bytes_.wide_below(2 * mesh.edge_count);
        uint32_t degree = 0, ik = il;
        do {
            ++degree;
            ik = mesh.rotate_ccw(ik);
        } while (ik != il);
        for (uint32_t turn = 1 + bytes_.byte() % (degree - 1); turn > 0; --turn) ik = mesh.rotate_ccw(ik);
        Done done{};
        done.is_split = true;
        done.collapse = {2 * mesh.edge_count, 2 * mesh.edge_count + 2, 2 * mesh.edge_count + 4, twin(ik), il,
                         mesh.vertex_count,   mesh.face_count,         mesh.face_count + 1};
        count(1);
        hmf::split(f_.mesh, done.collapse);
        split_values(f_.value, done.collapse);
        log_.push_back(done);
    }

    void undo() {
        const Done done = log_.back();
        log_.pop_back();
        if (done.is_split) {
            FUZZ_ASSERT(collapse_foliation(f_, done.collapse, scratch_));
            count(-1);
        } else {
            flip_foliation(f_, done.edge, !done.reverse, statistics_);
            simplicial_ = done.simplicial;
        }
        random_.assert_valid();
    }

    void count(int32_t n) {
        f_.mesh.vertex_count += static_cast<uint32_t>(n);
        f_.mesh.edge_count += static_cast<uint32_t>(3 * n);
        f_.mesh.face_count += static_cast<uint32_t>(2 * n);
        splits_ += static_cast<uint32_t>(n);
    }

    Bytes& bytes_;
    RandomFoliation random_;
    Foliation& f_;
    RestrictionScratch scratch_;
    TransportStatistics statistics_;
    std::vector<Done> log_;
    uint32_t splits_ = 0;
    bool simplicial_ = true;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Bytes bytes(data, size);
    Mixture(bytes).run();
    return 0;
}
