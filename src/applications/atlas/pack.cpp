#include "pack.hpp"

#include "../../core/base/heap_sort.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {
constexpr uint32_t ROUND = 300;                   // packings after which higher ones are accepted again
constexpr uint32_t TRIES = 200, TRIES_EACH = 700; // of an atlas, and for each chart
constexpr uint32_t NO_INTERVAL = 0xffffffffu;
constexpr uint8_t ANY = 4;             // quarter turns: those with which a shape lies lowest
constexpr uint64_t PACK_STRIDE = 4096; // steps between two reports
} // namespace

void Packer::start(Memory& memory, double column, double margin) {
    memory_ = &memory;
    column_ = std::floor(std::max(1.0, column));
    margin_ = margin;
    side_ = 0;
    steps_ = reported_ = 0;
    items_.start(memory);
    bottom_.start(memory);
    top_.start(memory);
    best_places_.start(memory);
}

Done Packer::Arrangement::copy(const Arrangement& from, Memory& memory) {
    if (order.size() != from.order.size()
        && (!order.allocate(memory, from.order.size()) || !turns.allocate(memory, from.turns.size())))
        return false;
    for (size_t i = 0; i < order.size(); ++i) {
        order[i] = from.order[i];
        turns[i] = from.turns[i];
    }
    return true;
}

Done Packer::begin_shape(double x0, double y0, double x1, double y1) {
    const double half = margin_ / 2;
    Item item{std::floor(x0 - half), std::floor(y0 - half), std::ceil(x1 + half), std::ceil(y1 + half), {}};
    const double size[2] = {item.x1 - item.x0, item.y1 - item.y0};
    for (int turned = 0; turned < 2; ++turned) {
        Profile& p = item.side[turned];
        p.first = bottom_.size();
        p.columns = static_cast<uint32_t>(size[turned] / column_) + 1;
        p.height = size[1 - turned];
        for (uint32_t j = 0; j < p.columns; ++j)
            if (!bottom_.push(p.height) || !top_.push(0)) return false;
    }
    return items_.push(item);
}

// A convex part, wider by half a margin, in each column that it meets.
uint64_t Packer::add_to(const Profile& profile, double x0, double y0, const double* xy, int corners) {
    double low = xy[0], high = xy[0];
    for (int i = 1; i < corners; ++i) {
        low = std::min(low, xy[2 * i]);
        high = std::max(high, xy[2 * i]);
    }
    const double half = margin_ / 2;
    const uint32_t last = profile.columns - 1;
    const auto column_at = [&](double x) {
        const double j = (x - x0) / column_;
        return j <= 0 ? 0u : std::min(last, static_cast<uint32_t>(j));
    };
    const uint32_t first = column_at(low - half), end = column_at(high + half) + 1;
    for (uint32_t j = first; j < end; ++j) {
        const double left = x0 + column_ * j - half, right = left + column_ + margin_;
        double least = HUGE_VAL, most = -HUGE_VAL;
        const auto meet = [&](double y) {
            least = std::min(least, y);
            most = std::max(most, y);
        };
        for (int i = 0; i < corners; ++i) {
            const double *a = xy + 2 * i, *b = xy + 2 * ((i + 1) % corners);
            if (a[0] >= left && a[0] <= right) meet(a[1]);
            for (const double x : {left, right})
                if ((a[0] < x) != (b[0] < x)) meet(a[1] + (b[1] - a[1]) * ((x - a[0]) / (b[0] - a[0])));
        }
        double& bottom = bottom_[profile.first + j];
        double& top = top_[profile.first + j];
        bottom = std::max(0.0, std::min(bottom, std::floor(least - half - y0)));
        top = std::min(profile.height, std::max(top, std::ceil(most + half - y0)));
    }
    return end - first;
}

uint64_t Packer::add_part(const double* xy, int corners) {
    const Item& item = items_.back();
    const uint64_t columns = add_to(item.side[0], item.x0, item.y0, xy, corners);
    double turned[8];
    for (int i = 0; i < corners; ++i) {
        turned[2 * i] = -xy[2 * i + 1];
        turned[2 * i + 1] = xy[2 * i];
    }
    return columns + add_to(item.side[1], -item.y1, item.x0, turned, corners);
}

// Half a turn turns a profile upside down.
Done Packer::turn_upside_down() {
    for (Item& item : items_)
        for (int turned = 0; turned < 2; ++turned) {
            const Profile& p = item.side[turned];
            Profile& q = item.side[turned + 2];
            q = p;
            q.first = bottom_.size();
            for (uint32_t j = p.columns; j-- > 0;) {
                const double bottom = p.height - top_[p.first + j], top = p.height - bottom_[p.first + j];
                if (!bottom_.push(bottom) || !top_.push(top)) return false;
            }
        }
    return true;
}

// The lowest y, at most `most`, at which a profile is free in all columns from x on.
// hint: the column to look at first; where it is not free, the one to look at first a column further right.
bool Packer::lowest(const Profile& p, uint32_t x, double most, uint32_t& hint, double& y) {
    const double *bottom = bottom_.data() + p.first, *top = top_.data() + p.first;
    y = 0;
    // It rises beyond all intervals of one column.  False: too far.
    const auto rise = [&](uint32_t j) {
        ++steps_;
        if (!(bottom[j] < top[j])) return true;
        for (uint32_t k = column_first_[x + j]; k != NO_INTERVAL; k = intervals_[k].next) {
            const Interval& i = intervals_[k];
            if (y + top[j] <= i.bottom) break;
            if (y + bottom[j] < i.top) y = i.top - bottom[j];
        }
        if (y <= most) return true;
        hint = j > 0 ? j - 1 : 0;
        return false;
    };
    if (most < 0) return false;
    // Round and round, until none of them has made it rise.
    uint32_t j = std::min(hint, p.columns - 1);
    for (uint32_t free = 0; free < p.columns; ++free) {
        const double before = y;
        if (!rise(j)) return false;
        if (y > before) free = 0;
        if (++j == p.columns) j = 0;
    }
    return true;
}

void Packer::occupy(const Profile& p, uint32_t x, double y) {
    const double *bottom = bottom_.data() + p.first, *top = top_.data() + p.first;
    for (uint32_t j = 0; j < p.columns; ++j) {
        if (!(bottom[j] < top[j])) continue;
        uint32_t before = NO_INTERVAL;
        uint32_t* at = &column_first_[x + j];
        while (*at != NO_INTERVAL && intervals_[*at].bottom < y + bottom[j]) {
            before = *at;
            at = &intervals_[before].next;
        }
        const uint32_t next = *at;
        *at = static_cast<uint32_t>(intervals_.size());
        intervals_.add({y + bottom[j], y + top[j], next});
        // Room between two that is too narrow for every shape is no room: nothing but the length of the list changes.
        const auto join_with_next = [this](Interval& i) {
            while (i.next != NO_INTERVAL && intervals_[i.next].bottom - i.top < narrowest_) {
                i.top = intervals_[i.next].top;
                i.next = intervals_[i.next].next;
            }
        };
        join_with_next(intervals_.back());
        if (before != NO_INTERVAL) join_with_next(intervals_[before]);
    }
}

// The area of the boxes that do not fit into the square of this width; HUGE_VAL if it is more than `most`, or if the
// call was cancelled.
double Packer::let_down(const Arrangement& state, uint32_t width, double most, Place* places, Call& call) {
    for (uint32_t j = 0; j < width; ++j) column_first_[j] = NO_INTERVAL;
    intervals_.clear();
    double missing = 0;
    missed_ = NO_INTERVAL;
    for (uint32_t k = 0; k < state.order.size(); ++k) {
        const uint32_t i = state.order[k];
        const bool is_free = state.turns[i] == ANY;
        uint32_t turns = 0, best_x = NO_INTERVAL;
        double best_y = 0, best_top = column_ * width;
        for (uint32_t t = is_free ? 0 : state.turns[i]; t <= (is_free ? 3u : state.turns[i]); ++t) {
            const Profile& side = items_[i].side[t];
            double limit = (best_x == NO_INTERVAL ? best_top : best_top - 1) - side.height, y = 0;
            uint32_t hint = 0;
            for (uint32_t x = 0; x + side.columns <= width && limit >= 0; ++x) {
                if (steps_ - reported_ >= PACK_STRIDE) {
                    reported_ = steps_;
                    if (!call.tick(0.9)) return HUGE_VAL;
                }
                if (!lowest(side, x, limit, hint, y)) continue;
                turns = t;
                best_x = x;
                best_y = y;
                best_top = y + side.height;
                limit = y - 1;
            }
        }
        const Profile& p = items_[i].side[turns];
        if (best_x == NO_INTERVAL) {
            missing += p.height * column_ * p.columns;
            if (missed_ == NO_INTERVAL) missed_ = k;
            if (missing > most) return HUGE_VAL;
            continue;
        }
        occupy(p, best_x, best_y);
        if (places) {
            const Item& item = items_[i];
            // The lower left corner of the box after the turns.
            const double left[4] = {item.x0, -item.y1, -item.x1, item.y0},
                         low[4] = {item.y0, item.x0, -item.y1, -item.x1};
            // Half a turn also reverses the columns, the last of which is wider than the shape.
            const double width_there = (turns & 1) ? item.y1 - item.y0 : item.x1 - item.x0;
            const double spare = turns < 2 ? 0 : column_ * p.columns - width_there;
            places[i] = {turns, column_ * best_x + spare - left[turns], best_y - low[turns]};
        }
    }
    return missing;
}

void Packer::sort(Arrangement& state, int key, bool upright) const {
    const auto size = [&](uint32_t i) {
        const double w = items_[i].x1 - items_[i].x0, h = items_[i].y1 - items_[i].y0;
        return key == 0 ? std::max(w, h) : key == 1 ? w * h : std::min(w, h);
    };
    for (uint32_t i = 0; i < count(); ++i) {
        state.order[i] = i;
        const bool tall = items_[i].y1 - items_[i].y0 > items_[i].x1 - items_[i].x0;
        state.turns[i] = tall != upright;
    }
    heap_sort(state.order.data(), state.order.size(),
              [&](uint32_t a, uint32_t b) { return size(a) != size(b) ? size(a) > size(b) : a < b; });
}

// Room for everything, and the widths that the search begins with.
hmf_status Packer::prepare(Arrangement& state, Widths& width, Call& call) {
    const uint32_t n = count();
    if (!state.order.allocate(*memory_, n) || !state.turns.allocate(*memory_, n) || !best_places_.allocate(*memory_, n)
        || !turn_upside_down())
        return call.out_of_memory();
    size_t most_intervals = 0;
    double area = 0; // of the profiles, with margins and what columns are too wide
    width.row = width.least = 1;
    narrowest_ = HUGE_VAL;
    for (const Item& item : items_) {
        double filled[2] = {0, 0};
        for (int turned = 0; turned < 2; ++turned) {
            const Profile& p = item.side[turned];
            for (size_t j = p.first; j < p.first + p.columns; ++j) {
                if (!(bottom_[j] < top_[j])) continue;
                filled[turned] += top_[j] - bottom_[j];
                narrowest_ = std::min(narrowest_, top_[j] - bottom_[j]);
            }
        }
        area += std::min(filled[0], filled[1]) * column_;
        const uint32_t wide = std::max(item.side[0].columns, item.side[1].columns);
        width.row += wide + 1;
        width.least = std::max(width.least, wide - 1); // of a square; the last column may be hardly met
        most_intervals += wide;
    }
    width.now = std::max(width.least, static_cast<uint32_t>(std::sqrt(area) / column_));
    width.row = std::max(width.row, width.now);
    intervals_.start(*memory_);
    return column_first_.allocate(*memory_, width.row) && intervals_.reserve(most_intervals) ? HMF_OK
                                                                                             : call.out_of_memory();
}

// A width that all orders are tried with, until one fits; one row of all fits at last.
hmf_status Packer::find_first(uint64_t effort, const Packer* coarser, Arrangement& state, Widths& width, Call& call) {
    const uint32_t n = count();
    if (coarser) {
        if (!state.copy(coarser->best_, *memory_)) return call.out_of_memory();
        width.now = std::min(width.row, std::max(width.now, static_cast<uint32_t>(coarser->side_ / column_)));
        for (;; ++width.now) {
            if (!call.tick(0.9)) return call.was_cancelled();
            if (let_down(state, width.now, 0, nullptr, call) == 0) return HMF_OK;
            if (width.now >= width.row) break;
        }
    }
    const int kinds = n < 100 ? 6 : 1;
    for (;;) {
        for (int kind = 0; kind < kinds; ++kind) {
            if (!call.tick(0.9)) return call.was_cancelled();
            sort(state, kind % 3, kind / 3 == 0);
            if (let_down(state, width.now, 0, nullptr, call) == 0) return HMF_OK;
        }
        if (call.cancelled()) return call.was_cancelled();
        if (width.now >= width.row)
            return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0, "The charts cannot be packed. Please report it.");
        const uint32_t part = steps_ > 10 * effort + 10000000 ? 4 : n < 100 ? 100 : 20;
        width.now = std::min(width.row, width.now + 1 + width.now / part);
    }
}

// Two shapes change places, or one comes earlier or later, or is turned.  Often it is one that did not fit.
void Packer::change(Arrangement& state, uint32_t missed) {
    const auto below = [this](uint32_t limit) {
        random_ = random_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<uint32_t>((random_ >> 33) % limit);
    };
    const uint32_t n = count();
    const uint32_t what = below(4), a = below(n), b = missed != NO_INTERVAL && below(2) ? missed : below(n);
    if (what == 1) std::swap(state.order[a], state.order[b]);
    else if (what > 1) {
        const uint32_t item = state.order[b];
        for (uint32_t i = b; i > a; --i) state.order[i] = state.order[i - 1];
        for (uint32_t i = b; i < a; ++i) state.order[i] = state.order[i + 1];
        state.order[a] = item;
    }
    if (what == 0 || below(2) == 0) state.turns[state.order[a]] = static_cast<uint8_t>(below(3) ? ANY : below(4));
}

// Simulated annealing at ever smaller widths: a worse state is accepted as well, less and less so.
hmf_status Packer::narrow(uint64_t effort, Arrangement& state, Widths& width, Call& call) {
    if (!best_.copy(state, *memory_) || !current_.copy(state, *memory_)) return call.out_of_memory();
    random_ = 0x9e3779b97f4a7c15u;
    bool fresh = true;       // as it is, at a new width
    double least = HUGE_VAL; // area that did not fit at the width that is tried
    uint32_t missed = 0;     // of current_
    for (uint32_t i = 0; steps_ < effort && i < TRIES + TRIES_EACH * count() && width.now > width.least; ++i) {
        if (!call.tick(0.9)) return call.was_cancelled();
        if (!state.copy(current_, *memory_)) return call.out_of_memory();
        if (!fresh) change(state, missed);
        fresh = false;
        const double part = 1 - static_cast<double>(i % ROUND) / ROUND;
        const double most = least * (1 + 0.5 * part * part);
        const double missing = let_down(state, width.now - 1, most, nullptr, call);
        if (missing > most) continue;
        least = std::min(least, missing);
        missed = missed_;
        if (!current_.copy(state, *memory_)) return call.out_of_memory();
        if (missing > 0) continue;
        --width.now;
        if (!best_.copy(state, *memory_)) return call.out_of_memory();
        least = HUGE_VAL;
        fresh = true;
    }
    return HMF_OK;
}

hmf_status Packer::search(uint64_t effort, const Packer* coarser, Call& call) {
    Arrangement state;
    Widths width;
    if (prepare(state, width, call) || find_first(effort, coarser, state, width, call)
        || narrow(effort, state, width, call))
        return call.status();
    let_down(best_, width.now, HUGE_VAL, best_places_.data(), call);
    if (call.cancelled()) return call.was_cancelled();
    side_ = column_ * width.now;
    return HMF_OK;
}

} // namespace hmf
