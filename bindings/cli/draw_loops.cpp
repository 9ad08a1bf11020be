// Shortest paths by Dijkstra's algorithm, with the straight line to the goal as a bound (A*):
//
//        o---o         o  picked      The path is closed; where the shortest way back is the way there, it
//       /     \                       goes around nothing, and the library says so.
//      o---o---o
#include "draw_loops.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <queue>
#include <sstream>

#include "failure.hpp"
#include "vec.hpp"

namespace cli {

namespace {

[[noreturn]] void refuse_points(const std::string& sentence) { throw Failure(EXIT_USAGE, "--through: " + sentence); }

// Neighbors of the vertices.
class Ways {
public:
    explicit Ways(const TriangleMesh& mesh) : mesh_(mesh), first_(mesh.vertex_count() + 1, 0) {
        // Both directions of the sides of a triangle: each edge inside twice, which costs nothing but space.
        const auto each_side = [&](const auto& use) {
            for (size_t k = 0; k < mesh.triangles.size(); ++k) {
                const uint32_t a = mesh.triangles[k], b = mesh.triangles[k % 3 == 2 ? k - 2 : k + 1];
                use(a, b);
                use(b, a);
            }
        };
        each_side([&](uint32_t a, uint32_t) { ++first_[a + 1]; });
        for (size_t v = 0; v < mesh.vertex_count(); ++v) first_[v + 1] += first_[v];
        std::vector<size_t> filled(first_.begin(), first_.end() - 1);
        to_.resize(first_.back());
        each_side([&](uint32_t a, uint32_t b) { to_[filled[a]++] = b; });
    }

    Vec place(uint32_t v) const {
        const double* const p = &mesh_.positions[3 * size_t{v}];
        return {p[0], p[1], p[2]};
    }

    // From start to just before goal; empty: there is none.
    std::vector<uint32_t> path(uint32_t start, uint32_t goal) {
        constexpr double INFINITE = 1e300;
        distance_.assign(mesh_.vertex_count(), INFINITE);
        before_.assign(mesh_.vertex_count(), start);
        const Vec end = place(goal);
        struct Reached {
            double least; // of a path through here
            uint32_t vertex;
            bool operator<(const Reached& o) const {
                return least != o.least ? least > o.least : vertex > o.vertex; // the top of the queue is the least
            }
        };
        std::priority_queue<Reached> queue;
        distance_[start] = 0;
        queue.push({length(end - place(start)), start});
        while (!queue.empty() && queue.top().vertex != goal) {
            const Reached here = queue.top();
            queue.pop();
            const Vec p = place(here.vertex);
            if (here.least > distance_[here.vertex] + length(end - p)) continue; // found shorter since
            for (size_t k = first_[here.vertex]; k < first_[here.vertex + 1]; ++k) {
                const double d = distance_[here.vertex] + length(place(to_[k]) - p);
                if (!(d < distance_[to_[k]])) continue;
                distance_[to_[k]] = d;
                before_[to_[k]] = here.vertex;
                queue.push({d + length(end - place(to_[k])), to_[k]});
            }
        }
        std::vector<uint32_t> found;
        if (queue.empty()) return found;
        for (uint32_t v = goal; v != start;) found.push_back(v = before_[v]);
        std::reverse(found.begin(), found.end());
        return found;
    }

private:
    const TriangleMesh& mesh_;
    std::vector<size_t> first_; // of the neighbors of each vertex
    std::vector<uint32_t> to_, before_;
    std::vector<double> distance_;
};

uint32_t nearest(const TriangleMesh& mesh, const Ways& ways, Vec place) {
    uint32_t best = 0;
    double least = 1e300;
    // Vertices of no triangle are no places of the surface.
    for (const uint32_t v : mesh.triangles) {
        const Vec d = ways.place(v) - place;
        if (!(dot(d, d) < least)) continue;
        least = dot(d, d);
        best = v;
    }
    return best;
}

constexpr double NEAR = 0.1; // of the diagonal of the box: a place further from the surface is of another one

double square(Vec a) { return dot(a, a); }

// Of a place from a triangle, squared.
double square_distance(Vec place, const Vec (&corners)[3]) {
    const Vec normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    double least = 1e300;
    bool inside = square(normal) > 0;
    for (size_t k = 0; k < 3; ++k) {
        const Vec side = corners[(k + 1) % 3] - corners[k], to = place - corners[k];
        const double along = square(side) > 0 ? std::clamp(dot(to, side) / square(side), 0.0, 1.0) : 0;
        least = std::min(least, square(to - along * side));
        inside = inside && dot(cross(side, to), normal) > 0;
    }
    const double height = dot(place - corners[0], normal);
    return inside ? height * height / square(normal) : least;
}

void refuse_if_far(const std::string& word, const TriangleMesh& mesh, const Ways& ways, Vec place) {
    Vec low = ways.place(mesh.triangles[0]), high = low;
    double least = 1e300;
    for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
        const Vec corners[3] = {ways.place(mesh.triangles[t]), ways.place(mesh.triangles[t + 1]),
                                ways.place(mesh.triangles[t + 2])};
        least = std::min(least, square_distance(place, corners));
        for (const Vec c : corners) {
            low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
            high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
        }
    }
    const double limit = NEAR * length(high - low);
    if (least <= limit * limit) return;
    char text[120];
    std::snprintf(text, sizeof text, " is %.3g from the surface, more than %.3g, a tenth of the mesh; ",
                  std::sqrt(least), limit);
    refuse_points(word + text + "check its unit and axes, or give the number of a vertex");
}

uint32_t picked_vertex(const std::string& word, const TriangleMesh& mesh, const Ways& ways) {
    const char *at = word.data(), *const stop = at + word.size();
    if (std::count(word.begin(), word.end(), ',') == 0) {
        uint32_t vertex = 0;
        const std::from_chars_result parsed = std::from_chars(at, stop, vertex);
        if (parsed.ec != std::errc() || parsed.ptr != stop)
            refuse_points("\"" + word + "\" is neither the number of a vertex nor a place X,Y,Z");
        if (vertex >= mesh.vertex_count())
            refuse_points("vertex " + word + " does not exist; the mesh has " + std::to_string(mesh.vertex_count())
                          + ", counted from 0");
        return vertex;
    }
    double x[3] = {};
    std::istringstream parts(word + ",");
    size_t count = 0;
    for (std::string part; std::getline(parts, part, ','); ++count) {
        char* end = nullptr;
        const double number = std::strtod(part.c_str(), &end);
        if (part.empty() || *end || !std::isfinite(number) || count == 3)
            refuse_points("\"" + word + "\" is no place; give three numbers X,Y,Z without blanks");
        x[count] = number;
    }
    if (count != 3) refuse_points("\"" + word + "\" is no place; give three numbers X,Y,Z without blanks");
    refuse_if_far(word, mesh, ways, {x[0], x[1], x[2]});
    return nearest(mesh, ways, {x[0], x[1], x[2]});
}

} // namespace

LoopList draw_loops(const std::string& picked, const TriangleMesh& mesh) {
    LoopList loops;
    loops.element_kind = HMF_PATH_VERTICES;
    Ways ways(mesh);
    std::istringstream lists(picked);
    for (std::string list; std::getline(lists, list, ';');) {
        std::vector<uint32_t> stops;
        std::istringstream words(list);
        for (std::string word; words >> word;) {
            const uint32_t v = picked_vertex(word, mesh, ways);
            if (stops.empty() || stops.back() != v) stops.push_back(v);
        }
        if (stops.size() > 1 && stops.front() == stops.back()) stops.pop_back();
        const size_t number = loops.count(); // from 0, as the library counts
        if (stops.size() < 3)
            refuse_points("loop " + std::to_string(number) + " has " + std::to_string(stops.size())
                          + " picked vertices that differ; three and more, on all sides, say which way it goes around");
        for (size_t i = 0; i < stops.size(); ++i) {
            const std::vector<uint32_t> way = ways.path(stops[i], stops[(i + 1) % stops.size()]);
            if (way.empty())
                refuse_points("loop " + std::to_string(number) + ": no edges lead from vertex "
                              + std::to_string(stops[i]) + " to " + std::to_string(stops[(i + 1) % stops.size()])
                              + "; pick vertices of one component");
            loops.elements.insert(loops.elements.end(), way.begin(), way.end());
        }
        loops.offsets.push_back(loops.elements.size());
        loops.arcs.push_back(0);
        loops.arc_sides.insert(loops.arc_sides.end(), 2, HMF_NONE);
        loops.lines.push_back(number);
    }
    if (loops.count() == 0) refuse_points("nothing is picked; give vertices or places X,Y,Z, separated by blanks");
    return loops;
}

} // namespace cli
