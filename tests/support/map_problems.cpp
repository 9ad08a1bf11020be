#include "map_problems.hpp"

#include <algorithm>
#include <cmath>

namespace test::map_problems {

namespace {

std::vector<uint32_t> random_marks(const TriMesh& mesh, size_t count, Random& random) {
    std::vector<uint32_t> marks;
    while (marks.size() < count) {
        const auto v = static_cast<uint32_t>(random.below(mesh.vertex_count()));
        if (std::find(marks.begin(), marks.end(), v) == marks.end()) marks.push_back(v);
    }
    return marks;
}

Problem with_handles(Random& random, size_t genus, int32_t kind) {
    Problem p = closed(random);
    while (p.mesh.genus < genus) {
        const size_t rings = 1 + random.below(6);
        if (!add_handle(p.mesh, rings, std::exp(-4 * random.unit()), random)) return {};
    }
    p.kind = kind;
    return p;
}

} // namespace

Problem closed(Random& random) {
    Problem p;
    p.mesh = closed_tube(random_tube(random));
    return p;
}

Problem open(Random& random) {
    Problem p;
    p.mesh = open_tube(random_tube(random));
    p.has_boundary = true;
    return p;
}

Problem sphere(Random& random) {
    Problem p;
    p.mesh = capped_tube(random_tube(random));
    p.is_sphere = true;
    p.kind = HMF_LOOPS_PANTS;
    return p;
}

Problem marked(Random& random) {
    Problem p = closed(random);
    p.marks = random_marks(p.mesh, 1 + random.below(4), random);
    p.kind = HMF_LOOPS_PANTS;
    return p;
}

Problem twisted(Random& random) {
    Problem p;
    const TubeOptions o = random_tube(random);
    p.mesh = closed_tube(o);
    const size_t turns = random.below(3);
    for (size_t i = 0, j = 0; i < o.rings; ++i) {
        const size_t until = turns * o.corners * (i + 1) / o.rings;
        for (;; ++j) {
            p.path.push_back(static_cast<uint32_t>(i * o.corners + j % o.corners));
            if (j == until) break;
        }
    }
    return p;
}

Problem genus_two(Random& random) { return with_handles(random, 2, HMF_LOOPS_CUT); }
Problem genus_two_pants(Random& random) { return with_handles(random, 2, HMF_LOOPS_PANTS); }
Problem genus_three_pants(Random& random) { return with_handles(random, 3, HMF_LOOPS_PANTS); }

Problem thin_cylinders(Random& random) {
    Problem p;
    const size_t holes = 2 + random.below(4);
    p.mesh = pretzel(holes, 1);
    p.kind = HMF_LOOPS_PANTS;
    for (size_t loop = 0; loop < 3 * holes - 3; ++loop) p.weights.push_back(std::exp2(10 * random.unit() - 5));
    return p;
}

} // namespace test::map_problems
