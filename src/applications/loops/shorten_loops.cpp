// Shortens loops within their classes, one after another: each becomes the strip of a closed geodesic
// (closed_geodesic.hpp), unless that meets another loop. Then it is tried again once the others are shorter.
#include "closed_geodesic.hpp"
#include "../../core/curves/disjoint.hpp"
#include "find_loops.hpp"
#include "loop_parameters.hpp"

namespace hmf {

namespace {

class Shortener {
public:
    Shortener(const Mesh& mesh, const double* position, Loops& loops, Call& call) :
        mesh_(mesh), call_(call), loops_(loops), geodesic_(mesh, position, 0, call) {}

    hmf_status run(size_t first) {
        Array<uint8_t> met; // per loop: its geodesic met another loop
        Memory& memory = call_.memory;
        found_.start(memory);
        if (!test_.allocate(mesh_, memory) || !met.allocate_filled(memory, loops_.count(), uint8_t{1})
            || !geodesic_.keep_lengths())
            return call_.out_of_memory();
        bool again = true;
        for (int sweep = 0; again && sweep < CHOICE_ROUNDS; ++sweep) {
            again = false;
            for (size_t c = first; c < loops_.count(); ++c) {
                if (!met[c]) continue;
                if (!call_.tick(0, true)) return call_.was_cancelled();
                bool taken = false;
                if (!straighten(c, taken)) return call_.stopped();
                met[c] = !taken;
                again |= !taken;
            }
        }
        return HMF_OK;
    }

private:
    Done straighten(size_t c, bool& taken) {
        double length = 0;
        found_.clear();
        for (size_t i = 0; i < loops_.length(c); ++i)
            if (!found_.push(loops_.loop(c)[i])) return false;
        Loops changed;
        if (!geodesic_.straighten_widely(found_, MOST_REPEATS, length) || !changed.start(call_.memory)) return false;
        for (size_t k = 0; k < loops_.count(); ++k)
            if (!(k == c ? changed.add(found_) : changed.add(loops_, k))) return false;
        if (!one_is_disjoint(mesh_, changed, c, test_, call_, taken)) return false;
        if (taken) loops_.swap(changed);
        return true;
    }

    const Mesh& mesh_;
    Call& call_;
    Loops& loops_;
    ClosedGeodesic geodesic_;
    Multicurve test_;
    Array<uint32_t> found_;
};

} // namespace

hmf_status shorten_loops(const Mesh& mesh, const double* position, Call& call, Loops& loops, size_t first) {
    Shortener shortener(mesh, position, loops, call);
    return shortener.run(first);
}

} // namespace hmf
