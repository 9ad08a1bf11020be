// Files made to be slow: the work of the readers grows with the size of the file, whatever it declares.
#include "support/polygons.hpp"
#include "work/count_blocks.hpp"

namespace test_reader_work {

using namespace test;

namespace {

template <class Action>
uint64_t work_of(Action&& action) {
    const uint64_t before = blocks;
    action();
    return blocks - before;
}

uint64_t of_face(const Plane& p) {
    return work_of([&] { EXPECT_EQ(read_face(p, 2).triangle_count(), p.size() - 2); });
}

uint64_t of_refusal(const std::string& bytes, Format format, const std::string& says) {
    return work_of([&] { expect_refused(bytes, format, {says}); });
}

} // namespace

// O(n sqrt n) is documented.
TEST(ReaderWork, Polygons) {
    expect_growth(
        "circle", [](size_t n) { return of_face(regular(n)); }, 5000, 1.5);
    expect_growth(
        "comb", [](size_t n) { return of_face(comb(n)); }, 2500, 1.5);
    expect_growth(
        "spiral", [](size_t n) { return of_face(spiral(n)); }, 2500, 1.5);
    const auto of_star = [](size_t n) {
        test::Random random(11);
        return of_face(star(n, random));
    };
    expect_growth("star", of_star, 5000, 1.5);
    const auto of_grid = [](size_t n) {
        const int halvings = static_cast<int>(std::log2(n));
        return of_face(with_flat_corners({{0, 0}, {1 << 14, 0}, {1 << 14, 1}, {0, 1}}, halvings));
    };
    expect_growth("grid", of_grid, 2048, 1.5);
}

TEST(ReaderWork, PointsThatCollideOnPurpose) {
    const auto work = [](size_t n) {
        const std::vector<double> points = colliding_points(n);
        std::vector<double> positions;
        PointNumbers numbers(positions);
        return work_of([&] {
            for (size_t i = 0; i < points.size(); i += 3) numbers.number_of(points[i], points[i + 1], points[i + 2]);
        });
    };
    expect_linear("points", work, 10000);
}

TEST(ReaderWork, JsonWithManyNodes) {
    const TriMesh mesh = torus(6, 5, 2, 0.8);
    const auto work = [&](size_t n) {
        const std::string file = with_nodes(mesh, n, ",{}").glb();
        return work_of([&] { EXPECT_EQ(read_mesh(file, Format::gltf).triangles, mesh.triangles); });
    };
    expect_linear("nodes", work, 20000);
}

// A thousandfold number in a header is no more work.
TEST(ReaderWork, NoHeaderIsBelieved) {
    const std::string points = "0 0 0\n1 0 0\n0 1 0\n", xyz = "property float x\nproperty float y\nproperty float z\n";
    const std::string list = "property list uint int vertex_indices\n",
                      binary = "ply\nformat binary_little_endian 1.0\n";
    const auto work = [&](uint32_t count) {
        const std::string n = std::to_string(count);
        std::string bytes(4, '\0');
        std::memcpy(&bytes[0], &count, 4);
        const std::string one_face = "element vertex 3\n" + xyz + "element face 1\n" + list + "end_header\n";
        const std::string many = "element vertex " + n + "\n" + xyz + "element face 1\n" + list + "end_header\n";
        return of_refusal("OFF\n" + n + " 1 0\n" + points, Format::off, "3 of " + n)
             + of_refusal("OFF\n3 " + n + " 0\n" + points, Format::off, "0 of " + n)
             + of_refusal("OFF\n3 1 0\n" + points + n + " 0 1 2\n", Format::off, "3 of " + n)
             + of_refusal("ply\nformat ascii 1.0\n" + many + points, Format::ply, "3 of " + n)
             + of_refusal("ply\nformat ascii 1.0\n" + one_face + points + n + " 0 1 2\n", Format::ply, "fewer numbers")
             + of_refusal(binary + many + std::string(60, '\0'), Format::ply, "only 60 bytes")
             + of_refusal(binary + one_face + std::string(36, '\0') + bytes + std::string(20, '\0'), Format::ply,
                          "ends in face 0")
             + of_refusal(std::string(80, '\0') + bytes, Format::stl, "for 0 only");
    };
    EXPECT_LT(work(1000000000), 2 * work(1000000));
}

} // namespace test_reader_work
