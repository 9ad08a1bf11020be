// Build of the hierarchy ([W] 4.1): arrays in -> validated mesh -> levels.
//
//   1  order in space, validate                             (mesh/spatial_order.cpp, mesh/validate.cpp)
//      a surface with boundary: its double, once more       (mesh/double_surface.cpp)
//   2  collapse and flip, level by level, keeping a log     (simplify.cpp, delaunay.cpp)
//   3  number everything by level                           (renumber.cpp)
//   4  replay the log backwards from the coarsest level and copy each level on
//      the way; what comes out at the end is the input mesh
//   5  make the input intrinsically Delaunay                (mesh/intrinsic.cpp)
//
// The levels are made by the reversal that interpolation uses, so they cannot
// disagree with it; step 2 keeps nothing but their positions and weights.  It
// works on a mesh that is dense after each level, so a coarse level fits into
// the caches.
#include "hierarchy.hpp"

#include "../mesh/intrinsic.hpp"
#include "../mesh/marked_vertices.hpp"
#include "../mesh/validate.hpp"
#include "../mesh/weights.hpp"
#include "delaunay.hpp"
#include "renumber.hpp"
#include "simplify.hpp"

#include <algorithm>
#include <type_traits>

namespace hmf {

namespace {

constexpr size_t MAX_LEVELS = 1024;

// Edge counts of the levels to come: by default down to the usual coarsest level, and from there on.
struct Schedule {
    double ratio;
    uint64_t vertices; // of the coarsest level to aim for
    uint64_t usual_edges, edges;

    Schedule(const BuildOptions& options, uint64_t genus, uint64_t vertex_count) : ratio(options.ratio) {
        vertices = coarsest_vertices(options, genus, vertex_count);
        edges = 3 * vertices + 6 * genus - 6;
        usual_edges = options.coarsest > 0 ? edges : 3 * std::max(vertices, USUAL_COARSEST) + 6 * genus - 6;
    }
    // 0: the level is the coarsest one.
    uint64_t next(uint64_t edge_count) const {
        const uint64_t target = next_towards(usual_edges, edge_count);
        return target > 0 ? target : next_towards(edges, edge_count);
    }

private:
    // 0: a last step of less than half the usual size is not made a level of its own.
    uint64_t next_towards(uint64_t last, uint64_t edge_count) const {
        if (edge_count <= last) return 0;
        const double step = ratio * static_cast<double>(edge_count);
        const uint64_t target = step < static_cast<double>(last) ? last : static_cast<uint64_t>(step);
        return static_cast<double>(target) > 0.5 * (1 + ratio) * static_cast<double>(edge_count) ? 0 : target;
    }
};

Done take_mesh(Arena& arena, uint32_t vertex_count, uint32_t edge_count, uint32_t face_count, Mesh& mesh) {
    mesh.vertex_count = vertex_count;
    mesh.edge_count = edge_count;
    mesh.face_count = face_count;
    return (mesh.origin = arena.take<uint32_t>(size_t{2} * edge_count))
        && (mesh.next = arena.take<uint32_t>(size_t{2} * edge_count))
        && (mesh.face = arena.take<uint32_t>(size_t{2} * edge_count))
        && (mesh.out = arena.take<uint32_t>(vertex_count));
}

// Copies the first elements, as many as the coarser of the two meshes has.
void copy_prefix(const Mesh& from, const Mesh& to, const Parallel& parallel) {
    const Mesh& coarser = from.edge_count < to.edge_count ? from : to;
    const size_t sides = size_t{2} * coarser.edge_count;
    parallel.copy(to.origin, from.origin, sides);
    parallel.copy(to.next, from.next, sides);
    parallel.copy(to.face, from.face, sides);
    parallel.copy(to.out, from.out, coarser.vertex_count);
}

class Builder {
public:
    Builder(hmf_hierarchy& h, const double* positions, size_t stride, const BuildOptions& options, Call& call) :
        h_(h), positions_(positions), stride_(stride), options_(options), call_(call), scratch_(h.memory) {}

    hmf_status check(size_t vertex_count, const uint32_t* triangles, size_t triangle_count) {
        only_checks_ = true;
        return load_surface(vertex_count, triangles, triangle_count);
    }

    hmf_status run(size_t vertex_count, const uint32_t* triangles, size_t triangle_count) {
        hmf_status status = load_surface(vertex_count, triangles, triangle_count);
        if (!status) status = coarsen();
        if (!status) status = number();
        if (!status) status = replay();
        if (!status) status = make_delaunay();
        return status;
    }

private:
    // Level 0 as the caller gave it; with boundary the double of it.
    hmf_status load_surface(size_t vertex_count, const uint32_t* triangles, size_t triangle_count) {
        Array<uint32_t> boundary;
        hmf_status status = load(vertex_count, triangles, triangle_count, boundary);
        const size_t sides = boundary.size();
        if (!status && sides > 0) status = load_double(vertex_count, triangles, triangle_count, boundary);
        h_.surface_vertices = static_cast<uint32_t>(vertex_count);
        h_.surface_triangles = static_cast<uint32_t>(triangle_count);
        h_.surface_edges = static_cast<uint32_t>((3 * triangle_count + sides) / 2);
        h_.boundary_count = doubling_.boundary_count;
        h_.surface_genus = sides == 0 ? h_.genus : (h_.genus + 1 - h_.boundary_count) / 2;
        return status;
    }

    // Sides with one triangle are left in `boundary`: then the double is to be loaded.
    hmf_status load(size_t vertex_count, const uint32_t* triangles, size_t triangle_count, Array<uint32_t>& boundary) {
        Arena& arena = h_.arena;
        vertex_count_ = static_cast<uint32_t>(vertex_count);
        face_count_ = static_cast<uint32_t>(triangle_count);
        edge_count_ = static_cast<uint32_t>((3 * triangle_count + 1) / 2); // of an odd number one side is left over
        const bool is_double = h_.mirror.triangle_count > 0;               // its triangles and mirror are there
        if ((!is_double && !(h_.triangle_vertices = arena.take<uint32_t>(3 * triangle_count)))
            || !(h_.triangle_edges = arena.take<uint32_t>(3 * triangle_count))
            || !(h_.vertex_internal = arena.take<uint32_t>(vertex_count))
            || !(input_position_ = arena.take<double>(3 * vertex_count)))
            return call_.out_of_memory();
        if (!is_double) std::memcpy(h_.triangle_vertices, triangles, 3 * triangle_count * sizeof(uint32_t));
        OrderedTriangles ordered;
        const CallerMesh caller = {h_.triangle_vertices, h_.vertex_internal, h_.mirror, doubling_.boundary_side.data()};
        hmf_status status =
            order_vertices(positions_, vertex_count, stride_, h_.vertex_internal, input_position_, h_.scale, call_);
        if (!status)
            status = put_marked_first(options_.marked_vertices, options_.marked_count, vertex_count, h_.vertex_internal,
                                      input_position_, call_);
        if (!status)
            status = order_triangles(h_.triangle_vertices, triangle_count, h_.vertex_internal, vertex_count,
                                     h_.triangle_edges, ordered, call_);
        if (status) return status;
        h_.input.marked_count = static_cast<uint32_t>(options_.marked_count);
        if (!take_mesh(arena, vertex_count_, edge_count_, face_count_, h_.input)
            || !work_.allocate(h_.memory, h_.input, options_.collapse == HMF_COLLAPSE_QSLIM))
            return call_.out_of_memory();
        work_.position = input_position_;
        work_.has_double_edges = is_double;
        uint32_t* const part = work_.link.data();
        uint32_t part_count = 0;
        if (options_.mollify <= 0) status = check_areas(ordered, work_.position, caller, call_);
        if (!status) status = match_sides(ordered, caller, work_.mesh, work_.degree, part, part_count, boundary, call_);
        if (!status && !boundary.empty()) return HMF_OK;
        if (!status) status = check_connection(work_.mesh, work_.degree, caller, part, part_count, call_);
        if (status) return status;
        const int64_t euler = static_cast<int64_t>(vertex_count_) - edge_count_ + face_count_;
        h_.genus = static_cast<uint32_t>((2 - euler) / 2);
        if (check_genus()) return call_.status();
        if (only_checks_) return HMF_OK;
        if (!(h_.edge_internal = arena.take<uint32_t>(edge_count_))) return call_.out_of_memory();
        status = number_edges(ordered, work_.mesh, h_.triangle_edges, h_.edge_internal, work_.link.data(), call_);
        if (status) return status;
        // Now, while triangles that are close together have close numbers.
        if (!(weight_ = arena.take<double>(edge_count_))) return call_.out_of_memory();
        if (!call_.tick(0.17)) return HMF_CANCELLED;
        if (options_.has_weights) {
            status = measure_input(work_.mesh, work_.position, ordered.words.data());
            if (status) return status;
            is_delaunay_ = is_delaunay(work_.mesh, weight_, call_.parallel);
            if (is_delaunay_) metric_ = Metric();
        } else { // as if it were Delaunay
            std::memset(weight_, 0, edge_count_ * sizeof(double));
            is_delaunay_ = true;
        }
        if (options_.collapse == HMF_COLLAPSE_QSLIM) initial_quadrics(work_);
        return call_.tick(0.2) ? HMF_OK : HMF_CANCELLED;
    }

    // From the surface to its double, once all that is wrong with its edges has been found.
    hmf_status load_double(size_t vertex_count, const uint32_t* triangles, size_t triangle_count,
                           const Array<uint32_t>& boundary) {
        work_ = WorkMesh();
        h_.arena.clear();
        uint32_t* const mirror = h_.arena.take<uint32_t>(vertex_count);
        if (!mirror || !(h_.triangle_vertices = h_.arena.take<uint32_t>(6 * triangle_count)))
            return call_.out_of_memory();
        std::memcpy(h_.triangle_vertices, triangles, 3 * triangle_count * sizeof(uint32_t));
        const hmf_status status =
            double_surface(positions_, vertex_count, stride_, h_.triangle_vertices, triangle_count, boundary,
                           options_.marked_vertices, options_.marked_count, mirror, doubling_, call_);
        if (status) return status;
        h_.mirror = {static_cast<uint32_t>(vertex_count), static_cast<uint32_t>(triangle_count), mirror};
        positions_ = doubling_.positions.data();
        stride_ = 0;
        options_.marked_vertices = doubling_.marked.data();
        options_.marked_count = doubling_.marked_count;
        Array<uint32_t> none;
        const hmf_status loaded = load(doubling_.vertex_count, nullptr, 2 * triangle_count, none);
        doubling_.boundary_side.release();
        return loaded;
    }

    hmf_status check_genus() {
        if (h_.genus > 0 || options_.marked_count >= 4 || options_.sphere_allowed) return HMF_OK;
        if (h_.mirror.triangle_count > 0)
            return call_.fail(
                HMF_ERROR_MESH_GENUS, HMF_ELEMENT_NONE, 0,
                "The surface is a disk (genus 0, one boundary) with too few marked vertices to carry a "
                "measured foliation. Mark four vertices of the boundary or two inside; one inside counts as "
                "two of the boundary.");
        return call_.fail(HMF_ERROR_MESH_GENUS, HMF_ELEMENT_NONE, 0,
                          "The surface is a sphere (genus 0) with %u marked vertices, which carries no measured "
                          "foliation. Mark four vertices or more, or use a surface of genus 1 or more.",
                          static_cast<unsigned>(options_.marked_count));
    }

    // The next level, without its geometry.
    Done begin_level(uint32_t vertex_count, uint32_t edge_count, uint32_t face_count) {
        Level level;
        level.mesh.marked_count = h_.input.marked_count;
        level.mesh.vertex_count = vertex_count;
        level.mesh.edge_count = edge_count;
        level.mesh.face_count = face_count;
        return levels_.push(level);
    }

    // From the finest level so far to a coarser one of about `target` edges: collapses, numbers, flips.
    hmf_status make_coarser(uint64_t target, uint32_t minimum) {
        const double total = edge_count_;
        const double from = 0.6 - 0.4 * work_.mesh.edge_count / total,
                     to = 0.6 - 0.4 * static_cast<double>(target) / total, middle = 0.5 * (from + to);
        Level& finer = levels_.back();
        const uint32_t edges_before = work_.mesh.edge_count;
        finer.collapse_begin = collapse_count_;
        finer.run_begin = runs_.size();
        Numbering numbering;
        if (!(numbering.vertex = scratch_.take<uint32_t>(work_.vertex_end))
            || !(numbering.edge = scratch_.take<uint32_t>(work_.edge_end))
            || !(numbering.face = scratch_.take<uint32_t>(work_.face_end)))
            return call_.out_of_memory();
        hmf_status status = collapse_level(work_, options_.collapse, static_cast<uint32_t>(target), minimum,
                                           h_.collapses, collapse_count_, runs_, numbering.edge, call_, from, middle);
        if (status) return status;
        finer.run_end = runs_.size();
        finer.collapse_end = collapse_count_;
        if (work_.mesh.edge_count == edges_before) return HMF_OK;
        if (!numberings_.push(numbering)) return call_.out_of_memory();
        number_level(work_, h_.collapses + finer.collapse_begin, finer.collapse_end - finer.collapse_begin, numbering,
                     call_.parallel);
        compact(work_, numbering, call_.parallel);
        finer.flip_begin = flips_.size();
        status = delaunay_flips(work_, flips_, call_, middle);
        if (status) return status;
        finer.flip_end = flips_.size();
        if (!begin_level(work_.mesh.vertex_count, work_.mesh.edge_count, work_.mesh.face_count))
            return call_.out_of_memory();
        return keep_geometry(levels_.back(), to);
    }

    hmf_status coarsen() {
        const Schedule schedule(options_, h_.genus, vertex_count_);
        levels_.start(h_.memory);
        flips_.start(h_.memory);
        runs_.start(h_.memory);
        numberings_.start(h_.memory);
        const uint32_t minimum =
            schedule.vertices < vertex_count_ ? static_cast<uint32_t>(schedule.vertices) : vertex_count_;
        if (!begin_level(vertex_count_, edge_count_, face_count_)
            || !(h_.collapses = h_.arena.take<Collapse>(vertex_count_ - minimum)))
            return call_.out_of_memory();
        while (levels_.size() < MAX_LEVELS) {
            const size_t levels_before = levels_.size();
            const uint64_t target = schedule.next(work_.mesh.edge_count);
            if (target == 0) break;
            if (const hmf_status status = make_coarser(target, minimum)) return status;
            if (levels_.size() == levels_before) break;
            if (work_.mesh.edge_count > target + 3 && work_.mesh.vertex_count > minimum) break; // stuck
        }
        if (levels_.size() > 1) { // the coarsest level has its final numbers
            Mesh& coarsest = levels_.back().mesh;
            if (!take_mesh(h_.arena, work_.mesh.vertex_count, work_.mesh.edge_count, work_.mesh.face_count, coarsest))
                return call_.out_of_memory();
            copy_prefix(work_.mesh, coarsest, call_.parallel);
        }
        work_ = WorkMesh();
        return HMF_OK;
    }

    // Positions and weights of the level that the working mesh is, in its numbers.
    hmf_status keep_geometry(Level& level, double fraction) {
        const size_t coordinates = size_t{3} * level.mesh.vertex_count;
        if (!(level.position = h_.arena.take<double>(coordinates))
            || !(level.weight = h_.arena.take<double>(level.mesh.edge_count)))
            return call_.out_of_memory();
        call_.parallel.for_blocks(coordinates, [&](size_t begin, size_t end) {
            std::memcpy(level.position + begin, work_.position + begin, (end - begin) * sizeof(double));
        });
        const hmf_status status = cotangent_sums(work_.mesh, work_.position, level.weight, call_, fraction);
        if (!status) level.raised_count = clamp_weights(work_.mesh, COARSE_WEIGHTS, level.weight, call_.parallel);
        return status;
    }

    // From the numbers of each level to the final ones, from coarse to fine.
    hmf_status number() {
        h_.level_count = levels_.size();
        if (!(h_.levels = h_.arena.take<Level>(levels_.size())) || !(h_.flips = h_.arena.take<uint32_t>(flips_.size())))
            return call_.out_of_memory();
        for (size_t k = 0; k < levels_.size(); ++k) h_.levels[k] = levels_[k];
        h_.levels[0].weight = weight_;
        if (!flips_.empty()) std::memcpy(h_.flips, flips_.data(), flips_.size() * sizeof(uint32_t));
        flips_.release();
        if (!(h_.collapse_runs = h_.arena.take<CollapseRun>(runs_.size()))) return call_.out_of_memory();
        if (!runs_.empty()) std::memcpy(h_.collapse_runs, runs_.data(), runs_.size() * sizeof(CollapseRun));
        runs_.release();
        if (h_.level_count == 1) return HMF_OK;
        Array<double> copy;
        const size_t largest = metric_.square.empty() ? edge_count_ : 2 * size_t{edge_count_};
        if (!copy.allocate(h_.memory, largest)) return call_.out_of_memory();
        // Some values for each element, as a std::integral_constant.
        const auto permute = [&](double* value, size_t count, auto values, const uint32_t* number) {
            constexpr size_t width = values;
            call_.parallel.copy(copy.data(), value, width * count);
            const double* const from = copy.data();
            call_.parallel.for_blocks(count, [=](size_t begin, size_t end) {
                for (size_t x = begin; x < end; ++x)
                    for (size_t c = 0; c < width; ++c) value[width * number[x] + c] = from[width * x + c];
            });
        };
        constexpr std::integral_constant<size_t, 1> one;
        constexpr std::integral_constant<size_t, 2> two;
        constexpr std::integral_constant<size_t, 3> three;
        for (size_t k = h_.level_count - 1; k-- > 0;) {
            const Level& level = h_.levels[k];
            const Numbering& numbers = numberings_[k];
            if (k + 1 < numberings_.size()) {
                // Flips come after the collapses, in the numbers of the coarser level.
                const Numbering& coarser = numberings_[k + 1];
                compose(level, numbers, h_.levels[k + 1], coarser, call_.parallel);
                for (size_t n = level.flip_begin; n < level.flip_end; ++n) h_.flips[n] = coarser.edge[h_.flips[n]];
            }
            if (!call_.tick(0.65 - 0.05 * level.mesh.edge_count / edge_count_)) return HMF_CANCELLED;
            renumber_collapses(h_.collapses + level.collapse_begin, level.collapse_end - level.collapse_begin, numbers,
                               call_.parallel);
            if (!call_.tick(0.65 - 0.05 * level.mesh.edge_count / edge_count_)) return HMF_CANCELLED;
            permute(level.weight, level.mesh.edge_count, one, numbers.edge);
            if (k > 0) permute(level.position, level.mesh.vertex_count, three, numbers.vertex);
        }
        const Numbering& finest = numberings_[0];
        if (!is_delaunay_) {
            permute(metric_.length.data(), edge_count_, one, finest.edge);
            permute(metric_.four_areas.data(), face_count_, one, finest.face);
            const auto permute_fine = [&](Array<TwoDoubles>& value, const uint32_t* number) {
                if (!value.empty()) permute(&value.data()->high, value.size(), two, number);
            };
            permute_fine(metric_.square, finest.edge);
            permute_fine(metric_.fine_area, finest.face);
        }
        const auto renumber_edges = [&](size_t begin, size_t end) {
            for (size_t e = begin; e < end; ++e) h_.edge_internal[e] = finest.edge[h_.edge_internal[e]];
        };
        const auto renumber_vertices = [&](size_t begin, size_t end) {
            for (size_t v = begin; v < end; ++v) h_.vertex_internal[v] = finest.vertex[h_.vertex_internal[v]];
        };
        if (!call_.pass(edge_count_, 0.65, renumber_edges) || !call_.pass(vertex_count_, 0.65, renumber_vertices))
            return HMF_CANCELLED;
        return HMF_OK;
    }

    hmf_status replay() {
        scratch_.clear();
        const size_t last = h_.level_count - 1;
        Mesh& mesh = h_.input; // its first elements are the coarsest level
        for (size_t k = last; k > 0; --k) {
            Level& level = h_.levels[k];
            const Level& finer = h_.levels[k - 1];
            if (k < last) {
                if (!take_mesh(h_.arena, level.mesh.vertex_count, level.mesh.edge_count, level.mesh.face_count,
                               level.mesh))
                    return call_.out_of_memory();
                copy_prefix(mesh, level.mesh, call_.parallel);
            }
            const double fraction = 0.65 + 0.2 * (1 - static_cast<double>(level.mesh.edge_count) / edge_count_);
            for (size_t n = finer.flip_end; n-- > finer.flip_begin;) {
                if (n % 65536 == 0 && !call_.tick(fraction)) return HMF_CANCELLED;
                unflip(mesh, h_.flips[n]);
            }
            const auto undo = [&](size_t n, size_t begin) {
                prefetch_split(mesh, h_.collapses, n, begin);
                split(mesh, h_.collapses[n]);
            };
            if (!undo_collapses(h_, finer, call_, fraction, false, undo)) return HMF_CANCELLED;
        }
        const auto place = [&](size_t begin, size_t end) {
            for (size_t v = begin; v < end; ++v)
                for (size_t c = 0; c < 3; ++c)
                    input_position_[3 * size_t{h_.vertex_internal[v]} + c] =
                        position_at(positions_, stride_, v)[c] * h_.scale;
        };
        if (!call_.pass(vertex_count_, 0.85, place)) return HMF_CANCELLED;
        h_.levels[0].position = input_position_;
        return HMF_OK;
    }

    // Metric of the input, and sums of cotangents for the weights of level 0.
    hmf_status measure_input(const Mesh& mesh, const double* position, const uint32_t* sides) {
        if (!measure(mesh, position, sides, metric_, weight_, call_)
            || (options_.mollify > 0 && !mollify(mesh, options_.mollify, metric_, weight_, call_))
            || !measure_thin(mesh, options_.mollify > 0 ? nullptr : position, metric_, weight_, call_))
            return call_.stopped();
        for (const double area : metric_.four_areas)
            if (!(area > 0)) // all points are one
                return call_.fail(HMF_ERROR_MESH_DEGENERATE, HMF_ELEMENT_NONE, 0,
                                  "The mesh has no extent. Check the positions.");
        return HMF_OK;
    }

    // From the input to level 0, with the log of the flips.
    hmf_status flip_input() {
        Level& level = h_.levels[0];
        // A log that grows would need three times its room.  Few flips fit into
        // this one; of many it gives the number, and a second run writes them.
        Array<uint32_t> few;
        if (!few.allocate(h_.memory, edge_count_ / 4)) return call_.out_of_memory();
        FlipLog log = {few.data(), few.size(), 0};
        hmf_status status = intrinsic_delaunay(level.mesh, metric_, weight_, log, call_, 0.9, 0.93);
        if (status) return status;
        if (log.count <= few.size()) {
            if (!(h_.intrinsic_flips = h_.arena.take<uint32_t>(log.count))) return call_.out_of_memory();
            std::memcpy(h_.intrinsic_flips, few.data(), log.count * sizeof(uint32_t));
        }
        few.release();
        // Areas measured in other numbers may round differently, and then
        // the second run makes other flips; a third one repeats it.
        for (double at = 0.93; log.count > log.capacity; at += 0.02) {
            log = {h_.arena.take<uint32_t>(log.count), log.count, 0};
            if (!log.edges) return call_.out_of_memory();
            h_.intrinsic_flips = log.edges;
            copy_prefix(h_.input, level.mesh, call_.parallel);
            status = measure_input(h_.input, level.position, nullptr);
            if (!status) status = intrinsic_delaunay(level.mesh, metric_, weight_, log, call_, at, at + 0.02);
            if (status) return status;
        }
        h_.intrinsic_flip_count = log.count;
        uint32_t bad = NONE;
        log.edges = h_.intrinsic_flips;
        if (!find_bad_flip(level.mesh, metric_, weight_, log, call_, 0.98, bad)) return call_.stopped();
        return bad == NONE ? HMF_OK : not_delaunay(1);
    }

    hmf_status not_delaunay(uint64_t edges) {
        return call_.fail(
            HMF_ERROR_MESH_NOT_DELAUNAY, HMF_ELEMENT_NONE, 0,
            "The intrinsic Delaunay triangulation of the mesh was not reached (edges left: %llu). Remesh the "
            "surface with fewer long thin triangles, or raise mollify.",
            static_cast<unsigned long long>(edges));
    }

    hmf_status make_delaunay() {
        Level& level = h_.levels[0];
        level.mesh = h_.input;
        if (!is_delaunay_) {
            if (!take_mesh(h_.arena, vertex_count_, edge_count_, face_count_, level.mesh)) return call_.out_of_memory();
            copy_prefix(h_.input, level.mesh, call_.parallel);
            if (const hmf_status status = flip_input()) return status;
        }
        level.raised_count = clamp_weights(level.mesh, INTRINSIC_WEIGHTS, weight_, call_.parallel);
        if (level.raised_count > 0) return not_delaunay(level.raised_count);
        return call_.tick(0.99) ? HMF_OK : HMF_CANCELLED;
    }

    hmf_hierarchy& h_;
    const double* positions_;
    size_t stride_;
    BuildOptions options_; // marked vertices: those of the double
    Call& call_;
    Doubling doubling_;
    uint32_t vertex_count_ = 0, edge_count_ = 0, face_count_ = 0;
    double* input_position_ = nullptr; // of the working mesh; in the end, the caller's in internal order
    WorkMesh work_;                    // lies in the arrays of h_.input
    Array<Level> levels_;
    Array<uint32_t> flips_;
    Array<CollapseRun> runs_;
    double* weight_ = nullptr; // of level 0: sums of cotangents first
    Metric metric_;            // of the input; empty if it is Delaunay
    bool is_delaunay_ = false, only_checks_ = false;
    Arena scratch_;               // of the numberings
    Array<Numbering> numberings_; // of all levels but the coarsest: level k -> k + 1 first, then to the final numbers
    size_t collapse_count_ = 0;
};

} // namespace

// What the caller sees of a hierarchy that has been built.
static Done write_info(hmf_hierarchy& h) {
    hmf_level_info* const levels = h.arena.take<hmf_level_info>(h.level_count);
    if (!levels) return false;
    for (size_t k = 0; k < h.level_count; ++k)
        levels[k] = {h.shown_vertices(k), h.shown_edges(k), h.shown_triangles(k), h.levels[k].raised_count};
    h.info = {h.level_count, h.surface_genus, h.boundary_count, 0, levels};
    return true;
}

hmf_status build_hierarchy(hmf_hierarchy& hierarchy, const double* positions, size_t vertex_count,
                           size_t position_stride, const uint32_t* triangles, size_t triangle_count,
                           const BuildOptions& options, Call& call) {
    hmf_status status = validate_arguments(positions, vertex_count, position_stride, triangles, triangle_count, call);
    if (status) return status;
    if (!call.tick(0)) status = HMF_CANCELLED;
    if (!status) {
        hierarchy.made_with = options;
        hierarchy.made_with.marked_vertices = nullptr;
        Builder builder(hierarchy, positions, position_stride, options, call);
        status = builder.run(vertex_count, triangles, triangle_count);
        if (!status && !write_info(hierarchy)) status = call.out_of_memory();
    }
    if (status == HMF_CANCELLED) return call.was_cancelled();
    return status;
}

hmf_status check_surface(hmf_hierarchy& hierarchy, const double* positions, size_t vertex_count,
                         const uint32_t* triangles, size_t triangle_count, const BuildOptions& options, Call& call) {
    Builder builder(hierarchy, positions, 0, options, call);
    const hmf_status status = builder.check(vertex_count, triangles, triangle_count);
    return status == HMF_CANCELLED ? call.was_cancelled() : status;
}

uint64_t coarsest_vertices(const BuildOptions& options, uint64_t genus, uint64_t vertex_count) {
    // The share is measured: bench/steering.md.
    constexpr uint64_t least_share = 16;
    const uint64_t wanted =
        options.coarsest > 0 ? options.coarsest : std::min(vertex_count / least_share, USUAL_COARSEST);
    const uint64_t least = std::max<uint64_t>(40 * genus + 10 * options.marked_count, 4);
    return std::min<uint64_t>(std::max(wanted, least), NONE / 3);
}

uint64_t build_memory_bound(size_t vertex_count, size_t triangle_count, const BuildOptions& options) {
    const uint64_t V = vertex_count, F = triangle_count, E = F + F / 2;
    const uint64_t genus = 2 + E > V + F ? (2 + E - V - F) / 2 : 0;
    const Schedule schedule(options, genus, V);
    // Edges of all coarse levels together; a level that gets stuck is almost
    // as large as the finer one.
    uint64_t sum = 0, coarse = 0, edges = E;
    for (size_t n = 1; n < MAX_LEVELS; ++n) {
        const uint64_t target = schedule.next(edges);
        if (target == 0) break;
        coarse = std::max(coarse, sum + edges);
        sum += target;
        coarse = std::max(coarse, sum);
        edges = target;
    }
    const uint64_t coarse_vertices = coarse / 3 + MAX_LEVELS;
    const uint64_t records = V > schedule.vertices ? V - schedule.vertices : 0;
    const uint64_t slack = 131072 + MAX_LEVELS * (2 * sizeof(Level) + sizeof(hmf_level_info) + 8 * 32);
    const uint64_t input = 24 * F + 4 * V + 4 * E + 8 * E; // the caller's triangles, the maps, weights of level 0
    const uint64_t metric = 24 * (E + F);                  // to 31 digits where triangles are thin
    // A polygon of all triangles, while flat polygons are triangulated.
    const uint64_t polygons = 200 * F + E + V;
    const bool has_blocks = V >> (WorkMesh::SMALLEST_BLOCK_SHIFT + 1) > 0;
    const uint64_t queues = 4 * BucketQueue::BUCKETS * (has_blocks ? WorkMesh::MOST_BLOCKS + 1 : 1);
    const uint64_t work = 30 * E + 34 * V + queues + (options.collapse == HMF_COLLAPSE_QSLIM ? sizeof(Quadric) * V : 0);
    // Of a group a run for each block and one alone after it, while their array grows by doubling.
    const uint64_t groups = has_blocks ? records / WorkMesh::LEAST_GROUP : 0;
    const uint64_t runs = 3 * sizeof(CollapseRun) * (groups * (WorkMesh::MOST_BLOCKS + 1) + MAX_LEVELS);
    const uint64_t log = sizeof(Collapse) * records + runs;
    const uint64_t flips = 4 * COARSE_FLIPS_PER_EDGE * coarse;
    const uint64_t geometry = 8 * coarse + 24 * coarse_vertices; // weights and positions of the coarse levels
    const uint64_t numberings = 8 * (E + coarse);                // V + F is E, but for the genus
    const uint64_t mesh = 24 * E + 4 * V, coarse_meshes = 24 * coarse + 4 * coarse_vertices;
    const uint64_t ordering = input + 40 * V; // positions, and the two lists of the sort
    // Ordered triangles and the metric.  12 V: before unused vertices are refused,
    // there may be more of them than edges.
    const uint64_t loading = input + work + 16 * F + 12 * V + metric + 8 * E; // 8: of the sums of cotangents
    // The log of flips grows by doubling: three times its length while it does.
    const uint64_t coarsening = input + work + metric + log + 3 * flips + geometry + numberings + mesh + 8 * coarse;
    const uint64_t numbering =
        input + metric + log + 3 * flips + geometry + numberings + coarse_meshes + mesh + 24 * V + 8 * E;
    const uint64_t replaying = input + metric + log + flips + geometry + coarse_meshes + mesh + 24 * V;
    const uint64_t finishing = replaying + mesh + 4 * E + 8 * E + E + 4 * INTRINSIC_FLIPS_PER_EDGE * E + polygons;
    uint64_t bound = ordering;
    const uint64_t stages[4] = {loading, coarsening, numbering, finishing};
    for (const uint64_t stage : stages) bound = std::max(bound, stage);
    return bound + slack;
}

} // namespace hmf
