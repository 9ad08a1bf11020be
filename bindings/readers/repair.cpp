#include "repair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "mesh_sides.hpp"
#include "point_numbers.hpp"

namespace readers {

namespace {

// Points that are not further apart than the distance, and what these join, are in one class.
Classes near_points(const std::vector<double>& points, double distance) {
    const size_t count = points.size() / 3;
    Classes classes(count);
    if (!(distance > 0)) return classes;
    // Points in a cell are in reach of each other: its diagonal is shorter.  Others are at most three cells away.
    const double cell = distance / 2;
    using Cell = std::array<double, 3>;
    const auto cell_of = [&](size_t i) {
        Cell c;
        for (size_t k = 0; k < 3; ++k) c[k] = std::floor(points[3 * i + k] / cell);
        return c;
    };
    std::map<Cell, std::vector<uint32_t>> cells;
    for (uint32_t i = 0; i < count; ++i) cells[cell_of(i)].push_back(i);
    const auto are_near = [&](uint32_t i, uint32_t j) {
        double square = 0;
        for (size_t k = 0; k < 3; ++k) {
            const double d = points[size_t{3} * i + k] - points[size_t{3} * j + k];
            square += d * d;
        }
        return square <= distance * distance;
    };
    for (const auto& [place, members] : cells) {
        for (const uint32_t i : members) classes.unite(members[0], i);
        for (int step = 0; step < 7 * 7 * 7; ++step) {
            const Cell other = {place[0] + step % 7 - 3, place[1] + step / 7 % 7 - 3, place[2] + step / 49 - 3};
            if (!(place < other)) continue;
            const auto found = cells.find(other);
            if (found == cells.end() || classes.of(found->second[0]) == classes.of(members[0])) continue;
            for (const uint32_t i : members)
                for (const uint32_t j : found->second)
                    if (are_near(i, j)) classes.unite(i, j);
        }
    }
    return classes;
}

class Repair {
public:
    Repair(TriangleMesh& mesh, std::optional<double> join_points) :
        mesh_(mesh), joins_(join_points), distance_(join_points.value_or(0)) {}

    Repairs go() {
        number_points();
        drop_repeated_vertices();
        drop_duplicates();
        drop_back_sides();
        pair_sides();
        find_fans();
        turn();
        renumber();
        count_crowded_edges();
        mesh_.origin.renumber(done_.vertices, done_.triangles);
        return std::move(done_);
    }

private:
    // Corners of triangle t as they count for neighbors: vertices, or points.
    const uint32_t* corners(uint32_t t) const { return &corner_[size_t{3} * t]; }
    uint32_t triangle_count() const { return static_cast<uint32_t>(corner_.size() / 3); }

    void number_points() {
        corner_ = mesh_.triangles;
        if (joins_) {
            std::vector<double> points;
            PointNumbers numbers(points);
            std::vector<uint32_t> point(mesh_.vertex_count());
            for (size_t v = 0; v < point.size(); ++v) {
                const double* const p = &mesh_.positions[3 * v];
                point[v] = numbers.number_of(p[0], p[1], p[2]);
            }
            Classes joined = near_points(points, distance_);
            for (uint32_t& v : corner_) v = joined.of(point[v]);
        }
        done_.triangles.resize(mesh_.triangle_count());
        for (uint32_t t = 0; t < done_.triangles.size(); ++t) done_.triangles[t] = t;
    }

    // Returns how many.
    template <class Keep>
    size_t keep_if(const Keep& keep) {
        uint32_t kept = 0;
        const uint32_t count = triangle_count();
        for (uint32_t t = 0; t < count; ++t) {
            if (!keep(t)) continue;
            for (size_t s = 0; s < 3; ++s) {
                corner_[size_t{3} * kept + s] = corner_[size_t{3} * t + s];
                mesh_.triangles[size_t{3} * kept + s] = mesh_.triangles[size_t{3} * t + s];
            }
            done_.triangles[kept++] = done_.triangles[t];
        }
        corner_.resize(size_t{3} * kept);
        mesh_.triangles.resize(size_t{3} * kept);
        done_.triangles.resize(kept);
        return count - kept;
    }

    void drop_repeated_vertices() {
        done_.repeated_vertex = keep_if([&](uint32_t t) {
            const uint32_t* c = corners(t);
            return c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
        });
    }

    // The same cyclic order, of triangles with the same corners.
    bool turns_up(uint32_t t) const {
        const uint32_t* c = corners(t);
        return (c[0] < c[1]) + (c[1] < c[2]) + (c[2] < c[0]) == 2;
    }

    void drop_duplicates() {
        const Groups equal = group_triangles(corner_, mesh_.vertex_count());
        std::vector<uint8_t> drop(triangle_count(), 0);
        for (size_t g = 0; g < equal.count(); ++g) {
            bool seen[2] = {false, false};
            for (const uint32_t* t = equal.begin_of(g); t != equal.end_of(g); ++t) {
                bool& before = seen[turns_up(*t)];
                drop[*t] = before;
                before = true;
            }
        }
        done_.duplicates = keep_if([&](uint32_t t) { return !drop[t]; });
    }

    // A sheet that is listed from both sides has edges with four triangles, and with two after one side is dropped.
    // Shells that share a wall have three then, and stay as they are.
    void drop_back_sides() {
        const Groups equal = group_triangles(corner_, mesh_.vertex_count());
        std::vector<uint32_t> front(triangle_count(), NONE); // of a back side
        for (size_t g = 0; g < equal.count(); ++g)
            if (equal.size_of(g) == 2) front[equal.begin_of(g)[1]] = equal.begin_of(g)[0];
        if (std::count(front.begin(), front.end(), NONE) == std::ptrdiff_t(front.size())) return;
        const Groups sides = group_sides(corner_, mesh_.vertex_count());
        Classes sheets(front.size());
        std::vector<uint8_t> is_listed_twice(front.size(), 0), keeps(front.size(), 0);
        for (const bool unites : {true, false})
            for (size_t g = 0; g < sides.count(); ++g) {
                uint32_t backs = 0, one = NONE;
                for (const uint32_t* side = sides.begin_of(g); side != sides.end_of(g); ++side) {
                    if (front[*side / 3] == NONE) continue;
                    ++backs;
                    if (unites && one != NONE) sheets.unite(one, *side / 3);
                    one = *side / 3;
                }
                if (unites || one == NONE) continue;
                if (sides.size_of(g) > 2) is_listed_twice[sheets.of(one)] = 1;
                if (sides.size_of(g) - backs > 2) keeps[sheets.of(one)] = 1;
            }
        done_.back_sides = keep_if(
            [&](uint32_t t) { return front[t] == NONE || !is_listed_twice[sheets.of(t)] || keeps[sheets.of(t)]; });
    }

    void make_neighbors(uint32_t a, uint32_t b, Classes& patches) {
        neighbor_[a] = b;
        neighbor_[b] = a;
        patches.unite(a / 3, b / 3);
    }

    // Of the sides at one edge: those with a key that exactly two have go to pairs_.
    template <class Key>
    void pair_by(std::vector<uint32_t>& waiting, const Key& key) {
        std::sort(waiting.begin(), waiting.end(),
                  [&](uint32_t a, uint32_t b) { return std::tuple(key(a), a) < std::tuple(key(b), b); });
        std::vector<uint32_t> left;
        for (size_t i = 0, j; i < waiting.size(); i = j) {
            for (j = i + 1; j < waiting.size() && key(waiting[j]) == key(waiting[i]);) ++j;
            if (j - i == 2) pairs_.push_back({waiting[i], waiting[i + 1]});
            else left.insert(left.end(), waiting.begin() + std::ptrdiff_t(i), waiting.begin() + std::ptrdiff_t(j));
        }
        waiting.swap(left);
    }

    void pair_sides() {
        const Groups sides = group_sides(corner_, mesh_.vertex_count());
        neighbor_.assign(corner_.size(), NONE);
        Classes patches(triangle_count());
        std::vector<std::vector<uint32_t>> crowded;
        const auto vertices_of = [&](uint32_t side) {
            const uint32_t a = mesh_.triangles[side], b = mesh_.triangles[next_corner(side)];
            return std::pair(std::min(a, b), std::max(a, b));
        };
        const auto make_pairs = [&] {
            for (const auto& [a, b] : pairs_) make_neighbors(a, b, patches);
            pairs_.clear();
        };
        for (size_t g = 0; g < sides.count(); ++g) {
            const uint32_t* const side = sides.begin_of(g);
            if (sides.size_of(g) == 2) make_neighbors(side[0], side[1], patches);
            if (sides.size_of(g) <= 2) continue;
            was_crowded_ = true;
            std::vector<uint32_t> waiting(side, sides.end_of(g));
            if (joins_) pair_by(waiting, vertices_of);
            make_pairs();
            if (!waiting.empty()) crowded.push_back(std::move(waiting));
        }
        // All pairs of one kind are found before the patches grow by them.
        for (std::vector<uint32_t>& waiting : crowded)
            if (waiting.size() > 2) pair_by(waiting, [&](uint32_t side) { return patches.of(side / 3); });
        make_pairs();
        pair_by_fans(crowded, patches);
        for (const std::vector<uint32_t>& waiting : crowded) {
            if (waiting.size() == 2) make_neighbors(waiting[0], waiting[1], patches);
            done_.cut_edges += waiting.size() > 2;
        }
    }

    // Goes around the vertex, away from the side and through neighbors, to a side that has none.
    uint32_t end_of_fan(uint32_t side, uint32_t vertex) const {
        for (;;) {
            uint32_t corner = side - side % 3;
            while (corner_[corner] != vertex) ++corner;
            const uint32_t before = corner % 3 == 0 ? corner + 2 : corner - 1; // the other side at the vertex
            side = side == corner ? before : corner;
            if (neighbor_[side] == NONE) return side;
            side = neighbor_[side];
        }
    }

    // Two sides that one fan begins and ends with are neighbors: what touches itself in an edge comes apart there.
    // Each pair makes two fans one, which may then begin and end at another edge.
    void pair_by_fans(std::vector<std::vector<uint32_t>>& crowded, Classes& patches) {
        std::vector<uint32_t> edge_of(neighbor_.size(), NONE), next;
        for (uint32_t edge = 0; edge < crowded.size(); ++edge) {
            next.push_back(edge);
            for (const uint32_t side : crowded[edge]) edge_of[side] = edge;
        }
        while (!next.empty()) {
            const uint32_t edge = next.back();
            next.pop_back();
            std::vector<uint32_t>& waiting = crowded[edge];
            for (const uint32_t a : waiting) {
                const uint32_t ends[] = {corner_[a], corner_[next_corner(a)]};
                for (const uint32_t vertex : ends) {
                    if (edge_of[a] == NONE) break;
                    const uint32_t b = end_of_fan(a, vertex);
                    if (b == a || edge_of[b] != edge) continue;
                    for (const uint32_t side : {a, b})
                        for (const uint32_t end : ends) {
                            const uint32_t other = edge_of[end_of_fan(side, end)];
                            if (other != NONE && other != edge) next.push_back(other);
                        }
                    make_neighbors(a, b, patches);
                    edge_of[a] = edge_of[b] = NONE;
                }
            }
            waiting.erase(
                std::remove_if(waiting.begin(), waiting.end(), [&](uint32_t side) { return edge_of[side] == NONE; }),
                waiting.end());
        }
    }

    // Corners at the same end of two sides.
    void unite_ends(Classes& fans, uint32_t a, uint32_t b) const {
        const uint32_t c = next_corner(a), d = next_corner(b);
        const bool same = corner_[a] == corner_[b];
        fans.unite(a, same ? b : d);
        fans.unite(c, same ? d : b);
    }

    void find_fans() {
        Classes fans(corner_.size());
        for (uint32_t side = 0; side < neighbor_.size(); ++side)
            if (neighbor_[side] != NONE && side < neighbor_[side]) unite_ends(fans, side, neighbor_[side]);
        fan_.resize(corner_.size());
        for (uint32_t c = 0; c < fan_.size(); ++c) fan_[c] = fans.of(c);
    }

    // Reverses the smaller part of each patch; of equal parts the one that does not contain the first triangle.
    void turn() {
        const uint32_t count = triangle_count();
        std::vector<uint8_t> sense(count, 2);
        std::vector<uint32_t> patch;
        for (uint32_t first = 0; first < count; ++first) {
            if (sense[first] != 2) continue;
            patch.assign(1, first);
            sense[first] = 0;
            bool has_sides = true;
            size_t other = 0;
            for (size_t n = 0; n < patch.size(); ++n) {
                const uint32_t t = patch[n];
                other += sense[t];
                for (uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
                    if (neighbor_[side] == NONE) continue;
                    const uint32_t u = neighbor_[side] / 3;
                    // Neighbors run through their edge in opposite senses.
                    const uint8_t wanted = sense[t] ^ (corner_[side] == corner_[neighbor_[side]]);
                    if (sense[u] == 2) {
                        sense[u] = wanted;
                        patch.push_back(u);
                    } else if (sense[u] != wanted) has_sides = false;
                }
            }
            const bool turns_first = 2 * other > patch.size();
            for (const uint32_t t : patch) sense[t] = has_sides && (sense[t] == 1) != turns_first;
            if (has_sides) done_.turned_triangles += turns_first ? patch.size() - other : other;
            else ++done_.one_sided_patches;
        }
        for (uint32_t t = 0; t < count; ++t) {
            if (!sense[t]) continue;
            std::swap(mesh_.triangles[size_t{3} * t + 1], mesh_.triangles[size_t{3} * t + 2]);
            std::swap(fan_[size_t{3} * t + 1], fan_[size_t{3} * t + 2]);
        }
    }

    // A fan has the least vertex of its corners; the first fan with a vertex keeps it.
    void renumber() {
        const size_t before = mesh_.vertex_count();
        std::vector<uint32_t> least(fan_.size(), NONE), keeper(before, NONE), extra;
        std::vector<uint8_t> is_used(before, 0), is_split(before, 0);
        // Fans are named by a corner as it was before triangles were turned; they are only names here.
        for (size_t c = 0; c < fan_.size(); ++c) {
            least[fan_[c]] = std::min(least[fan_[c]], mesh_.triangles[c]);
            is_used[mesh_.triangles[c]] = 1;
        }
        std::vector<uint8_t> is_seen(fan_.size(), 0);
        for (const uint32_t fan : fan_) {
            if (is_seen[fan]) continue;
            is_seen[fan] = 1;
            const uint32_t v = least[fan];
            if (keeper[v] == NONE) keeper[v] = fan;
            else {
                extra.push_back(fan);
                is_split[v] = 1;
            }
        }
        std::vector<uint32_t> number(fan_.size(), NONE);
        std::vector<double> positions;
        const auto give_number = [&](uint32_t fan) {
            const uint32_t v = least[fan];
            number[fan] = static_cast<uint32_t>(done_.vertices.size());
            done_.vertices.push_back(v);
            positions.insert(positions.end(), &mesh_.positions[size_t{3} * v], &mesh_.positions[size_t{3} * v] + 3);
        };
        for (uint32_t v = 0; v < before; ++v) {
            done_.unused_vertices += !is_used[v];
            done_.joined_vertices += is_used[v] && keeper[v] == NONE;
            done_.split_vertices += is_split[v];
            if (keeper[v] != NONE) give_number(keeper[v]);
        }
        for (const uint32_t fan : extra) give_number(fan);
        mesh_.positions = std::move(positions);
        for (size_t c = 0; c < fan_.size(); ++c) mesh_.triangles[c] = number[fan_[c]];
    }

    // None, except where sheets that were separated at one edge meet again at both its ends.
    void count_crowded_edges() {
        if (!was_crowded_) return;
        const Groups sides = group_sides(mesh_.triangles, mesh_.vertex_count());
        for (size_t g = 0; g < sides.count(); ++g) done_.crowded_edges += sides.size_of(g) > 2;
    }

    TriangleMesh& mesh_;
    const bool joins_;
    const double distance_;
    Repairs done_;
    std::vector<uint32_t> corner_;
    std::vector<uint32_t> neighbor_; // of each side; NONE: it has none
    std::vector<std::pair<uint32_t, uint32_t>> pairs_;
    bool was_crowded_ = false;  // an edge had three or more triangles
    std::vector<uint32_t> fan_; // of each corner
};

std::string many(size_t count, const std::string& one, const std::string& several) {
    return std::to_string(count) + " " + (count == 1 ? one : several);
}

} // namespace

std::vector<std::string> Repairs::sentences() const {
    std::vector<std::string> said;
    const auto say = [&](size_t count, const std::string& before, const std::string& one, const std::string& several,
                         const std::string& after) {
        if (count > 0) said.push_back(before + many(count, one, several) + after);
    };
    say(joined_vertices, "joined ", "vertex", "vertices", " with others at the same points");
    say(repeated_vertex, "dropped ", "triangle", "triangles", " with a vertex or a point twice");
    say(duplicates, "dropped ", "duplicate triangle", "duplicate triangles", "");
    say(back_sides, "dropped ", "triangle", "triangles", " that listed a sheet from its other side");
    say(split_vertices, "split ", "vertex", "vertices", " where several sheets touched");
    say(cut_edges, "cut ", "edge", "edges", " where three or more sheets met that nothing pairs");
    say(turned_triangles, "turned ", "triangle", "triangles", " to the sense of the patch around");
    say(unused_vertices, "dropped ", "unused vertex", "unused vertices", "");
    say(crowded_edges, "left ", "edge", "edges", " with three or more triangles");
    say(one_sided_patches, "left ", "patch", "patches", " that cannot be oriented, as on a Moebius strip");
    return said;
}

Repairs repair(TriangleMesh& mesh, std::optional<double> join_points) { return Repair(mesh, join_points).go(); }

size_t drop_unused_vertices(TriangleMesh& mesh) {
    constexpr uint32_t unused = UINT32_MAX;
    std::vector<uint32_t> number(mesh.vertex_count(), unused), kept;
    for (const uint32_t v : mesh.triangles) number[v] = 0;
    for (uint32_t v = 0; v < number.size(); ++v) {
        if (number[v] == unused) continue;
        number[v] = static_cast<uint32_t>(kept.size());
        std::copy_n(&mesh.positions[size_t{3} * v], 3, &mesh.positions[3 * kept.size()]);
        kept.push_back(v);
    }
    const size_t dropped = number.size() - kept.size();
    if (dropped == 0) return 0;
    mesh.positions.resize(3 * kept.size());
    for (uint32_t& v : mesh.triangles) v = number[v];
    std::vector<uint32_t> same(mesh.triangle_count());
    for (uint32_t t = 0; t < same.size(); ++t) same[t] = t;
    mesh.origin.renumber(kept, same);
    return dropped;
}

} // namespace readers
