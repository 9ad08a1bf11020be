#include "run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "counted.hpp"
#include "marks.hpp"
#include "write_results.hpp"

namespace cli {

namespace {

using readers::Json;

constexpr double FAR_OFF = 0.1; // areas of quads and of their surface

// The sum of a number in the reports of components; null: no component has it.
Json sum(const Json::Array& reports, const char* key) {
    Json total;
    for (const Json& report : reports) {
        const Json* const number = report.find(key);
        if (number && !number->is_null()) total = Json(total.number() + number->number());
    }
    // Counts stay whole numbers in the file.
    const double value = total.number();
    const bool is_whole = !total.is_null() && value == std::floor(value) && std::fabs(value) < 1e15;
    return is_whole ? Json(static_cast<int64_t>(value)) : total;
}

// Levels of several reports as those of one, the finest first.
Json::Array sum_of_levels(const Json::Array& reports) {
    std::vector<Json::Array> rows;
    for (const Json& report : reports)
        if (const Json* const levels = report.find("levels"))
            for (size_t k = 0; k < levels->elements().size(); ++k) {
                if (k == rows.size()) rows.emplace_back();
                rows[k].push_back(levels->elements()[k]);
            }
    Json::Array all;
    for (const Json::Array& row : rows) {
        Json level;
        for (const char* key : {"vertices", "edges", "nld", "raised_count", "sweeps", "linear_solves",
                                "optimize_seconds", "interpolate_seconds"})
            level.set(key, sum(row, key));
        all.push_back(level);
    }
    return all;
}

} // namespace

void Run::report() {
    const double seconds = seconds_since(begin_);
    const Json json = report_json(seconds);
    if (!r_.report.empty()) attempt("--report", true, [&] { write_report(r_.report, json); });
    const auto number = [&](const Json& object, const char* key) {
        const Json* const found = object.find(key);
        return found ? found->number() : 0;
    };
    std::string summary = name_ + ": ";
    if (!is_alone())
        summary += std::to_string(components_.size()) + " components, " + std::to_string(solved_count()) + " solved, ";
    char line[300];
    const size_t boundaries = static_cast<size_t>(number(*json.find("mesh"), "boundaries"));
    const std::string rims = boundaries == 0 ? ""
                           : boundaries == 1 ? "1 boundary, "
                                             : std::to_string(boundaries) + " boundaries, ";
    std::snprintf(
        line, sizeof line, "genus %.0f, %s%zu edges, %s, energy %.10g, residual %.2g, class %s, %s, %s, %.2f s",
        number(*json.find("mesh"), "genus"), rims.c_str(), f_.values.size(), counted(loop_count_, "loop").c_str(),
        number(json, "energy"), number(json, "residual_max"), json.find("class")->text()->c_str(),
        counted(static_cast<size_t>(number(json, "zeros")), "zero").c_str(),
        counted(static_cast<size_t>(number(json, "poles")), "pole").c_str(), seconds);
    outcome_.summary = summary + line;
    if (r_.count > 0 && quads_ > 0)
        outcome_.summary +=
            "\n" + r_.quads + ": " + counted(quads_, "quad")
            + (quad_meshes_.size() < components_.size() ? " on " + std::to_string(quad_meshes_.size()) + " of "
                                                              + std::to_string(components_.size()) + " components, "
                                                        : ", ")
            + std::to_string(irregular_) + (irregular_ == 1 ? " irregular vertex, " : " irregular vertices, ")
            + counted(inverted_, "inverted quad") + area_sentence();
    if (fewest_ > 0)
        outcome_.summary += "; " + std::to_string(r_.count)
                          + " were wished, and these loops and marked vertices need about " + std::to_string(fewest_);
    if (has_doubled_)
        outcome_.summary += "; " + std::to_string(r_.count) + " were wished, of which too many would be folded over";
    if (atlas_.charts > 0) {
        std::snprintf(line, sizeof line, ": %zu charts, %.0f %% of the square used", atlas_.charts, 100 * atlas_.used);
        outcome_.summary += "\n" + r_.atlas + line;
    }
    if (kind_ == LOOPS_EVEN) outcome_.summary += "\n" + design_sentence();
    else if (tipped_ > 0) outcome_.summary += "\n" + sentence_of(marks_, tipped_, has_tips_);
}

size_t Run::solved_count() const {
    return static_cast<size_t>(
        std::count_if(components_.begin(), components_.end(), [](const Component& c) { return !c.is_refused(); }));
}

// Where quads lie upon others, or do not reach everywhere.
std::string Run::area_sentence() const {
    const double ratio = quad_area_ / covered_area_;
    if (std::fabs(ratio - 1) < FAR_OFF) return {};
    char text[100];
    std::snprintf(text, sizeof text, "; they have %.2f times the area of the surface", ratio);
    return text;
}

std::string Run::design_sentence() const {
    std::string text = "even: " + std::to_string(marks_.size())
                     + (marks_.size() == 1 ? " marked vertex, " : " marked vertices, ") + counted(loop_count_, "loop")
                     + (loop_count_ == 1 ? " with a weight" : " with weights");
    if (is_alone()) {
        char numbers[100];
        std::snprintf(numbers, sizeof numbers, "; unevenness %.2f, with --loops cut %.2f", components_[0].unevenness(),
                      components_[0].design()->unevenness_before);
        text += numbers;
    }
    return text + " (--save-marks and --save-loops keep them)";
}

Json Run::report_json(double seconds) const {
    Json report = {{"version", version_text()},
                   {"input", r_.mesh},
                   {"options", values_of(options_)},
                   {"exit_status", static_cast<int>(outcome_.exit_status)},
                   {"errors", outcome_.errors}};
    if (r_.prepare.repairs || !repairs_.empty()) {
        std::vector<std::string> repairs = repairs_;
        if (std::any_of(components_.begin(), components_.end(), [](const Component& c) { return c.is_mollified(); }))
            repairs.emplace_back(MOLLIFIED);
        report.set("repairs", repairs);
    }
    if (!warnings_.empty()) report.set("warnings", warnings_);
    report.set("components_solved", solved_count());
    if (!outcome_.notes.empty()) report.set("notes", outcome_.notes);
    if (is_alone()) {
        const Json own = components_[0].json(singular_[0]);
        for (const auto& [key, value] : own.members()) report.set(key, value);
        Json mesh = *own.find("mesh");
        mesh.set("components", 1);
        report.set("mesh", mesh);
    } else add_totals(report);
    report.set("total_seconds", seconds);
    report.set("cpu_seconds", double(std::clock()) / CLOCKS_PER_SEC);
    report.set("threads", r_.threads);
    report.set("weights", r_.weights);
    report.set("peak_memory_bytes", meter_.peak);
    if (leaves_ > 0) report.set("leaves", leaves_);
    if (atlas_.charts > 0) {
        report.set("atlas_charts", atlas_.charts);
        report.set("atlas_used_area", atlas_.used);
        report.set("atlas_seam_length", atlas_.seams);
        report.set("atlas_collapsed_triangles", atlas_.collapsed);
    }
    if (quads_ > 0) {
        report.set("quads", quads_);
        report.set("quads_components", quad_meshes_.size());
        report.set("quads_irregular", irregular_);
        report.set("quads_inverted", inverted_);
        report.set("quads_area_ratio", quad_area_ / covered_area_);
        report.set("quads_distance", quad_distance_);
        if (fewest_ > 0) report.set("quads_fewest", fewest_);
    }
    return report;
}

void Run::add_totals(Json& report) const {
    Json::Array parts, meshes, singular;
    double residual_max = 0, residual_mean = 0, vertices = 0;
    bool converged = true;
    int32_t class_state = HMF_CLASS_PROVEN;
    Json method;
    for (size_t k = 0; k < components_.size(); ++k) {
        parts.push_back(components_[k].json(singular_[k]));
        const Json& part = parts.back();
        meshes.push_back(*part.find("mesh"));
        if (components_[k].is_refused()) continue;
        const hmf_report& r = components_[k].report();
        const double own = meshes.back().find("vertices")->number();
        residual_max = std::max(residual_max, r.residual_max);
        residual_mean += own * r.residual_mean;
        vertices += own;
        converged = converged && components_[k].is_converged();
        class_state = less_sure(class_state, r.class_state);
        method = *part.find("method");
        const Json::Array& list = part.find("singularities")->elements();
        singular.insert(singular.end(), list.begin(), list.end());
    }
    Json mesh = {{"vertices", f_.positions.size() / 3}, {"edges", f_.values.size()}};
    for (const char* key : {"triangles", "genus", "marked", "boundaries"}) mesh.set(key, sum(meshes, key));
    mesh.set("components", components_.size());
    report.set("mesh", mesh);
    report.set("method", method);
    report.set("class", class_name(class_state));
    report.set("levels", sum_of_levels(parts));
    report.set("loops", loop_count_);
    for (const char* key :
         {"class_repeats", "class_seconds", "build_seconds", "loops_seconds", "solve_seconds", "energy"})
        report.set(key, sum(parts, key));
    report.set("residual_max", residual_max);
    report.set("residual_mean", residual_mean / vertices);
    for (const char* key : {"poles", "zeros", "index_sum"}) report.set(key, sum(parts, key));
    report.set("singularities", singular);
    for (const char* key : {"bad_flips", "bad_flips_left"}) report.set(key, sum(parts, key));
    report.set("converged", converged);
    for (const char* key : {"flipped_count", "degenerate_count", "seam_edges", "seam_length", "parameterize_seconds"})
        if (const Json total = sum(parts, key); !total.is_null()) report.set(key, total);
    report.set("components", parts);
}

} // namespace cli
