#include "atlas.hpp"

#include "chart_layout.hpp"
#include "pack.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint64_t THOROUGH = 40000000, FINISHING = 60000000; // steps of packing, in wide columns, then narrow ones
constexpr double COARSE_COLUMN = GRID / 128, COLUMN = GRID / 320;
constexpr int MARGIN_ROUNDS = 20; // of finding the margin in units
constexpr double LARGEST_MARGIN = 64 * GRID;

// Charts on the grid into the square.
class ChartPacking {
public:
    ChartPacking(const FlatPieces& pieces, const GridLayout& grid, Call& call) :
        pieces_(pieces), grid_(grid), call_(call) {}

    hmf_status run(Atlas& out) {
        if (!outline(out)) return call_.out_of_memory();
        Packer coarse;
        double margin = 0;
        if (find_margin(margin) || add_charts(COARSE_COLUMN, margin, coarse) || coarse.search(THOROUGH, nullptr, call_)
            || add_charts(COLUMN, margin, packer_) || packer_.search(FINISHING, &coarse, call_))
            return call_.status();
        if (!out.uv.allocate_filled(call_.memory, size_t{4} * pieces_.mesh.edge_count, 0)) return call_.out_of_memory();
        for (uint32_t t = 0; t < pieces_.side.size(); ++t)
            if (grid_.chart[t] != NONE) place(t, out);
        out.side = packer_.side();
        out.used_area = area_ / (packer_.side() * packer_.side());
        return HMF_OK;
    }

private:
    template <class Visit>
    void for_corners(uint32_t t, const Visit& visit) const {
        uint32_t h = pieces_.side[t];
        for (int k = 0; k < 3; ++k, h = pieces_.mesh.next[h]) visit(h);
    }

    // Boxes and triangles of the charts, areas.
    Done outline(Atlas& out) {
        const uint32_t n = grid_.chart_count;
        if (!first_.allocate_filled(call_.memory, size_t{n} + 1, 0)
            || !faces_.allocate(call_.memory, pieces_.side.size())
            || !box_.allocate_filled(call_.memory, n, Box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL}))
            return false;
        out.collapsed = 0;
        for (uint32_t t = 0; t < pieces_.side.size(); ++t) {
            const uint32_t c = grid_.chart[t];
            if (c == NONE) continue;
            ++first_[c];
            for_corners(t, [&](uint32_t h) {
                const double x = static_cast<double>(grid_.x[h]), y = static_cast<double>(grid_.y[h]);
                box_[c].add({x, y, x, y});
            });
            const int64_t twice = grid_area(pieces_.mesh, grid_, pieces_.side[t]);
            out.collapsed += twice <= 0;
            area_ += static_cast<double>(twice) / 2;
        }
        for (uint32_t c = 0, sum = 0; c <= n; ++c) sum = first_[c] += sum;
        for (uint32_t t = 0; t < pieces_.side.size(); ++t)
            if (grid_.chart[t] != NONE) faces_[--first_[grid_.chart[t]]] = t;
        return true;
    }

    // column: of a square that is no wider than twice GRID.  Where long charts or many margins make it
    // wider, columns are as well.
    hmf_status add_charts(double column, double margin, Packer& packer) {
        packer.start(call_.memory, column * (widest_ / (2 * GRID)), margin);
        for (uint32_t c = 0; c < grid_.chart_count; ++c) {
            if (!call_.work(64, 0.9, false)) return call_.was_cancelled();
            if (!packer.begin_shape(box_[c].u0, box_[c].v0, box_[c].u1, box_[c].v1)) return call_.out_of_memory();
            for (uint32_t i = first_[c]; i < first_[c + 1]; ++i) {
                double xy[6];
                size_t k = 0;
                for_corners(faces_[i], [&](uint32_t h) {
                    xy[k++] = static_cast<double>(grid_.x[h]);
                    xy[k++] = static_cast<double>(grid_.y[h]);
                });
                if (!call_.work(8 * packer.add_part(xy, 3), 0.9, false)) return call_.was_cancelled();
            }
        }
        return HMF_OK;
    }

    // The side of a rough packing gives the margin in units.
    hmf_status find_margin(double& margin) {
        margin = pieces_.margin * GRID * 1.12;
        for (const Box& b : box_) widest_ = std::max(widest_, std::max(b.u1 - b.u0, b.v1 - b.v0));
        for (int round = 0;; ++round) {
            if (round == MARGIN_ROUNDS || margin > LARGEST_MARGIN)
                return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                                  "The margin is too large for %u charts. Choose a smaller one.",
                                  static_cast<unsigned>(grid_.chart_count));
            if (add_charts(COARSE_COLUMN, margin, packer_) || packer_.search(0, nullptr, call_)) return call_.status();
            if (margin >= pieces_.margin * packer_.side()) return HMF_OK;
            widest_ = std::max(widest_, packer_.side());
            margin = pieces_.margin * packer_.side() * 1.02;
        }
    }

    void place(uint32_t t, Atlas& out) const {
        const Packer::Place& place = packer_.place(grid_.chart[t]);
        const double side = packer_.side();
        for_corners(t, [&](uint32_t h) {
            const double x = static_cast<double>(grid_.x[h]), y = static_cast<double>(grid_.y[h]);
            const double turned[4] = {x, -y, -x, y}; // x after the given number of quarter turns; y is one turn behind
            // To whole units of the grid, so that corners which coincide still do.
            out.uv[2 * size_t{h}] = (turned[place.turns] + std::floor(place.x)) / side;
            out.uv[2 * size_t{h} + 1] = (turned[(place.turns + 3) % 4] + std::floor(place.y)) / side;
        });
    }

    const FlatPieces& pieces_;
    const GridLayout& grid_;
    Call& call_;
    Packer packer_;
    Array<uint32_t> first_, faces_; // triangles of each chart
    Array<Box> box_;                // per chart
    double area_ = 0;               // of all triangles
    double widest_ = 2 * GRID;      // square that is reckoned with
};

} // namespace

bool Atlas::is_joined(const Mesh& mesh, uint32_t edge) const {
    const uint32_t h = 2 * edge, t = h + 1;
    if (chart[mesh.face[h]] != chart[mesh.face[t]]) return false;
    for (size_t i = 0; i < 2; ++i)
        if (uv[2 * size_t{h} + i] != uv[2 * size_t{mesh.next[t]} + i]
            || uv[2 * size_t{t} + i] != uv[2 * size_t{mesh.next[h]} + i])
            return false;
    return true;
}

hmf_status Atlas::build(const Mesh& mesh, const double* position, const SignBundle& bundle, const Strips& strips,
                        double margin, Call& call) {
    FlatPieces pieces{mesh, position, bundle, strips, margin, {}, {}, {}};
    ChartPlan plan(pieces, call);
    GridLayout grid;
    if (pieces.measure(call) || plan.run()) return call.status();
    if (!ChartLayout(pieces, plan, grid, call).run()) return call.stopped();
    if (ChartPacking(pieces, grid, call).run(*this)) return call.status();
    chart_count = grid.chart_count;
    chart.swap(grid.chart);
    return HMF_OK;
}

} // namespace hmf
