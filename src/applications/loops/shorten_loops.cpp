// Shortens loops within their classes, one after another: each becomes the shortest in a strip around it that the
// others do not enter (annulus.hpp).
#include "../../core/base/heap_sort.hpp"
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
        if (!curves_.allocate(mesh_, call_.memory) || !test_.allocate(mesh_, call_.memory))
            return call_.out_of_memory();
        bool are_disjoint = false;
        if (!disjoint(mesh_, loops_, 0, n, curves_, nullptr, call_, are_disjoint)) return call_.out_of_memory();
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
    struct Own { // crossing of the loop, from the origin of half-edge 2 * edge
        uint32_t edge, position;
    };

    // Where loop c passes between the other loops. The crossing numbers of all loops tell: of the curves that cross its
    // first edge, it is the one that goes on as the loop does.
    Done find_places(size_t c) {
        const uint32_t* const loop = loops_.loop(c);
        const size_t n = loops_.length(c);
        if (!places_.allocate(call_.memory, n)) return false;
        for (uint32_t place = 0; place < curves_.count[edge_of(loop[0])]; ++place) {
            uint32_t h = loop[0], p = place;
            size_t k = 0;
            for (; k < n && h == loop[k]; ++k) {
                places_[k] = {h, p};
                curves_.step(mesh_, h, p);
            }
            if (!call_.work(4 * (k + 1))) return false;
            if (k == n && h == loop[0] && p == place) break;
        }
        return leave_out_own();
    }

    // Of the places, those between the other loops: without the crossings of the loop itself.
    Done leave_out_own() {
        own_.start(call_.memory);
        for (const Annulus::Place& place : places_) {
            const uint32_t h = place.half_edge, e = edge_of(h);
            if (!own_.push({e, h & 1u ? curves_.count[e] - 1 - place.position : place.position})) return false;
        }
        heap_sort(own_.data(), own_.size(), [](const Own& a, const Own& b) {
            return a.edge != b.edge ? a.edge < b.edge : a.position < b.position;
        });
        for (Annulus::Place& place : places_) {
            const uint32_t h = place.half_edge, e = edge_of(h), all = curves_.count[e];
            const Own here = {e, h & 1u ? all - 1 - place.position : place.position};
            const Own* const at = std::lower_bound(own_.begin(), own_.end(), here, [](const Own& a, const Own& b) {
                return a.edge != b.edge ? a.edge < b.edge : a.position < b.position;
            });
            uint32_t below = 0, above = 0;
            for (const Own* o = at; o != own_.begin() && (o - 1)->edge == e; --o) ++below;
            for (const Own* o = at + 1; o != own_.end() && o->edge == e; ++o) ++above;
            place.position -= h & 1u ? above : below;
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
        if (!one_is_disjoint(mesh_, changed, c, test_, call_, sound)) return call_.stopped();
        if (!sound) return HMF_OK;
        for (uint64_t i = first; i < end; ++i) --curves_.count[edge_of(loops_.crossings[i])];
        if (!curves_.add(found_.data() + from, to - from)) return call_.out_of_memory();
        again = after < before * (1 - SHORTEN_LITTLE);
        loops_.swap(changed);
        return HMF_OK;
    }

    const Mesh& mesh_;
    Call& call_;
    Loops& loops_;
    size_t width_, more_;
    DualLength length_;
    Annulus annulus_;
    Multicurve curves_, test_; // curves_: the crossing numbers of all loops
    Array<uint32_t> found_;
    Array<Own> own_;
    Array<Annulus::Place> places_;
};

} // namespace

hmf_status shorten_loops(const Mesh& mesh, const double* position, size_t first, size_t width, double ambiguous,
                         Call& call, Loops& loops) {
    Shortener shortener(mesh, position, width, ambiguous, loops, call);
    return shortener.run(first);
}

} // namespace hmf
