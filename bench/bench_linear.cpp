// Signed multigrid against CHOLMOD on twisted Laplacians.
//
//     bench_linear [-r repeats] [-k kind] [mesh.obj ...]
//
// kind: gauge (random signs of the unknowns, singular), twisted (signs that
// turn around a few dozen pairs of triangles), fixed (twisted, and some
// unknowns fixed), or all (default).  Without meshes: tori of several sizes.
// One line per matrix; seconds are medians over the repeats, ratios are taken
// repeat by repeat, with their smallest and largest value.  With less than
// three repeats there is no spread to speak of.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <unordered_map>
#include <vector>

#if HMF_HAVE_CHOLMOD
#include <cholmod.h>
#endif

#include "../src/core/linear/signed_multigrid.hpp"
#include "soup.hpp"

namespace {

double now() {
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

struct Random {
    uint64_t state = 0x9e3779b97f4a7c15u;
    uint64_t next() {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        return state;
    }
    double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    uint32_t below(size_t n) { return static_cast<uint32_t>(next() % n); }
};

// Breadth-first order, as the library renumbers at load.
void renumber(Soup& soup) {
    const size_t n = soup.vertices();
    std::vector<uint32_t> first(n + 1, 0), at(soup.triangle.size());
    for (uint32_t v : soup.triangle) ++first[v + 1];
    for (size_t v = 0; v < n; ++v) first[v + 1] += first[v];
    std::vector<uint32_t> fill(first.begin(), first.end() - 1);
    for (size_t c = 0; c < soup.triangle.size(); ++c) at[fill[soup.triangle[c]]++] = static_cast<uint32_t>(c / 3);
    std::vector<uint32_t> order, rank(n, 0xffffffffu), faces;
    std::vector<char> seen(soup.triangles(), 0);
    order.reserve(n);
    for (uint32_t seed = 0; seed < n; ++seed) {
        if (rank[seed] != 0xffffffffu) continue;
        rank[seed] = static_cast<uint32_t>(order.size());
        order.push_back(seed);
        for (size_t k = order.size() - 1; k < order.size(); ++k)
            for (uint32_t c = first[order[k]]; c < first[order[k] + 1]; ++c) {
                if (!seen[at[c]]) {
                    seen[at[c]] = 1;
                    faces.push_back(at[c]);
                }
                for (int s = 0; s < 3; ++s) {
                    const uint32_t w = soup.triangle[3 * size_t{at[c]} + static_cast<size_t>(s)];
                    if (rank[w] != 0xffffffffu) continue;
                    rank[w] = static_cast<uint32_t>(order.size());
                    order.push_back(w);
                }
            }
    }
    std::vector<double> position;
    for (uint32_t v : order)
        for (size_t s = 0; s < 3; ++s) position.push_back(soup.position[3 * size_t{v} + s]);
    std::vector<uint32_t> triangle;
    for (uint32_t f : faces)
        for (size_t s = 0; s < 3; ++s) triangle.push_back(rank[soup.triangle[3 * size_t{f} + s]]);
    soup.position = position;
    soup.triangle = triangle;
}

struct Edge {
    uint32_t v[2], f[2];
    double weight;
    int sign;
};

std::vector<Edge> edges_of(const Soup& soup) {
    std::vector<Edge> edges;
    std::unordered_map<uint64_t, uint32_t> index;
    index.reserve(soup.triangle.size());
    for (uint32_t f = 0; f < soup.triangles(); ++f)
        for (uint32_t s = 0; s < 3; ++s) {
            const uint32_t i = soup.triangle[3 * size_t{f} + s], j = soup.triangle[3 * size_t{f} + (s + 1) % 3],
                           k = soup.triangle[3 * size_t{f} + (s + 2) % 3];
            const double* a = &soup.position[3 * size_t{i}];
            const double* b = &soup.position[3 * size_t{j}];
            const double* c = &soup.position[3 * size_t{k}];
            double p[3], q[3];
            for (int t = 0; t < 3; ++t) {
                p[t] = a[t] - c[t];
                q[t] = b[t] - c[t];
            }
            const double x = p[1] * q[2] - p[2] * q[1], y = p[2] * q[0] - p[0] * q[2], z = p[0] * q[1] - p[1] * q[0];
            const double area = std::sqrt(x * x + y * y + z * z);
            const double half = 0.5 * (p[0] * q[0] + p[1] * q[1] + p[2] * q[2]) / (area > 1e-300 ? area : 1e-300);
            const uint64_t key = static_cast<uint64_t>(std::min(i, j)) << 32 | std::max(i, j);
            auto [it, fresh] = index.try_emplace(key, static_cast<uint32_t>(edges.size()));
            if (fresh) edges.push_back({{i, j}, {f, f}, 0, -1});
            Edge& e = edges[it->second];
            if (!fresh) e.f[1] = f;
            e.weight += half;
        }
    for (Edge& e : edges) e.weight = std::min(1e6, std::max(1e-9, e.weight));
    return edges;
}

// Flips the edges that dual paths between random pairs of triangles cross.
void twist(const Soup& soup, std::vector<Edge>& edges, int pairs, Random& random) {
    std::vector<std::vector<uint32_t>> of(soup.triangles());
    for (uint32_t e = 0; e < edges.size(); ++e)
        for (uint32_t f : edges[e].f) of[f].push_back(e);
    for (int p = 0; p < pairs; ++p) {
        const uint32_t from = random.below(soup.triangles()), to = random.below(soup.triangles());
        std::vector<uint32_t> by(soup.triangles(), 0xffffffffu), queue{from};
        std::vector<char> seen(soup.triangles(), 0);
        seen[from] = 1;
        for (size_t k = 0; k < queue.size() && !seen[to]; ++k)
            for (uint32_t e : of[queue[k]]) {
                const uint32_t g = edges[e].f[0] ^ edges[e].f[1] ^ queue[k];
                if (seen[g]) continue;
                seen[g] = 1;
                by[g] = e;
                queue.push_back(g);
            }
        for (uint32_t f = to; f != from && by[f] != 0xffffffffu;) {
            const uint32_t e = by[f];
            edges[e].sign = -edges[e].sign;
            f ^= edges[e].f[0] ^ edges[e].f[1];
        }
    }
}

struct System {
    std::vector<uint32_t> offset, column;
    std::vector<double> entry, diagonal, b;
    bool singular = false;
    hmf::SignedMatrix matrix() const {
        return {static_cast<uint32_t>(diagonal.size()), offset.data(), column.data(), entry.data(), diagonal.data()};
    }
};

System assemble(const Soup& soup, std::vector<Edge> edges, const std::string& kind) {
    Random random;
    const size_t all = soup.vertices();
    if (kind != "gauge") twist(soup, edges, 24, random);
    std::vector<int> gauge(all);
    for (int& g : gauge) g = random.next() & 1 ? 1 : -1;
    std::vector<uint32_t> number(all, 0);
    if (kind == "fixed")
        for (int k = 0; k < 60; ++k) number[random.below(all)] = 0xffffffffu;
    uint32_t n = 0;
    for (uint32_t& k : number)
        if (k == 0) k = n++;
    System s;
    s.singular = kind == "gauge";
    s.diagonal.assign(n, 0);
    s.offset.assign(n + size_t{1}, 0);
    for (const Edge& e : edges)
        for (int t = 0; t < 2; ++t) {
            const uint32_t i = number[e.v[t]], j = number[e.v[1 - t]];
            if (i == 0xffffffffu) continue;
            s.diagonal[i] += e.weight;
            s.offset[i + size_t{1}] += j != 0xffffffffu;
        }
    for (size_t i = 0; i < n; ++i) s.offset[i + 1] += s.offset[i];
    std::vector<uint32_t> at(s.offset.begin(), s.offset.end() - 1);
    s.column.resize(s.offset[n]);
    s.entry.resize(s.offset[n]);
    for (const Edge& e : edges)
        for (int t = 0; t < 2; ++t) {
            const uint32_t i = number[e.v[t]], j = number[e.v[1 - t]];
            if (i == 0xffffffffu || j == 0xffffffffu) continue;
            s.column[at[i]] = j;
            s.entry[at[i]++] = e.weight * e.sign * gauge[e.v[0]] * gauge[e.v[1]];
        }
    s.b.resize(n);
    double along = 0;
    for (size_t v = 0; v < all; ++v)
        if (number[v] != 0xffffffffu) {
            s.b[number[v]] = 2 * random.uniform() - 1;
            along += gauge[v] * s.b[number[v]];
        }
    if (s.singular)
        for (size_t v = 0; v < all; ++v) s.b[v] -= gauge[v] * along / static_cast<double>(n);
    return s;
}

double median(std::vector<double> x) {
    std::sort(x.begin(), x.end());
    return x.empty() ? 0 : x[x.size() / 2];
}

#if HMF_HAVE_CHOLMOD
// Seconds to order, factorize and solve; negative: failed.
double run_cholmod(const System& s, std::vector<double>& x) {
    cholmod_common common;
    cholmod_start(&common);
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.print = 0;
    const size_t n = s.diagonal.size();
    cholmod_sparse* a = cholmod_allocate_sparse(n, n, n + s.column.size() / 2, 0, 1, -1, CHOLMOD_REAL, &common);
    int* start = static_cast<int*>(a->p);
    int* row = static_cast<int*>(a->i);
    double* value = static_cast<double*>(a->x);
    int at = 0;
    for (size_t i = 0; i < n; ++i) {
        start[i] = at;
        row[at] = static_cast<int>(i);
        value[at++] = s.diagonal[i];
        for (uint32_t k = s.offset[i]; k < s.offset[i + 1]; ++k) {
            if (s.column[k] < i) continue;
            row[at] = static_cast<int>(s.column[k]);
            value[at++] = s.entry[k];
        }
    }
    start[n] = at;
    cholmod_dense* b = cholmod_allocate_dense(n, 1, n, CHOLMOD_REAL, &common);
    std::copy(s.b.begin(), s.b.end(), static_cast<double*>(b->x));
    const double begin = now();
    cholmod_factor* factor = cholmod_analyze(a, &common);
    cholmod_factorize(a, factor, &common);
    cholmod_dense* solution = cholmod_solve(CHOLMOD_A, factor, b, &common);
    const double seconds = now() - begin;
    const bool good = common.status == CHOLMOD_OK && solution;
    if (good) x.assign(static_cast<double*>(solution->x), static_cast<double*>(solution->x) + n);
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&b, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&a, &common);
    cholmod_finish(&common);
    return good ? seconds : -1;
}
#endif

void run(const Soup& soup, const std::vector<Edge>& edges, const std::string& kind, int repeats) {
    const System s = assemble(soup, edges, kind);
    const hmf::SignedMatrix matrix = s.matrix();
    std::vector<double> x(matrix.n), setup, solve, ratio, other;
    hmf::LinearResult result;
    double complexity = 0, bytes = 0;
    uint32_t levels = 0;
    for (int r = 0; r < repeats; ++r) {
        hmf::Memory memory(nullptr, nullptr, nullptr, 0);
        hmf::Call call(memory, nullptr, nullptr, nullptr);
        std::fill(x.begin(), x.end(), 0.0);
        {
            hmf::SignedMultigrid multigrid;
            const double t0 = now();
            if (!multigrid.setup(matrix, call)) std::exit(1);
            const double t1 = now();
            result = multigrid.solve(matrix, s.b.data(), x.data(), 1e-8, 200, call);
            const double t2 = now();
            setup.push_back(t1 - t0);
            solve.push_back(t2 - t1);
            complexity = multigrid.operator_complexity();
            levels = multigrid.level_count();
            bytes = static_cast<double>(memory.peak()) / matrix.n;
        }
#if HMF_HAVE_CHOLMOD
        if (!s.singular) {
            std::vector<double> y;
            const double seconds = run_cholmod(s, y);
            if (seconds > 0) {
                other.push_back(seconds);
                ratio.push_back((setup.back() + solve.back()) / seconds);
            }
        }
#endif
    }
    std::printf("%-34s %-7s %8u  it %3u %s %.1e  setup %.3f solve %.3f s  levels %u oc %.2f  %3.0f B",
                soup.name.c_str(), kind.c_str(), matrix.n, result.iterations, result.converged ? "ok  " : "FAIL",
                result.residual, median(setup), median(solve), levels, complexity, bytes);
    if (!ratio.empty())
        std::printf("  cholmod %.3f s  ratio %.3f [%.3f %.3f]", median(other), median(ratio),
                    *std::min_element(ratio.begin(), ratio.end()), *std::max_element(ratio.begin(), ratio.end()));
    std::printf("\n");
    std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv) {
    int repeats = 3;
    std::string only = "all";
    std::vector<std::string> paths;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "-r") && i + 1 < argc) repeats = std::max(1, std::atoi(argv[++i]));
        else if (!std::strcmp(argv[i], "-k") && i + 1 < argc) only = argv[++i];
        else paths.push_back(argv[i]);
    }
    std::vector<Soup> soups;
    if (paths.empty())
        for (uint32_t k : {60u, 180u, 540u}) soups.push_back(torus(3 * k, k));
    for (const std::string& path : paths) {
        soups.emplace_back();
        if (!read_obj(path.c_str(), soups.back())) {
            std::fprintf(stderr, "cannot read %s\n", path.c_str());
            return 1;
        }
    }
    for (Soup& soup : soups) {
        renumber(soup);
        const std::vector<Edge> edges = edges_of(soup);
        for (const char* kind : {"gauge", "twisted", "fixed"})
            if (only == "all" || only == kind) run(soup, edges, kind, repeats);
    }
    return 0;
}
