// Curves on several levels of a hierarchy, compared by their free homotopy
// classes: words (curve_words.hpp) go along from a coarse level to the finer ones,
// and curves are named (class_table.hpp) where they lie.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"
#include "../../core/homotopy/class_table.hpp"
#include "../../core/curves/loops.hpp"
#include "../../core/leaves/class_certificate.hpp"
#include "../../core/leaves/cylinders.hpp"
#include "../../core/mesh/mesh_copy.hpp"

namespace hmf {

class CurveClasses {
public:
    // On the caller's side of a level, with room down to `finest`.
    [[nodiscard]] hmf_status start(const hmf_hierarchy& hierarchy, size_t level, size_t finest, Call& call);
    // One level finer, on the caller's side.
    [[nodiscard]] hmf_status refine(Call& call);
    // From the caller's side of level 0.
    [[nodiscard]] hmf_status to_intrinsic(Call& call);
    size_t level() const { return level_; }

    // Loops on this mesh; the cylinders of a foliation on it, by their lower boundaries.
    [[nodiscard]] hmf_status name(const Loops& loops, ClassTable& names, Call& call) const;
    [[nodiscard]] hmf_status name(const Cylinders& cylinders, ClassTable& names, Call& call) const;

private:
    const hmf_hierarchy* hierarchy_ = nullptr;
    size_t level_ = 0;
    MeshCopy arrays_;
    Mesh mesh_;
    CurveWords words_;
};

} // namespace hmf
