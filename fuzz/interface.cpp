// The C interface under arbitrary input: small arrays of vertices, triangles,
// loops, values and options.  Whatever they are, there is no crash, the status
// is one that the header lists, a failing call gives nothing, a result is a
// foliation, the memory limit holds and all memory comes back.
//
// Half of the inputs begin with a chain of grid tori, so that the later stages
// are reached; a few bytes may then spoil it.
//
//     bytes -> surface, options -> components, hierarchy -> loops -> initial foliation, solve -> calls on it
#include <numeric>

#include "interface/calls.hpp"
#include "interface/components.hpp"

namespace {

using namespace fuzz;

class Session {
public:
    Session(const uint8_t* data, size_t size) : bytes_(data, size) {
        meter_now = &meter_;
        charts_now = std::accumulate(data, data + size, 0u) % 8 == 0;
        build_.allocate = Meter::take;
        build_.release = Meter::give;
        build_.allocator_user = &meter_;
    }

    // The status of the last call.
    hmf_status run() {
        choose_options();
        choose_surface();
        marks_now = build_.struct_size > offsetof(hmf_hierarchy_options, marked_count) ? marks_.size() : 0;
        hmf_status status = HMF_OK;
        if (hmf_hierarchy* const h = build(status)) status = use(h);
        FUZZ_ASSERT(meter_.used == 0);
        return status;
    }

private:
    // What is built: bytes, tori; also with marked vertices, mollified, larger, with a stride.
    enum Sort { plain = 3, marked, ball, mollified, large, strided };

    size_t vertices() const { return vertices_; }
    size_t triangles() const { return surface_.triangles.size() / 3; }
    uint32_t wide() {
        const uint32_t first = bytes_.byte();
        return 7 * first + bytes_.byte();
    }

    void choose_options() {
        build_.coarsest = 20 + bytes_.byte();
        if (bytes_.rarely()) {
            // Of an older header; not one that ends between the hooks and their user.
            uint32_t end = bytes_.below(sizeof build_ + 1);
            if (end % 16 != 1) end -= end % 8; // else a size that no structure has
            if (end > offsetof(hmf_hierarchy_options, allocate)
                && end < offsetof(hmf_hierarchy_options, position_stride))
                end = offsetof(hmf_hierarchy_options, allocate);
            build_.struct_size = end;
        }
        if (bytes_.rarely()) build_.ratio = coordinate(bytes_);
        if (bytes_.rarely()) build_.collapse = static_cast<int32_t>(bytes_.below(6)) - 1;
        if (bytes_.rarely()) {
            build_.memory_limit = 1 + bytes_.byte() * uint64_t{2048};
            if (build_.struct_size > offsetof(hmf_hierarchy_options, memory_limit)) meter_.limit = build_.memory_limit;
            memory_is_short_ = true;
        }
        if (bytes_.rarely()) {
            meter_.fail = 1 + bytes_.byte();
            memory_is_short_ = true;
        }
    }

    void choose_surface() {
        const uint8_t kind = bytes_.byte();
        const int sort = kind % 2 ? plain : std::max<int>(plain, kind / 2 % 9);
        surface_ = kind % 2 ? anything(bytes_) : sort == ball ? sphere(bytes_) : chain_of_tori(bytes_, sort >= large);
        vertices_ = surface_.positions.size() / 3;
        if (sort == marked || sort == ball) choose_marks(sort == ball);
        else if (sort == mollified) flatten();
        else if (sort == strided) spread();
    }

    // Any vertices, or those that are suggested.
    void choose_marks(bool on_sphere) {
        for (uint32_t i = bytes_.below(9); i > 0; --i) marks_.push_back(wide() % static_cast<uint32_t>(vertices()));
        if (!bytes_.rarely()) {
            std::sort(marks_.begin(), marks_.end());
            marks_.erase(std::unique(marks_.begin(), marks_.end()), marks_.end());
        }
        hmf_mark_set* proposed = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_suggest_marks(surface_.positions.data(), vertices(), surface_.triangles.data(),
                                                    triangles(), &build_, nullptr, &proposed, &error);
        const Owned<hmf_mark_set> set(proposed);
        expect_status(status, error, {1, 2, 3});
        FUZZ_ASSERT((proposed != nullptr) == (status == HMF_OK));
        if (set) FUZZ_ASSERT(set->marked_count <= 24 && (set->marked_count >= 4 || !on_sphere));
        for (size_t i = 0; set && i < set->marked_count; ++i) FUZZ_ASSERT(set->marked_vertices[i] < vertices());
        if (set && bytes_.byte() % 2 == 0)
            marks_.assign(set->marked_vertices, set->marked_vertices + set->marked_count);
        build_.marked_vertices = marks_.data();
        build_.marked_count = marks_.size();
    }

    // A vertex on top of a neighbor, or on the line between two.
    void flatten() {
        build_.mollify = (1 + bytes_.below(20)) / 1000.0;
        const uint32_t* const corner = &surface_.triangles[wide() % triangles() * 3];
        const double share = bytes_.below(3) / 2.0;
        if (std::max({corner[0], corner[1], corner[2]}) >= vertices()) return;
        double* const p = surface_.positions.data();
        for (size_t c = 0; c < 3; ++c)
            p[3 * corner[0] + c] = share * p[3 * corner[1] + c] + (1 - share) * p[3 * corner[2] + c];
    }

    // Positions with other doubles between them.
    void spread() {
        build_.position_stride = 8 * (3 + bytes_.below(4));
        const size_t doubles = static_cast<size_t>(build_.position_stride / 8);
        std::vector<double> spread(vertices() * doubles - (doubles - 3), NAN);
        for (size_t v = 0; v < vertices(); ++v)
            std::copy_n(&surface_.positions[3 * v], 3, spread.begin() + static_cast<ptrdiff_t>(doubles * v));
        surface_.positions = std::move(spread);
    }

    hmf_hierarchy* build(hmf_status& status) {
        const hmf_status alone = expect_components(surface_, vertices(), build_, memory_is_short_);
        meter_.peak = 0;
        hmf_hierarchy* h = nullptr;
        hmf_error error{};
        status = hmf_hierarchy_create(surface_.positions.data(), vertices(), surface_.triangles.data(), triangles(),
                                      &build_, nullptr, &h, &error);
        if (h && build_.struct_size == sizeof build_)
            FUZZ_ASSERT(hmf_hierarchy_describe(h)->memory_bytes == meter_.used
                        && hmf_hierarchy_memory_estimate(vertices(), triangles(), &build_) >= meter_.peak);
        expect_status(status, error, {1, 2, 3});
        FUZZ_ASSERT((h != nullptr) == (status == HMF_OK));
        FUZZ_ASSERT(memory_is_short_ || status / 100 != 2);
        FUZZ_ASSERT(memory_is_short_ || alone < 0 || alone == status);
        return h;
    }

    // Destroys the hierarchy.
    hmf_status use(hmf_hierarchy* h) {
        const uint64_t held = meter_.held = meter_.used;
        FUZZ_ASSERT((hmf_hierarchy_describe(h)->genus >= 1 || marks_now >= 4)
                    && hmf_hierarchy_describe(h)->level_count >= 1);
        LoopArrays loops;
        any_loops(bytes_, h, loops);
        initialize(h, loops);
        FUZZ_ASSERT(meter_.used == held);
        hmf_foliation* made = nullptr;
        const hmf_status status = solve(h, loops, made);
        // Each of the two may go first.
        const bool hierarchy_first = bytes_.byte() % 2;
        if (bytes_.byte() % 2) any_values(bytes_, h, memory_is_short_);
        if (made) any_calls(bytes_, h, made, loops, memory_is_short_);
        if (hierarchy_first) hmf_hierarchy_destroy(h);
        hmf_foliation_destroy(made);
        FUZZ_ASSERT(meter_.used == (hierarchy_first ? 0 : held));
        if (!hierarchy_first) hmf_hierarchy_destroy(h);
        return status;
    }

    void initialize(const hmf_hierarchy* h, const LoopArrays& loops) {
        hmf_foliation* made = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_foliation_from_loops(h, &loops.set, nullptr, &made, &error);
        const Owned<hmf_foliation> f(made);
        expect_status(status, error, {1, 2, 4});
        FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
        if (f) expect_foliation(h, f.get(), memory_is_short_);
    }

    hmf_status solve(const hmf_hierarchy* h, const LoopArrays& loops, hmf_foliation*& made) {
        Stop stop;
        hmf_solve_options solve = sized<hmf_solve_options>();
        solve.method = static_cast<int32_t>(bytes_.below(4));
        solve.iteration_limit = 1 + bytes_.below(30);
        if (bytes_.rarely())
            (solve.method == HMF_METHOD_NEWTON ? solve.tolerance : solve.energy_tolerance) = coordinate(bytes_);
        if (bytes_.rarely()) solve.stop_level = bytes_.below(4);
        if (bytes_.rarely()) {
            stop.at = 1 + bytes_.byte();
            stop.answer = 1 + static_cast<int32_t>(bytes_.below(2));
        }
        hmf_control control = sized<hmf_control>();
        control.progress = Stop::call;
        control.progress_user = &stop;
        hmf_error error{};
        meter_.begin_call();
        const hmf_status status = bytes_.byte() % 4 ? hmf_solve_cut_system(h, &solve, &control, &made, &error)
                                                    : hmf_solve(h, &loops.set, &solve, &control, &made, &error);
        expect_status(status, error, {0, 1, 2, 4});
        FUZZ_ASSERT(memory_is_short_ || status / 100 != 2);
        FUZZ_ASSERT(status != HMF_CANCELLED || stop.at > 0);
        FUZZ_ASSERT(status == HMF_CANCELLED
                    || (made != nullptr) == (status < HMF_CANCELLED || status == HMF_LIMIT_CLASS));
        if (!made) return status;
        const hmf_report* report = hmf_foliation_report(made);
        FUZZ_ASSERT(report && report->poles == 0 && report->bad_flips_left == 0);
        FUZZ_ASSERT(hmf_foliation_level(made) == solve.stop_level);
        expect_foliation(h, made, memory_is_short_);
        return status;
    }

    Bytes bytes_;
    Meter meter_;
    hmf_hierarchy_options build_ = sized<hmf_hierarchy_options>();
    Surface surface_;
    size_t vertices_ = 0; // positions may have a stride
    std::vector<uint32_t> marks_;
    bool memory_is_short_ = false; // calls may fail for that reason
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const hmf_status status = Session(data, size).run();
    FUZZ_ASSERT(hmf_version() > 0 && std::strlen(hmf_status_string(status)) > 3
                && std::strlen(hmf_status_string(static_cast<hmf_status>(size % 1000))) > 3);
    return 0;
}
