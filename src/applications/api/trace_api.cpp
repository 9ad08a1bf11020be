// applications.h: trace.
#include "../lines/check_lines.hpp"
#include "../lines/front_lines.hpp"
#include "../lines/trace.hpp"
#include "../cylinders/to_minimum.hpp"
#include "../../core/api/result.hpp"
#include "application_entry.hpp"

#include <algorithm>
#include <cmath>

using namespace hmf;

namespace {

hmf_status check_points(const hmf_trace_options& options, uint32_t triangle_count, Call& call) {
    if (options.point_count > 0 && (!options.point_triangles || !options.point_barycentrics))
        return call.fail(
            HMF_ERROR_NULL, HMF_ELEMENT_OPTION, 0,
            "point_triangles or point_barycentrics is NULL. Give one triangle and three coordinates for each point.");
    if (options.point_count > UINT32_MAX / 2)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There are too many points.");
    for (uint64_t i = 0; i < options.point_count; ++i) {
        if (options.point_triangles[i] >= triangle_count)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_NONE, i,
                             "Point %llu lies in triangle %u, which does not exist.",
                             static_cast<unsigned long long>(i), static_cast<unsigned>(options.point_triangles[i]));
        const double* b = options.point_barycentrics + 3 * i;
        const double sum = b[0] + b[1] + b[2];
        if (!(b[0] >= 0 && b[1] >= 0 && b[2] >= 0) || !(sum > 1 - 1e-6 && sum < 1 + 1e-6))
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_NONE, i,
                             "The barycentric coordinates of point %llu are negative, or their sum is not 1.",
                             static_cast<unsigned long long>(i));
    }
    return HMF_OK;
}

// length_limit is then in the unit of the positions inside.
hmf_status read_trace_options(const hmf_trace_options* options, const hmf_hierarchy& h, size_t level,
                              hmf_trace_options& all, Call& call) {
    if (read_options(options, all, "hmf_trace_options", call)) return call.status();
    if (!(all.spacing >= 0) || !(all.length_limit >= 0) || !std::isfinite(all.spacing)
        || !std::isfinite(all.length_limit))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "spacing and length_limit must be finite and not negative; 0 means none.");
    if (all.leaves < HMF_LEAVES_DEFAULT || all.leaves > HMF_LEAVES_CONJUGATE)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There are no leaves %d. Use HMF_LEAVES_*.",
                         static_cast<int>(all.leaves));
    if (check_points(all, h.shown_triangles(level), call)) return call.status();
    if (all.spacing == 0 && all.point_count == 0) all.critical = 1;
    if (all.leaves == HMF_LEAVES_CONJUGATE && all.length_limit == 0)
        all.length_limit = 10 * std::sqrt(surface_area(h.levels[level].mesh, h.levels[level].position, call.parallel));
    else if (all.length_limit > 0) all.length_limit = length_inside(h, all.length_limit);
    return HMF_OK;
}

// f(begin, end) for pieces of n points, with a report before each: lines can be far larger than the mesh.
template <class F>
Done in_pieces(size_t n, double fraction, Call& call, F f) {
    constexpr size_t piece = 8192;
    for (size_t first = 0; first < n; first += piece) {
        const auto block = [&](size_t begin, size_t end) { f(first + begin, first + end); };
        if (!call.pass(std::min(piece, n - first), fraction, block)) return false;
    }
    return true;
}

// A part of the points, so that the check costs little beside the lines and what they are made from.
hmf_status compare_points(const Lines& made, const Foliation& f, const double* position, LineCheck& found, Call& call) {
    const uint64_t most = f.mesh.edge_count / 64 + made.edges.size() / 128 + 1;
    if (check_lines(made, f, position, most, found, call)) return call.status();
    if (found.wrong == 0) return HMF_OK;
    return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                     "Leaves do not follow the foliation: %llu of %llu pairs of points that were compared do not lie "
                     "on one leaf. Please report it.",
                     static_cast<unsigned long long>(found.wrong), static_cast<unsigned long long>(found.pairs));
}

// By the heights of the cylinders, each has as many level sets as it should, and all of them close.
hmf_status count_levels(const Lines& made, const Cylinders& cylinders, double unit, double spacing, Call& call) {
    Array<uint32_t> count;
    if (!count.allocate_filled(call.memory, cylinders.list.size(), 0)) return call.out_of_memory();
    uint64_t open = 0, wrong = 0;
    for (const hmf_line& line : made.list) {
        if (line.kind != HMF_LINE_LEVEL) continue;
        ++count[line.cylinder];
        open += !line.closed && !made.limited(HUGE_VAL);
    }
    for (size_t c = 0; c < count.size(); ++c) {
        const double wanted = static_cast<double>(cylinders.list[c].height) * unit / spacing;
        wrong += std::fabs(std::max(wanted, 1.0) - count[c]) > 0.5 + 1e-9 * wanted;
    }
    if (open > 0)
        return call.fail(
            HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
            "%llu leaves do not close after 64 crossings of each edge. Pass values as the library returned "
            "them for loops.",
            static_cast<unsigned long long>(open));
    if (wrong == 0) return HMF_OK;
    return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                     "%llu cylinders have another number of leaves than their height asks for. Please report it.",
                     static_cast<unsigned long long>(wrong));
}

// Every conjugate line across a cylinder goes from side to side.
hmf_status check_across(const Lines& made, const Mesh& mesh, const FlatConeMetric& flat, const double* position,
                        const Array<double>& height, Call& call) {
    uint64_t wrong = 0;
    const uint64_t most = mesh.edge_count / 64 + made.edges.size() / 128 + 1;
    if (check_crossings(made, mesh, flat, position, height, most, wrong, call)) return call.status();
    if (wrong == 0) return HMF_OK;
    return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                     "Along %llu lines across cylinders u does not change by the height. Please report it.",
                     static_cast<unsigned long long>(wrong));
}

// Lines that are made, as the caller gets them.  f: what they follow, in this unit.
hmf_status hand_over_lines(const hmf_foliation& foliation, const Foliation& f, double unit, Lines& made, Call& call,
                           hmf_lines** out) {
    const hmf_hierarchy& h = *foliation.hierarchy;
    LineCheck found;
    if (compare_points(made, f, h.levels[foliation.level].position, found, call)) return call.status();
    if (foliation.level == 0) {
        Array<uint32_t> caller;
        if (inverse_numbers(h.edge_internal, h.input.edge_count, caller, call)) return call.status();
        const auto renumber = [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                made.edges[i] = made.edges[i] == NONE ? HMF_NONE : caller[made.edges[i]];
        };
        if (!in_pieces(made.edges.size(), 0.96, call, renumber)) return call.stopped();
        if (h.is_double() && keep_front(h, made, call)) return call.status();
    }
    for (hmf_line& line : made.list) line.length /= h.scale;
    hmf_lines lines{};
    lines.struct_size = sizeof lines;
    lines.line_count = made.list.size();
    lines.point_count = made.edges.size();
    lines.compared_count = found.pairs;
    lines.deviation = found.deviation * unit;
    ResultBlock block;
    block.array(lines, lines.lines, made.list.size(), made.list.data());
    block.array(lines, lines.offsets, made.offsets.size(), made.offsets.data());
    block.room(lines, lines.points, made.points.size());
    block.room(lines, lines.point_edges, made.edges.size());
    hmf_lines* const result = block.make(lines, h, call);
    if (!result) return call.status();
    // Leaves that pass all edges many times are far larger than the mesh: copied with reports between.
    double* const points = fill(result->points);
    uint32_t* const edges = fill(result->point_edges);
    const auto copy = [&](size_t begin, size_t end) {
        for (size_t i = 3 * begin; i < 3 * end; ++i) points[i] = made.points[i] / h.scale;
        std::copy(&made.edges[begin], &made.edges[begin] + (end - begin), edges + begin);
    };
    if (!in_pieces(made.edges.size(), 0.97, call, copy)) {
        free_block(result);
        return call.stopped();
    }
    *out = result;
    return HMF_OK;
}

} // namespace

extern "C" void hmf_trace_options_init(hmf_trace_options* options, uint32_t struct_size) {
    hmf_trace_options defaults{};
    defaults.leaves = HMF_LEAVES_FOLIATION;
    init_options(options, struct_size, defaults);
}

extern "C" hmf_status hmf_trace(const hmf_foliation* foliation, const hmf_trace_options* options,
                                const hmf_control* control, hmf_lines** out, hmf_error* error) {
    ApplicationEntry entry(foliation, control, error);
    Call& call = entry.call;
    if (entry.check(out)) return call.status();
    const Level& level = foliation->hierarchy->levels[foliation->level];
    hmf_trace_options all;
    if (read_trace_options(options, *foliation->hierarchy, foliation->level, all, call)) return call.status();
    Array<uint32_t> side;
    if (all.point_count > 0 && !side_of_triangles(*foliation->hierarchy, foliation->level, side, call))
        return call.stopped();
    if (all.leaves != HMF_LEAVES_CONJUGATE) {
        Leaves leaves;
        if (leaves.load(*foliation, call)) return call.status();
        Lines made(leaves.state.foliation, level.position, foliation->unit, all.length_limit, call);
        if (!made.start()) return call.out_of_memory();
        if (trace_leaves(all, side, leaves.cylinders, made, call)
            || (all.spacing > 0 && count_levels(made, leaves.cylinders, foliation->unit, all.spacing, call)))
            return call.status();
        return hand_over_lines(*foliation, leaves.state.foliation, foliation->unit, made, call, out) ? call.status()
                                                                                                     : entry.end();
    }
    ConjugateLevels levels;
    if (all.spacing > 0) {
        Leaves leaves;
        if (leaves.load(*foliation, call) || read_levels(leaves.state.foliation, leaves.cylinders, levels, call))
            return call.status();
    }
    FlatOf flat;
    State state; // becomes |dv|
    const auto improve = [&](State& solved, double& unit) { return to_minimum(solved, unit, call); };
    if (const hmf_status status = flat.find(*foliation, entry, HARMONIC_TOLERANCE, improve)) return status;
    for (double& height : levels.height) height *= foliation->unit / flat.unit;
    if (load_values(*foliation, foliation->level, state, call)) return call.status();
    Lines made(state.foliation, level.position, foliation->unit, all.length_limit, call);
    if (!made.start()) return call.out_of_memory();
    if (trace_conjugate(state.foliation, level.position, *flat.flat, flat.unit, all, side, levels, made, call)
        || check_across(made, state.foliation.mesh, *flat.flat, level.position, levels.height, call))
        return call.status();
    return hand_over_lines(*foliation, state.foliation, flat.unit, made, call, out) ? call.status() : entry.end();
}
