// Arrays for the pictures of the report.
//
//     bench_pictures MESH.obj FILE [--levels] [--ratio R] [--paper] [--loops handle|cut|pants] [--limit S]
//
// FILE has records, each a line "name type rows columns" and then its numbers, little endian: positions, triangles,
// corner_u (the function whose level sets are the leaves, for each corner), and points of leaves, zeros and poles.
// --levels: the same without corner_u for every level, with the prefix "L_", and the initial values.
#include "measure.hpp"

namespace {

using namespace measure;

template <class T>
void put(std::ofstream& file, const std::string& name, const T* data, size_t rows, size_t columns) {
    const char* type = sizeof(T) == 8 ? "f8" : std::is_signed<T>::value ? "i4" : "u4";
    file << name << ' ' << type << ' ' << rows << ' ' << columns << '\n';
    file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(rows * columns * sizeof(T)));
}

void put_leaves(std::ofstream& file, const std::string& name, const hmf_foliation* f, double spacing) {
    hmf_trace_options options;
    hmf_trace_options_init(&options, sizeof options);
    options.spacing = spacing;
    hmf_lines* out = nullptr;
    if (hmf_trace(f, &options, nullptr, &out, nullptr) != HMF_OK) return;
    const Owned<hmf_lines> lines(out);
    put(file, name + "leaf_points", lines->points, lines->point_count, 3);
    std::vector<uint32_t> starts;
    for (uint64_t l = 0; l <= lines->line_count; ++l) starts.push_back(static_cast<uint32_t>(lines->offsets[l]));
    put(file, name + "leaf_starts", starts.data(), starts.size(), 1);
}

void put_singularities(std::ofstream& file, const std::string& name, const hmf_foliation* f) {
    hmf_singularity_set* out = nullptr;
    if (hmf_singularities(f, nullptr, &out, nullptr) != HMF_OK) return;
    const Owned<hmf_singularity_set> set(out);
    std::vector<double> rows;
    for (uint64_t i = 0; i < set->count; ++i) {
        const hmf_singularity& s = set->list[i];
        rows.insert(rows.end(), {static_cast<double>(s.index), s.position[0], s.position[1], s.position[2]});
    }
    put(file, name + "singularities", rows.data(), rows.size() / 4, 4);
}

void put_level(std::ofstream& file, const std::string& name, const hmf_hierarchy* h, size_t level) {
    hmf_level_mesh* out = nullptr;
    if (hmf_level(h, level, nullptr, &out, nullptr) != HMF_OK) return;
    const Owned<hmf_level_mesh> mesh(out);
    put(file, name + "positions", mesh->positions, mesh->vertex_count, 3);
    put(file, name + "triangles", mesh->triangle_vertices, mesh->triangle_count, 3);
}

} // namespace

int main(int argc, char** argv) {
    bool levels = false, paper = false;
    double ratio = 0.5, limit = 20;
    int32_t kind = HMF_LOOPS_HANDLE;
    std::vector<std::string> paths;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--levels") levels = true;
        else if (word == "--paper") paper = true;
        else if (word == "--ratio" && i + 1 < argc) ratio = std::atof(argv[++i]);
        else if (word == "--limit" && i + 1 < argc) limit = std::atof(argv[++i]);
        else if (word == "--loops" && i + 1 < argc)
            kind = argv[++i][0] == 'h' ? HMF_LOOPS_HANDLE : argv[i][0] == 'p' ? HMF_LOOPS_PANTS : HMF_LOOPS_CUT;
        else paths.push_back(word);
    }
    if (paths.size() != 2) return std::fprintf(stderr, "bench_pictures MESH.obj FILE [options]\n"), 2;
    const Mesh mesh = read_mesh(paths[0]);
    hmf_hierarchy_options build_options;
    hmf_hierarchy_options_init(&build_options, sizeof build_options);
    build_options.ratio = ratio;
    hmf_hierarchy* built = nullptr;
    hmf_error error = {};
    if (hmf_hierarchy_create(mesh.position.data(), mesh.vertices(), mesh.triangle.data(), mesh.triangles(),
                             &build_options, nullptr, &built, &error))
        return std::fprintf(stderr, "%s\n", error.message), 1;
    const Owned<hmf_hierarchy> h(built);
    std::string name;
    const Owned<hmf_loop_set> loops = choose_loops(built, kind, name);
    std::ofstream file(paths[1], std::ios::binary);
    put_level(file, "", built, 0);
    hmf_solve_options options;
    hmf_solve_options_init(&options, sizeof options);
    options.method = paper ? HMF_METHOD_PAPER : HMF_METHOD_NEWTON;
    const Solved result = solve(built, loops.get(), options, limit);
    if (!result.report) return std::fprintf(stderr, "%s\n", result.message.c_str()), 1;
    put_singularities(file, "", result.foliation.get());
    hmf_parameterization* out = nullptr;
    if (!paper && hmf_parameterize(result.foliation.get(), nullptr, nullptr, &out, nullptr) == HMF_OK) {
        const Owned<hmf_parameterization> map(out);
        put(file, "corner_uv", map->corner_uv, 3 * map->triangle_count, 2);
    }
    Row("picture")
        .text("mesh", mesh.name)
        .text("loops", name)
        .count("status", static_cast<uint64_t>(result.status))
        .count("poles", result.report->poles)
        .print();
    if (!levels) return 0;
    hmf_foliation* initial = nullptr;
    if (hmf_foliation_from_loops(built, loops.get(), nullptr, &initial, nullptr) == HMF_OK) {
        const Owned<hmf_foliation> owner(initial);
        put_leaves(file, "initial_", initial, 0.05);
    }
    for (size_t l = 0; l < hmf_hierarchy_describe(built)->level_count; ++l) {
        const std::string prefix = std::to_string(l) + "_";
        options.stop_level = l;
        const Solved on_level = solve(built, loops.get(), options, limit);
        if (!on_level.report) continue;
        put_level(file, prefix, built, l);
        put_leaves(file, prefix, on_level.foliation.get(), 0.125);
        put_singularities(file, prefix, on_level.foliation.get());
    }
    return 0;
}
