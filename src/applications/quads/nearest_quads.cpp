#include "nearest_quads.hpp"

#include "surface_walk.hpp"

namespace hmf {

Done NearestQuads::build(const QuadMesh& quads, Memory& memory) {
    quads_ = &quads;
    const auto corner = [&](size_t q, int k) { return at(quads, quads.quads[4 * q + static_cast<size_t>(k)]); };
    return tree_.build(quads.quad_count(), 4, corner, memory);
}

NearestQuads::Place NearestQuads::find(const Point& p, double enough) {
    constexpr uint64_t steps_of_quad = 64;
    Place found{last_, square_to(p, last_), steps_of_quad};
    if (found.square <= enough) return found;
    tree_.search(p, found.square, [&](size_t q) {
        const double square = square_to(p, static_cast<uint32_t>(q));
        found.steps += steps_of_quad;
        if (square < found.square) found = {static_cast<uint32_t>(q), square, found.steps};
        return found.square > enough ? found.square : 0;
    });
    last_ = found.quad;
    return found;
}

double NearestQuads::square_to(const Point& p, uint32_t q) const {
    Point corner[4];
    for (size_t k = 0; k < 4; ++k) corner[k] = at(*quads_, quads_->quads[4 * size_t{q} + k]);
    const size_t turn = square_of(corner[0] - corner[2]) <= square_of(corner[1] - corner[3]) ? 0 : 1;
    const auto half = [&](size_t k) {
        return nearest_in_triangle(p, corner[k % 4], corner[(k + 1) % 4], corner[(k + 2) % 4]).square;
    };
    return std::min(half(turn), half(turn + 2));
}

} // namespace hmf
