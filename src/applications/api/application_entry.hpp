// What the calls of applications.h begin with.
#pragma once

#include "../../../include/hmf/applications.h"

#include <limits>

#include "../common/caller_lists.hpp"
#include "../common/cylinder_leaves.hpp"
#include "../../core/leaves/double_reflection.hpp"
#include "shared_flat.hpp"

namespace hmf {

// Default, relative: how far from harmonic a foliation may be to be unfolded.
constexpr double HARMONIC_TOLERANCE = 1e-2;

// Inside, of a length above 0 that the caller gives: it stays above 0 and finite.
inline double length_inside(const hmf_hierarchy& h, double length) {
    return std::min(std::max(length * h.scale, std::numeric_limits<double>::min()), std::numeric_limits<double>::max());
}

// A call on a foliation without poles.
class ApplicationEntry : public Entry {
public:
    ApplicationEntry(const hmf_foliation* foliation, const hmf_control* control, hmf_error* error) :
        Entry(foliation ? foliation->hierarchy : nullptr, control, error), foliation_(foliation) {}
    template <class Result>
    hmf_status check(Result** out) {
        if (Entry::check(foliation_ ? foliation_->hierarchy : nullptr, out)) return call.status();
        return check_foliation(foliation_, call);
    }

private:
    const hmf_foliation* foliation_;
};

// Of a surface with boundary only level 0 is that surface.
[[nodiscard]] hmf_status refuse_level_of_double(const hmf_foliation& foliation, Call& call);

// The foliation on the caller's side of its level, with the order in which the
// caller numbers vertices and faces, and its cylinders.
struct Leaves {
    State state;
    Array<uint32_t> face_order;
    const uint32_t* vertices = nullptr;
    const uint32_t* faces = nullptr;
    Cylinders cylinders;

    // reflection: filled on level 0 of a double, whose clusters on the boundary are then divided; NULL: not needed.
    [[nodiscard]] hmf_status load(const hmf_foliation& f, Call& call, Reflection* reflection = nullptr);
};

// The flat surface of a foliation on the caller's side: the one that is kept with
// it, or one of its own after improve(state, unit), which leaves residuals of at most `residual`.
struct FlatOf {
    const FlatConeMetric* flat = nullptr;
    double unit = 1;

    template <class Improve>
    hmf_status find(const hmf_foliation& foliation, Entry& entry, double residual, Improve improve) {
        Call& call = entry.call;
        unit = foliation.unit;
        if (const hmf_status status = shared_flat(foliation, entry, flat)) return status;
        if (flat) return HMF_OK;
        flat = &own_;
        State state;
        if (load_solved_in_unit_of_values(foliation, state, call) || improve(state, unit)) return call.status();
        return flat_cone_metric(state, residual, own_, call);
    }

private:
    FlatConeMetric own_;
};

} // namespace hmf
