// A cut system: genus many disjoint loops that cut the surface into one planar
// piece, each the shortest found (the default loops of [W] 3.3).
//
// Erickson, Whittlesey: Greedy optimal homotopy and homology generators, 2005,
// on the dual graph of the surface cut along the loops found before.  A cycle
// in it that visits no region twice is simple and meets no earlier loop,
// however narrow the mesh: loops may run side by side through a triangle.
//
//  1. Few segments have a signature, and a loop that does not separate crosses
//     one of them (signatures.hpp).  A region beside each is a root.
//  2. The shortest loop through each root that may have one shorter than the
//     best so far (loop_search.hpp).  The roots come in the order of the loops
//     through them that are known beforehand, closed by the segment in the tree
//     of the regions.
//  3. Of all that these searches find, the loop with the shortest class is taken
//     (class_lengths.hpp).
//  4. The others serve for the next loops as well: a batch.  It ends where the class
//     that comes next is that of a strip through a face of a loop of the batch; for
//     those the surface is cut first, and searched again.
//  5. Classes that come close are measured on finer levels, and the batch is chosen again.
//  6. Once the system is complete, likewise what came close in batches of one loop: from the first choice
//     that was wrong on it is made again.
#include "class_lengths.hpp"
#include "../../core/curves/disjoint.hpp"
#include "dual_length.hpp"
#include "../../core/base/heap_sort.hpp"
#include "loop_search.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double UNREACHED = HUGE_VAL;

struct Root {
    double known; // length of a loop through it, whatever its labels; 0 beside gates
    uint32_t region;
};

class CutSystem {
public:
    CutSystem(const Mesh& mesh, const LoopCondition* condition, ClassLengths& lengths, bool is_wide, Call& call) :
        mesh_(mesh), condition_(condition), lengths_(lengths), is_wide_(is_wide), call_(call), memory_(call.memory),
        search_(cut_, length_, condition ? condition->label : nullptr, call) {}

    hmf_status run(const double* position, Loops& out) {
        const uint32_t wanted = (2 + mesh_.edge_count - mesh_.vertex_count - mesh_.face_count) / 2;
        out_ = &out;
        try_.start(memory_);
        candidates_.start(memory_);
        strips_.start(memory_);
        kept_.start(memory_);
        strip_.start(memory_);
        words_.start(memory_);
        ids_.start(memory_);
        choice_.start(memory_);
        waits_.start(memory_);
        if (!out.start(memory_) || !curves_.allocate(mesh_, memory_) || !length_.allocate(memory_, mesh_.edge_count)
            || (!is_quick() && !test_.allocate(mesh_, memory_)))
            return call_.out_of_memory();
        const DualLength length(mesh_, position);
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) length_[e] = length(e);
        const double budget = search_budget(mesh_.face_count);
        uint32_t k = 0;
        for (; k < wanted && is_permitted(k); ++k)
            if (!add(condition_->free->loop(k), condition_->free->length(k))) return call_.out_of_memory();
        const uint32_t fixed = k;
        uint64_t steps = 0;
        for (int round = 0; round < CHOICE_ROUNDS; ++round) {
            while (k < wanted) {
                if (!call_.tick(static_cast<double>(k) / wanted, true)) return call_.was_cancelled();
                const uint32_t before = k;
                const hmf_status status = add_batch(k, wanted, budget);
                if (status) return status;
                steps += k - before;
            }
            bool changed = false;
            if (!lengths_.measure(changed)) return call_.stopped();
            if (!changed || round + 1 == CHOICE_ROUNDS) break; // the last round keeps what it has
            for (k = fixed; k < wanted; ++k) {
                Choice& choice = choice_[k - fixed];
                const size_t taken = lengths_.shortest(&ids_[choice.first], choice.end - choice.first);
                if (taken == choice.taken) continue;
                if (steps + wanted - k > MOST_REPEATS + wanted + wanted / 2) return HMF_OK;
                choice.taken = taken;
                if (!go_back(k, fixed)) return call_.out_of_memory();
                ++k;
                break;
            }
        }
        return HMF_OK;
    }

private:
    enum class Place : uint8_t { open, waits, gone };
    struct Candidate { // strips_[first], ..; half-edges.  In strip_: kept_[first], ..
        double length;
        size_t first, size;
        uint64_t signature;
        uint32_t id; // of its class, or NONE
        Place place; // in this batch
    };

    // Loop k and those after it for which one search is enough; k: the next one.
    hmf_status add_batch(uint32_t& k, uint32_t genus, double budget) {
        if (!curves_.trace(mesh_, call_) || !cut_.build(mesh_, curves_, true, call_) || !signatures_.build(cut_, call_)
            || !prepare())
            return call_.stopped();
        is_last_ = k + 1 == genus && !condition_;
        const hmf_status status = find_loop(budget * (0.3 + 0.7 * static_cast<double>(k + 1) / genus));
        if (status) return status;
        // Labels of a surface that intersects itself may leave no simple loop, or only loops that wind many times.
        if (!found_ && condition_)
            return call_.fail(
                HMF_ERROR_MESH_NOT_EMBEDDED, HMF_ELEMENT_NONE, 0,
                "No such loops were found: the surface intersects itself, or they wind too much. Repair the "
                "mesh, or use HMF_LOOPS_CUT or HMF_LOOPS_PANTS.");
        if (!found_)
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, k,
                              "No further loop was found. Please report this.");
        if (!open_batch()) return call_.out_of_memory();
        const uint32_t begin = k, end = k + std::min(std::max((genus - k) / 2, 1u), LOOPS_OF_BATCH);
        bool changed = true;
        for (int time = 0; changed && time < CHOICE_ROUNDS; ++time) {
            if (time > 0 && !reopen_batch(begin)) return call_.out_of_memory();
            k = begin;
            if (const hmf_status chosen = choose_batch(k, end)) return chosen;
            changed = false;
            if (k - begin > 1 && !lengths_.measure(changed)) return call_.stopped();
        }
        return HMF_OK;
    }

    // k: after the last one that the candidates serve for.
    hmf_status choose_batch(uint32_t& k, uint32_t end) {
        for (bool any = true; k < end; ++k) {
            if (!choose(any)) return call_.stopped();
            if (!any) break;
            const Candidate taken = strip_[choice_.back().first + choice_.back().taken];
            if (!take(taken)) return call_.out_of_memory();
            if (curves_.total >= MULTICURVE_LIMIT)
                return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LOOP, k,
                                  "The loops cross more than 2^29 edges. Use a coarser level.");
        }
        return HMF_OK;
    }

    Done open_batch() {
        heap_sort(candidates_.data(), candidates_.size(), [](const Candidate& a, const Candidate& b) {
            return a.length < b.length || (a.length == b.length && a.first < b.first);
        });
        words_.clear();
        return taken_.allocate_filled(memory_, mesh_.face_count, uint8_t{0})
            && left_.allocate_filled(memory_, mesh_.edge_count, uint64_t{0});
    }

    // As it was opened, with the first k loops.
    Done reopen_batch(uint32_t k) {
        while (out_->count() > k) {
            out_->keep_first(out_->count() - 1);
            choice_.pop();
        }
        forget_ids(choice_.empty() ? 0 : choice_.back().end);
        for (Candidate& c : candidates_) c.place = Place::open;
        curves_.clear();
        return curves_.add(out_->crossings.data(), out_->crossings.size()) && open_batch();
    }

    // The signature on the surface cut along the loops of the batch.
    uint64_t reduced(uint64_t signature) const {
        for (const uint64_t word : words_) signature = std::min(signature, signature ^ word);
        return signature;
    }

    // After loops of the batch: does the candidate separate, or cross one of them an odd number of times, however
    // it is moved?  Else, does it wait for the next search, as it passes a face of one?
    void look_at(Candidate& c) const {
        uint64_t crosses = 0;
        bool meets = false;
        for (size_t k = c.first; k < c.first + c.size; ++k) {
            crosses ^= left_[edge_of(strips_[k])];
            meets |= taken_[mesh_.face[strips_[k]]] != 0;
        }
        c.place = crosses || reduced(c.signature) == 0 ? Place::gone : meets ? Place::waits : Place::open;
    }

    // Of the candidates the one with the shortest class.  any: there is one, and none that waits is shorter.
    Done choose(bool& any) {
        const size_t first = ids_.size();
        const size_t most = is_quick() ? 1 : CANDIDATES;
        double shortest = UNREACHED, waiting = UNREACHED;
        waits_.clear();
        for (size_t i = 0; i < candidates_.size() && ids_.size() < first + most; ++i) {
            Candidate& c = candidates_[i];
            if (!by_count_ && c.length > slack() * shortest) break;
            if (!words_.empty() && shortest == UNREACHED && c.length > ROOTS * best_) break;
            if (!words_.empty() && c.place == Place::open) look_at(c);
            if (c.place == Place::gone) continue;
            if (c.id == NONE && !lengths_.add(strips_.data() + c.first, c.size, c.id)) return false;
            if (c.place == Place::waits) {
                if (is_quick()) waiting = std::min(waiting, c.length);
                else if (!waits_.push(c.id)) return false;
                continue;
            }
            shortest = std::min(shortest, c.length);
            bool known = false;
            for (size_t k = first; k < ids_.size(); ++k) known |= ids_[k] == c.id;
            if (!known && !keep(c)) return false;
        }
        any = ids_.size() > first;
        if (!any) return true;
        for (const uint32_t id : waits_) waiting = std::min(waiting, lengths_.length(id));
        const Choice choice = {first, ids_.size(), lengths_.shortest(&ids_[first], ids_.size() - first)};
        any = length(strip_[first + choice.taken]) <= waiting;
        if (!any) {
            forget_ids(first);
            return true;
        }
        return choice_.push(choice);
    }

    // Of its class, or of its strip where classes are not measured.
    double length(const Candidate& c) const { return is_quick() ? c.length : lengths_.length(c.id); }

    void forget_ids(size_t end) {
        while (ids_.size() > end) {
            ids_.pop();
            strip_.pop();
        }
        const size_t used = strip_.empty() ? 0 : strip_.back().first + strip_.back().size;
        while (kept_.size() > used) kept_.pop();
    }

    // Its strip outlasts the batch.
    Done keep(Candidate c) {
        const size_t first = kept_.size();
        for (size_t k = c.first; k < c.first + c.size; ++k)
            if (!kept_.push(strips_[k])) return false;
        c.first = first;
        return ids_.push(c.id) && strip_.push(c);
    }

    // The next loop of the batch.  A curve crosses it as often as the edges on its left, up to an even number.
    Done take(const Candidate& taken) {
        if (!add_taken(taken)) return false;
        const size_t n = out_->length(out_->count() - 1);
        const uint32_t* const loop = out_->loop(out_->count() - 1);
        const uint64_t bit = uint64_t{1} << words_.size();
        for (size_t k = 0; k < n; ++k) {
            taken_[mesh_.face[loop[k]]] = 1;
            const uint32_t in = twin(loop[k]), go = loop[k + 1 < n ? k + 1 : 0];
            if (go == mesh_.next[in]) left_[edge_of(mesh_.prev(in))] ^= bit;
        }
        return words_.push(reduced(taken.signature));
    }

    // Keeps the first k loops, and takes the next one as it is chosen now.
    Done go_back(uint32_t k, uint32_t fixed) {
        while (choice_.size() > size_t{k} - fixed + 1) choice_.pop();
        forget_ids(choice_.back().end);
        out_->keep_first(k);
        curves_.clear();
        const Candidate taken = strip_[choice_.back().first + choice_.back().taken];
        return curves_.add(out_->crossings.data(), out_->crossings.size()) && add_taken(taken);
    }

    Done add(const uint32_t* loop, size_t n) { return out_->add(loop, n) && curves_.add(loop, n); }

    // The strip of the class, pulled straight, if it meets no loop; else the strip that was found.
    Done add_taken(const Candidate& taken) {
        if (lengths_.has_pulled()) {
            bool are_disjoint = false;
            if (!out_->add(lengths_.pulled(taken.id), lengths_.pulled_size(taken.id))
                || !one_is_disjoint(mesh_, *out_, out_->count() - 1, test_, call_, are_disjoint))
                return false;
            if (are_disjoint) return curves_.add(lengths_.pulled(taken.id), lengths_.pulled_size(taken.id));
            out_->keep_first(out_->count() - 1);
        }
        return add(kept_.data() + taken.first, taken.size);
    }
    bool is_quick() const { return lengths_.care() == LoopCare::quick; }

    // Does the loop that was found without the condition meet it?  If so do all
    // before it, it is the shortest with the condition as well.
    bool is_permitted(uint32_t k) const {
        if (!condition_) return false;
        const Loops& free = *condition_->free;
        uint64_t sum = 0;
        for (uint64_t i = free.offsets[k]; i < free.offsets[k + 1]; ++i) {
            const uint64_t label = condition_->label[edge_of(free.crossings[i])];
            sum += free.crossings[i] & 1u ? uint64_t{0} - label : label;
        }
        return sum == 0;
    }

    Done prepare() {
        if (!search_.prepare(signatures_, states_per_region_)
            || !visited_.allocate_filled(memory_, cut_.region_count, 0u))
            return false;
        visit_ = 0;
        return true;
    }

    // A region beside each segment with a signature, or those where a loop can
    // cross a gate, if they are fewer.
    Done choose_roots() {
        if (!choose_signed_roots()) return false;
        if (!condition_) return true;
        const Loops& gates = *condition_->gates;
        gate_.start(memory_);
        ++visit_;
        for (const uint32_t h : gates.crossings) {
            const uint32_t f = mesh_.face[h],
                           end = f + 1 < mesh_.face_count ? cut_.region_first[f + 1] : cut_.region_count;
            for (uint32_t r = cut_.region_first[f]; r < end; ++r) {
                if (visited_[r] == visit_) continue;
                visited_[r] = visit_;
                if (!gate_.push({0, r})) return false;
            }
        }
        if (!gate_.empty() && gate_.size() < roots_.size()) roots_.swap(gate_);
        return true;
    }

    Done choose_signed_roots() {
        roots_.start(memory_);
        ++visit_;
        double least = UNREACHED; // what is longer by far comes late, in any order
        for (uint32_t s = 0; s < cut_.segment_count; ++s) {
            if (!signatures_.of[s]) continue;
            const uint32_t r = cut_.region[2 * size_t{s}], q = cut_.region[2 * size_t{s} + 1];
            if (visited_[r] == visit_ || visited_[q] == visit_) continue;
            visited_[r] = visit_;
            const double known = signatures_.cycle(cut_, s, length_, SLACK * least);
            least = std::min(least, known);
            if (!roots_.push({known, r})) return false;
        }
        heap_sort(roots_.data(), roots_.size(), [](const Root& a, const Root& b) {
            return a.known < b.known || (a.known == b.known && a.region < b.region);
        });
        return true;
    }

    Done all_roots() {
        roots_.start(memory_);
        if (!roots_.reserve(cut_.region_count)) return false;
        for (uint32_t r = 0; r < cut_.region_count; ++r) roots_.add({0, r});
        return true;
    }

    // From now on the length of a loop is the number of edges that it crosses.
    void count_edges() {
        by_count_ = true;
        states_per_region_ = 4;
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) length_[e] = 1;
    }

    // Candidates for the next loop; found_: there is one.
    hmf_status find_loop(double allowed) {
        found_ = false;
        best_ = UNREACHED;
        candidates_.clear();
        strips_.clear();
        work_before_ = search_.work();
        // The cut has cost as much as to settle all of its regions.
        allowed = std::max(allowed, static_cast<double>(work_before_) + cut_.region_count);
        if (!choose_roots()) return call_.out_of_memory();
        for (;;) {
            if (!search_roots(allowed)) return call_.stopped();
            if (found_ || !search_.budget_exhausted() || exceeds_budget(allowed)
                || (by_count_ && states_per_region_ == MOST_STATES))
                break;
            // Short ways in other directions use the room in the covering up: each edge counts the same.  A loop that
            // winds a lot needs more room even so.
            if (by_count_) states_per_region_ *= 4;
            else count_edges();
            if (!prepare()) return call_.out_of_memory();
        }
        // Loops that meet themselves may have hidden others.
        if (!found_ && condition_ && (!all_roots() || !search_roots(allowed))) return call_.stopped();
        return HMF_OK;
    }

    bool exceeds_budget(double allowed) const {
        return !found_ && static_cast<double>(search_.work() - work_before_) >= MOST_BUDGET * allowed;
    }

    Done search_roots(double allowed) {
        for (size_t i = 0; i < roots_.size(); ++i) {
            if (search_.bound(roots_[i].region) >= roots() * best_
                || (found_ && search_.nearest_root(roots_[i].region) < APART * best_))
                continue;
            if (found_ ? static_cast<double>(search_.work()) >= allowed : exceeds_budget(allowed)) return true;
            if (candidates_.size() >= PART_OF_BATCH * LOOPS_OF_BATCH) return true;
            if (search_.budget_exhausted() && !found_ && i >= 4 && !(by_count_ && states_per_region_ == MOST_STATES))
                return true;
            if (i % 16 == 0 && !call_.tick(0, true)) return false;
            if (!look_from(roots_[i].region)) return false;
        }
        return true;
    }

    // Some handles are so narrow that strips around them are twice as long as they should be. Such a one comes last:
    // its search reaches further, and leaves out less.
    double slack() const { return is_quick() ? 1 : is_last_ ? SLACK * SLACK : SLACK; }
    double roots() const { return is_last_ ? SLACK * SLACK : is_wide_ ? SLACK : ROOTS; }

    // The short loops through a region are candidates.
    Done look_from(uint32_t root) {
        if (!search_.search(root, slack() * best_, is_last_ && found_ ? slack() * best_ : 0)) return false;
        for (size_t i = 0; i < search_.count(); ++i) {
            if (!search_.strip(i, try_)) return false;
            double total = 0;
            for (const uint32_t link : try_) total += length_[cut_.segment_edge[link >> 1]];
            if (!(total < slack() * best_)) continue;
            bool simple = true;
            if (condition_ && !find_if_simple(simple)) return false;
            if (!simple) continue;
            if (total < best_) {
                found_ = true;
                best_ = total;
            }
            if (!offer(total, search_.signature(i))) return false;
        }
        return true;
    }

    Done offer(double total, uint64_t signature) {
        const Candidate c = {total, strips_.size(), try_.size(), signature, NONE, Place::open};
        for (const uint32_t link : try_)
            if (!strips_.push(cut_.half_edge(link))) return false;
        return candidates_.push(c);
    }

    // A loop is simple in the covering; is it so here?  It may run through a
    // region twice as long as it can be pushed apart.
    Done find_if_simple(bool& simple) {
        const Loops& earlier = *out_;
        simple = true;
        ++visit_;
        for (uint32_t link : try_) {
            uint32_t& visited = visited_[cut_.region[link]];
            simple = simple && visited != visit_;
            visited = visit_;
        }
        if (simple) return true;
        Loops all;
        all.offsets.start(memory_);
        all.crossings.start(memory_);
        for (const uint64_t at : earlier.offsets)
            if (!all.offsets.push(at)) return false;
        for (const uint32_t h : earlier.crossings)
            if (!all.crossings.push(h)) return false;
        for (const uint32_t link : try_)
            if (!all.crossings.push(cut_.half_edge(link))) return false;
        return all.offsets.push(all.crossings.size())
            && disjoint(mesh_, all, 0, all.count(), test_, nullptr, call_, simple);
    }

    const Mesh& mesh_;
    const LoopCondition* condition_; // or NULL
    ClassLengths& lengths_;
    const bool is_wide_;
    Call& call_;
    Memory& memory_;
    Loops* out_ = nullptr; // the loops so far
    Multicurve curves_, test_;
    CutSurface cut_;
    Signatures signatures_;
    Array<double> length_; // per edge
    LoopSearch search_;
    size_t states_per_region_ = 4;
    uint64_t work_before_ = 0; // of the search, before this loop
    bool by_count_ = false;
    bool is_last_ = false; // of the loops
    Array<Root> roots_, gate_;
    Array<uint32_t> visited_; // per region
    uint32_t visit_ = 0;
    struct Choice { // of ids_[first] .. ids_[end - 1]
        size_t first, end, taken;
    };
    Array<Candidate> candidates_;                 // for the next loops
    Array<uint32_t> strips_, kept_, ids_, waits_; // waits_: classes of candidates that wait
    Array<Candidate> strip_;                      // per id
    Array<Choice> choice_;
    Array<uint32_t> try_;     // half-segments
    double best_ = UNREACHED; // length of the shortest candidate
    bool found_ = false;
    // Of a batch: signatures of its loops, each reduced by those before; faces that they pass; per edge a bit for
    // each of them that runs along it, with the edge on its left.
    Array<uint64_t> words_, left_;
    Array<uint8_t> taken_;
};

} // namespace

hmf_status cut_system(const Mesh& mesh, const double* position, const LoopCondition* condition, ClassLengths& lengths,
                      Call& call, Loops& out, bool is_wide) {
    CutSystem system(mesh, condition, lengths, is_wide, call);
    return system.run(position, out);
}

hmf_status cut_system(const Mesh& mesh, const double* position, Call& call, Loops& out) {
    ClassLengths lengths(mesh, position, call);
    return cut_system(mesh, position, nullptr, lengths, call, out);
}

} // namespace hmf
