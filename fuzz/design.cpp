// The even design of a closed surface, of one with boundary, of a sphere or a disk, in any unit: its marked vertices
// and loops are what hmf_hierarchy_create and hmf_solve take, its weights are whole numbers, its marks contain those of
// the caller.  On the foliation of the design: the conformal scale, relaxed quads of any wish, charts.  No pole, quads
// are an oriented manifold, charts lie in the square, everything is finite.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <utility>

#include "interface/surfaces.hpp"
#include "owned.hpp"
#include "random_plate.hpp"
#include "random_sheet.hpp"

namespace {

using namespace fuzz;

class Run {
public:
    explicit Run(Bytes& bytes) : bytes_(bytes) { choose_surface(); }

    void run() {
        for (uint32_t i = bytes_.rarely() ? 1 + bytes_.below(6) : 0; i > 0; --i)
            marks_.push_back(bytes_.wide_below(static_cast<uint32_t>(vertices())));
        std::sort(marks_.begin(), marks_.end());
        marks_.erase(std::unique(marks_.begin(), marks_.end()), marks_.end());
        hmf_hierarchy_options build = sized<hmf_hierarchy_options>();
        build.marked_vertices = marks_.data();
        build.marked_count = marks_.size();
        if (!design(build)) return;
        for (const uint32_t mark : marks_)
            FUZZ_ASSERT(std::count(design_->marked_vertices, design_->marked_vertices + design_->marked_count, mark));
        for (size_t c = 0; c < design_->loops->count; ++c) {
            const double weight = design_->loops->weights[c];
            FUZZ_ASSERT(weight >= 1 && weight == std::floor(weight));
        }
        FUZZ_ASSERT(std::isfinite(design_->unevenness) && design_->unevenness >= 0);
        build.marked_vertices = design_->marked_vertices;
        build.marked_count = static_cast<size_t>(design_->marked_count);
        solve(build);
        expect_scale();
        expect_quads();
        if (bytes_.byte() % 8 == 7) expect_charts(); // packing takes ten times as long as all the rest
    }

private:
    size_t vertices() const { return surface_.positions.size() / 3; }
    size_t triangles() const { return surface_.triangles.size() / 3; }

    void choose_surface() {
        const uint32_t kind = bytes_.below(4);
        if (kind == 0) surface_ = sphere(bytes_);
        else if (kind == 1) take(Sheet(bytes_));
        else take(Plate(bytes_));
        exponent_ = bytes_.rarely() ? 8 * (static_cast<int>(bytes_.byte()) - 128) : 0;
        exponent_ = std::min(std::max(exponent_, -900), 900);
        for (double& x : surface_.positions) x = std::ldexp(x, exponent_);
    }
    template <class From>
    void take(const From& from) {
        surface_ = {from.positions, from.triangles};
    }

    // Refused with a sentence: a disk or sphere with too few vertices for marks, or no loops.
    bool design(const hmf_hierarchy_options& build) {
        hmf_design_options options = sized<hmf_design_options>();
        options.build = &build;
        options.no_poles = bytes_.byte() % 4 == 3;
        options.solve_limit = 1 + bytes_.below(6);
        hmf_design* raw = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_even_design(surface_.positions.data(), vertices(), surface_.triangles.data(),
                                                  triangles(), &options, nullptr, &raw, &error);
        design_.reset(raw);
        expect_told(status, error, {HMF_ERROR_UNSUPPORTED, HMF_ERROR_MESH_GENUS});
        FUZZ_ASSERT((raw != nullptr) == (status == HMF_OK));
        return raw != nullptr;
    }

    void solve(const hmf_hierarchy_options& build) {
        hmf_hierarchy* h = nullptr;
        hmf_foliation* f = nullptr;
        FUZZ_ASSERT(hmf_hierarchy_create(surface_.positions.data(), vertices(), surface_.triangles.data(), triangles(),
                                         &build, nullptr, &h, nullptr)
                    == HMF_OK);
        hierarchy_.reset(h);
        FUZZ_ASSERT(hmf_solve(h, design_->loops, nullptr, nullptr, &f, nullptr) < HMF_CANCELLED + 2 && f);
        foliation_.reset(f);
        FUZZ_ASSERT(hmf_foliation_report(f)->poles == 0 && hmf_foliation_memory(f) > 0);
    }

    void expect_scale() {
        hmf_scale* raw = nullptr;
        FUZZ_ASSERT(hmf_conformal_scale(foliation_.get(), nullptr, &raw, nullptr) == HMF_OK);
        const Owned<hmf_scale> made(raw);
        FUZZ_ASSERT(std::isfinite(made->unevenness) && made->unevenness >= 0 && made->triangle_count == triangles());
        const double* const end = made->log_scale + made->triangle_count;
        const double largest = *std::max_element(made->log_scale, end);
        for (const double* s = made->log_scale; s != end; ++s) FUZZ_ASSERT(std::isfinite(*s) && *s >= largest - 16.2);
    }

    void expect_quads() {
        hmf_quad_options options = sized<hmf_quad_options>();
        if (bytes_.byte() % 2) options.count = 1 + bytes_.wide_below(600);
        else options.edge_length = std::ldexp(0.2 + bytes_.below(64) / 16.0, exponent_);
        options.merge = bytes_.byte() % 2;
        options.keep_poles = bytes_.byte() % 2;
        options.relax = bytes_.below(12);
        hmf_quad_mesh* raw = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_quads(foliation_.get(), &options, nullptr, &raw, &error);
        const Owned<hmf_quad_mesh> quads(raw);
        expect_told(status, error, {HMF_ERROR_QUADS, HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS});
        if (!quads) return;
        for (size_t i = 0; i < 3 * quads->vertex_count; ++i) FUZZ_ASSERT(std::isfinite(quads->positions[i]));
        std::vector<std::pair<uint32_t, uint32_t>> sides;
        for (size_t i = 0; i < 4 * quads->quad_count; ++i)
            sides.push_back({quads->quads[i], quads->quads[i - i % 4 + (i + 1) % 4]});
        std::sort(sides.begin(), sides.end());
        const bool closed = hmf_hierarchy_describe(hierarchy_.get())->boundary_count == 0;
        for (size_t i = 0; i < sides.size(); ++i) {
            FUZZ_ASSERT(sides[i].first < quads->vertex_count && (i == 0 || sides[i] != sides[i - 1]));
            const auto other = std::make_pair(sides[i].second, sides[i].first);
            FUZZ_ASSERT(!closed || std::binary_search(sides.begin(), sides.end(), other));
        }
    }

    void expect_charts() {
        hmf_atlas_options options = sized<hmf_atlas_options>();
        options.margin = bytes_.below(17) / 256.0;
        hmf_chart_set* raw = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_atlas(foliation_.get(), &options, nullptr, &raw, &error);
        const Owned<hmf_chart_set> charts(raw);
        expect_told(status, error, {HMF_ERROR_UNSUPPORTED, HMF_ERROR_VALUE_NOT_HARMONIC});
        for (size_t i = 0; charts && i < 6 * charts->triangle_count; ++i)
            FUZZ_ASSERT(charts->corner_uv[i] >= 0 && charts->corner_uv[i] <= 1);
    }

    static void expect_told(hmf_status status, const hmf_error& error, std::initializer_list<hmf_status> refusals) {
        if (status == HMF_OK) return;
        if (std::find(refusals.begin(), refusals.end(), status) == refusals.end())
            std::fprintf(stderr, "%d: %s\n", static_cast<int>(status), error.message);
        FUZZ_ASSERT(std::find(refusals.begin(), refusals.end(), status) != refusals.end());
        FUZZ_ASSERT(error.status == status && std::strlen(error.message) > 10);
    }

    Bytes& bytes_;
    Surface surface_;
    int exponent_ = 0;
    std::vector<uint32_t> marks_;
    Owned<hmf_design> design_;
    Owned<hmf_hierarchy> hierarchy_;
    Owned<hmf_foliation> foliation_;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Bytes bytes(data, size);
    Run(bytes).run();
    return 0;
}
