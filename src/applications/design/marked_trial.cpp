// The scale of a foliation depends smoothly on the weights: the signs of the
// local potentials stay, and the equations are linear.  With n_c(e) = how often
// a leaf of cylinder c crosses edge e, a little more weight w_c makes
//
//     F'_ij = F_ij + n_c(ij) dw - s_ij d_i - s_ji d_j      (twisted_model.hpp)
//
// and d minimizes the energy: one linear solve for each loop, all with the same
// matrix.  The derivative of the log scale of a triangle is exact except near the zeros, which are fixed.
#include "marked_trial.hpp"

#include "../../core/base/nearest_first.hpp"
#include "../loops/dual_length.hpp"
#include "../loops/library_loops.hpp"
#include "../../core/mesh/weights.hpp"
#include "../../core/solve/twisted_model.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr int64_t LABELS = 4096;              // low bits of the weights in integers: the number of the loop
constexpr int64_t LARGEST = int64_t{1} << 40; // weight in integers
constexpr double LEAST_GUESS = 0.02;          // of a weight, where the largest is 1
constexpr double LINEAR_ACCURACY = 1e-2;
constexpr uint32_t LINEAR_ITERATIONS = 12;
constexpr double STEEPEST = 8; // largest derivative that is used

// Twice the area of the face left of h.
double twice_area(const Mesh& mesh, const double* position, uint32_t h) {
    const double *p = position + size_t{3} * mesh.origin[h], *q = position + size_t{3} * mesh.target(h),
                 *r = position + size_t{3} * mesh.origin[mesh.prev(h)];
    double cross[3];
    for (size_t c = 0; c < 3; ++c) {
        const size_t x = (c + 1) % 3, y = (c + 2) % 3;
        cross[c] = (q[x] - p[x]) * (r[y] - p[y]) - (q[y] - p[y]) * (r[x] - p[x]);
    }
    return std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
}

} // namespace

int32_t MarkedTrial::pass_on(void* user, double) {
    const Progress& progress = *static_cast<const Progress*>(user);
    return progress.call.tick(progress.fraction) ? HMF_PROGRESS_CONTINUE : HMF_PROGRESS_CANCEL;
}

MarkedTrial::MarkedTrial(const hmf_hierarchy& like, Call& call, const double& fraction) :
    outer_(call), progress_{call, fraction}, h_(like, call.memory), call_(h_.memory, &error_, pass_on, &progress_) {}

hmf_status MarkedTrial::failed(Call& inner) {
    usable_ = false;
    const bool untold = inner.status() == HMF_OK; // an array did not get its room
    const hmf_status status = untold ? inner.out_of_memory() : inner.status();
    if (inner.cancelled() || outer_.cancelled()) return outer_.was_cancelled();
    if (status == HMF_ERROR_MEMORY || status == HMF_ERROR_MEMORY_LIMIT)
        return outer_.fail(status, HMF_ELEMENT_NONE, 0,
                           "The search for an even design needs more memory. Free some, or raise memory_limit.");
    return HMF_OK;
}

hmf_status MarkedTrial::start(const TrialMesh& surface, const Array<uint32_t>& marks, int32_t kind, Loops& loops) {
    BuildOptions options;
    options.coarsest = 250;
    options.marked_vertices = marks.data();
    options.marked_count = marks.size();
    options.mollify = 1e-6; // thin triangles of a coarse level
    if (build_hierarchy(h_, surface.position.data(), surface.vertex_count(), 0, surface.triangles.data(),
                        surface.triangles.size() / 3, options, call_))
        return failed(call_);
    if (loops.count() > 0) {
        if (!loops_.copy_from(loops, call_.memory)) return failed(call_);
    } else {
        if (library_loops(h_, h_.level_count - 1, kind, call_, loops_, LoopCare::quick)) return failed(call_);
        if (!loops.copy_from(loops_, outer_.memory)) return outer_.out_of_memory();
    }
    if (loops_.count() == 0 || loops_.count() >= static_cast<size_t>(LABELS)) return HMF_OK;
    if (!weights.allocate(call_.memory, loops_.count()) || !guess_weights() || !state_.allocate(h_, 0, call_.memory)
        || !solved_.allocate(call_.memory, h_.input.edge_count)
        || !input_values_.allocate(call_.memory, h_.input.edge_count)
        || !integer_weights_.allocate(call_.memory, loops_.count()))
        return failed(call_);
    usable_ = true;
    return HMF_OK;
}

// For each face the loop that is nearest along paths of faces.  side: a half-edge of each face.
Done MarkedTrial::find_nearest_loops(const DualLength& dual, const Array<uint32_t>& side, Array<uint32_t>& nearest) {
    const Mesh& mesh = loop_mesh(h_, h_.level_count - 1);
    Array<double> distance;
    NearestFirst heap;
    heap.start(call_.memory);
    if (!distance.allocate_filled(call_.memory, mesh.face_count, HUGE_VAL)
        || !nearest.allocate_filled(call_.memory, mesh.face_count, NONE))
        return false;
    for (uint32_t c = 0; c < loops_.count(); ++c)
        for (uint64_t i = loops_.offsets[c]; i < loops_.offsets[c + 1]; ++i) {
            const uint32_t t = mesh.face[loops_.crossings[i]];
            if (nearest[t] != NONE) continue;
            nearest[t] = c;
            distance[t] = 0;
            if (!heap.push({0, t})) return false;
        }
    while (!heap.empty()) {
        const NearestFirst::Entry top = heap.pop();
        if (top.distance > distance[top.item]) continue;
        uint32_t h = side[top.item];
        for (int i = 0; i < 3; ++i, h = mesh.next[h]) {
            const uint32_t t = mesh.face[twin(h)];
            const double d = top.distance + dual(edge_of(h));
            if (!(d < distance[t])) continue;
            distance[t] = d;
            nearest[t] = nearest[top.item];
            if (!heap.push({d, t})) return false;
        }
    }
    return true;
}

// The height of a cylinder that covers what is nearest to its loop: area / length.
Done MarkedTrial::guess_weights() {
    const size_t coarsest = h_.level_count - 1, n = loops_.count();
    const Mesh& mesh = loop_mesh(h_, coarsest);
    const double* position = h_.levels[coarsest].position;
    const DualLength dual(mesh, position);
    Array<double> length, area; // area: twice
    Array<uint32_t> side, nearest;
    if (!length.allocate_filled(call_.memory, n, 0.0) || !area.allocate_filled(call_.memory, n, 0.0)
        || !side.allocate(call_.memory, mesh.face_count))
        return false;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) side[mesh.face[h]] = h;
    if (!find_nearest_loops(dual, side, nearest)) return false;

    for (size_t c = 0; c < n; ++c)
        for (uint64_t i = loops_.offsets[c]; i < loops_.offsets[c + 1]; ++i)
            length[c] += dual(edge_of(loops_.crossings[i]));
    for (uint32_t t = 0; t < mesh.face_count; ++t)
        if (nearest[t] != NONE) area[nearest[t]] += twice_area(mesh, position, side[t]);
    double largest = 0;
    for (size_t c = 0; c < n; ++c) {
        weights[c] = length[c] > 0 ? area[c] / length[c] : 0;
        largest = std::max(largest, weights[c]);
    }
    for (double& w : weights) w = largest > 0 ? std::max(w / largest, LEAST_GUESS) : 1;
    return true;
}

hmf_status MarkedTrial::solve() {
    if (!usable_) return HMF_OK;
    const size_t coarsest = h_.level_count - 1;
    double largest = 0;
    for (const double w : weights) largest = std::max(largest, w);
    for (size_t c = 0; c < weights.size(); ++c) {
        integer_weights_[c] = 0;
        if (weights[c] == 0) continue; // a loop that is left out
        if (weights[c] * LARGEST_WEIGHT_RATIO < largest) weights[c] = largest / LARGEST_WEIGHT_RATIO;
        const int64_t w = static_cast<int64_t>(weights[c] / largest * static_cast<double>(LARGEST));
        integer_weights_[c] = w / LABELS * LABELS + static_cast<int64_t>(c);
    }
    state_.load(coarsest, Triangulation::input);
    initial_foliation(state_.foliation.mesh, loops_, integer_weights_.data(), state_.foliation.value);
    if (coarsest == 0 && !state_.to_intrinsic(call_)) return failed(call_);
    SolveLog log(false, call_, 1);
    SolveOptions options;
    options.tolerance = 1e-4;
    const hmf_status status = run_cascade(state_, options, call_, log);
    if (call_.cancelled() || outer_.cancelled() || status >= HMF_ERROR_NULL) return failed(call_);
    factor_ = 1 / log.unit();
    const Mesh& mesh = state_.foliation.mesh;
    const size_t bytes = mesh.edge_count * sizeof(int64_t);
    std::memcpy(solved_.data(), state_.foliation.value, bytes);
    if (!state_.to_input(call_)) return failed(call_);
    std::memcpy(input_values_.data(), state_.foliation.value, bytes);
    if (!scale_.measure(h_.input, h_.levels[0].position, input_values_.data(),
                        log.unit() / static_cast<double>(LARGEST), call_.memory))
        return failed(call_);
    return HMF_OK;
}

// How often a leaf in the middle of each cylinder crosses the edges: lists with
// repetitions, in the order of the loops.  state_ is on the intrinsic side.
hmf_status MarkedTrial::count_crossings(Array<uint32_t>& offsets, Array<uint32_t>& edges, bool& known) {
    known = false;
    const size_t n = weights.size();
    Cylinders cylinders;
    Array<uint32_t> of_loop;
    Array<Crossing> leaf;
    if (!of_loop.allocate_filled(call_.memory, n, NONE)) return failed(call_);
    offsets.start(call_.memory);
    edges.start(call_.memory);
    leaf.start(call_.memory);
    hmf_error error{};
    Call part(call_.memory, &error, pass_on, &progress_); // what fails here is no defect of the trial
    Foliation& f = state_.foliation;
    if (cylinders.build(f, nullptr, nullptr, part)) {
        const bool fatal =
            part.status() == HMF_ERROR_MEMORY || part.status() == HMF_ERROR_MEMORY_LIMIT || part.cancelled();
        return fatal ? failed(part) : HMF_OK;
    }
    if (cylinders.list.size() != n) return HMF_OK;
    for (uint32_t k = 0; k < n; ++k) {
        const int64_t height = cylinders.list[k].height / static_cast<int64_t>(factor_);
        const size_t c = static_cast<size_t>(height % LABELS);
        if (c >= n || height != integer_weights_[c]) return HMF_OK;
        of_loop[c] = k;
    }
    if (!offsets.push(0)) return failed(call_);
    for (size_t c = 0; c < n; ++c) {
        if (of_loop[c] == NONE) return HMF_OK;
        const int64_t middle = cylinders.list[of_loop[c]].height | 1;
        if (!closed_leaf(f, leaf_at(f, cylinders, of_loop[c], middle), cylinders.graph.crossing_limit(), leaf))
            return failed(call_);
        for (const Crossing& x : leaf)
            if (!edges.push(edge_of(x.half_edge))) return failed(call_);
        if (!offsets.push(static_cast<uint32_t>(edges.size()))) return failed(call_);
    }
    known = true;
    return HMF_OK;
}

// The equations at the solution.
struct MarkedTrial::Linearized {
    Rings rings; // the model refers to them
    TwistedModel model;
    SignedMultigrid multigrid;
    Array<double> right;
    Array<double> change; // of the value of each edge, for one unit of a weight
};

// A triangle that both triangulations have: cot F / (2 energy) of each side.
struct MarkedTrial::SmoothTriangle {
    uint32_t face, edge[3];
    double pull[3];
};

// The solution is in state_, on the intrinsic side.
Done MarkedTrial::linearize(Linearized& at) {
    Foliation& f = state_.foliation;
    const Mesh& mesh = f.mesh;
    const double* weight = h_.levels[0].weight;
    Star star;
    if (!at.rings.build(mesh, weight, call_.memory) || !star.allocate(call_.memory, at.rings.max_degree)
        || !at.model.allocate(mesh, call_.memory, call_.parallel) || !at.right.allocate(call_.memory, mesh.vertex_count)
        || !at.change.allocate(call_.memory, mesh.edge_count) || !at.model.linearize(f, at.rings, weight, star, call_))
        return false;
    at.model.assemble(f, at.rings, weight, call_);
    return !call_.cancelled() && at.multigrid.setup(at.model.matrix(), call_);
}

// Triangles that are no tripods, which contain zeros.
Done MarkedTrial::list_smooth_triangles(Array<SmoothTriangle>& out) {
    const Foliation& f = state_.foliation;
    const Mesh &mesh = f.mesh, &input = h_.input;
    out.start(call_.memory);
    if (!out.reserve(input.face_count)) return false;
    for_each_face(input, 0, 2 * input.edge_count, [&](uint32_t h, uint32_t g, uint32_t k) {
        const uint32_t side[3] = {h, g, k};
        SmoothTriangle triangle{input.face[h], {edge_of(h), edge_of(g), edge_of(k)}, {0, 0, 0}};
        double energy = 0;
        bool tripod = true;
        for (size_t i = 0; i < 3; ++i) {
            if (mesh.next[side[i]] != input.next[side[i]] || mesh.origin[side[i]] != input.origin[side[i]]) return;
            const double* at[3];
            for (size_t x = 0; x < 3; ++x)
                at[x] = h_.levels[0].position + size_t{3} * input.origin[side[(i + 2 + x) % 3]];
            const double F = static_cast<double>(f.at(side[i]));
            triangle.pull[i] = cotangent(at[0], at[1], at[2]) * F;
            energy += 0.5 * triangle.pull[i] * F;
            tripod = tripod && f.corner2(side[i]) > 0;
        }
        if (tripod || !(energy > 0)) return;
        for (double& x : triangle.pull) x *= 0.5 / energy;
        out.add(triangle);
    });
    return true;
}

// Sets at.change: the growth of the weight of the cylinder whose leaf crosses these edges.
Done MarkedTrial::change_values(const uint32_t* crossed, size_t count, Linearized& at) {
    const Mesh& mesh = state_.foliation.mesh;
    const double* weight = h_.levels[0].weight;
    TwistedModel& model = at.model;
    for (double& x : at.change) x = 0;
    for (double& x : at.right) x = 0;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t e = crossed[i];
        at.change[e] += 1;
        for (uint32_t h = 2 * e; h < 2 * e + 2; ++h) at.right[mesh.origin[h]] += model.sign[h] * weight[e];
    }
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (model.is_fixed[v]) at.right[v] = 0;
        model.d[v] = 0;
    }
    at.multigrid.solve(model.matrix(), at.right.data(), model.d.data(), LINEAR_ACCURACY, LINEAR_ITERATIONS, call_);
    if (call_.cancelled()) return false;
    for (uint32_t e = 0; e < mesh.edge_count; ++e)
        at.change[e] -=
            model.sign[2 * e] * model.d[mesh.origin[2 * e]] + model.sign[2 * e + 1] * model.d[mesh.origin[2 * e + 1]];
    return true;
}

// From the change of the values for a unit of weight c to that of the scale, by the logarithm of the weight.
void MarkedTrial::set_derivative(size_t c, const Array<double>& change, const Array<SmoothTriangle>& triangles) {
    const double by = static_cast<double>(integer_weights_[c]) * factor_; // the weight in units of the values
    const size_t faces = h_.input.face_count;
    double* const out = derivative_.data() + c * faces;
    for (size_t t = 0; t < faces; ++t) out[t] = 0;
    for (const SmoothTriangle& t : triangles) {
        const double slope =
            t.pull[0] * change[t.edge[0]] + t.pull[1] * change[t.edge[1]] + t.pull[2] * change[t.edge[2]];
        const double d = slope * by;
        if (!(d > -STEEPEST && d < STEEPEST)) continue;
        smooth_[t.face] = 1;
        out[t.face] = d;
    }
}

hmf_status MarkedTrial::derive(bool& known) {
    known = false;
    if (!usable_) return HMF_OK;
    state_.load(0, Triangulation::intrinsic);
    std::memcpy(state_.foliation.value, solved_.data(), solved_.size() * sizeof(int64_t));
    Array<uint32_t> offsets, edges;
    bool counted = false;
    if (count_crossings(offsets, edges, counted) || !usable_) return outer_.status();
    if (!counted) return HMF_OK;

    const size_t loops = weights.size(), faces = h_.input.face_count;
    Linearized at;
    Array<SmoothTriangle> triangles;
    if (!derivative_.allocate(call_.memory, loops * faces) || !smooth_.allocate_filled(call_.memory, faces, uint8_t{0})
        || !linearize(at) || !list_smooth_triangles(triangles))
        return failed(call_);
    for (size_t c = 0; c < loops; ++c) {
        if (!change_values(edges.data() + offsets[c], offsets[c + 1] - offsets[c], at)) return failed(call_);
        set_derivative(c, at.change, triangles);
    }
    known = true;
    return HMF_OK;
}

// Gauss-Newton: the mean of the scale is free.
hmf_status MarkedTrial::best_step(double damping, Array<double>& step) {
    const size_t n = weights.size(), faces = scale_.area.size();
    Array<double> matrix, mean, centered; // centered: times the area, per face
    if (!matrix.allocate_filled(call_.memory, n * n, 0.0) || !mean.allocate_filled(call_.memory, n, 0.0)
        || !centered.allocate(call_.memory, faces) || !step.allocate_filled(outer_.memory, n, 0.0))
        return failed(call_);
    double area = 0, scale_mean = 0;
    for (size_t t = 0; t < faces; ++t) {
        if (!smooth_[t]) continue;
        area += scale_.area[t];
        scale_mean += scale_.area[t] * scale_.log_scale[t];
        for (size_t c = 0; c < n; ++c) mean[c] += scale_.area[t] * derivative_[c * faces + t];
    }
    if (!(area > 0)) return HMF_OK;
    scale_mean /= area;
    for (double& x : mean) x /= area;
    for (size_t c = 0; c < n; ++c) {
        const double* const x = derivative_.data() + c * faces;
        double sum = 0;
        for (size_t t = 0; t < faces; ++t) {
            centered[t] = smooth_[t] ? scale_.area[t] * (x[t] - mean[c]) : 0;
            sum += centered[t] * (scale_.log_scale[t] - scale_mean);
        }
        step[c] = -sum;
        // Four sums: an addition to one sum depends on the previous one, so four run in parallel.
        for (size_t d = 0; d <= c; d += 4) {
            const size_t together = c + 1 - d < 4 ? c + 1 - d : 4;
            const double* y[4];
            double sums[4] = {0, 0, 0, 0};
            for (size_t k = 0; k < 4; ++k) y[k] = derivative_.data() + (d + (k < together ? k : 0)) * faces;
            for (size_t t = 0; t < faces; ++t)
                for (size_t k = 0; k < 4; ++k) sums[k] += centered[t] * y[k][t];
            for (size_t k = 0; k < together; ++k) matrix[c * n + d + k] = sums[k];
        }
    }
    // (J^T J + damping) step = right, by Cholesky's method.
    for (size_t c = 0; c < n; ++c) matrix[c * n + c] += damping;
    for (size_t c = 0; c < n; ++c) {
        for (size_t d = 0; d <= c; ++d) {
            double sum = matrix[c * n + d];
            for (size_t k = 0; k < d; ++k) sum -= matrix[c * n + k] * matrix[d * n + k];
            matrix[c * n + d] = d < c ? sum / matrix[d * n + d] : std::sqrt(sum > 1e-300 ? sum : 1e-300);
        }
    }
    for (size_t c = 0; c < n; ++c) {
        for (size_t k = 0; k < c; ++k) step[c] -= matrix[c * n + k] * step[k];
        step[c] /= matrix[c * n + c];
    }
    for (size_t c = n; c-- > 0;) {
        for (size_t k = c + 1; k < n; ++k) step[c] -= matrix[k * n + c] * step[k];
        step[c] /= matrix[c * n + c];
    }
    return HMF_OK;
}

Done MarkedTrial::vertex_scale(Array<double>& out, Memory& memory) const {
    const Mesh& mesh = h_.input;
    Array<double> sum, area;
    if (!out.allocate(memory, mesh.vertex_count) || !sum.allocate_filled(memory, mesh.vertex_count, 0.0)
        || !area.allocate_filled(memory, mesh.vertex_count, 0.0))
        return false;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const uint32_t v = mesh.origin[h], t = mesh.face[h];
        sum[v] += scale_.area[t] * scale_.log_scale[t];
        area[v] += scale_.area[t];
    }
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        const uint32_t internal = h_.vertex_internal[v];
        out[v] = area[internal] > 0 ? sum[internal] / area[internal] : scale_.mean;
    }
    return true;
}

} // namespace hmf
