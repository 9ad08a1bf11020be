// A finer unit on a level, where the rounding of values to integers limits the residual.
#include "solve.hpp"

namespace hmf {

namespace {

// Bits by which the unit must be finer for this residual: rounding to a unit
// changes the pull of an edge by its weight.
uint32_t bits_for_residual(const LevelWork& work, double residual) {
    const Foliation& f = work.state.foliation;
    const Rings& rings = work.rings;
    double total = 0;
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) total += work.level.weight[e] * static_cast<double>(f.value[e]);
    const double floor = pull_floor(total, f.mesh.vertex_count);
    double worst = 0;
    for (uint32_t v = 0; v < f.mesh.vertex_count; ++v) {
        double pull = 0, rounding = 0;
        for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) {
            const uint32_t e = edge_of(rings.side[t].half_edge);
            pull += work.level.weight[e] * static_cast<double>(f.value[e]);
            rounding += work.level.weight[e];
        }
        if (pull < floor) pull = floor;
        if (rounding > worst * pull) worst = rounding / pull;
    }
    uint32_t bits = 0;
    for (double error = 2 * worst; error > residual && bits < 52; error *= 0.5) ++bits;
    return bits;
}

} // namespace

bool LevelWork::refine_unit(double residual) {
    Foliation& f = state.foliation;
    int64_t largest = state.largest_input_value;
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e)
        if (f.value[e] > largest) largest = f.value[e];
    uint32_t bits = bits_for_residual(*this, residual);
    while (bits > 0 && largest > options.largest_value >> bits) --bits;
    // Heights are no values of an edge: on a fine mesh they can be much larger.
    int64_t highest = 0;
    if (guard) highest = guard->reference.largest_height() * static_cast<int64_t>(guard->unit / log.unit());
    while (bits > 0 && highest > LARGEST_HEIGHT >> bits) --bits;
    // Exact, as the factor is a power of two.
    const int64_t factor = int64_t{1} << bits;
    for (uint32_t e = 0; e < f.mesh.edge_count && bits > 0; ++e) f.value[e] *= factor;
    state.largest_input_value *= factor;
    log.set_unit(log.unit() / static_cast<double>(factor));
    return bits > 0;
}

} // namespace hmf
