// A surface with boundary, marked vertices, and arcs from boundary to boundary or
// loops of the library: the whole solve, and the result through all levels down and
// up, which reverses the flips and splits of the double.  No pole and exact triangle
// inequalities throughout, the index sum of the double, its class; quads whose
// boundary is that of the surface.  Disks that carry nothing are refused with a sentence.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "owned.hpp"
#include "random_sheet.hpp"

namespace {

using namespace fuzz;

class Run {
public:
    explicit Run(Bytes& bytes) : bytes_(bytes), sheet_(bytes) {}

    void run() {
        read_sides();
        mark();
        if (!build()) return;
        const bool has_arcs = bytes_.byte() % 4 != 0;
        if (has_arcs) find_arcs();
        hmf_loop_set arcs = sized<hmf_loop_set>();
        arcs.element_kind = HMF_PATH_VERTICES;
        arcs.count = is_arc_.size();
        arcs.offsets = offsets_.data();
        arcs.elements = elements_.data();
        arcs.weights = weights_.data();
        arcs.arcs = is_arc_.data();
        Owned<hmf_loop_set> made;
        const hmf_loop_set* loops = &arcs;
        if (is_arc_.empty()) {
            hmf_loop_set* raw = nullptr;
            const int32_t kind = bytes_.byte() % 2 ? HMF_LOOPS_PANTS : HMF_LOOPS_CUT;
            FUZZ_ASSERT(hmf_loops(hierarchy_.get(), 0, kind, nullptr, &raw, nullptr) == HMF_OK);
            made.reset(loops = raw);
        }
        hmf_foliation* raw = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_solve(hierarchy_.get(), loops, nullptr, nullptr, &raw, &error);
        const Owned<hmf_foliation> solved(raw);
        if (!solved) { // arcs that bound a disk, are parallel, or run side by side through one vertex
            tells(status, error);
            FUZZ_ASSERT(loops == &arcs && status >= HMF_ERROR_LOOP_NOT_SIMPLE && status <= HMF_ERROR_LOOP_PARALLEL);
            return;
        }
        const hmf_report& report = *hmf_foliation_report(raw);
        const int64_t sum =
            8 - 8 * static_cast<int64_t>(sheet_.genus) - 4 * static_cast<int64_t>(sheet_.boundaries) - marks_of_double_;
        FUZZ_ASSERT(report.poles == 0 && report.bad_flips_left == 0 && report.index_sum == sum);
        FUZZ_ASSERT(report.class_state != HMF_CLASS_LOST && (status != HMF_OK || report.converged));
        expect_no_pole(raw);
        expect_closed(raw);
        through_levels(raw);
        expect_quads(raw);
    }

private:
    using Side = std::pair<uint32_t, uint32_t>;

    static void tells(hmf_status status, const hmf_error& error) {
        FUZZ_ASSERT(error.status == status && std::strlen(error.message) > 10);
    }

    void read_sides() {
        for (size_t i = 0; i < sheet_.triangles.size(); ++i)
            sides_.insert({{sheet_.triangles[i], sheet_.triangles[i - i % 3 + (i + 1) % 3]}, 0});
        on_boundary_.assign(sheet_.vertex_count(), 0);
        neighbors_.resize(sheet_.vertex_count());
        for (const auto& side : sides_) {
            const Side s = side.first;
            neighbors_[s.first].push_back(s.second);
            if (sides_.count({s.second, s.first})) continue;
            neighbors_[s.second].push_back(s.first);
            on_boundary_[s.first] = on_boundary_[s.second] = 1;
        }
        for (uint32_t v = 0; v < sheet_.vertex_count(); ++v)
            if (on_boundary_[v]) boundary_.push_back(v);
    }

    void mark() {
        for (uint32_t more = bytes_.byte() % 8; more > 0; --more) {
            const uint32_t v = bytes_.wide_below(static_cast<uint32_t>(sheet_.vertex_count()));
            if (std::count(marks_.begin(), marks_.end(), v)) continue;
            marks_.push_back(v);
            marks_of_double_ += on_boundary_[v] ? 1 : 2;
        }
    }

    bool build() {
        hmf_hierarchy_options options = sized<hmf_hierarchy_options>();
        options.marked_vertices = marks_.data();
        options.marked_count = marks_.size();
        options.coarsest = 4 + bytes_.below(60);
        options.ratio = 0.3 + bytes_.below(5) / 10.0;
        hmf_hierarchy* raw = nullptr;
        hmf_error error{};
        const hmf_status status =
            hmf_hierarchy_create(sheet_.positions.data(), sheet_.vertex_count(), sheet_.triangles.data(),
                                 sheet_.triangle_count(), &options, nullptr, &raw, &error);
        hierarchy_.reset(raw);
        const bool carries = sheet_.genus > 0 || sheet_.boundaries > 1 || marks_of_double_ >= 4;
        if (!carries) {
            FUZZ_ASSERT(status == HMF_ERROR_MESH_GENUS);
            tells(status, error);
            return false;
        }
        FUZZ_ASSERT(status == HMF_OK);
        FUZZ_ASSERT(hmf_hierarchy_describe(raw)->genus == sheet_.genus
                    && hmf_hierarchy_describe(raw)->boundary_count == sheet_.boundaries);
        return true;
    }

    // Shortest ways inside from one vertex of the boundary to another; mostly beside those before.
    void find_arcs() {
        std::vector<uint8_t> taken(sheet_.vertex_count(), 0);
        offsets_.push_back(0);
        for (uint32_t tries = 1 + bytes_.below(6); tries > 0; --tries) {
            const uint32_t from = boundary_[bytes_.wide_below(static_cast<uint32_t>(boundary_.size()))];
            const uint32_t to = boundary_[bytes_.wide_below(static_cast<uint32_t>(boundary_.size()))];
            const bool over_others = bytes_.rarely();
            std::vector<uint32_t> before(sheet_.vertex_count(), HMF_NONE), queue{to};
            before[to] = to;
            for (size_t i = 0; i < queue.size() && before[from] == HMF_NONE; ++i)
                for (const uint32_t w : neighbors_[queue[i]]) {
                    const bool blocked = w != from && (on_boundary_[w] || (taken[w] && !over_others));
                    if (blocked || before[w] != HMF_NONE) continue;
                    if (w == from && i == 0) continue; // not along an edge
                    before[w] = queue[i];
                    queue.push_back(w);
                }
            if (from == to || before[from] == HMF_NONE || taken[from] || taken[to]) continue;
            for (uint32_t v = from;; v = before[v]) {
                elements_.push_back(v);
                taken[v] = 1;
                if (v == to) break;
            }
            offsets_.push_back(elements_.size());
            weights_.push_back(0.25 * (1 + bytes_.below(40)));
            is_arc_.push_back(1);
        }
    }

    void expect_closed(const hmf_foliation* f) const {
        const size_t level = hmf_foliation_level(f);
        hmf_level_mesh* raw = nullptr;
        FUZZ_ASSERT(hmf_level(hierarchy_.get(), level, nullptr, &raw, nullptr) == HMF_OK);
        const Owned<hmf_level_mesh> mesh(raw);
        const double* const values = hmf_foliation_values(f, nullptr);
        const uint32_t* const side = mesh->triangle_edges;
        for (size_t i = 0; i < 3 * mesh->triangle_count; ++i) {
            const size_t t = i - i % 3;
            FUZZ_ASSERT(values[side[i]] >= 0
                        && values[side[i]] <= values[side[t + (i + 1) % 3]] + values[side[t + (i + 2) % 3]]);
        }
    }

    static void expect_no_pole(const hmf_foliation* f) {
        hmf_singularity_set* raw = nullptr;
        FUZZ_ASSERT(hmf_singularities(f, nullptr, &raw, nullptr) == HMF_OK);
        const Owned<hmf_singularity_set> set(raw);
        for (size_t i = 0; i < raw->count; ++i) FUZZ_ASSERT(raw->list[i].index <= 0);
    }

    // Down to the coarsest level one by one, and up again.
    void through_levels(const hmf_foliation* from) const {
        const size_t levels = hmf_hierarchy_describe(hierarchy_.get())->level_count;
        Owned<hmf_foliation> held;
        for (size_t step = 1; step < 2 * levels - 1; ++step) {
            const size_t level = step < levels ? step : 2 * levels - 2 - step;
            hmf_foliation* raw = nullptr;
            FUZZ_ASSERT(hmf_interpolate(from, level, nullptr, &raw, nullptr) == HMF_OK);
            held.reset(from = raw);
            expect_no_pole(raw);
            expect_closed(raw);
        }
    }

    // An oriented manifold like the surface; or some part of it is crossed by no leaf.
    void expect_quads(const hmf_foliation* f) {
        hmf_quad_options options = sized<hmf_quad_options>();
        options.count = 50 + bytes_.byte();
        options.merge = bytes_.byte() % 2;
        hmf_quad_mesh* raw = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_quads(f, &options, nullptr, &raw, &error);
        const Owned<hmf_quad_mesh> quads(raw);
        if (!quads) {
            tells(status, error);
            FUZZ_ASSERT(status == HMF_ERROR_QUADS || status == HMF_ERROR_UNSUPPORTED);
            return;
        }
        std::map<Side, int> sides;
        for (size_t i = 0; i < 4 * quads->quad_count; ++i)
            ++sides[{quads->quads[i], quads->quads[i - i % 4 + (i + 1) % 4]}];
        int64_t edges = 0;
        for (const auto& side : sides) {
            FUZZ_ASSERT(side.second == 1);
            const Side s = side.first;
            edges += s.first < s.second || !sides.count({s.second, s.first});
        }
        FUZZ_ASSERT(static_cast<int64_t>(quads->vertex_count) - edges + static_cast<int64_t>(quads->quad_count)
                    == 2 - 2 * static_cast<int64_t>(sheet_.genus) - static_cast<int64_t>(sheet_.boundaries));
    }

    Bytes& bytes_;
    Sheet sheet_;
    std::map<Side, int> sides_;
    std::vector<uint8_t> on_boundary_;
    std::vector<std::vector<uint32_t>> neighbors_;
    std::vector<uint32_t> boundary_, marks_;
    int64_t marks_of_double_ = 0;
    Owned<hmf_hierarchy> hierarchy_;
    std::vector<uint64_t> offsets_;
    std::vector<uint32_t> elements_;
    std::vector<double> weights_;
    std::vector<uint8_t> is_arc_;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Bytes bytes(data, size);
    Run(bytes).run();
    return 0;
}
