// Every call of the interface: its processor time, and the longest time between two calls of the progress
// function, which bounds how long a cancellation takes.
//
//     bench_calls [-r N] MESH.obj
//
// Rows: "call", medians of N repetitions (3).
#include <functional>

#include "measure.hpp"

namespace {

using namespace measure;

// The longest time between two reports, the beginning and the end of the call included.
struct Gaps {
    double last = 0, longest = 0;
    static int32_t report(void* user, double) {
        Gaps& gaps = *static_cast<Gaps*>(user);
        gaps.meet();
        return HMF_PROGRESS_CONTINUE;
    }
    void meet() {
        const double t = processor();
        longest = std::max(longest, t - last);
        last = t;
    }
};

struct Samples {
    std::string name;
    std::vector<double> seconds, gap;
};

double median(std::vector<double> x) {
    std::sort(x.begin(), x.end());
    return x[x.size() / 2];
}

class Table {
public:
    // Makes call(control, error), which fails the program unless it succeeds.
    void measure(const char* name, const std::function<hmf_status(const hmf_control*, hmf_error*)>& call) {
        Gaps gaps;
        const hmf_control control{sizeof(hmf_control), 0, Gaps::report, &gaps, nullptr, nullptr};
        hmf_error error{};
        const double start = gaps.last = processor();
        if (call(&control, &error) != HMF_OK) {
            std::fprintf(stderr, "%s: %s\n", name, error.message);
            std::exit(1);
        }
        gaps.meet();
        auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Samples& r) { return r.name == name; });
        if (row == rows_.end()) row = rows_.insert(rows_.end(), Samples{name, {}, {}});
        row->seconds.push_back(processor() - start);
        row->gap.push_back(gaps.longest);
    }
    void print(const std::string& mesh, double edges) const {
        for (const Samples& r : rows_)
            Row("call")
                .text("mesh", mesh)
                .number("edges", edges)
                .text("call", r.name)
                .number("seconds", median(r.seconds))
                .number("gap", median(r.gap))
                .number("gap_ms_per_million_edges", 1e9 * median(r.gap) / edges)
                .print();
    }

private:
    std::vector<Samples> rows_;
};

void run(const Mesh& mesh, Table& table, double& edges) {
    hmf_hierarchy* h = nullptr;
    hmf_loop_set* loops = nullptr;
    hmf_foliation *f = nullptr, *g = nullptr;
    table.measure("build", [&](const hmf_control* c, hmf_error* e) {
        return hmf_hierarchy_create(mesh.position.data(), mesh.vertices(), mesh.triangle.data(), mesh.triangles(),
                                    nullptr, c, &h, e);
    });
    edges = static_cast<double>(hmf_hierarchy_describe(h)->levels[0].edge_count);
    const struct {
        const char* name;
        int32_t kind;
    } kinds[] = {{"loops pants", HMF_LOOPS_PANTS}, {"loops handle", HMF_LOOPS_HANDLE}, {"loops cut", HMF_LOOPS_CUT}};
    for (const auto& kind : kinds) {
        hmf_free(loops);
        table.measure(kind.name,
                      [&](const hmf_control* c, hmf_error* e) { return hmf_loops(h, 0, kind.kind, c, &loops, e); });
    }
    table.measure("initialize",
                  [&](const hmf_control* c, hmf_error* e) { return hmf_foliation_from_loops(h, loops, c, &g, e); });
    hmf_foliation_destroy(g);
    table.measure("solve", [&](const hmf_control* c, hmf_error* e) { return hmf_solve(h, loops, nullptr, c, &f, e); });
    table.measure("relax", [&](const hmf_control* c, hmf_error* e) { return hmf_relax(f, nullptr, c, &g, e); });
    hmf_foliation_destroy(g);
    size_t count = 0;
    const double* values = hmf_foliation_values(f, &count);
    table.measure("create", [&](const hmf_control* c, hmf_error* e) {
        return hmf_foliation_from_values(h, 0, values, count, c, &g, e);
    });
    hmf_foliation_destroy(g);
    hmf_foliation* coarse = nullptr;
    const size_t level = hmf_hierarchy_describe(h)->level_count - 1;
    table.measure("interpolate to the coarsest",
                  [&](const hmf_control* c, hmf_error* e) { return hmf_interpolate(f, level, c, &coarse, e); });
    table.measure("interpolate to level 0",
                  [&](const hmf_control* c, hmf_error* e) { return hmf_interpolate(coarse, 0, c, &g, e); });
    hmf_foliation_destroy(coarse);
    hmf_foliation_destroy(g);
    double energy = 0;
    hmf_residual_set* residuals = nullptr;
    table.measure("energy", [&](const hmf_control* c, hmf_error* e) { return hmf_energy(f, c, &energy, e); });
    table.measure("residuals", [&](const hmf_control* c, hmf_error* e) { return hmf_residuals(f, c, &residuals, e); });
    hmf_free(residuals);
    hmf_singularity_set* singularities = nullptr;
    table.measure("singularities",
                  [&](const hmf_control* c, hmf_error* e) { return hmf_singularities(f, c, &singularities, e); });
    hmf_free(singularities);
    hmf_cylinder_set* cylinders = nullptr;
    table.measure("cylinders",
                  [&](const hmf_control* c, hmf_error* e) { return hmf_cylinders(f, loops, c, &cylinders, e); });
    hmf_free(cylinders);
    hmf_trace_options options{};
    options.struct_size = sizeof options;
    options.critical = 1;
    options.spacing = 0.05;
    hmf_lines* lines = nullptr;
    table.measure("trace", [&](const hmf_control* c, hmf_error* e) { return hmf_trace(f, &options, c, &lines, e); });
    hmf_free(lines);
    hmf_quad_mesh* quads = nullptr;
    table.measure("quads", [&](const hmf_control* c, hmf_error* e) { return hmf_quads(f, nullptr, c, &quads, e); });
    hmf_free(quads);
    options.leaves = HMF_LEAVES_CONJUGATE;
    table.measure("trace conjugate",
                  [&](const hmf_control* c, hmf_error* e) { return hmf_trace(f, &options, c, &lines, e); });
    hmf_free(lines);
    hmf_parameterization* flat = nullptr;
    table.measure("parameterize after it",
                  [&](const hmf_control* c, hmf_error* e) { return hmf_parameterize(f, nullptr, c, &flat, e); });
    hmf_free(flat);
    hmf_foliation_destroy(f);
    hmf_free(loops);
    hmf_hierarchy_destroy(h);
}

} // namespace

int main(int argc, char** argv) {
    int repetitions = 3;
    std::string path;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "-r") && i + 1 < argc) repetitions = std::max(1, std::atoi(argv[++i]));
        else path = argv[i];
    }
    if (path.empty()) return std::fprintf(stderr, "bench_calls [-r N] MESH.obj\n"), 2;
    const Mesh mesh = read_mesh(path);
    Table table;
    double edges = 0;
    for (int r = 0; r < repetitions; ++r) run(mesh, table, edges);
    table.print(mesh.name, edges);
    return 0;
}
