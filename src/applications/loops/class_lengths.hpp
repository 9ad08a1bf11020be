// Lengths of the classes that loops are chosen from.
//
// A loop on the level where it was found is as long as its strip there;
// what counts is the closed geodesic of its class on the surface.  So each class, identified by its name
// (curve_words.hpp), has a length: first that of the curve pulled straight where it was found and, if the choice
// depends on it, as measured on a fine level:
//
//     found on a coarse level -> carried (carry_loops.hpp) -> pulled straight
//
// The first level to measure on is the coarsest that has 10 000 vertices; classes
// that are close even there are measured on the coarsest one that has 100 000, or
// else on the mesh of the caller.  A surface with bumps has several closed geodesics
// in a class: so other strips of the class are pulled as well, the first ones, and later ones that are shorter than all
// earlier ones.
//
// Ties: lengths are measured in a metric that grows by 0.5 % along the x axis,
// from end to end of the surface, by 0.3 % along y and 0.2 % along z.  So of two
// loops that are equally long, by symmetry say, the one that lies lower counts as
// shorter.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"
#include "../../core/homotopy/curve_words.hpp"
#include "closed_geodesic.hpp"
#include "dual_length.hpp"
#include "find_loops.hpp"
#include "../../core/curves/multicurve.hpp"

namespace hmf {

class ClassLengths {
public:
    // Loops on level `found` of a hierarchy, or on a mesh alone, where they are measured immediately.
    ClassLengths(const hmf_hierarchy& hierarchy, size_t found, Call& call, LoopCare care = LoopCare::shortest);
    ClassLengths(const Mesh& mesh, const double* position, Call& call);

    // The number of a loop's class.
    Done add(const uint32_t* crossings, size_t n, uint32_t& id);

    // The shortest of these, as far as is known. Classes that may turn out shorter once measured are recorded. n > 0.
    size_t shortest(const uint32_t* ids, size_t n);
    // It is noted.
    void want(uint32_t id) {
        if (care_ == LoopCare::shortest) classes_[id].wanted |= classes_[id].stage != Stage::done;
    }
    // May n of them, together, be shorter than n others?  If so, all are noted.
    bool may_be_shorter(const uint32_t* ids, const uint32_t* others, size_t n);
    double length(uint32_t id) const { return classes_[id].length; }
    // A simple strip of it, pulled straight where it was found if that is simple; it may meet other loops.
    bool has_pulled() const { return care_ == LoopCare::shortest; }
    const uint32_t* pulled(uint32_t id) const { return crossings_.data() + classes_[id].first; }
    size_t pulled_size(uint32_t id) const { return static_cast<size_t>(classes_[id].end - classes_[id].first); }
    LoopCare care() const { return care_; }
    bool is_sphere() const { return mesh_.euler() == 2; }

    // Measures what is noted; changed: there was any.
    Done measure(bool& changed);

private:
    enum Stage : uint8_t { found, measured, done }; // where: found_, level_, finest_
    Stage stage_where_found() const {
        return found_ == finest_ ? Stage::done : level_ == found_ ? Stage::measured : Stage::found;
    }
    struct Class {
        uint64_t first, end; // its loop in crossings_, see pulled()
        double length;       // tilted
        double found;        // likewise, where it was found
        double strip;        // dual length, the shortest that was pulled
        double doubt;        // relative: it may be longer by so much, beside the error of the stage
        Stage stage;
        uint8_t starts; // strips that were pulled to it
        bool wanted;
    };
    Done start();
    void measure_extent();
    Done measure_stage(Stage stage, bool& changed);
    Done pull(ClosedGeodesic& geodesic, const Mesh& mesh, const double* position, const uint32_t* crossings, size_t n,
              Class& c);
    double strip_length(const uint32_t* crossings, size_t n);
    Done keep_curve(const uint32_t* crossings, size_t n, Class& c);

    const hmf_hierarchy* hierarchy_;
    const Mesh& mesh_;
    const double* position_;
    Call& call_;
    LoopCare care_ = LoopCare::shortest;
    size_t found_ = 0, level_ = 0, finest_ = 0; // where loops are found, and measured
    bool started_ = false;
    double lowest_[3] = {0, 0, 0}, tilt_[3] = {0, 0, 0}; // of the box, and growth of the metric per unit
    CurveWords words_;
    ClosedGeodesic geodesic_;
    DualLength dual_length_;
    Array<double> strip_length_; // dual length per edge; below 0: not known yet
    Array<Class> classes_;
    Array<uint32_t> crossings_, loop_;
    Array<uint32_t> visited_; // per face
    Loops one_;               // to see whether it is simple
    Multicurve curve_;
    uint32_t visit_ = 0;
    Walk name_;
    WordTable names_; // of classes_
};

} // namespace hmf
