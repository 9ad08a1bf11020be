// A pants decomposition: a cut system leaves a sphere with 2 genus holes, and
// marked vertices are holes as well.  As long as it has more than three, a loop around two close holes cuts off a pair
// of pants:
//
//          ______________           The new loop runs along A, over to B,
//         /  __      __  \          along B and back, with A, the way and B
//        |  /  \____/  \  |         on its right.  Its length is estimated
//        |  \A_/ way\B_/  |         as A + B + 2 way; the pair where that is
//         \______________/          least are candidates, and the shortest
//                                   class of these is taken (class_lengths.hpp).
//
// hole_joins.hpp finds these. Other candidates are short cycles with two holes or more on both sides, from the trees of
// shortest paths from regions (signatures.hpp, loop_search.hpp).
//
// Classes that come close are measured on a fine level once there are all loops,
// and from the first choice that was wrong on it is made again.
//
// Each loop is the shortest that those before it leave, so an early tie would
// decide all the others.  Elementary moves shorten them at the end
// (elementary_moves.hpp); loops around pairs of marked vertices alone have no moves.
//
// Both sides of it keep at least two holes, or one and the new one, so it is
// essential, and parallel to no other loop.  To run along a marked vertex is to
// cross each of its edges.
//
// Joining only marked vertices gives loops around pairs of them; cycles around other holes are no candidates then.
#include "../../core/base/heap_sort.hpp"
#include "class_lengths.hpp"
#include "../../core/curves/cut_surface.hpp"
#include "../../core/curves/disjoint.hpp"
#include "dual_length.hpp"
#include "elementary_moves.hpp"
#include "hole_joins.hpp"
#include "loop_search.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

class Pants {
public:
    Pants(const Mesh& mesh, const double* position, bool marks_only, ClassLengths& lengths, Loops& loops, Call& call) :
        mesh_(mesh), position_(position), marks_only_(marks_only), lengths_(lengths), loops_(loops), call_(call),
        memory_(call.memory), joins_(mesh, length_), search_(cut_, length_, nullptr, call) {}

    hmf_status run() {
        if (!curves_.allocate(mesh_, memory_) || !test_.allocate(mesh_, memory_)
            || !length_.allocate(memory_, mesh_.edge_count))
            return call_.out_of_memory();
        const DualLength length(mesh_, position_);
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) length_[e] = length(e);
        const size_t genus = (2 + mesh_.edge_count - mesh_.vertex_count - mesh_.face_count) / 2;
        const size_t holes = 3 * genus + mesh_.marked_count; // 3 fewer are needed
        wanted_ = !marks_only_ ? (holes > 3 ? holes - 3 : 0) : holes == 4 ? 1 : holes / 2;
        given_ = loops_.count();
        choice_.start(memory_);
        ids_.start(memory_);
        strip_.start(memory_);
        strips_.start(memory_);
        cycles_.start(memory_);
        mark_word_.start(memory_);
        steps_ = 0;
        for (int round = 0; round < CHOICE_ROUNDS; ++round) {
            while (loops_.count() < wanted_)
                if (const hmf_status status = add_loop()) return status;
            bool changed = false;
            if (!lengths_.measure(changed)) return call_.stopped();
            if (!changed || round + 1 == CHOICE_ROUNDS) break; // the last round keeps what it has
            if (const hmf_status status = choose_again()) return status;
        }
        if (loops_.count() == given_) return HMF_OK;
        if (!marks_only_ && lengths_.care() == LoopCare::shortest) {
            const hmf_status status = shorten_by_moves(mesh_, position_, lengths_, call_, loops_);
            if (status) return status;
        }
        return shorten_loops(mesh_, position_, call_, loops_);
    }

private:
    struct Strip { // in strips_
        size_t first, size;
    };
    struct Choice { // of ids_[first] .. ids_[end - 1]
        size_t first, end, taken;
    };

    hmf_status add_loop() {
        if (!call_.tick(static_cast<double>(loops_.count()) / static_cast<double>(wanted_), true))
            return call_.was_cancelled();
        const double made = static_cast<double>(loops_.count() - given_ + 1);
        allowed_ = search_budget(mesh_.face_count) * (0.3 + 0.7 * made / static_cast<double>(wanted_ - given_));
        const size_t first_loop = loops_.count();
        if (cut()) return call_.status();
        if (!joins_.find(cut_, holes_, join_, call_)) return call_.stopped();
        if (join_.empty())
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, loops_.count(),
                              "No further loop was found. Please report this.");
        if (!choose() || !take_last() || !take_others()) return call_.stopped();
        return lengths_.has_pulled() ? HMF_OK : shorten_loops(mesh_, position_, call_, loops_, first_loop);
    }

    // From the first choice on that was wrong.
    hmf_status choose_again() {
        for (size_t k = 0; k < choice_.size(); ++k) {
            Choice& choice = choice_[k];
            const size_t taken = lengths_.shortest(&ids_[choice.first], choice.end - choice.first);
            if (taken == choice.taken) continue;
            if (steps_ + choice_.size() - k > MOST_REPEATS + choice_.size() + choice_.size() / 2) break;
            choice.taken = taken;
            while (choice_.size() > k + 1) choice_.pop();
            while (ids_.size() > choice_.back().end) {
                ids_.pop();
                strip_.pop();
            }
            loops_.keep_first(given_ + k);
            return take_last() ? HMF_OK : call_.stopped();
        }
        return HMF_OK;
    }

    hmf_status cut() {
        const size_t n = loops_.count();
        bool are_disjoint = false;
        if (!disjoint(mesh_, loops_, 0, n, curves_, nullptr, call_, are_disjoint)) return call_.out_of_memory();
        if (!are_disjoint)
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, n, "Loops are not disjoint. Please report this.");
        if (!cut_.build(mesh_, curves_, true, call_)
            || !holes_.allocate_filled(memory_, cut_.point_count, uint8_t{NO_HOLE}))
            return call_.stopped();
        for (uint32_t p = 0; p < cut_.point_count; ++p) {
            if (p < mesh_.marked_count) holes_[p] = HOLE_JOINED;
            if (p >= mesh_.vertex_count) holes_[p] = marks_only_ ? HOLE_LEFT_ALONE : HOLE_JOINED;
        }
        return HMF_OK;
    }

    // Short loops that have two holes or more on both sides, found as those of a
    // cut system (loop_search.hpp).
    Done find_cycles() {
        cycles_.clear();
        if (marks_only_ && mesh_.marked_count > CANDIDATES) return true;
        if (!signatures_.build_holes(cut_, holes_, call_) || !search_.prepare(signatures_, 1)) return false;
        if (marks_only_ && !find_mark_words()) return false;
        // On a sphere a class has many closed geodesics, some of which hang on marked vertices: more searches.
        const double roots = lengths_.is_sphere() ? SLACK : ROOTS,
                     apart = lengths_.is_sphere() ? APART_ON_SPHERE : APART;
        double best = HUGE_VAL;
        if (!shortest_strip(best)) return false;
        const size_t first = strips_.size();
        if (!search_.find_cycles(
                roots, apart, 0, allowed_, [this](uint32_t region) { return joins_.holes_around(region) > 3; },
                [this](uint64_t signature) { return !marks_only_ || is_round_pair(signature); }, best, strips_,
                cycles_))
            return false;
        for (size_t i = first; i < strips_.size(); ++i) strips_[i] = cut_.half_edge(strips_[i]);
        return true;
    }

    // Of its edge, the one where the half-edge begins.
    uint32_t segment_at_origin(uint32_t h) const {
        const uint32_t e = edge_of(h);
        return cut_.segment_first[e] + (h & 1u ? curves_.count[e] : 0);
    }

    // Of each marked vertex, the sum of the signatures around it: a cycle adds up to those on one side of it.
    Done find_mark_words() {
        mark_word_.clear();
        for (uint32_t v = 0; v < mesh_.marked_count; ++v) {
            uint64_t word = 0;
            for (const uint32_t h : mesh_.around(v)) word ^= signatures_.of[segment_at_origin(h)];
            if (!mark_word_.push(word)) return false;
        }
        return true;
    }
    bool is_round_pair(uint64_t signature) const {
        for (size_t i = 0; i < mark_word_.size(); ++i)
            for (size_t k = 0; k < i; ++k)
                if ((mark_word_[i] ^ mark_word_[k]) == signature) return true;
        return false;
    }

    // Of the joins.  Around marked vertices a strip is longer than the estimate.
    Done shortest_strip(double& shortest) {
        const size_t begin = strips_.size();
        for (size_t i = 0; i < join_.size() && i < CANDIDATES && join_[i].length < shortest; ++i) {
            if (!joins_.walk(join_[i], strips_, memory_)) return false;
            if (strips_.size() == begin) continue;
            double length = 0;
            for (; strips_.size() > begin; strips_.pop()) length += length_[edge_of(strips_.back())];
            shortest = std::min(shortest, length);
        }
        return true;
    }

    // The class of a strip for the next loop, if there is no other of the class.
    Done offer(size_t first, const Strip& strip, bool& added) {
        uint32_t id = 0;
        if (!lengths_.add(strips_.data() + strip.first, strip.size, id)) return false;
        added = true;
        for (size_t k = first; k < ids_.size() && lengths_.has_pulled(); ++k) added &= ids_[k] != id;
        return !added || (ids_.push(id) && strip_.push(strip));
    }

    // Of the candidates the one with the shortest class.
    Done choose() {
        const size_t first = ids_.size();
        const bool is_quick = lengths_.care() == LoopCare::quick;
        bool added = false;
        if (!is_quick && !find_cycles()) return false;
        for (size_t i = 0; i < cycles_.size() && ids_.size() < first + CANDIDATES; ++i) {
            if (cycles_[i].length > SLACK * cycles_[0].length) break;
            if (!offer(first, {cycles_[i].first, cycles_[i].size}, added)) return false;
        }
        for (size_t i = 0; i < join_.size() && i < CANDIDATES; ++i) {
            const size_t begin = strips_.size();
            if (!joins_.walk(join_[i], strips_, memory_)) return false;
            if (strips_.size() == begin) continue;
            const Strip strip = {begin, strips_.size() - begin};
            if (!offer(first, strip, added)) return false;
            while (!added && strips_.size() > begin) strips_.pop();
        }
        const size_t best = is_quick ? 0 : lengths_.shortest(&ids_[first], ids_.size() - first);
        return choice_.push({first, ids_.size(), best});
    }

    // The loop of the last choice.
    Done take_last() {
        const size_t at = choice_.back().first + choice_.back().taken;
        bool added = false;
        ++steps_;
        return take_pulled(at, added) && (added || loops_.add(strips_.data() + strip_[at].first, strip_[at].size));
    }

    // The pulled strip of a candidate's class if that meets no loop.
    Done take_pulled(size_t at, bool& added) {
        const uint32_t id = ids_[at];
        return !lengths_.has_pulled() || take_apart(lengths_.pulled(id), lengths_.pulled_size(id), added);
    }
    Done take_apart(const uint32_t* strip, size_t n, bool& added) {
        if (!loops_.add(strip, n) || !one_is_disjoint(mesh_, loops_, loops_.count() - 1, test_, call_, added))
            return false;
        if (!added) loops_.keep_first(loops_.count() - 1);
        return true;
    }

    // Of many loops that are left, more candidates at once: those that come next, are of other classes and meet no
    // loop.
    Done take_others() {
        const Choice choice = choice_.back();
        const size_t end = loops_.count() + (wanted_ - loops_.count()) / PART_OF_BATCH;
        Array<size_t> order;
        order.start(memory_);
        for (size_t at = choice.first; at < choice.end && end > loops_.count(); ++at)
            if (at != choice.first + choice.taken && !order.push(at)) return false;
        heap_sort(order.data(), order.size(), [this](size_t a, size_t b) {
            const double x = lengths_.length(ids_[a]), y = lengths_.length(ids_[b]);
            return x < y || (x == y && a < b);
        });
        for (size_t i = 0; i < order.size() && loops_.count() < end; ++i) {
            const Strip strip = strip_[order[i]];
            const uint32_t id = ids_[order[i]];
            bool added = false;
            if (!take_pulled(order[i], added)
                || (!added && !take_apart(strips_.data() + strip.first, strip.size, added)))
                return false;
            if (!added) continue;
            ++steps_;
            if (!ids_.push(id) || !strip_.push(strip) || !choice_.push({ids_.size() - 1, ids_.size(), 0})) return false;
        }
        return true;
    }

    const Mesh& mesh_;
    const double* position_;
    const bool marks_only_;
    ClassLengths& lengths_;
    Loops& loops_;
    Call& call_;
    Memory& memory_;
    Array<double> length_; // per edge
    size_t wanted_ = 0, given_ = 0;
    uint64_t steps_ = 0; // loops taken
    Multicurve curves_, test_;
    CutSurface cut_;
    Array<uint8_t> holes_; // per point of cut_: HoleKind
    HoleJoins joins_;
    Array<HoleJoins::Join> join_; // for the next loop
    Array<uint64_t> mark_word_;
    Array<uint32_t> strips_, ids_;
    Array<Strip> strip_; // per id
    Array<Choice> choice_;
    Array<LoopSearch::Cycle> cycles_; // in strips_
    double allowed_ = 0;              // regions to be settled in all searches up to the next loop
    Signatures signatures_;
    LoopSearch search_;
};

} // namespace

hmf_status pants_decomposition(const Mesh& mesh, const double* position, ClassLengths& lengths, Call& call,
                               Loops& out) {
    const size_t genus = static_cast<size_t>(2 - mesh.euler()) / 2;
    const bool is_wide = lengths.care() == LoopCare::shortest && genus >= MANY_HANDLES;
    hmf_status status = cut_system(mesh, position, nullptr, lengths, call, out, is_wide);
    if (status) return status;
    Pants pants(mesh, position, false, lengths, out, call);
    return pants.run();
}

hmf_status mark_loops(const Mesh& mesh, const double* position, ClassLengths& lengths, Call& call, Loops& out) {
    if (!out.start(call.memory)) return call.out_of_memory();
    Pants pants(mesh, position, true, lengths, out, call);
    return pants.run();
}

} // namespace hmf
