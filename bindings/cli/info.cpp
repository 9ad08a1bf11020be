#include "info.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "../readers/components.hpp"
#include "../readers/json.hpp"
#include "counted.hpp"
#include "failure.hpp"
#include "library.hpp"
#include "marks.hpp"
#include "progress.hpp"
#include "split_mesh.hpp"

namespace cli {

using readers::Json;

namespace {

// What the library says of a component.
struct Finding {
    hmf_status status = HMF_OK;
    hmf_error error{};
    size_t genus = 0, boundaries = 0;
    uint64_t edges = 0, negative = 0; // negative: edges that are not Delaunay
    std::vector<uint32_t> marks;      // that the library suggests
};

Finding look_at(const TriangleMesh& mesh, double mollify, const std::string& mesh_name, const hmf_control* control) {
    hmf_hierarchy_options options;
    hmf_hierarchy_options_init(&options, sizeof options);
    // Validation only: one level.
    options.coarsest = mesh.vertex_count();
    options.mollify = mollify;
    hmf_hierarchy* raw = nullptr;
    Finding found;
    found.status = suggest_marks(mesh, options, control, found.marks, found.error);
    options.marked_vertices = found.marks.data();
    options.marked_count = found.marks.size();
    if (found.status == HMF_OK)
        found.status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                            mesh.triangle_count(), &options, control, &raw, &found.error);
    const Owned<hmf_hierarchy> hierarchy(raw);
    if (found.status != HMF_OK) {
        if (found.status < 300 || found.status >= 400) fail_with(found.status, found.error, mesh_name);
        return found;
    }
    const auto level = make<hmf_level_mesh>(mesh_name, [&](hmf_level_mesh** out, hmf_error* error) {
        return hmf_level(hierarchy.get(), 0, nullptr, out, error);
    });
    found.edges = level->edge_count;
    found.genus = hmf_hierarchy_describe(hierarchy.get())->genus;
    found.boundaries = hmf_hierarchy_describe(hierarchy.get())->boundary_count;
    found.negative = static_cast<uint64_t>(
        std::count_if(level->weights, level->weights + level->edge_count, [](double w) { return w < 0; }));
    return found;
}

struct Quality {
    double low[3] = {}, high[3] = {}, area = 0, least_angle = 180, largest_angle = 0, mean_edge = 0;
};

Quality quality_of(const TriangleMesh& mesh) {
    Quality q;
    double edge_sum = 0;
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        for (size_t a = 0; a < 3; ++a) {
            const double x = mesh.positions[3 * v + a];
            q.low[a] = v ? std::min(q.low[a], x) : x;
            q.high[a] = v ? std::max(q.high[a], x) : x;
        }
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        double square[3];
        for (size_t s = 0; s < 3; ++s) {
            square[s] = 0;
            for (size_t a = 0; a < 3; ++a) {
                const double d = mesh.positions[3 * size_t(mesh.triangles[3 * t + s]) + a]
                               - mesh.positions[3 * size_t(mesh.triangles[3 * t + (s + 1) % 3]) + a];
                square[s] += d * d;
            }
            edge_sum += std::sqrt(square[s]);
        }
        const double a = square[0], b = square[1], c = square[2];
        const double twice = 0.5 * std::sqrt(std::max(0.0, 4 * a * b - (a + b - c) * (a + b - c)));
        q.area += twice / 2;
        for (size_t s = 0; s < 3; ++s) {
            const double cosine_side = (square[s] + square[(s + 1) % 3] - square[(s + 2) % 3]) / 2;
            const double angle = std::atan2(twice, cosine_side) * 57.29577951308232;
            q.least_angle = std::min(q.least_angle, angle);
            q.largest_angle = std::max(q.largest_angle, angle);
        }
    }
    q.mean_edge = edge_sum / double(3 * mesh.triangle_count());
    return q;
}

// `printed` tells whether standard output has its JSON, also if this throws.
void look_at_all(const InfoRequest& request, const std::string& mesh_name, bool& printed) {
    PreparedMesh prepared = prepare_mesh(request.mesh, request.prepare);
    TriangleMesh& mesh = prepared.mesh;
    const readers::Origin origin = std::move(mesh.origin);
    const Quality q = quality_of(mesh);
    const size_t vertices = mesh.vertex_count(), triangles = mesh.triangle_count();
    const std::vector<MeshPart> parts = split_mesh(mesh, mesh_name);
    const bool alone = parts.size() == 1;
    Progress progress;
    Json::Array rows;
    std::vector<std::string> lines;
    Finding total;
    size_t good = 0, boundaries = 0;
    bool mollified = false;
    uint64_t memory = 0;
    for (size_t k = 0; k < parts.size(); ++k) {
        const TriangleMesh& part = parts[k].mesh;
        const double from = double(k) / double(parts.size()), to = double(k + 1) / double(parts.size());
        Finding found = look_at(part, 0, mesh_name, progress.part("check", from, to));
        if (found.status == HMF_ERROR_MESH_DEGENERATE && request.prepare.repairs) {
            found = look_at(part, MOLLIFY_OF_REPAIR, mesh_name, progress.part("check", from, to));
            mollified = true;
        }
        if (alone) total = found;
        const uint64_t edges = found.status == HMF_OK ? found.edges : readers::edges_of(part).count();
        const size_t open = found.status == HMF_OK ? found.boundaries : readers::boundary_count(part);
        const size_t copies = open > 0 ? 2 : 1; // with boundary the double is built
        memory += hmf_hierarchy_memory_estimate(copies * part.vertex_count(), copies * part.triangle_count(), nullptr);
        Json row = {{"valid", found.status == HMF_OK},
                    {"vertices", part.vertex_count()},
                    {"edges", edges},
                    {"triangles", part.triangle_count()},
                    {"boundaries", open}};
        std::string line;
        if (found.status == HMF_OK) {
            row.set("genus", found.genus);
            line = "genus " + std::to_string(found.genus);
            if (!found.marks.empty())
                line += ", "
                      + (found.boundaries == 0 ? counted(found.marks.size() / 2, "tip")
                                               : counted(found.marks.size(), "vertex", "vertices"))
                      + " to mark";
        } else {
            const std::string advice =
                repair_advice(found.status, request.prepare.repairs, request.prepare.joins.has_value());
            row.set("status", found.status);
            row.set("text", hmf_status_string(found.status));
            line = hmf_status_string(found.status) + advice;
        }
        if (!alone) {
            row.set("first_triangle", parts[k].triangles[0]);
            total.edges += edges;
            total.genus += found.genus;
            total.negative += found.negative;
            for (const uint32_t v : found.marks) total.marks.push_back(parts[k].vertices[v]);
            lines.push_back(name_of_component(parts[k], k) + ": " + line);
        }
        good += found.status == HMF_OK;
        boundaries += open;
        rows.push_back(row);
    }
    progress.clear();
    std::vector<std::string> repaired = prepared.sentences();
    if (mollified) {
        repaired.emplace_back(MOLLIFIED);
        std::fprintf(stderr, "%s: %s\n", mesh_name.c_str(), MOLLIFIED);
    }
    if (request.json) {
        Json report = {{"mesh", mesh_name}, {"valid", good > 0}};
        if (request.prepare.repairs || !repaired.empty()) report.set("repairs", repaired);
        if (!prepared.warnings.empty()) report.set("warnings", prepared.warnings);
        report.set("doubled_points", prepared.doubled);
        report.set("unused_vertices", prepared.dropped + prepared.repairs.unused_vertices);
        if (total.status != HMF_OK) {
            report.set("status", total.status);
            report.set("text", hmf_status_string(total.status));
            report.set("message", in_words_of_tool(total.error.message));
            report.set("index", total.error.index);
        } else {
            report.set("vertices", vertices);
            report.set("edges", total.edges);
            report.set("triangles", triangles);
            report.set("genus", total.genus);
            report.set("suggested_marks", total.marks);
            report.set("non_delaunay_edges", total.negative);
            report.set("min_angle", q.least_angle);
            report.set("max_angle", q.largest_angle);
            report.set("mean_edge_length", q.mean_edge);
            report.set("area", q.area);
            report.set("box_low", std::vector<double>(q.low, q.low + 3));
            report.set("box_high", std::vector<double>(q.high, q.high + 3));
            report.set("memory_estimate_bytes", memory);
        }
        report.set("boundaries", boundaries);
        report.set("components_usable", good);
        if (alone) report.set("components", 1);
        else report.set("components", rows);
        std::printf("%s\n", report.dump(2).c_str());
        printed = true;
    }
    if (total.status != HMF_OK)
        fail_with(total.status, total.error, mesh_name,
                  repair_advice(total.status, request.prepare.repairs, request.prepare.joins.has_value()),
                  [&](int32_t element, uint64_t index, bool with_line) {
                      return element == HMF_ELEMENT_TRIANGLE ? origin.name_of_triangle(index, with_line)
                                                             : origin.name_of_vertex(index, with_line);
                  });
    if (!request.json) {
        if (alone)
            std::printf("%s: %s oriented manifold, genus %zu\n", mesh_name.c_str(), boundaries > 0 ? "open" : "closed",
                        total.genus);
        else
            std::printf("%s: %zu components, %zu of them %s oriented manifolds, genus %zu\n", mesh_name.c_str(),
                        parts.size(), good, boundaries > 0 ? "closed or open" : "closed", total.genus);
        if (!total.marks.empty())
            std::printf(
                "  to mark        %zu vertices%s; hmf solve marks them unless it is told others\n", total.marks.size(),
                boundaries == 0 ? (", two at each of " + std::to_string(total.marks.size() / 2) + " tips").c_str()
                                : "");
        std::printf("  vertices       %zu\n", vertices);
        std::printf("  edges          %llu\n", static_cast<unsigned long long>(total.edges));
        std::printf("  triangles      %zu\n", triangles);
        if (boundaries > 0) std::printf("  boundaries     %zu\n", boundaries);
        std::printf("  not Delaunay   %llu edges (%.2f %%)\n", static_cast<unsigned long long>(total.negative),
                    100.0 * double(total.negative) / double(total.edges));
        std::printf("  angles         %.3f to %.3f degrees\n", q.least_angle, q.largest_angle);
        std::printf("  mean edge      %.6g\n", q.mean_edge);
        std::printf("  area           %.6g\n", q.area);
        std::printf("  box            %.6g %.6g %.6g  to  %.6g %.6g %.6g\n", q.low[0], q.low[1], q.low[2], q.high[0],
                    q.high[1], q.high[2]);
        std::printf("  memory to build, at most %.1f MB\n", double(memory) / 1e6);
        for (const std::string& line : lines) std::printf("  %s\n", line.c_str());
    }
    if (good == 0) throw Failure(EXIT_BAD_INPUT, mesh_name + ": no component carries a foliation");
}

} // namespace

void info(const InfoRequest& request) {
    const std::string mesh_name = shown(request.mesh);
    bool printed = false;
    try {
        look_at_all(request, mesh_name, printed);
    } catch (const Failure& failure) {
        // With --json the output is JSON also for a file that cannot be read.
        if (request.json && !printed)
            std::printf("%s\n",
                        Json({{"mesh", mesh_name}, {"valid", false}, {"message", failure.what()}}).dump(2).c_str());
        throw;
    }
}

} // namespace cli
