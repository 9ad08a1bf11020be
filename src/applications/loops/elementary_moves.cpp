// In passes. Each curve is removed, and its component (pants_component.hpp) searched for others. Once none of these is
// shorter, the same is done for each two curves that bound a pair of pants together:
//
//     four holes              curves around two of them (hole_joins.hpp), cycles with two on each side
//     one hole and a handle   cycles that do not separate (loop_search.hpp)
//     two curves              one of these cycles, and others in the component cut along it; or curves round
//                             different pairs of its holes
//
// Lengths on the level of the search can be too short by a tenth, so the curves themselves are measured first, and
// classes that may be shorter.  Of the shortening moves, those that gain most are made first, and none in a pair of
// pants that another one has changed. Then the curves whose component has changed are searched again.  The sum of the
// lengths falls with each move, so this ends.
#include "elementary_moves.hpp"

#include "../../core/base/disjoint_sets.hpp"
#include "../../core/base/heap_sort.hpp"
#include "../../core/curves/disjoint.hpp"
#include "dual_length.hpp"
#include "hole_joins.hpp"
#include "loop_search.hpp"
#include "pants_component.hpp"

#include <algorithm>

namespace hmf {

namespace {

class ElementaryMoves {
public:
    ElementaryMoves(const Mesh& mesh, const double* position, ClassLengths& lengths, Loops& loops, Call& call) :
        mesh_(mesh), position_(position), lengths_(lengths), loops_(loops), call_(call), memory_(call.memory),
        components_(mesh), joins_(mesh, length_), search_(whole_.surface, length_, nullptr, call),
        second_search_(half_.surface, length_, nullptr, call) {}

    hmf_status run() {
        if (!start()) return call_.stopped();
        bool in_pairs = false;
        for (;;) {
            bool moved = false;
            const hmf_status status = components_.start(loops_, call_);
            if (status) return status;
            moves_.clear();
            strips_.clear();
            if (!find_moves(in_pairs) || !measure() || !make_moves(moved)) return call_.stopped();
            if (!moved && in_pairs) break;
            in_pairs = !moved;
        }
        return straighten() && put_in_order() ? HMF_OK : call_.stopped();
    }

private:
    struct Strip { // in strips_
        size_t first, size;
    };
    using Cycle = LoopSearch::Cycle; // in links_
    struct Option {                  // a class for a curve
        uint32_t id;
        Strip strip;
        uint32_t hole[2]; // the marked vertex or hole that it goes around, or NONE
    };
    struct Move {
        uint32_t count; // one curve, or two
        uint32_t curve[2], id[2];
        Strip strip[2];
        double gain;
    };

    Done start() {
        const size_t n = loops_.count();
        strips_.start(memory_);
        links_.start(memory_);
        cycle_.start(memory_);
        found_.start(memory_);
        cycles_.start(memory_);
        second_.start(memory_);
        options_.start(memory_);
        moves_.start(memory_);
        own_strips_.start(memory_);
        if (!test_.allocate(mesh_, memory_) || !length_.allocate(memory_, mesh_.edge_count) || !id_.allocate(memory_, n)
            || !alone_.allocate_filled(memory_, n, uint8_t{1}) || !paired_.allocate_filled(memory_, n, uint8_t{1})
            || !own_.allocate_filled(memory_, n, Strip{0, 0})
            || !stamped_.allocate_filled(memory_, mesh_.edge_count, 0u))
            return false;
        const DualLength length(mesh_, position_);
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) length_[e] = length(e);
        for (size_t k = 0; k < n; ++k)
            if (!lengths_.add(loops_.loop(k), loops_.length(k), id_[k])) return false;
        bool changed = true;
        for (int time = 0; changed && time < 2; ++time) {
            for (const uint32_t id : id_) lengths_.want(id);
            if (!lengths_.measure(changed)) return false;
        }
        return true;
    }

    double length(uint32_t k) const { return lengths_.length(id_[k]); }
    double strip_length(const uint32_t* crossings, size_t n) const {
        double sum = 0;
        for (size_t i = 0; i < n; ++i) sum += length_[edge_of(crossings[i])];
        return sum;
    }
    double strip_length(uint32_t k) const { return strip_length(loops_.loop(k), loops_.length(k)); }

    // The curves, or pairs, whose components have changed since they were searched.
    Done find_moves(bool in_pairs) {
        const uint32_t n = static_cast<uint32_t>(loops_.count());
        for (uint32_t k = 0; k < n; ++k) {
            if (!call_.tick(0, true)) return false;
            if (static_cast<double>(search_.work() + second_search_.work()) >= search_budget(mesh_.face_count)) break;
            if (!in_pairs && alone_[k] && !try_one(k)) return false;
            for (uint32_t l = k + 1; in_pairs && l < n; ++l)
                if ((paired_[k] || paired_[l]) && components_.touch(k, l) && !try_two(k, l)) return false;
        }
        for (uint8_t& open : in_pairs ? paired_ : alone_) open = 0;
        return true;
    }

    // Its class is one of those from `first` on, then.  Its strip is the end of strips_, and goes if it is not needed.
    Done add_option(size_t first, Option option) {
        if (!lengths_.add(strips_.data() + option.strip.first, option.strip.size, option.id)) return false;
        for (size_t k = first; k < options_.size(); ++k) {
            if (options_[k].id != option.id) continue;
            while (strips_.size() > option.strip.first) strips_.pop();
            return true;
        }
        return options_.push(option);
    }

    // Curves around two holes.
    Done find_joins(const Component& component) {
        const size_t begin = options_.size();
        if (!joins_.find(component.surface, component.is_hole, join_, call_)) return false;
        for (size_t i = 0; i < join_.size() && options_.size() < begin + CANDIDATES; ++i) {
            const size_t first = strips_.size();
            if (!joins_.walk(join_[i], strips_, memory_)) return false;
            if (strips_.size() == first) continue;
            if (!add_option(begin, {NONE, {first, strips_.size() - first}, {join_[i].hole[0], join_[i].hole[1]}}))
                return false;
        }
        return true;
    }

    // Cycles that are not around one hole: those short compared with the best one, a known strip, and those shorter
    // than `wanted`. One for each option.
    Done find_cycles(const Component& component, LoopSearch& search, double best, double wanted, Array<Cycle>& cycles) {
        const CutSurface& cut = component.surface;
        cycles.clear();
        if (!signatures_.build_punctured(cut, component.is_hole, call_) || !search.prepare(signatures_, 1)
            || !search.find_cycles(
                ROOTS, APART, wanted, HUGE_VAL, [](uint32_t) { return true; }, [](uint64_t) { return true; }, best,
                links_, found_))
            return false;
        const size_t begin = options_.size();
        for (const Cycle& c : found_) {
            if (cycles.size() == CANDIDATES || c.length > std::max(SLACK * best, wanted)) break;
            const Strip strip = {strips_.size(), c.size};
            for (size_t k = c.first; k < c.first + c.size; ++k)
                if (!strips_.push(cut.half_edge(links_[k]))) return false;
            if (!add_option(begin, {NONE, strip, {NONE, NONE}})) return false;
            if (options_.size() > begin + cycles.size() && !cycles.push(c)) return false;
        }
        return true;
    }

    static bool has_handle(const CutSurface& surface) {
        return surface.point_count + surface.region_count != surface.segment_count + 2;
    }

    Done try_one(uint32_t k) {
        options_.clear();
        links_.clear();
        if (!components_.build(&k, 1, whole_, memory_) || !find_cycles(whole_, search_, strip_length(k), 0, cycles_)
            || (!has_handle(whole_.surface) && !find_joins(whole_)))
            return false;
        own_[k] = {0, 0};
        double best = strip_length(k) * (1 - SAME);
        for (const Option& o : options_) {
            const uint32_t* const strip = strips_.data() + o.strip.first;
            if (o.id != id_[k] || !(strip_length(strip, o.strip.size) < best)) continue;
            best = strip_length(strip, o.strip.size);
            own_[k] = {own_strips_.size(), o.strip.size};
            for (size_t i = 0; i < o.strip.size; ++i)
                if (!own_strips_.push(strip[i])) return false;
        }
        for (const Option& o : options_) {
            if (o.id == id_[k] || !lengths_.may_be_shorter(&o.id, &id_[k], 1)) continue;
            if (!moves_.push({1, {k, NONE}, {o.id, NONE}, {o.strip, {0, 0}}, 0})) return false;
        }
        return true;
    }

    Done try_two(uint32_t k, uint32_t l) {
        const uint32_t pair[2] = {k, l};
        const double strips = strip_length(k) + strip_length(l);
        options_.clear();
        links_.clear();
        if (!components_.build(pair, 2, whole_, memory_)
            || !find_cycles(whole_, search_, std::min(strip_length(k), strip_length(l)), strips / 2, cycles_))
            return false;
        const size_t cycles = options_.size();
        if (!has_handle(whole_.surface) && !find_joins(whole_)) return false;
        for (size_t i = cycles; i < options_.size(); ++i)
            for (size_t j = i + 1; j < options_.size(); ++j) {
                const Option &a = options_[i], &b = options_[j];
                if (a.hole[0] == b.hole[0] || a.hole[0] == b.hole[1] || a.hole[1] == b.hole[0]
                    || a.hole[1] == b.hole[1])
                    continue;
                if (!offer(pair, a, b)) return false;
            }
        while (options_.size() > cycles) options_.pop();
        size_t tried = 0;
        for (size_t i = 0; i < cycles && tried < STARTS; ++i) {
            if (options_[i].id == id_[k] || options_[i].id == id_[l]) continue;
            if (2 * lengths_.length(options_[i].id) > (length(k) + length(l)) * (1 + DOUBT[0])) continue;
            ++tried;
            cycle_.clear();
            for (size_t n = cycles_[i].first; n < cycles_[i].first + cycles_[i].size; ++n)
                if (!cycle_.push(links_[n])) return false;
            const size_t links = links_.size();
            if (!whole_.cut_along(mesh_, cycle_, half_, memory_)
                || !find_cycles(half_, second_search_, strips - cycles_[i].length, 0, second_) || !find_joins(half_))
                return false;
            for (size_t j = cycles; j < options_.size(); ++j)
                if (!offer(pair, options_[i], options_[j])) return false;
            while (options_.size() > cycles) options_.pop();
            while (links_.size() > links) links_.pop();
        }
        return true;
    }

    // Both instead of both.
    Done offer(const uint32_t* pair, const Option& a, const Option& b) {
        const uint32_t old[2] = {id_[pair[0]], id_[pair[1]]}, ids[2] = {a.id, b.id};
        for (const uint32_t id : ids)
            if (id == old[0] || id == old[1]) return true; // one curve alone
        const double most = (lengths_.length(old[0]) + lengths_.length(old[1])) * (1 + DOUBT[0]);
        if (a.id == b.id || lengths_.length(a.id) + lengths_.length(b.id) > most) return true;
        return !lengths_.may_be_shorter(ids, old, 2)
            || moves_.push({2, {pair[0], pair[1]}, {a.id, b.id}, {a.strip, b.strip}, 0});
    }

    Done measure() {
        bool changed = true;
        for (int time = 0; changed && time < CHOICE_ROUNDS; ++time) {
            if (!lengths_.measure(changed)) return false;
            for (size_t i = 0; changed && i < moves_.size(); ++i) {
                const Move& m = moves_[i];
                const uint32_t old[2] = {id_[m.curve[0]], m.count > 1 ? id_[m.curve[1]] : NONE};
                lengths_.may_be_shorter(m.id, old, m.count);
            }
        }
        for (Move& m : moves_)
            for (uint32_t i = 0; i < m.count; ++i) m.gain += length(m.curve[i]) - lengths_.length(m.id[i]);
        return true;
    }

    Done make_moves(bool& moved) {
        Array<uint8_t> taken;
        if (!taken.allocate_filled(memory_, components_.pants_count(), uint8_t{0})) return false;
        heap_sort(moves_.data(), moves_.size(), [](const Move& a, const Move& b) {
            return a.gain > b.gain || (a.gain == b.gain && a.strip[0].first < b.strip[0].first);
        });
        for (const Move& m : moves_) {
            double sum = 0;
            bool free = true, done = false;
            for (uint32_t i = 0; i < m.count; ++i) {
                sum += length(m.curve[i]);
                for (size_t left = 0; left < 2; ++left) free &= !taken[components_.pants(m.curve[i], left)];
            }
            if (!(m.gain > SAME * sum)) continue;
            if (free && !make(m, done)) return false;
            moved |= done;
            for (uint32_t i = 0; i < m.count; ++i) {
                const uint32_t k = m.curve[i];
                alone_[k] = paired_[k] = 1;
                if (!done) continue;
                id_[k] = m.id[i];
                own_[k] = {0, 0}; // that was of another class
                for (size_t left = 0; left < 2; ++left) taken[components_.pants(k, left)] = 1;
                for (uint32_t l = 0; l < loops_.count(); ++l)
                    if (components_.touch(k, l)) alone_[l] = paired_[l] = 1;
            }
        }
        return true;
    }

    // Uses the pulled strips of the classes if they meet no other loops, otherwise the strips that were found.
    Done make(const Move& m, bool& done) {
        done = false;
        for (uint32_t found = 0; !done && found < (1u << m.count); ++found) {
            const uint32_t* strip[2] = {};
            size_t size[2] = {};
            for (uint32_t i = 0; i < m.count; ++i) {
                const bool as_found = (found >> i) & 1u;
                strip[i] = as_found ? strips_.data() + m.strip[i].first : lengths_.pulled(m.id[i]);
                size[i] = as_found ? m.strip[i].size : lengths_.pulled_size(m.id[i]);
            }
            if (!replace(m.curve, strip, size, m.count, done)) return false;
        }
        return true;
    }

    // Other strips for one curve or two, if they meet no other loops.
    Done replace(const uint32_t* curve, const uint32_t* const* strip, const size_t* size, uint32_t count, bool& done) {
        Loops changed, again;
        if (!changed.start(memory_) || !again.start(memory_)) return false;
        for (size_t c = 0; c < loops_.count(); ++c)
            if (c != curve[0] && (count < 2 || c != curve[1]) && !changed.add(loops_, c)) return false;
        done = true;
        for (uint32_t i = 0; done && i < count; ++i)
            if (!changed.add(strip[i], size[i])
                || !one_is_disjoint(mesh_, changed, changed.count() - 1, test_, call_, done))
                return false;
        if (!done) return true;
        for (size_t c = 0; c < loops_.count(); ++c) {
            const size_t i = c == curve[0] ? 0 : count > 1 && c == curve[1] ? 1 : 2;
            if (!(i < 2 ? again.add(strip[i], size[i]) : again.add(loops_, c))) return false;
        }
        loops_.swap(again);
        return true;
    }

    // In a class with several closed geodesics a curve may lie beside one that is not the shortest: then it is replaced
    // by its pulled curve, together with the curves that this crosses; otherwise by the curve found last.
    Done straighten() {
        for (uint32_t k = 0; k < loops_.count(); ++k) {
            if (!call_.tick(0, true)) return false;
            bool done = false;
            if (strip_length(lengths_.pulled(id_[k]), lengths_.pulled_size(id_[k])) < strip_length(k) * (1 - SAME)
                && !pull_with_others(k, done))
                return false;
            const uint32_t* const strip = own_strips_.data() + own_[k].first;
            if (!done && own_[k].size > 0 && !replace(&k, &strip, &own_[k].size, 1, done)) return false;
        }
        return true;
    }

    // The curves that its pulled strip meets are pulled as well, and so on, if all are disjoint afterwards.
    Done pull_with_others(uint32_t k, bool& done) {
        const size_t n = loops_.count();
        Array<uint32_t> pulled;
        Array<uint8_t> is_pulled;
        pulled.start(memory_);
        if (!is_pulled.allocate_filled(memory_, n, uint8_t{0}) || !pulled.push(k)) return false;
        is_pulled[k] = 1;
        Loops two, changed;
        for (size_t i = 0; i < pulled.size(); ++i) {
            if (i == static_cast<size_t>(CHOICE_ROUNDS)) return true;
            const uint32_t id = id_[pulled[i]];
            ++stamp_;
            for (size_t x = 0; x < lengths_.pulled_size(id); ++x) stamped_[edge_of(lengths_.pulled(id)[x])] = stamp_;
            for (uint32_t c = 0; c < n; ++c) {
                bool apart = true; // without a common edge
                for (size_t x = 0; x < loops_.length(c) && !is_pulled[c]; ++x)
                    apart &= stamped_[edge_of(loops_.loop(c)[x])] != stamp_;
                if (apart) continue;
                if (!two.start(memory_) || !two.add(loops_, c)
                    || !two.add(lengths_.pulled(id), lengths_.pulled_size(id))
                    || !one_is_disjoint(mesh_, two, 1, test_, call_, apart))
                    return false;
                if (apart) continue;
                is_pulled[c] = 1;
                if (!pulled.push(c)) return false;
            }
        }
        if (!changed.start(memory_)) return false;
        for (uint32_t c = 0; c < n; ++c)
            if (!(is_pulled[c] ? changed.add(lengths_.pulled(id_[c]), lengths_.pulled_size(id_[c]))
                               : changed.add(loops_, c)))
                return false;
        if (!disjoint(mesh_, changed, 0, n, test_, nullptr, call_, done)) return false;
        if (done) loops_.swap(changed);
        return true;
    }

    // A cut system first: the shortest ones without which the surface stays in one piece.
    Done put_in_order() {
        const uint32_t n = static_cast<uint32_t>(loops_.count()),
                       pants = static_cast<uint32_t>(components_.pants_count());
        Array<uint32_t> order, piece;
        Array<uint8_t> joins;
        Loops sorted;
        if (!order.allocate(memory_, n) || !piece.allocate(memory_, pants)
            || !joins.allocate_filled(memory_, n, uint8_t{0}) || !sorted.start(memory_))
            return false;
        for (uint32_t k = 0; k < n; ++k) order[k] = k;
        for (uint32_t p = 0; p < pants; ++p) piece[p] = p;
        heap_sort(order.data(), n, [this](uint32_t a, uint32_t b) {
            const double x = length(a), y = length(b);
            return x < y || (x == y && a < b);
        });
        for (uint32_t i = n; i-- > 0;) {
            const uint32_t k = order[i];
            joins[k] = unite(piece.data(), components_.pants(k, 0), components_.pants(k, 1));
        }
        for (const bool last : {false, true})
            for (const uint32_t k : order)
                if ((joins[k] != 0) == last && !sorted.add(loops_, k)) return false;
        loops_.swap(sorted);
        return true;
    }

    const Mesh& mesh_;
    const double* position_;
    ClassLengths& lengths_;
    Loops& loops_;
    Call& call_;
    Memory& memory_;
    Array<double> length_; // per edge
    PantsComponents components_;
    Component whole_, half_;
    HoleJoins joins_;
    Signatures signatures_;
    LoopSearch search_, second_search_; // in whole_ and half_
    Multicurve test_;
    Array<uint32_t> id_;            // per curve
    Array<uint8_t> alone_, paired_; // per curve: has another component than when it was looked at, alone or with others
    Array<Cycle> found_, cycles_, second_;
    Array<HoleJoins::Join> join_;
    Array<Option> options_;
    Array<uint32_t> links_, strips_, cycle_;
    Array<Move> moves_;
    Array<Strip> own_; // per curve: in own_strips_, a shorter one of its class, or none
    Array<uint32_t> own_strips_;
    Array<uint32_t> stamped_; // per edge: the last of the pulled strips that cross it
    uint32_t stamp_ = 0;
};

} // namespace

hmf_status shorten_by_moves(const Mesh& mesh, const double* position, ClassLengths& lengths, Call& call, Loops& loops) {
    ElementaryMoves moves(mesh, position, lengths, loops, call);
    return moves.run();
}

} // namespace hmf
