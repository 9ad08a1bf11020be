#include "prepare_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "../readers/holes.hpp"
#include "counted.hpp"
#include "failure.hpp"

namespace cli {

namespace {

constexpr size_t few_edges = 4;         // a hole of so many is rarely meant
constexpr double short_boundary = 0.01; // of the diagonal of the box

double diagonal_of(const TriangleMesh& mesh) {
    double square = 0;
    for (size_t k = 0; k < 3; ++k) {
        double low = mesh.positions[k], high = low;
        for (size_t v = 0; v < mesh.vertex_count(); ++v) {
            low = std::min(low, mesh.positions[3 * v + k]);
            high = std::max(high, mesh.positions[3 * v + k]);
        }
        square += (high - low) * (high - low);
    }
    return std::sqrt(square);
}

std::string number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.3g", x);
    return text;
}

// Boundaries that are holes by accident.
void warn_of_holes(PreparedMesh& prepared, const std::vector<readers::Hole>& holes) {
    const double diagonal = diagonal_of(prepared.mesh);
    const readers::Hole* smallest = nullptr;
    size_t count = 0;
    for (const readers::Hole& hole : holes) {
        if (hole.vertices.size() > few_edges && hole.length >= short_boundary * diagonal) continue;
        ++count;
        if (!smallest || hole.vertices.size() < smallest->vertices.size()) smallest = &hole;
    }
    if (count == 0) return;
    const std::string edges = std::to_string(smallest->vertices.size());
    prepared.warnings.push_back("warning: " + counted(count, "boundary", "boundaries")
                                + (count == 1 ? " looks like a hole" : " look like holes")
                                + " by accident, the smallest with " + edges + " edges, " + number(smallest->length)
                                + " long (at " + prepared.mesh.origin.name_of_vertex(smallest->vertices[0])
                                + "); a hole changes the answer: --fill-holes " + edges
                                + " closes such ones, --closed refuses them");
}

void warn_of_doubled_points(PreparedMesh& prepared) {
    prepared.doubled = readers::doubled_boundary_vertices(prepared.mesh);
    if (prepared.doubled > 0)
        prepared.warnings.push_back(
            counted(prepared.doubled, "vertex", "vertices") + " on the boundary "
            + (prepared.doubled == 1 ? "lies at the point of another" : "lie at points of others")
            + "; --repair --join-points joins them");
}

} // namespace

Options mesh_options(MeshRequest& request) {
    return {
        Option{"--repair", &request.repairs, "",
               "lossless repairs: drop duplicate triangles and triangles with a repeated vertex, separate sheets\n"
               "that touch in a vertex or an edge, orient patches consistently, accept triangles of zero area as\n"
               "with --mollify 1e-5"},
        Option{"--join-points", &request.joins, "[DISTANCE]",
               "before the repair, merge vertices at the same position, or within the distance"}
            .in("[0, inf)")
            .requires_one_of("--repair"),
        Option{"--fill-holes", &request.fills, "N", "close every boundary of at most N edges; 0: none"}.in(
            "[0, 1000000]"),
        Option{"--closed", &request.closed, "", "refuse a mesh with a boundary"},
    };
}

std::vector<std::string> PreparedMesh::sentences() const {
    std::vector<std::string> said = repairs.sentences();
    if (dropped > 0) said.push_back("dropped " + counted(dropped, "unused vertex", "unused vertices"));
    if (filled > 0) said.push_back("filled " + counted(filled, "hole"));
    return said;
}

PreparedMesh prepare_mesh(const std::string& path, const MeshRequest& request) {
    const std::string name = shown(path);
    PreparedMesh prepared;
    TriangleMesh& mesh = prepared.mesh;
    mesh = read_mesh(path);
    const auto say = [&](const std::string& sentence) {
        std::fprintf(stderr, "%s: %s\n", name.c_str(), sentence.c_str());
    };
    for (const std::string& note : mesh.notes) say(note);
    try {
        if (request.repairs) prepared.repairs = readers::repair(mesh, request.joins);
        else prepared.dropped = readers::drop_unused_vertices(mesh);
        if (request.fills > 0) prepared.filled = readers::fill_holes(mesh, request.fills);
        for (const std::string& sentence : prepared.sentences()) say(sentence);
        if (request.repairs && prepared.repairs.count() == 0) say("nothing to repair");
        if (mesh.triangles.empty()) throw Failure(EXIT_BAD_INPUT, name + ": no triangle is left");
        const std::vector<readers::Hole> holes = readers::holes_of(mesh);
        if (!holes.empty()) {
            if (!request.joins) warn_of_doubled_points(prepared);
            warn_of_holes(prepared, holes);
        }
        if (!holes.empty() && request.closed)
            throw Failure(EXIT_BAD_INPUT, name + ": the mesh has " + counted(holes.size(), "boundary", "boundaries")
                                              + ", the first with " + std::to_string(holes[0].vertices.size())
                                              + " edges at " + mesh.origin.name_of_vertex(holes[0].vertices[0])
                                              + ", and --closed was given; close it, or give --fill-holes "
                                              + std::to_string(holes[0].vertices.size()));
    } catch (const readers::MeshError& error) { throw Failure(EXIT_BAD_INPUT, name + ": " + error.what()); }
    for (const std::string& warning : prepared.warnings) say(warning);
    return prepared;
}

} // namespace cli
