// Bytes choose a surface, a sequence of calls, and for each the allocation that fails or the call of the progress
// function that cancels.  A call that fails gives nothing and leaves the memory as it was; made again without a
// fault it succeeds, with the same bits as if nothing had happened.
#include <cstring>

#include "random_plate.hpp"

namespace {

using namespace fuzz;

// Allocations and calls of the progress function, counted; one of each may fail.
struct Host {
    uint64_t used = 0, allocations = 0, fail = 0, ticks = 0, stop = 0;
    int32_t answer = HMF_PROGRESS_CANCEL;
    bool was_hit = false;

    static void* take(void* user, size_t size) {
        Host& host = *static_cast<Host*>(user);
        if (++host.allocations == host.fail) {
            host.was_hit = true;
            return nullptr;
        }
        void* const block = std::malloc(size ? size : 1);
        if (!block) return nullptr;
        std::memset(block, 0xa5, size);
        host.used += size;
        return block;
    }
    static void give(void* user, void* block, size_t size) {
        Host& host = *static_cast<Host*>(user);
        FUZZ_ASSERT(block && host.used >= size);
        host.used -= size;
        std::free(block);
    }
    static int32_t progress(void* user, double) {
        Host& host = *static_cast<Host*>(user);
        if (++host.ticks != host.stop) return HMF_PROGRESS_CONTINUE;
        host.was_hit = true;
        return host.answer;
    }
};

class Session {
public:
    explicit Session(Bytes& bytes) : bytes_(bytes) {
        control_ = sized<hmf_control>();
        control_.progress = Host::progress;
        control_.progress_user = &host_;
    }

    // call(control, out, error), with a fault and, if that was hit, once more without.  The foliation of a solve that
    // was cancelled is a result.
    template <class T, class Call>
    Owned<T> make(Call&& call) {
        const uint64_t before = host_.used;
        const uint32_t far = bytes_.byte(), near = bytes_.byte();
        host_.allocations = host_.ticks = 0;
        host_.fail = host_.stop = 0;
        host_.was_hit = false;
        if (far % 3 == 0) host_.fail = 1 + near + (far / 3 % 4) * 256;
        if (far % 3 == 1) host_.stop = 1 + near + (far / 3 % 4) * 256;
        host_.answer = far >= 128 ? HMF_PROGRESS_FINISH : HMF_PROGRESS_CANCEL;
        T* made = reinterpret_cast<T*>(&host_); // must be overwritten
        hmf_error error{};
        hmf_status status = call(&control_, &made, &error);
        const bool ended_early = status == HMF_CANCELLED && made;
        if (host_.was_hit && !ended_early && status != HMF_OK) {
            FUZZ_ASSERT(status == (host_.fail ? HMF_ERROR_MEMORY : HMF_CANCELLED));
            FUZZ_ASSERT(error.status == status && std::strlen(error.message) > 10);
            // A foliation keeps the flat surface that was made before the fault, once.
            FUZZ_ASSERT(!made && (host_.used == before || (may_keep_ && host_.used > before)));
            may_keep_ = may_keep_ && host_.used == before;
            host_.fail = host_.stop = 0;
            made = reinterpret_cast<T*>(&host_);
            error = hmf_error{};
            status = call(&control_, &made, &error);
            host_.was_hit = false;
        }
        FUZZ_ASSERT(status / 100 != 2 && (status != HMF_CANCELLED || ended_early));
        FUZZ_ASSERT((made != nullptr) == (status < HMF_ERROR_NULL));
        host_.fail = host_.stop = 0;
        return Owned<T>(made);
    }

    void run() {
        const Plate plate(bytes_);
        hmf_hierarchy_options build = sized<hmf_hierarchy_options>();
        build.allocate = Host::take;
        build.release = Host::give;
        build.allocator_user = &host_;
        build.coarsest = 20 + bytes_.byte();
        {
            const auto h = make<hmf_hierarchy>([&](auto c, auto out, auto e) {
                return hmf_hierarchy_create(plate.positions.data(), plate.vertex_count(), plate.triangles.data(),
                                            plate.triangle_count(), &build, c, out, e);
            });
            FUZZ_ASSERT(h);
            FUZZ_ASSERT(host_.used == hmf_hierarchy_describe(h.get())->memory_bytes);
            calls(h.get());
        }
        FUZZ_ASSERT(host_.used == 0);
    }

private:
    void calls(const hmf_hierarchy* h) {
        const int32_t kind = HMF_LOOPS_CUT + static_cast<int32_t>(bytes_.below(4));
        const auto loops =
            make<hmf_loop_set>([&](auto c, auto out, auto e) { return hmf_loops(h, 0, kind, c, out, e); });
        Owned<hmf_foliation> f = make<hmf_foliation>(
            [&](auto c, auto out, auto e) { return hmf_solve(h, loops.get(), nullptr, c, out, e); });
        if (!f) return;
        may_keep_ = true;
        const std::vector<double> expected = values(f.get());
        const bool whole = !host_.was_hit; // not told to finish early
        for (uint32_t n = 1 + bytes_.below(6); n > 0; --n) {
            switch (bytes_.below(8)) {
            case 0:
                make<hmf_lines>([&](auto c, auto out, auto e) { return hmf_trace(f.get(), nullptr, c, out, e); });
                break;
            case 1:
                make<hmf_parameterization>(
                    [&](auto c, auto out, auto e) { return hmf_parameterize(f.get(), nullptr, c, out, e); });
                break;
            case 2:
                make<hmf_quad_mesh>([&](auto c, auto out, auto e) { return hmf_quads(f.get(), nullptr, c, out, e); });
                break;
            case 3:
                make<hmf_cylinder_set>(
                    [&](auto c, auto out, auto e) { return hmf_cylinders(f.get(), loops.get(), c, out, e); });
                break;
            case 4: {
                hmf_trace_options options = sized<hmf_trace_options>();
                options.leaves = HMF_LEAVES_CONJUGATE;
                options.critical = 1;
                make<hmf_lines>([&](auto c, auto out, auto e) { return hmf_trace(f.get(), &options, c, out, e); });
                break;
            }
            case 5:
                make<hmf_singularity_set>(
                    [&](auto c, auto out, auto e) { return hmf_singularities(f.get(), c, out, e); });
                break;
            case 6: {
                const std::vector<double> given = values(f.get());
                const auto again = make<hmf_foliation>([&](auto c, auto out, auto e) {
                    return hmf_foliation_from_values(h, 0, given.data(), given.size(), c, out, e);
                });
                FUZZ_ASSERT(!again || values(again.get()) == given);
                break;
            }
            default: { // the same solve: the same bits, whatever failed before
                auto again = make<hmf_foliation>(
                    [&](auto c, auto out, auto e) { return hmf_solve(h, loops.get(), nullptr, c, out, e); });
                FUZZ_ASSERT(again);
                if (whole && !host_.was_hit) FUZZ_ASSERT(values(again.get()) == expected);
            }
            }
        }
    }

    static std::vector<double> values(const hmf_foliation* f) {
        size_t count = 0;
        const double* const v = hmf_foliation_values(f, &count);
        return std::vector<double>(v, v + count);
    }

    Bytes& bytes_;
    Host host_;
    hmf_control control_;
    bool may_keep_ = false;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    Bytes bytes(data, size);
    Session(bytes).run();
    return 0;
}
