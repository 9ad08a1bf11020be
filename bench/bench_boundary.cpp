// A mesh with holes against the same mesh without: what half of a closed double costs.
//
//     bench_boundary [-r N] [--holes N,N,...] [--rings N] MESH.obj...
//
//     -r N         runs of each (3)
//     --holes      numbers of holes, each its own case (1,3,10); 0: the mesh is taken as it is
//     --rings N    a hole is a vertex and so many rings of triangles around it (3)
//
// Processor seconds of build and of solve with the loops of the library, the least of the
// runs; all meshes by turns.  A row of a table in Markdown for each case.
//
// What is solved is the closed double: more triangles, and of a higher genus than the mesh
// without holes.  So there are two ratios: "job" to the mesh without holes, and "same genus"
// to a closed mesh of the genus of the double with about as many triangles as the mesh with
// holes: level 1 of the double, taken as a mesh of its own.
#include <hmf/applications.h>

#include "../bindings/readers/mesh_formats.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Run {
    double build = 1e9, solve = 1e9;
    double finest = 1e9, coarser = 1e9, certificate = 1e9; // parts of the solve, wall time
    unsigned long long solves = 0, sweeps = 0, boundaries = 0;
    double energy = 0;
    std::string failure;

    double total() const { return build + solve; }
};

void run_once(const readers::TriangleMesh& mesh, Run& run) {
    hmf_hierarchy* hierarchy = nullptr;
    hmf_foliation* foliation = nullptr;
    hmf_error error{};
    const double begin = processor_seconds();
    hmf_status status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                             mesh.triangle_count(), nullptr, nullptr, &hierarchy, &error);
    const double built = processor_seconds();
    if (status == HMF_OK) status = hmf_solve_cut_system(hierarchy, nullptr, nullptr, &foliation, &error);
    if (status != HMF_OK) run.failure = error.message;
    if (foliation) {
        const hmf_report& report = *hmf_foliation_report(foliation);
        double coarser = 0;
        for (uint64_t k = 0; k < report.level_count; ++k)
            coarser += report.levels[k].interpolate_seconds + (k > 0 ? report.levels[k].optimize_seconds : 0);
        run.build = std::min(run.build, built - begin);
        run.solve = std::min(run.solve, processor_seconds() - built);
        run.finest = std::min(run.finest, report.levels[0].optimize_seconds);
        run.coarser = std::min(run.coarser, coarser);
        run.certificate = std::min(run.certificate, report.class_seconds);
        run.solves = report.levels[0].linear_solve_count;
        run.sweeps = report.levels[0].sweep_count;
        run.energy = report.energy;
        run.boundaries = hmf_hierarchy_describe(hierarchy)->boundary_count;
    }
    hmf_foliation_destroy(foliation);
    hmf_hierarchy_destroy(hierarchy);
}

struct Random {
    uint64_t state;
    uint64_t below(uint64_t n) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return (state >> 33) % n;
    }
};

// Without the triangles around some vertices; unused vertices are left out.
readers::TriangleMesh with_holes(const readers::TriangleMesh& mesh, size_t holes, size_t rings, uint64_t seed) {
    Random random{seed};
    std::vector<char> gone(mesh.triangle_count(), 0), inside;
    for (size_t k = 0; k < holes; ++k) {
        inside.assign(mesh.vertex_count(), 0);
        inside[random.below(mesh.vertex_count())] = 1;
        for (size_t r = 0; r < rings; ++r) {
            std::vector<char> more = inside;
            for (size_t t = 0; t < mesh.triangle_count(); ++t) {
                const uint32_t* v = &mesh.triangles[3 * t];
                if (!inside[v[0]] && !inside[v[1]] && !inside[v[2]]) continue;
                gone[t] = 1;
                for (size_t s = 0; s < 3; ++s) more[v[s]] = 1;
            }
            inside = more;
        }
    }
    readers::TriangleMesh out;
    std::vector<uint32_t> number(mesh.vertex_count(), HMF_NONE);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t s = 0; s < 3 && !gone[t]; ++s) {
            const uint32_t v = mesh.triangles[3 * t + s];
            if (number[v] == HMF_NONE) {
                number[v] = static_cast<uint32_t>(out.positions.size() / 3);
                for (size_t c = 0; c < 3; ++c) out.positions.push_back(mesh.positions[3 * size_t{v} + c]);
            }
            out.triangles.push_back(number[v]);
        }
    return out;
}

// Level 1 of the double; empty if it is no mesh with one edge between two vertices.
readers::TriangleMesh coarser_double(const readers::TriangleMesh& mesh) {
    readers::TriangleMesh out;
    hmf_hierarchy *hierarchy = nullptr, *usable = nullptr;
    hmf_level_mesh* level = nullptr;
    if (hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                             nullptr, nullptr, &hierarchy, nullptr)
            == HMF_OK
        && hmf_level(hierarchy, 1, nullptr, &level, nullptr) == HMF_OK) {
        out.positions.assign(level->positions, level->positions + 3 * level->vertex_count);
        out.triangles.assign(level->triangle_vertices, level->triangle_vertices + 3 * level->triangle_count);
        if (hmf_hierarchy_create(out.positions.data(), out.vertex_count(), out.triangles.data(), out.triangle_count(),
                                 nullptr, nullptr, &usable, nullptr)
            != HMF_OK)
            out = readers::TriangleMesh();
    }
    hmf_free(level);
    hmf_hierarchy_destroy(usable);
    hmf_hierarchy_destroy(hierarchy);
    return out;
}

// whole: without holes; same_genus: coarser_double, or null.
void row(const std::string& name, const readers::TriangleMesh& mesh, const Run& run, const Run* whole,
         const Run* same_genus) {
    if (!run.failure.empty()) {
        std::printf("| %s | %s |\n", name.c_str(), run.failure.c_str());
        return;
    }
    const double triangles = static_cast<double>(mesh.triangle_count());
    const auto of = [&](double with, double without) { return whole && without > 0 ? with / without : 0; };
    const double same = same_genus && same_genus->failure.empty() ? run.total() / same_genus->total() : 0;
    std::printf("| %s | %.0f | %llu | %.3f | %.3f | %.3f | %.3f | %.3f | %llu | %llu | %.2f | %.2f | %.2f | %.2f | "
                "%.12g |\n",
                name.c_str(), triangles, run.boundaries, run.build, run.solve, run.coarser, run.finest, run.certificate,
                run.solves, run.sweeps, whole ? of(run.build, whole->build) : 1,
                whole ? of(run.solve, whole->solve) : 1, whole ? of(run.total(), whole->total()) : 1, same, run.energy);
}

} // namespace

int main(int argc, char** argv) {
    long runs = 3;
    size_t rings = 3;
    std::vector<size_t> holes{1, 3, 10};
    std::printf("| mesh | triangles | boundaries | build s | solve s | coarser levels | level 0 | certificate "
                "| linear solves | sweeps | build, ratio | solve, ratio | job, ratio | same genus, ratio | energy |\n"
                "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "-r") && i + 1 < argc) {
            runs = std::strtol(argv[++i], nullptr, 10);
            continue;
        }
        if (!std::strcmp(argv[i], "--rings") && i + 1 < argc) {
            rings = std::strtoul(argv[++i], nullptr, 10);
            continue;
        }
        if (!std::strcmp(argv[i], "--holes") && i + 1 < argc) {
            holes.clear();
            for (char* at = argv[++i]; *at; at += *at == ',') holes.push_back(std::strtoul(at, &at, 10));
            continue;
        }
        const char* const slash = std::strrchr(argv[i], '/');
        const std::string name = slash ? slash + 1 : argv[i];
        std::ifstream file(argv[i], std::ios::binary);
        if (!file) {
            std::fprintf(stderr, "cannot read %s\n", argv[i]);
            return 1;
        }
        const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
        std::vector<readers::TriangleMesh> meshes{readers::read_obj(bytes)};
        for (const size_t n : holes)
            if (n > 0) meshes.push_back(with_holes(meshes[0], n, rings, 7 * n + 1));
        const size_t cases = meshes.size();
        for (size_t k = 1; k < cases; ++k) meshes.push_back(coarser_double(meshes[k]));
        std::vector<Run> found(meshes.size());
        for (long r = 0; r < runs; ++r)
            for (size_t k = 0; k < meshes.size(); ++k)
                if (found[k].failure.empty()) run_once(meshes[k], found[k]);
        row(name, meshes[0], found[0], nullptr, nullptr);
        for (size_t k = 1; k < cases; ++k) row(name, meshes[k], found[k], &found[0], &found[cases + k - 1]);
        std::fflush(stdout);
    }
    return 0;
}
