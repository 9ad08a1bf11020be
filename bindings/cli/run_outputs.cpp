#include "run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "loop_lines.hpp"
#include "marks.hpp"
#include "whole_stripes.hpp"
#include "write_results.hpp"
#include "write_textured.hpp"

namespace cli {

namespace {

constexpr double FAR_ABOVE = 1.15;    // the wished number
constexpr size_t QUADS_OF_LOOP = 100; // with more for each loop than this, the least possible number is not in question
constexpr double DOUBLED = 1.5;       // likewise: what is between is rounding

// Of the largest coordinate: with it taken away squares of areas neither overflow nor vanish.
int exponent_of(const std::vector<double>& positions) {
    double largest = 0;
    for (const double x : positions) largest = std::max(largest, std::fabs(x));
    return largest > 0 ? std::ilogb(largest) : 0;
}

// In units of 4^exponent.
double area_of(const Foliation& f, size_t triangle, int exponent) {
    double side[2][3], square = 0;
    const auto at = [&](size_t c, size_t k) { return f.positions[size_t{3} * f.triangles[3 * triangle + c] + k]; };
    for (size_t s = 0; s < 2; ++s)
        for (size_t k = 0; k < 3; ++k) side[s][k] = std::scalbn(at(s + 1, k) - at(0, k), -exponent);
    for (size_t k = 0; k < 3; ++k) {
        const size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const double x = side[0][i] * side[1][j] - side[0][j] * side[1][i];
        square += x * x;
    }
    return std::sqrt(square) / 2;
}

} // namespace

void Run::write() {
    write_numbers();
    control_ = progress_.part("leaves", 0, 1);
    const bool wants_uv = !r_.obj.empty() || !r_.textured.empty();
    const bool pictured = !r_.image.empty() || wants_uv;
    attempt_each("--leaves", !r_.leaves.empty(), [&](Component& c) {
        if (c.status() == HMF_OK) c.find_cylinders(control_);
    });
    if (has_start_ && !weights_given_ && (pictured || !r_.leaves.empty())) find_weights();
    f_.loop_weights = r_.weights;
    write_quad_meshes();
    write_leaf_lines();
    const double* const uv = unfold(wants_uv);
    double period = 1;
    if (pictured) {
        control_ = progress_.part("picture", 0, 1);
        attempt("--period", true, [&] { r_.period = period = choose_period(); });
    }
    attempt("--obj", !r_.obj.empty() && uv, [&] { write_textured_obj(r_.obj, f_, uv, period); });
    attempt("--textured", !r_.textured.empty() && uv, [&] {
        if (extension_of(r_.textured) == ".glb") write_textured_glb(r_.textured, f_, uv, period);
        else write_textured_ply(r_.textured, f_, uv, period);
    });
    make_atlas();
    draw(uv, period);
    progress_.clear();
}

void Run::write_numbers() {
    for (const std::string& path : r_.values)
        attempt("--values", true, [&] {
            if (extension_of(path) == ".npy") write_values_npy(path, f_.values);
            else write_values_csv(path, f_);
        });
    attempt("--history", !r_.history.empty(), [&] {
        std::vector<const hmf_report*> reports;
        for (const Component& c : components_) reports.push_back(c.is_refused() ? nullptr : &c.report());
        write_history(r_.history, reports);
    });
    attempt("--save-marks", !r_.save_marks.empty(), [&] { write_marks(r_.save_marks, marks_); });
    attempt("--save-loops", !r_.save_loops.empty(), [&] { write_loops(r_.save_loops, fine_loops(), r_.weights); });
}

void Run::make_quad_meshes() {
    control_ = progress_.part("quads", 0, 1);
    const bool may_miss = !r_.quads.empty() && r_.count > 0;
    if (may_miss && r_.count < QUADS_OF_LOOP * loop_count_) count_fewest();
    const bool is_shown = style_.pattern == Pattern::quads;
    attempt_each(r_.quads.empty() ? "--pattern" : "--quads", !r_.quads.empty() || is_shown, [&](Component& c) {
        quad_meshes_.push_back(make_quads(c.foliation(), quad_wish(c), control_, c.subject()));
    });
    progress_.clear();
    if (r_.quads.empty()) return;
    for (const Owned<hmf_quad_mesh>& mesh : quad_meshes_) {
        quads_ += mesh->quad_count;
        irregular_ += mesh->irregular_count;
        inverted_ += mesh->inverted_count;
        const double surface = mesh->edge_length * mesh->edge_length * static_cast<double>(mesh->quad_count);
        quad_area_ += mesh->area_ratio * surface;
        covered_area_ += surface;
        quad_distance_ = std::max(quad_distance_, mesh->distance);
    }
    if (may_miss && is_far_above(quads_) && fewest_ == 0) {
        count_fewest();
        has_doubled_ = fewest_ == 0 && static_cast<double>(quads_) > DOUBLED * static_cast<double>(r_.count);
    }
    if (fewest_ > 0 && quads_ > 0) fewest_ = std::min(fewest_, quads_);
}

void Run::write_quad_meshes() {
    attempt("--quads", !quad_meshes_.empty() && !r_.quads.empty(), [&] {
        const size_t made = std::exchange(quads_, 0);
        write_quads(r_.quads, quad_meshes_);
        quads_ = made;
    });
}

bool Run::wants_cut_loops() const {
    const bool has_missed = (r_.count > 0 && is_far_above(quads_)) || !area_sentence().empty();
    return kind_ == LOOPS_EVEN && is_alone() && !was_interrupted() && !r_.quads.empty()
        && (quad_meshes_.empty() || (inverted_ > 0 && has_missed));
}

bool Run::has_better_quads_than(const Run& other) const {
    return has_quads() && (!other.has_quads() || inverted_ < other.inverted_);
}

bool Run::is_far_above(size_t quads) const {
    return static_cast<double>(quads) > FAR_ABOVE * static_cast<double>(r_.count);
}

// Each critical leaf and each cylinder needs its columns and rows.
void Run::count_fewest() {
    size_t fewest = 0;
    for (Component& c : components_) {
        if (c.is_refused()) continue;
        hmf_quad_options wish = quad_wish(c);
        wish.count = 1;
        wish.relax = 0;
        try {
            fewest += make_quads(c.foliation(), wish, control_, c.subject())->quad_count;
        } catch (const Failure&) {} // those that are wished fail likewise
    }
    if (!is_far_above(fewest)) return;
    fewest_ = fewest;
    if (quads_ > 0) return;
    progress_.clear();
    std::fprintf(stderr, "hmf: %s: %zu quads are wished, and these loops and marked vertices need about %zu\n",
                 name_.c_str(), static_cast<size_t>(r_.count), fewest);
}

void Run::write_leaf_lines() {
    std::vector<Leaves> leaves;
    if (r_.spacing == 0 && !r_.leaves.empty())
        r_.spacing = 0.1 * *std::min_element(r_.weights.begin(), r_.weights.end());
    attempt_each("--leaves", !r_.leaves.empty(), [&](Component& c) {
        leaves.push_back(trace_leaves(c.foliation(), r_.spacing, r_.conjugate, control_, c.subject()));
    });
    attempt("--leaves", !leaves.empty(), [&] { leaves_ = write_leaves(r_.leaves, leaves); });
}

const double* Run::unfold(bool wants_uv) {
    const char* const asking = !r_.obj.empty()      ? "--obj"
                             : !r_.textured.empty() ? "--textured"
                             : shows_uv()           ? "--pattern"
                                                    : "--conformality";
    if (!shows_uv() && !wants_uv && !r_.conformality) return nullptr;
    attempt_each(asking, true, [&](Component& c) {
        control_ = progress_.part("unfold", 0, 1);
        c.parameterize(control_);
    });
    return corner_uv();
}

void Run::make_atlas() {
    std::vector<std::pair<const Component*, Owned<hmf_chart_set>>> atlas;
    attempt_each("--atlas", !r_.atlas.empty(), [&](Component& c) {
        control_ = progress_.part("atlas", 0, 1);
        atlas.emplace_back(&c, c.make_atlas(control_));
    });
    attempt("--atlas", !atlas.empty(), [&] { write_atlas(atlas); });
}

void Run::write_atlas(const std::vector<std::pair<const Component*, Owned<hmf_chart_set>>>& made) {
    std::vector<double> uv(2 * f_.triangles.size(), 0);
    size_t across = 1;
    while (across * across < made.size()) ++across;
    const double side = 1 / static_cast<double>(across);
    atlas_ = {};
    for (size_t k = 0; k < made.size(); ++k) {
        const auto& [c, charts] = made[k];
        const double at[2] = {static_cast<double>(k % across), static_cast<double>(k / across)};
        for (uint32_t t = 0; t < charts->triangle_count; ++t)
            for (size_t i = 0; i < 6; ++i)
                uv[size_t{6} * c->whole_triangle(t) + i] = (charts->corner_uv[6 * size_t{t} + i] + at[i % 2]) * side;
        atlas_.charts += charts->chart_count;
        atlas_.used += charts->used_area * side * side;
        atlas_.seams += charts->seam_length;
        atlas_.collapsed += charts->collapsed_count;
    }
    constexpr unsigned tiles = 16;
    if (extension_of(r_.atlas) == ".glb") write_textured_glb(r_.atlas, f_, uv.data(), 1, tiles);
    else write_textured_obj(r_.atlas, f_, uv.data(), 1, tiles);
}

void Run::draw(const double* uv, double period) {
    const bool has_data = style_.pattern == Pattern::quads ? !quad_meshes_.empty() : !shows_uv() || uv;
    attempt("--image", !r_.image.empty() && has_data, [&] {
        // In a unit in which nothing overflows; it is the last use of the positions.
        const int exponent = exponent_of(f_.positions);
        for (double& x : f_.positions) x = std::scalbn(x, -exponent);
        for (hmf_singularity& s : f_.singular)
            for (double& x : s.position) x = std::scalbn(x, -exponent);
        std::vector<Line> lines;
        if (!has_start_) lines = loop_lines(f_, fine_loops());
        PictureData picture;
        std::vector<double> squares;
        if (style_.pattern == Pattern::checkerboard) squares = checkerboard_uv(period);
        picture.corner_uv = squares.data();
        if (shows_uv()) picture.dilatation = dilatation();
        if (style_.pattern == Pattern::scale) picture.log_scale = log_scale();
        std::vector<std::vector<double>> places;
        std::vector<hmf_quad_mesh> quads;
        for (const Owned<hmf_quad_mesh>& mesh : quad_meshes_) {
            places.emplace_back(mesh->positions, mesh->positions + 3 * mesh->vertex_count);
            for (double& x : places.back()) x = std::scalbn(x, -exponent);
            quads.push_back(*mesh);
            quads.back().positions = places.back().data();
        }
        for (const hmf_quad_mesh& mesh : quads) picture.quads.push_back(&mesh);
        const Potential potential =
            style_.pattern == Pattern::stripes ? local_potential(f_, period) : Potential{{}, {}, period};
        write_png(r_.image, render(f_, potential, picture, lines, style_, control_), control_);
    });
}

void Run::find_weights() {
    std::vector<double> weights;
    for (Component& c : components_) {
        if (c.is_refused() || c.status() != HMF_OK) continue;
        try {
            const hmf_cylinder_set* const cylinders = c.find_cylinders(control_);
            for (uint64_t k = 0; k < cylinders->count; ++k) weights.push_back(cylinders->list[k].height);
        } catch (const Failure&) {}
    }
    if (!weights.empty()) r_.weights = weights;
}

const double* Run::corner_uv() {
    return of_triangles(uv_, 6, [](const hmf_parameterization& p) { return p.corner_uv; });
}

const double* Run::dilatation() {
    return of_triangles(dilatation_, 1, [](const hmf_parameterization& p) { return p.dilatation; });
}

std::vector<double> Run::checkerboard_uv(double period) const {
    if (is_alone()) return components_[0].checkerboard_uv(period);
    std::vector<double> all(2 * f_.triangles.size());
    for (const Component& c : components_) {
        if (!c.parameterization()) continue;
        const std::vector<double> own = c.checkerboard_uv(period);
        for (uint32_t t = 0; t < own.size() / 6; ++t)
            std::copy_n(&own[size_t{6} * t], 6, &all[size_t{6} * c.whole_triangle(t)]);
    }
    return all;
}

double Run::choose_period() {
    const double wanted = r_.period > 0 ? r_.period : wanted_period(f_);
    if (const double common = common_period(r_.weights, wanted); common > 0) return common;
    if (style_.pattern != Pattern::stripes || r_.image.empty()) return wanted;
    std::vector<Crossing> crossings;
    std::vector<double> heights;
    for (size_t k = 0; k < components_.size(); ++k) {
        const Component& c = components_[k];
        if (c.is_refused()) continue;
        add_crossings(f_, *c.trace_cylinders(control_), is_alone() ? nullptr : whole_edges_[k].data(), crossings,
                      heights);
    }
    f_.stripe_values = whole_stripes(f_, std::move(crossings), heights, wanted);
    return wanted;
}

hmf_quad_options Run::quad_wish(const Component& c) const {
    hmf_quad_options wish;
    hmf_quad_options_init(&wish, sizeof wish);
    wish.edge_length = r_.size;
    wish.merge = r_.merges;
    wish.relax = static_cast<uint32_t>(r_.relax);
    wish.count = r_.count;
    if (r_.count > 0 && !is_alone()) {
        double all = 0, own = 0;
        const int exponent = exponent_of(f_.positions);
        for (size_t t = 0; t < f_.triangle_count(); ++t) {
            const Component& of = components_[f_.component[t]];
            if (of.is_refused()) continue;
            const double area = area_of(f_, t, exponent);
            all += area;
            if (&of == &c) own += area;
        }
        wish.count = std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(double(r_.count) * own / all)));
    }
    return wish;
}

std::vector<double> Run::log_scale() const {
    std::vector<double> scale(f_.triangle_count(), 0);
    for (const Component& c : components_) {
        if (c.is_refused()) continue;
        const std::vector<double> own = c.log_scale(control_);
        for (uint32_t t = 0; t < own.size(); ++t) scale[c.whole_triangle(t)] = own[t];
    }
    return scale;
}

} // namespace cli
