// What each stage gains by threads, and what bounds that.
//
//     bench_threads [-r N] [-t THREADS] MESH ...      medians of N repetitions (3) with 2 threads
//
// The work is cut into blocks by the problem alone, so its two parts can be
// measured in one thread: a host that runs the tasks itself, one after the
// other, knows how much time is spent in them, and what is outside is a chain
// that no number of threads makes shorter.  With p threads a stage takes at
// least  chain + blocks / p.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "../include/hmf/pool.h"
#include "../include/hmf/applications.h"
#include "each_mesh.hpp"

namespace {

double now(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> x) {
    std::sort(x.begin(), x.end());
    return x[x.size() / 2];
}

// A host with one thread that keeps the time of its tasks.
struct OneAfterTheOther {
    double seconds = 0;
    uint64_t calls = 0;
    static void run(void* user, hmf_task_fn task, void* context, uint32_t count) {
        OneAfterTheOther& self = *static_cast<OneAfterTheOther*>(user);
        const double start = now(CLOCK_THREAD_CPUTIME_ID);
        for (uint32_t i = 0; i < count; ++i) task(context, i);
        self.seconds += now(CLOCK_THREAD_CPUTIME_ID) - start;
        ++self.calls;
    }
};

struct Row {
    std::string name;
    std::vector<double> work, in_blocks, one, many; // processor seconds; wall time with one thread and with many
    uint64_t calls = 0;
};

using Call = std::function<hmf_status(const hmf_control*, hmf_error*)>;

class Table {
public:
    explicit Table(hmf_pool* pool) : pool_(pool) {}

    // Three times: tasks one after the other, one thread, the pool.  undo: frees what the first two have made.
    void measure(const std::string& name, const Call& call, const std::function<void()>& undo) {
        auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.name == name; });
        if (row == rows_.end()) row = rows_.insert(rows_.end(), Row{name, {}, {}, {}, {}});
        OneAfterTheOther host;
        hmf_control control{};
        control.struct_size = sizeof control;
        control.workers = 2;
        control.parallel_for = OneAfterTheOther::run;
        control.parallel_user = &host;
        row->work.push_back(seconds(CLOCK_THREAD_CPUTIME_ID, name, call, &control));
        row->in_blocks.push_back(host.seconds);
        row->calls = host.calls;
        undo();
        row->one.push_back(seconds(CLOCK_MONOTONIC, name, call, nullptr));
        undo();
        control.workers = hmf_pool_threads(pool_);
        control.parallel_for = hmf_pool_run;
        control.parallel_user = pool_;
        row->many.push_back(seconds(CLOCK_MONOTONIC, name, call, &control));
    }

    void print(const std::string& mesh) const {
        std::printf(
            "\n%s\n\n| stage | work s | in blocks | calls | at most with 2 | with 16 | wall 1 | wall %u | ratio |\n"
            "|---|--:|--:|--:|--:|--:|--:|--:|--:|\n",
            mesh.c_str(), static_cast<unsigned>(hmf_pool_threads(pool_)));
        Row job{"job (build, loops, solve)", {0}, {0}, {0}, {0}};
        for (const Row& r : rows_) {
            print(r);
            if (&r - rows_.data() >= 3) continue;
            job.work[0] += median(r.work);
            job.in_blocks[0] += median(r.in_blocks);
            job.one[0] += median(r.one);
            job.many[0] += median(r.many);
            job.calls += r.calls;
        }
        print(job);
    }

private:
    static double seconds(clockid_t clock, const std::string& name, const Call& call, const hmf_control* control) {
        hmf_error error{};
        const double start = now(clock);
        if (call(control, &error) != HMF_OK) {
            std::fprintf(stderr, "%s: %s\n", name.c_str(), error.message);
            std::exit(1);
        }
        return now(clock) - start;
    }

    static void print(const Row& r) {
        const double work = median(r.work), blocks = median(r.in_blocks), chain = work - blocks;
        const auto bound = [&](double threads) { return work / (chain + blocks / threads); };
        std::printf("| %s | %.4f | %.0f %% | %llu | %.2f | %.2f | %.4f | %.4f | %.2f |\n", r.name.c_str(), work,
                    100 * blocks / work, static_cast<unsigned long long>(r.calls), bound(2), bound(16), median(r.one),
                    median(r.many), median(r.one) / median(r.many));
    }

    hmf_pool* pool_;
    std::vector<Row> rows_;
};

void run(const readers::TriangleMesh& mesh, Table& table) {
    hmf_hierarchy* h = nullptr;
    hmf_loop_set* loops = nullptr;
    hmf_foliation* f = nullptr;
    table.measure(
        "build",
        [&](const hmf_control* c, hmf_error* e) {
            return hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                        mesh.triangle_count(), nullptr, c, &h, e);
        },
        [&] { hmf_hierarchy_destroy(h); });
    table.measure(
        "loops",
        [&](const hmf_control* c, hmf_error* e) {
            return hmf_loops(h, hmf_hierarchy_describe(h)->level_count - 1, HMF_LOOPS_CUT, c, &loops, e);
        },
        [&] { hmf_free(loops); });
    table.measure(
        "solve", [&](const hmf_control* c, hmf_error* e) { return hmf_solve(h, loops, nullptr, c, &f, e); },
        [&] { hmf_foliation_destroy(f); });
    hmf_trace_options options{};
    options.struct_size = sizeof options;
    options.critical = 1;
    options.spacing = 0.05;
    hmf_lines* lines = nullptr;
    table.measure(
        "trace", [&](const hmf_control* c, hmf_error* e) { return hmf_trace(f, &options, c, &lines, e); },
        [&] { hmf_free(lines); });
    hmf_free(lines);
    hmf_quad_mesh* quads = nullptr;
    table.measure(
        "quads", [&](const hmf_control* c, hmf_error* e) { return hmf_quads(f, nullptr, c, &quads, e); },
        [&] { hmf_free(quads); });
    hmf_free(quads);
    // The flat surface stays with the foliation: each time another one.
    hmf_parameterization* flat = nullptr;
    table.measure(
        "parameterize", [&](const hmf_control* c, hmf_error* e) { return hmf_parameterize(f, nullptr, c, &flat, e); },
        [&] {
            hmf_free(flat);
            hmf_foliation_destroy(f);
            if (hmf_solve(h, loops, nullptr, nullptr, &f, nullptr) != HMF_OK) std::exit(1);
        });
    hmf_free(flat);
    hmf_foliation_destroy(f);
    hmf_free(loops);
    hmf_hierarchy_destroy(h);
}

} // namespace

int main(int argc, char** argv) {
    int repetitions = 3;
    uint32_t threads = 2;
    std::vector<std::string> paths;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "-r") && i + 1 < argc) repetitions = std::max(1, std::atoi(argv[++i]));
        else if (!std::strcmp(argv[i], "-t") && i + 1 < argc) threads = static_cast<uint32_t>(std::atoi(argv[++i]));
        else paths.push_back(argv[i]);
    }
    if (paths.empty()) {
        std::fprintf(stderr, "usage: bench_threads [-r N] [-t THREADS] MESH ...\n");
        return 2;
    }
    hmf_pool* const pool = hmf_pool_create(threads);
    const bool read = for_each_mesh(paths, [&](const readers::TriangleMesh& mesh, const std::string& name) {
        Table table(pool);
        for (int r = 0; r < repetitions; ++r) run(mesh, table);
        table.print(name);
    });
    hmf_pool_destroy(pool);
    return read ? 0 : 1;
}
