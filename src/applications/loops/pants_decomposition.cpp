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
//                                   Then the loop is shortened.
//
// Other candidates are short cycles with two holes or more on both sides, from the trees of shortest paths from regions
// (signatures.hpp, loop_search.hpp).
// Paths connect the cells of a Voronoi diagram of the holes: one for each piece of the border between two cells.
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
#include "../../core/base/disjoint_sets.hpp"
#include "../../core/base/heap_sort.hpp"
#include "../../core/base/nearest_first.hpp"
#include "cell_borders.hpp"
#include "class_lengths.hpp"
#include "../../core/curves/cut_surface.hpp"
#include "../../core/curves/disjoint.hpp"
#include "dual_length.hpp"
#include "elementary_moves.hpp"
#include "loop_search.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double PANTS_FURTHER = 2.5; // than the least estimate: true lengths may be in another order
constexpr double PANTS_SLACK = LoopSearch::SLACK, PANTS_ROOTS = 1.15, PANTS_APART = 0.1; // see cut_system.cpp
// On a sphere a class has many closed geodesics, some of which hang on marked vertices: more searches.
constexpr double ROOTS_OF_SPHERE = 1.4, APART_ON_SPHERE = 0.05;
constexpr size_t MOST_PAIRED_MARKS = 64; // with more there are no cycles for loops around pairs of them
constexpr size_t PANTS_MOST_CANDIDATES = 64;
constexpr uint64_t PANTS_MOST_STEPS = 100; // as in cut_system.cpp
constexpr int PANTS_MOST_ROUNDS = 8;       // of measuring and choosing again

class Pants {
public:
    Pants(const Mesh& mesh, const double* position, bool marks_only, ClassLengths& lengths, Loops& loops, Call& call) :
        mesh_(mesh), position_(position), marks_only_(marks_only), lengths_(lengths), loops_(loops), call_(call),
        memory_(call.memory), search_(cut_, length_, nullptr, call) {}

    hmf_status run() {
        if (!curves_.allocate(mesh_, memory_) || !length_.allocate(memory_, mesh_.edge_count)
            || !face_bound_.allocate_filled(memory_, mesh_.face_count, 0.0))
            return call_.out_of_memory();
        const DualLength length(mesh_, position_);
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) length_[e] = length(e);
        const size_t genus = (2 + mesh_.edge_count - mesh_.vertex_count - mesh_.face_count) / 2;
        const size_t holes = 3 * genus + mesh_.marked_count; // 3 fewer are needed
        const size_t wanted = !marks_only_ ? (holes > 3 ? holes - 3 : 0) : holes == 4 ? 1 : holes / 2;
        const size_t given = loops_.count();
        choice_.start(memory_);
        ids_.start(memory_);
        strip_.start(memory_);
        strips_.start(memory_);
        candidates_.start(memory_);
        sides_.start(memory_);
        cycles_.start(memory_);
        hole_.start(memory_);
        cycle_.start(memory_);
        mark_word_.start(memory_);
        // Regions settled in all searches: linear in the faces on large meshes.
        const double budget = 5e6 + 12.0 * mesh_.face_count;
        const bool moves = !marks_only_ && lengths_.care() == LoopCare::shortest;
        uint64_t steps = 0;
        for (int round = 0; round < PANTS_MOST_ROUNDS; ++round) {
            for (; loops_.count() < wanted; ++steps) {
                if (!call_.tick(static_cast<double>(loops_.count()) / static_cast<double>(wanted), true))
                    return call_.was_cancelled();
                if (cut()) return call_.status();
                const size_t made = loops_.count() - given;
                allowed_ = budget * (0.3 + 0.7 * static_cast<double>(made + 1) / static_cast<double>(wanted - given));
                if (!spread() || !find_candidates()) return call_.stopped();
                if (candidates_.empty())
                    return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, loops_.count(),
                                      "No further loop was found. Please report this.");
                if (!choose()) return call_.stopped();
                const hmf_status status = take_last();
                if (status) return status;
            }
            bool changed = false;
            if (!lengths_.measure(changed)) return call_.stopped();
            if (!changed || round + 1 == PANTS_MOST_ROUNDS) break; // the last round keeps what it has
            for (size_t k = 0; k < choice_.size(); ++k) {
                Choice& choice = choice_[k];
                const size_t taken = lengths_.shortest(&ids_[choice.first], choice.end - choice.first);
                if (taken == choice.taken) continue;
                if (steps + choice_.size() - k > PANTS_MOST_STEPS + choice_.size() + choice_.size() / 2) break;
                choice.taken = taken;
                while (choice_.size() > k + 1) choice_.pop();
                while (ids_.size() > choice_.back().end) {
                    ids_.pop();
                    strip_.pop();
                }
                loops_.keep_first(given + k);
                for (double& bound : face_bound_) bound = 0;
                const hmf_status status = take_last();
                if (status) return status;
                break;
            }
        }
        if (loops_.count() == given) return HMF_OK;
        if (moves) {
            const hmf_status status = shorten_by_moves(mesh_, position_, lengths_, call_, loops_);
            if (status) return status;
        }
        return shorten_loops(mesh_, position_, 0, 1, 1, call_, loops_);
    }

private:
    // A side of a loop (2 * component, + 1 for the right one), after one of its crossings: the region there.
    // Marked vertices follow as further sides; the crossing is a half-edge out of it then.
    struct Seed {
        uint32_t side, crossing, region;
    };
    struct Pair {
        uint32_t a, b;
    }; // of seeds
    struct Candidate {
        double length; // estimated
        Pair pair;
        uint32_t middle; // half-segment
    };
    struct Strip { // in strips_
        size_t first, size;
    };
    struct Choice { // of ids_[first] .. ids_[end - 1]
        size_t first, end, taken;
    };
    hmf_status cut() {
        const size_t n = loops_.count();
        bool are_disjoint = false;
        if (!disjoint(mesh_, loops_, 0, n, curves_, nullptr, call_, are_disjoint)) return call_.out_of_memory();
        if (!are_disjoint)
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, n, "Loops are not disjoint. Please report this.");
        if (!cut_.build(mesh_, curves_, true, call_) || !piece_.allocate(memory_, cut_.region_count)
            || !holes_.allocate_filled(memory_, cut_.region_count, 0u)
            || !around_.allocate_filled(memory_, 2 * n + mesh_.marked_count, 0.0))
            return call_.stopped();
        for (uint32_t r = 0; r < cut_.region_count; ++r) piece_[r] = r;
        for (size_t s = 0; s < cut_.segment_count; ++s)
            unite(piece_.data(), cut_.region[2 * s], cut_.region[2 * s + 1]);
        if (!call_.work(32 * uint64_t{cut_.segment_count})) return call_.was_cancelled();
        for (size_t k = 0; k < n; ++k) {
            for (uint64_t i = curves_.components.offsets[k]; i < curves_.components.offsets[k + 1]; ++i)
                around_[2 * k] += length_[edge_of(curves_.components.crossings[i])];
            around_[2 * k + 1] = around_[2 * k];
        }
        return HMF_OK;
    }

    Done add_seed(uint32_t side, uint32_t crossing, uint32_t region, bool& counted) {
        if (!counted) ++holes_[find_root(piece_.data(), region)];
        counted = true;
        if (marks_only_ && side < 2 * curves_.components.count()) return true;
        const uint32_t seed = static_cast<uint32_t>(seeds_.size());
        if (!seeds_.push({side, crossing, region})) return false;
        if (seed_[region] == NONE) {
            seed_[region] = seed;
            distance_[region] = 0;
        } else if (seeds_[seed_[region]].side != side) {
            return pairs_.push({seed_[region], seed});
        }
        return true;
    }

    // Of its edge, the one where the half-edge begins.
    uint32_t segment_at_origin(uint32_t h) const {
        const uint32_t e = edge_of(h);
        return cut_.segment_first[e] + (h & 1u ? curves_.count[e] : 0);
    }

    // The regions around a marked vertex.
    Done seed_mark(uint32_t v) {
        bool counted = false;
        for (const uint32_t h : mesh_.around(v)) {
            if (!call_.work(16)) return false;
            const uint32_t segment = segment_at_origin(h);
            const uint32_t side = 2 * static_cast<uint32_t>(curves_.components.count()) + v;
            if (!add_seed(side, h, cut_.region[2 * size_t{segment} + (h & 1u)], counted)) return false;
        }
        return true;
    }

    // A seed after each crossing of a loop, on both of its sides.
    Done seed_loop(uint32_t k) {
        const uint64_t first = curves_.components.offsets[k], end = curves_.components.offsets[k + 1];
        uint32_t h = curves_.components.crossings[first], p = curves_.begin[k] - curves_.first[edge_of(h)];
        if (h & 1u) p = curves_.count[edge_of(h)] - 1 - p;
        bool counted[2] = {false, false};
        for (uint64_t i = first; i < end; ++i) {
            if (!call_.work(32)) return false;
            // Segments beside the crossing, from the origin of h: p on the right, p + 1 on the left.
            const uint32_t e = edge_of(h), count = curves_.count[e];
            for (uint32_t right = 0; right < 2; ++right) {
                const uint32_t q = right ? p : p + 1;
                const uint32_t segment = cut_.segment_first[e] + (h & 1u ? count - q : q);
                const uint32_t r = cut_.region[2 * size_t{segment} + (twin(h) & 1u)];
                if (!add_seed(2 * k + right, static_cast<uint32_t>(i - first), r, counted[right])) return false;
            }
            curves_.step(mesh_, h, p);
        }
        return true;
    }

    // From all sides of loops at once: the nearest side of each region.
    Done spread() {
        const size_t n = cut_.region_count;
        seeds_.start(memory_);
        heap_.start(memory_);
        pairs_.start(memory_);
        if (!distance_.allocate_filled(memory_, n, HUGE_VAL) || !seed_.allocate_filled(memory_, n, NONE)
            || !from_.allocate_filled(memory_, n, NONE))
            return false;
        for (uint32_t k = 0; k < curves_.components.count(); ++k)
            if (!seed_loop(k)) return false;
        for (uint32_t v = 0; v < mesh_.marked_count; ++v)
            if (!seed_mark(v)) return false;
        // Only in pieces that are no pants yet.
        double least = HUGE_VAL;
        for (uint32_t seed = 0; seed < seeds_.size(); ++seed) {
            const uint32_t r = seeds_[seed].region;
            if (!call_.work(8)) return false;
            if (holes_[find_root(piece_.data(), r)] <= 3) continue;
            least = std::min(least, around_[seeds_[seed].side]);
            if (seed_[r] == seed && !heap_.push({0, r})) return false;
        }
        return grow_cells(least);
    }

    // The cells of the diagram, from their seeds.  No way that is left is shorter than
    // the next distance: it stops where that cannot make a loop shorter than the best
    // one yet.  least: length of the shortest hole.
    Done grow_cells(double least) {
        double best = HUGE_VAL;
        while (!heap_.empty()) {
            const NearestFirst::Entry top = heap_.pop();
            if (!call_.work(64)) return false;
            if (top.distance > distance_[top.item]) continue;
            if (2 * (least + top.distance) > PANTS_FURTHER * best) break;
            for (uint32_t i = 0; i < 3; ++i) {
                const uint32_t link = cut_.link[3 * size_t{top.item} + i];
                if (link == NONE) break;
                const uint32_t to = cut_.region[link ^ 1u];
                const double d = top.distance + length_[cut_.segment_edge[link >> 1]];
                if (seed_[to] != NONE && seeds_[seed_[to]].side != seeds_[seed_[top.item]].side)
                    best = std::min(best, estimate(seed_[to], seed_[top.item], d + distance_[to]));
                if (!(d < distance_[to])) continue;
                distance_[to] = d;
                seed_[to] = seed_[top.item];
                from_[to] = link;
                if (!heap_.push({d, to})) return false;
            }
        }
        return true;
    }

    double estimate(uint32_t a, uint32_t b, double way) const {
        return around_[seeds_[a].side] + around_[seeds_[b].side] + 2 * way;
    }

    // Pairs of holes, and the link that their way crosses in the middle (NONE:
    // they meet in one region), least estimates first.
    Done find_candidates() {
        candidates_.clear();
        // Each two sides once, by the first pair of seeds.
        sides_.clear();
        for (uint32_t i = 0; i < pairs_.size(); ++i) {
            if (holes_[find_root(piece_.data(), seeds_[pairs_[i].a].region)] <= 3) continue;
            const uint64_t a = seeds_[pairs_[i].a].side, b = seeds_[pairs_[i].b].side;
            if (!sides_.push({std::min(a, b) << 32 | std::max(a, b), i})) return false;
        }
        if (!call_.work(128 * sides_.size())) return false;
        heap_sort(sides_.data(), sides_.size(),
                  [](const Sides& a, const Sides& b) { return a.both != b.both ? a.both < b.both : a.pair < b.pair; });
        for (size_t i = 0; i < sides_.size(); ++i) {
            const Pair& pair = pairs_[sides_[i].pair];
            const bool first = i == 0 || sides_[i].both != sides_[i - 1].both;
            if (!call_.work(64)) return false;
            if (first && !candidates_.push({estimate(pair.a, pair.b, 0), pair, NONE})) return false;
        }
        // The segments between two cells, in one piece as long as they meet at vertices of two cells.
        const auto is_contact = [&](uint32_t s) {
            const uint32_t r = cut_.region[2 * size_t{s}], q = cut_.region[2 * size_t{s} + 1];
            return seed_[r] != NONE && seed_[q] != NONE && seeds_[seed_[r]].side != seeds_[seed_[q]].side
                && holes_[find_root(piece_.data(), r)] > 3;
        };
        if (!call_.work(64 * uint64_t{cut_.segment_count})) return false;
        if (!borders_.find(
                cut_, is_contact, [&](uint32_t p) { return p >= mesh_.vertex_count || mesh_.is_marked(p); },
                [&](uint32_t s) { return contact(s).length; }, memory_))
            return false;
        for (const uint32_t s : borders_.best())
            if (s != NONE && !candidates_.push(contact(s))) return false;
        if (!call_.work(64 * candidates_.size())) return false;
        heap_sort(candidates_.data(), candidates_.size(), [](const Candidate& a, const Candidate& b) {
            if (a.length != b.length) return a.length < b.length;
            return a.pair.a != b.pair.a ? a.pair.a < b.pair.a : a.pair.b < b.pair.b;
        });
        return true;
    }

    Candidate contact(uint32_t s) const {
        const uint32_t r = cut_.region[2 * size_t{s}], q = cut_.region[2 * size_t{s} + 1];
        const double way = distance_[r] + length_[cut_.segment_edge[s]] + distance_[q];
        return {estimate(seed_[r], seed_[q], way), {seed_[r], seed_[q]}, 2 * s};
    }

    // Short loops that have two holes or more on both sides, found as those of a
    // cut system (loop_search.hpp).
    Done find_cycles() {
        cycles_.clear();
        if (marks_only_ && mesh_.marked_count > MOST_PAIRED_MARKS) return true;
        hole_.clear();
        for (uint32_t v = 0; v < mesh_.marked_count; ++v)
            if (!hole_.push(v)) return false;
        for (uint32_t p = mesh_.vertex_count; p < cut_.point_count; ++p)
            if (!hole_.push(p)) return false;
        if (!signatures_.build_holes(cut_, hole_, call_) || !search_.prepare(signatures_, 1)) return false;
        search_.raise_bounds(face_bound_);
        if (marks_only_ && !find_mark_words()) return false;
        const bool sphere = lengths_.is_sphere();
        const double roots = sphere ? ROOTS_OF_SPHERE : PANTS_ROOTS, apart = sphere ? APART_ON_SPHERE : PANTS_APART;
        double best = HUGE_VAL;
        if (!shortest_strip(best)) return false;
        uint32_t done = NONE;
        for (uint32_t s = 0; s < cut_.segment_count; ++s) {
            if (!call_.work(4)) return false;
            if (!signatures_.of[s]) continue;
            const uint32_t r = cut_.region[2 * size_t{s}];
            if (r == done || holes_[find_root(piece_.data(), r)] <= 3 || search_.bound(r) >= roots * best
                || search_.nearest_root(r) < apart * best)
                continue;
            if (static_cast<double>(search_.work()) >= allowed_) break;
            done = r;
            if (!search_.search(r, PANTS_SLACK * best)) return false;
            for (size_t i = 0; i < search_.count(); ++i) {
                if (marks_only_ && !is_round_pair(search_.signature(i))) continue;
                if (!search_.strip(i, cycle_)) return false;
                double total = 0;
                for (const uint32_t link : cycle_) total += length_[cut_.segment_edge[link >> 1]];
                best = std::min(best, total);
                if (!(total < PANTS_SLACK * best)) continue;
                const size_t begin = strips_.size();
                for (const uint32_t link : cycle_)
                    if (!strips_.push(cut_.half_edge(link))) return false;
                if (!cycles_.push({total, begin, cycle_.size()})) return false;
            }
        }
        search_.read_bounds(face_bound_);
        heap_sort(cycles_.data(), cycles_.size(), [](const Cycle& a, const Cycle& b) {
            return a.length < b.length || (a.length == b.length && a.first < b.first);
        });
        return true;
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

    // Of the candidates.  Around marked vertices a strip is longer than the estimate.
    Done shortest_strip(double& shortest) {
        const size_t begin = strips_.size();
        for (size_t i = 0; i < candidates_.size() && i < PANTS_MOST_CANDIDATES && candidates_[i].length < shortest;
             ++i) {
            if (!join(candidates_[i])) return false;
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
        for (size_t k = first; k < ids_.size(); ++k) added &= ids_[k] != id;
        return !added || (ids_.push(id) && strip_.push(strip));
    }

    // Of the candidates the one with the shortest class.
    Done choose() {
        const size_t first = ids_.size();
        bool added = false;
        if (lengths_.care() == LoopCare::shortest && !find_cycles()) return false;
        for (size_t i = 0; i < cycles_.size() && ids_.size() < first + PANTS_MOST_CANDIDATES; ++i) {
            if (cycles_[i].length > PANTS_SLACK * cycles_[0].length) break;
            if (!offer(first, {cycles_[i].first, cycles_[i].size}, added)) return false;
        }
        for (size_t i = 0; i < candidates_.size() && i < PANTS_MOST_CANDIDATES; ++i) {
            if (candidates_[i].length > PANTS_FURTHER * candidates_[0].length) break;
            if (lengths_.care() == LoopCare::quick && ids_.size() > first) break;
            const size_t begin = strips_.size();
            if (!join(candidates_[i])) return false;
            if (strips_.size() == begin) continue;
            if (!offer(first, {begin, strips_.size() - begin}, added)) return false;
            while (!added && strips_.size() > begin) strips_.pop();
        }
        if (!lengths_.look_beside(&ids_[first], ids_.size() - first)) return false;
        return choice_.push({first, ids_.size(), lengths_.shortest(&ids_[first], ids_.size() - first)});
    }

    // The loop of the last choice, shortened.
    hmf_status take_last() {
        const size_t at = choice_.back().first + choice_.back().taken;
        bool are_disjoint = false;
        if (lengths_.has_pulled()) {
            const uint32_t id = ids_[at];
            if (!loops_.add(lengths_.pulled(id), lengths_.pulled_size(id))
                || !one_is_disjoint(mesh_, loops_, loops_.count() - 1, curves_, call_, are_disjoint))
                return call_.out_of_memory();
            if (!are_disjoint) loops_.keep_first(loops_.count() - 1);
        }
        if (!are_disjoint && !loops_.add(strips_.data() + strip_[at].first, strip_[at].size))
            return call_.out_of_memory();
        return shorten_loops(mesh_, position_, loops_.count() - 1, 2, 1, call_, loops_);
    }

    // Once along the loop or around the marked vertex of a seed, with it on the right.
    Done go_round(Array<uint32_t>& walk, uint32_t seed) const {
        if (seeds_[seed].side >= 2 * curves_.components.count()) {
            for (const uint32_t h : mesh_.clockwise_from(seeds_[seed].crossing))
                if (!walk.push(h)) return false;
            return true;
        }
        const uint32_t k = seeds_[seed].side / 2, right = seeds_[seed].side & 1u, i = seeds_[seed].crossing;
        const uint64_t first = curves_.components.offsets[k], n = curves_.components.offsets[k + 1] - first;
        for (uint64_t t = 0; t < n; ++t) {
            const uint64_t at = right ? (i + n - t) % n : (i + 1 + t) % n;
            const uint32_t h = curves_.components.crossings[first + at];
            if (!walk.push(right ? twin(h) : h)) return false;
        }
        return true;
    }

    // The loop of a candidate, at the end of strips_.
    Done join(const Candidate& candidate) {
        const uint32_t middle = candidate.middle;
        Array<uint32_t> walk, way;
        walk.start(memory_);
        way.start(memory_);
        if (middle != NONE) {
            for (uint32_t r = cut_.region[middle]; from_[r] != NONE; r = cut_.region[from_[r]])
                if (!way.push(from_[r])) return false;
            std::reverse(way.begin(), way.end());
            if (!way.push(middle)) return false;
            for (uint32_t r = cut_.region[middle ^ 1u]; from_[r] != NONE; r = cut_.region[from_[r]])
                if (!way.push(from_[r] ^ 1u)) return false;
        }
        if (!go_round(walk, candidate.pair.a)) return false;
        for (const uint32_t link : way)
            if (!walk.push(cut_.half_edge(link))) return false;
        if (!go_round(walk, candidate.pair.b)) return false;
        for (size_t i = way.size(); i-- > 0;)
            if (!walk.push(twin(cut_.half_edge(way[i])))) return false;
        size_t begin = 0, end = 0;
        remove_backtracking(walk, begin, end);
        for (size_t i = begin; i < end; ++i)
            if (!strips_.push(walk[i])) return false;
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
    Multicurve curves_;
    CutSurface cut_;
    Array<uint32_t> piece_, holes_; // per region; number of holes at the root of a piece
    Array<double> around_;          // length per side; of a marked vertex 0
    Array<Seed> seeds_;
    Array<Pair> pairs_;      // that meet in one region
    Array<double> distance_; // per region
    Array<uint32_t> seed_, from_;
    NearestFirst heap_;
    Array<Candidate> candidates_; // for the next loop
    struct Sides {
        uint64_t both;
        uint32_t pair;
    };
    Array<Sides> sides_; // of pairs_
    Array<uint64_t> mark_word_;
    Array<uint32_t> strips_, ids_;
    Array<Strip> strip_; // per id
    Array<Choice> choice_;
    struct Cycle { // in strips_
        double length;
        size_t first, size;
    };
    Array<Cycle> cycles_;
    Array<uint32_t> hole_, cycle_;
    double allowed_ = 0;       // regions to be settled in all searches up to the next loop
    Array<double> face_bound_; // of the cycles through a face, which only get longer as loops are added
    Signatures signatures_;
    LoopSearch search_;
    CellBorders borders_;
};

} // namespace

hmf_status pants_decomposition(const Mesh& mesh, const double* position, ClassLengths& lengths, Call& call,
                               Loops& out) {
    const RootReach reach = lengths.care() == LoopCare::quick ? RootReach::near : RootReach::far;
    hmf_status status = cut_system(mesh, position, nullptr, lengths, call, out, reach);
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
