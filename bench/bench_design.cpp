// The even design against default loops: unevenness on the whole mesh, and the
// time of the search in solves of it.  A row of a table in Markdown for each mesh.
//
//     bench_design MESH.obj...
#include <hmf/applications.h>

#include "../bindings/readers/mesh_formats.hpp"

#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <string>

namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Run {
    double unevenness = -1, seconds = 0;
    hmf_status status = HMF_OK;
};

Run solve(const readers::TriangleMesh& mesh, const uint32_t* marks, uint64_t count, const hmf_loop_set* loops) {
    Run run;
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.marked_vertices = marks;
    options.marked_count = count;
    hmf_hierarchy* hierarchy = nullptr;
    hmf_foliation* foliation = nullptr;
    hmf_error error{};
    run.status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                      mesh.triangle_count(), &options, nullptr, &hierarchy, &error);
    if (run.status == HMF_OK) {
        const double begin = processor_seconds();
        run.status = hmf_solve(hierarchy, loops, nullptr, nullptr, &foliation, &error);
        run.seconds = processor_seconds() - begin;
    }
    hmf_scale* scale = nullptr;
    if (foliation && hmf_conformal_scale(foliation, nullptr, &scale, nullptr) == HMF_OK)
        run.unevenness = scale->unevenness;
    hmf_free(scale);
    if (run.status != HMF_OK) std::fprintf(stderr, "status %d: %s\n", static_cast<int>(run.status), error.message);
    hmf_foliation_destroy(foliation);
    hmf_hierarchy_destroy(hierarchy);
    return run;
}

void row(const char* path) {
    const char* const slash = std::strrchr(path, '/');
    const std::string name = slash ? slash + 1 : path;
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const readers::TriangleMesh mesh = readers::read_obj(bytes);
    hmf_mark_set* marks = nullptr;
    hmf_design* design = nullptr;
    hmf_error error{};
    if (hmf_suggest_marks(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                          nullptr, nullptr, &marks, &error)) {
        std::printf("| %s | %s |\n", name.c_str(), error.message);
        return;
    }
    const double begin = processor_seconds();
    const hmf_status status = hmf_even_design(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                              mesh.triangle_count(), nullptr, nullptr, &design, &error);
    const double seconds = processor_seconds() - begin;
    if (status) {
        std::printf("| %s | %s |\n", name.c_str(), error.message);
    } else {
        const Run before = solve(mesh, marks->marked_vertices, marks->marked_count, nullptr);
        const Run even = solve(mesh, design->marked_vertices, design->marked_count, design->loops);
        std::printf("| %s | %zu | %.2f | %.2f | %.2f | %llu | %llu | %.2f | %.1f |\n", name.c_str(),
                    mesh.vertex_count(), before.unevenness, design->unevenness, even.unevenness,
                    static_cast<unsigned long long>(design->marked_count),
                    static_cast<unsigned long long>(design->loops->count), seconds, seconds / even.seconds);
    }
    std::fflush(stdout);
    hmf_free(design);
    hmf_free(marks);
}

} // namespace

int main(int count, char** words) {
    std::printf("| mesh | vertices | default loops | even, coarse mesh | even | marked | loops | seconds | solves |\n"
                "|---|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 1; i < count; ++i) row(words[i]);
    return 0;
}
