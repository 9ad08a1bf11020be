// What the measuring programs share: clocks, a mesh, results with owners, CHOLMOD, rows of output.
//
// Each program prints one JSON object per line as soon as it is known, so that a run which is stopped
// keeps what it has measured.  bench/report collects the lines.
#pragma once

#include <dlfcn.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#if HMF_HAVE_CHOLMOD
#include <cholmod.h>
#endif

#include "../bindings/readers/mesh_formats.hpp"
#include "../include/hmf/applications.h"
#include "../include/hmf/pool.h"

namespace measure {

// --- Clocks --------------------------------------------------------------------

inline double wall() {
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

// Processor time of the calling thread: on one thread the wall time of an idle machine.
inline double processor() {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Seconds {
    double wall = 0, processor = 0;
};

struct Watch {
    double wall_start = wall(), processor_start = processor();
    Seconds elapsed() const { return {wall() - wall_start, processor() - processor_start}; }
};

// A fixed computation: passes over 32 MB, then a chain of multiplications.  On a quiet machine it takes
// the same wall time each time, and no more wall time than processor time.
inline Seconds reference_computation() {
    static std::vector<uint64_t> block(size_t{1} << 22, 1);
    const Watch watch;
    uint64_t x = 1;
    for (int pass = 0; pass < 2; ++pass)
        for (uint64_t& b : block) x += b += x >> 7;
    for (int i = 0; i < 8000000; ++i) x = x * 6364136223846793005u + 1442695040888963407u;
    block[x % block.size()] = x;
    return watch.elapsed();
}

// --- Output --------------------------------------------------------------------

class Row {
public:
    explicit Row(const char* kind) { text("row", kind); }
    Row& text(const char* key, const std::string& value) {
        std::string plain;
        for (const char c : value) plain += c == '"' || c == '\\' || static_cast<unsigned char>(c) < ' ' ? '\'' : c;
        return raw(key, "\"" + plain + "\"");
    }
    Row& number(const char* key, double value) {
        char digits[40];
        std::snprintf(digits, sizeof digits, "%.9g", value);
        return raw(key, std::isfinite(value) ? digits : "null");
    }
    Row& count(const char* key, uint64_t value) { return raw(key, std::to_string(value)); }
    Row& raw(const char* key, const std::string& value) {
        line_ += (line_.empty() ? "{\"" : ", \"") + std::string(key) + "\": " + value;
        return *this;
    }
    void print() const {
        std::printf("%s}\n", line_.c_str());
        std::fflush(stdout);
    }

private:
    std::string line_;
};

// --- Mesh ----------------------------------------------------------------------

struct Mesh {
    std::string name;
    std::vector<double> position;
    std::vector<uint32_t> triangle;
    size_t vertices() const { return position.size() / 3; }
    size_t triangles() const { return triangle.size() / 3; }
};

// Exits with a row if the file cannot be read.
inline Mesh read_mesh(const std::string& path) {
    Mesh mesh;
    const size_t slash = path.find_last_of('/'), from = slash == std::string::npos ? 0 : slash + 1;
    mesh.name = path.substr(from, path.find_last_of('.') - from);
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    try {
        readers::TriangleMesh data = readers::read_mesh(bytes, readers::Format::obj);
        mesh.position.swap(data.positions);
        mesh.triangle.swap(data.triangles);
    } catch (const readers::MeshError& error) {
        Row("failure").text("mesh", mesh.name).text("what", error.what()).print();
        std::exit(1);
    }
    return mesh;
}

// --- Results of the library ------------------------------------------------------

struct Destroy {
    void operator()(hmf_hierarchy* h) const { hmf_hierarchy_destroy(h); }
    void operator()(hmf_foliation* f) const { hmf_foliation_destroy(f); }
    template <class Result>
    void operator()(Result* result) const {
        hmf_free(result);
    }
};
template <class T>
using Owned = std::unique_ptr<T, Destroy>;

// Memory in use and its peak, by the allocator of the options.
struct Counter {
    size_t used = 0, peak = 0;
    static void* allocate(void* user, size_t size) {
        Counter& c = *static_cast<Counter*>(user);
        void* block = std::malloc(size);
        if (block) c.peak = std::max(c.peak, c.used += size);
        return block;
    }
    static void release(void* user, void* block, size_t size) {
        static_cast<Counter*>(user)->used -= size;
        std::free(block);
    }
};

// A limit on the clock that is measured; the limit of the library is wall time.
struct Deadline {
    double at = 0;
    bool passed = false;
    static int32_t watch(void* user, double) {
        Deadline& d = *static_cast<Deadline*>(user);
        if (processor() > d.at) d.passed = true;
        return d.passed ? HMF_PROGRESS_FINISH : HMF_PROGRESS_CONTINUE;
    }
};

struct Solved {
    hmf_status status = HMF_OK;
    Seconds seconds;
    Owned<hmf_foliation> foliation;
    const hmf_report* report = nullptr; // NULL: no foliation
    bool out_of_time = false;
    std::string message;
};

// limit: processor seconds, 0 = none.
inline Solved solve(const hmf_hierarchy* hierarchy, const hmf_loop_set* loops, const hmf_solve_options& options,
                    double limit = 0, const hmf_control* threads = nullptr) {
    Solved s;
    Deadline deadline;
    deadline.at = processor() + limit;
    hmf_control control;
    hmf_control_init(&control, sizeof control);
    if (threads) control = *threads;
    if (limit > 0) {
        control.progress = Deadline::watch;
        control.progress_user = &deadline;
    }
    hmf_error error = {};
    hmf_foliation* out = nullptr;
    const Watch watch;
    s.status = hmf_solve(hierarchy, loops, &options, &control, &out, &error);
    s.seconds = watch.elapsed();
    s.foliation.reset(out);
    s.report = hmf_foliation_report(out);
    s.out_of_time = deadline.passed;
    if (s.status != HMF_OK) s.message = error.message;
    return s;
}

// Loops of the paper, if the surface has them; otherwise those of the cut system.
inline Owned<hmf_loop_set> choose_loops(const hmf_hierarchy* hierarchy, int32_t kind, std::string& name) {
    hmf_loop_set* loops = nullptr;
    name = kind == HMF_LOOPS_HANDLE ? "handle" : kind == HMF_LOOPS_PANTS ? "pants" : "cut";
    if (hmf_loops(hierarchy, 0, kind, nullptr, &loops, nullptr) != HMF_OK && kind != HMF_LOOPS_CUT) {
        name = "cut";
        hmf_loops(hierarchy, 0, HMF_LOOPS_CUT, nullptr, &loops, nullptr);
    }
    return Owned<hmf_loop_set>(loops);
}

inline const char* class_name(int32_t state) {
    return state == HMF_CLASS_PROVEN ? "proven" : state == HMF_CLASS_LOST ? "lost" : "unknown";
}

// --- CHOLMOD ---------------------------------------------------------------------

// BLAS and OpenMP read their number of threads before main: start again with it.
inline void run_with_threads(int threads, char** arguments) {
    if (std::getenv("HMF_BENCH_THREADS")) return;
    const std::string number = std::to_string(threads);
    for (const char* name : {"HMF_BENCH_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"})
        setenv(name, number.c_str(), 1);
    execv("/proc/self/exe", arguments);
}

#if HMF_HAVE_CHOLMOD
// The library that the products of dense blocks come from: it makes a factor of 1.5.
inline std::string blas() {
    Dl_info info = {};
    void* const product = dlsym(RTLD_DEFAULT, "dgemm_");
    if (!product || !dladdr(product, &info) || !info.dli_fname) return "unknown";
    const std::unique_ptr<char, void (*)(void*)> path(realpath(info.dli_fname, nullptr), std::free);
    return path ? path.get() : info.dli_fname;
}

// Analysis, factorization and one solve of the cotangent Laplacian, the last vertex fixed, in METIS order.  Filling
// the matrix is not counted.  False: failed.
inline bool run_cholmod(const hmf_level_mesh& mesh, Seconds& factor_time, Seconds& solve_time) {
    cholmod_common common;
    cholmod_start(&common);
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.print = 0;
    const size_t n = mesh.vertex_count - 1;
    cholmod_triplet* t = cholmod_allocate_triplet(n, n, n + mesh.edge_count, -1, CHOLMOD_REAL, &common);
    int* row = static_cast<int*>(t->i);
    int* column = static_cast<int*>(t->j);
    double* value = static_cast<double*>(t->x);
    std::vector<double> diagonal(n + 1, 0.0);
    size_t at = 0;
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        const uint32_t a = mesh.edge_vertices[2 * e], b = mesh.edge_vertices[2 * e + 1];
        diagonal[a] += mesh.weights[e];
        diagonal[b] += mesh.weights[e];
        if (std::max(a, b) >= n) continue;
        row[at] = static_cast<int>(std::max(a, b));
        column[at] = static_cast<int>(std::min(a, b));
        value[at++] = -mesh.weights[e];
    }
    for (size_t i = 0; i < n; ++i) {
        row[at] = column[at] = static_cast<int>(i);
        value[at++] = diagonal[i];
    }
    t->nnz = at;
    cholmod_sparse* a = cholmod_triplet_to_sparse(t, at, &common);
    cholmod_free_triplet(&t, &common);
    cholmod_dense* b = cholmod_allocate_dense(n, 1, n, CHOLMOD_REAL, &common);
    for (size_t i = 0; i < n; ++i) static_cast<double*>(b->x)[i] = i % 2 ? 1.0 : -1.0;
    const Watch factor_watch;
    cholmod_factor* factor = cholmod_analyze(a, &common);
    cholmod_factorize(a, factor, &common);
    factor_time = factor_watch.elapsed();
    const Watch solve_watch;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, b, &common);
    solve_time = solve_watch.elapsed();
    const bool good = common.status == CHOLMOD_OK && x;
    cholmod_free_dense(&x, &common);
    cholmod_free_dense(&b, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&a, &common);
    cholmod_finish(&common);
    return good;
}
#endif

} // namespace measure
