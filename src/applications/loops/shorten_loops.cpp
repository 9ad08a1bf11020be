// Shortens loops within their classes, one after another: each becomes the shortest in a strip around it that the
// others do not enter (annulus.hpp).
#include "../../core/base/cyclic.hpp"
#include "annulus.hpp"

#include "../../core/curves/disjoint.hpp"
#include "find_loops.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr size_t STRIP = 10;            // triangles across the strip
constexpr size_t MORE = 512;            // of a short loop, but not more than its share of the mesh
constexpr int SHORTEN_ROUNDS = 6;       // strips for one loop
constexpr double SHORTEN_GAIN = 1e-9;   // relative, what counts as shorter
constexpr double SHORTEN_LITTLE = 2e-3; // relative, what is not worth another strip

class Shortener {
public:
    Shortener(const Mesh& mesh, const double* position, size_t width, double ambiguous, Loops& loops, Call& call) :
        mesh_(mesh), call_(call), loops_(loops), width_(width),
        more_(std::min(MORE, mesh.face_count / (loops.count() + 1))), length_(mesh, position, ambiguous),
        annulus_(mesh, length_, call) {}

    hmf_status run(size_t first) {
        const size_t n = loops_.count();
        if (!curves_.allocate(mesh_, call_.memory)) return call_.out_of_memory();
        bool are_disjoint = false;
        if (!disjoint(mesh_, loops_, 0, n, curves_, &loop_of_, call_, are_disjoint)) return call_.out_of_memory();
        if (!are_disjoint)
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, 0,
                              "Carried loops are not disjoint. Please report this.");
        for (size_t c = first; c < n; ++c)
            for (int round = 0; round < SHORTEN_ROUNDS; ++round) {
                if (!call_.tick(0, true)) return call_.was_cancelled();
                bool again = false;
                const hmf_status status = shorten(c, again);
                if (status) return status;
                if (!again) break;
            }
        return HMF_OK;
    }

private:
    // Where loop c passes between the other loops, in its own direction.
    Done find_places(size_t c) {
        uint32_t component = 0;
        while (loop_of_[component] != c) ++component;
        const uint64_t first = curves_.components.offsets[component], end = curves_.components.offsets[component + 1];
        const uint32_t* const traced = curves_.components.crossings.data() + first;
        const size_t n = static_cast<size_t>(end - first);
        const bool same = same_cycle(traced, loops_.crossings.data() + loops_.offsets[c], n);
        if (!places_.allocate(call_.memory, n)) return false;
        uint32_t h = traced[0], p = curves_.begin[component] - curves_.first[edge_of(h)];
        if (h & 1u) p = curves_.count[edge_of(h)] - 1 - p;
        for (size_t k = 0; k < n; ++k) {
            const uint32_t e = edge_of(h), all = curves_.count[e];
            uint32_t before = 0, others = 0; // others between the origin and the loop; all others
            for (uint32_t q = 0; q < all; ++q) {
                if (curves_.strand[curves_.first[e] + (h & 1u ? all - 1 - q : q)] / 2 == component) continue;
                ++others;
                before += q < p;
            }
            places_[same ? k : n - 1 - k] = same ? Annulus::Place{h, before} : Annulus::Place{twin(h), others - before};
            curves_.step(mesh_, h, p);
        }
        return true;
    }

    double length(const uint32_t* crossings, size_t n) const {
        double sum = 0;
        for (size_t i = 0; i < n; ++i) sum += length_(edge_of(crossings[i]));
        return sum;
    }

    // again: it gained much, and may gain more.
    hmf_status shorten(size_t c, bool& again) {
        const uint64_t first = loops_.offsets[c], end = loops_.offsets[c + 1];
        const size_t n = static_cast<size_t>(end - first);
        if (!find_places(c)) return call_.out_of_memory();
        for (uint64_t i = first; i < end; ++i) --curves_.count[edge_of(loops_.crossings[i])];
        const double before = length(loops_.crossings.data() + first, n);
        const Done searched = annulus_.shortest(curves_.count, places_, width_ * (STRIP * n + more_),
                                                before * (1 - SHORTEN_GAIN), found_);
        for (uint64_t i = first; i < end; ++i) ++curves_.count[edge_of(loops_.crossings[i])];
        if (!searched) return call_.stopped();
        size_t from = 0, to = 0;
        remove_backtracking(found_, from, to);
        const double after = length(found_.data() + from, to - from);
        if (from == to || !(after < before * (1 - SHORTEN_GAIN))) return HMF_OK;
        // The new loop in place of the old one, if the loops stay simple and disjoint.
        Loops changed;
        if (!changed.start(call_.memory)) return call_.out_of_memory();
        for (size_t k = 0; k < loops_.count(); ++k)
            if (!(k == c ? changed.add(found_.data() + from, to - from) : changed.add(loops_, k)))
                return call_.out_of_memory();
        bool sound = false;
        if (!disjoint(mesh_, changed, 0, changed.count(), curves_, &loop_of_, call_, sound))
            return call_.out_of_memory();
        if (sound) {
            again = after < before * (1 - SHORTEN_LITTLE);
            loops_.swap(changed);
        } else if (!disjoint(mesh_, loops_, 0, loops_.count(), curves_, &loop_of_, call_, sound)) {
            return call_.out_of_memory();
        }
        return HMF_OK;
    }

    const Mesh& mesh_;
    Call& call_;
    Loops& loops_;
    size_t width_, more_;
    DualLength length_;
    Annulus annulus_;
    Multicurve curves_;
    Array<uint32_t> loop_of_, found_;
    Array<Annulus::Place> places_;
};

} // namespace

hmf_status shorten_loops(const Mesh& mesh, const double* position, size_t first, size_t width, double ambiguous,
                         Call& call, Loops& loops) {
    Shortener shortener(mesh, position, width, ambiguous, loops, call);
    return shortener.run(first);
}

} // namespace hmf
