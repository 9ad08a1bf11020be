// The reader of glTF: containers, accessors, strips and fans, transforms; a sentence for each defect.
#include <cmath>
#include <cstring>

#include "support/mesh_files.hpp"

namespace test_readers_gltf {

using namespace test;

TEST(ReadGltf, Containers) {
    const Sample s = make_sample();
    const std::vector<double> floats = as_floats(s.positions);
    const Gltf gltf = gltf_of(s.positions, s.triangles);
    expect_same(read_mesh(gltf.glb(), Format::gltf), floats, s.triangles);
    expect_same(read_mesh(gltf.embedded(), Format::gltf), floats, s.triangles);
    const Neighbor neighbor = [&](const std::string& name) {
        EXPECT_EQ(name, "my data.bin");
        return std::string_view(gltf.buffer);
    };
    expect_same(read_mesh(gltf.json("my%20data.bin"), Format::gltf, neighbor), floats, s.triangles);
}

TEST(ReadGltf, IndicesAndStrides) {
    const Sample s = make_sample();
    const std::vector<double> floats = as_floats(s.positions);
    const auto expect = [&](const Gltf& gltf) {
        expect_same(read_mesh(gltf.glb(), Format::gltf), floats, s.triangles);
    };
    Gltf bytes, shorts;
    int points = bytes.add_points(s.positions);
    bytes.add_primitive(points, bytes.add_indices<uint8_t>(s.triangles));
    expect(bytes);
    points = shorts.add_points(s.positions);
    shorts.add_primitive(points, shorts.add_indices<uint16_t>(s.triangles), ",\"mode\":4");
    expect(shorts);

    // Points between other numbers, behind an offset.
    Gltf strided;
    std::string interleaved = "1234";
    for (size_t v = 0; v < s.vertex_count(); ++v) {
        for (size_t k = 0; k < 3; ++k) interleaved += bytes_of(static_cast<float>(s.positions[3 * v + k]));
        interleaved += "normal..";
    }
    interleaved.resize(interleaved.size() - 8);
    points = strided.add(interleaved, s.vertex_count(), 5126, "VEC3", 20, ",\"byteOffset\":4");
    strided.add_primitive(points, strided.add_indices<uint16_t>(s.triangles));
    expect(strided);

    // Without indices every corner has its point; they are joined.
    Sample joined = s;
    number_by_triangles(joined.positions, joined.triangles);
    std::vector<double> corners;
    for (const uint32_t v : s.triangles) corners.insert(corners.end(), &s.positions[3 * v], &s.positions[3 * v] + 3);
    Gltf soup;
    soup.add_primitive(soup.add_points(corners), -1);
    expect_same(read_mesh(soup.glb(), Format::gltf), as_floats(joined.positions), joined.triangles);

    // Two primitives that share points, one without any use of the last ones, with a seam between them.
    std::vector<double> split = s.positions;
    split.insert(split.end(), s.positions.begin(), s.positions.end());
    split.insert(split.end(), {9, 9, 9});
    const std::vector<uint32_t> first(s.triangles.begin(), s.triangles.begin() + 150);
    std::vector<uint32_t> second(s.triangles.begin() + 150, s.triangles.end());
    for (uint32_t& v : second) v += static_cast<uint32_t>(s.vertex_count());
    Gltf seam;
    points = seam.add_points(split);
    seam.add_primitive(points, seam.add_indices<uint32_t>(first));
    seam.add_primitive(points, seam.add_indices<uint32_t>(second));
    seam.add_primitive(points, -1, ",\"mode\":1"); // lines
    expect(seam);
}

TEST(ReadGltf, StripsAndFans) {
    const std::vector<double> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
    const auto triangles = [&](const std::vector<uint32_t>& indices, const char* mode) {
        Gltf gltf;
        const int points = gltf.add_points(positions);
        gltf.add_primitive(points, gltf.add_indices<uint16_t>(indices), std::string(",\"mode\":") + mode);
        return read_mesh(gltf.glb(), Format::gltf).triangles;
    };
    EXPECT_EQ(triangles({0, 1, 2, 3, 4}, "5"), (std::vector<uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
    EXPECT_EQ(triangles({0, 1, 2, 2, 3, 4}, "5"), (std::vector<uint32_t>{0, 1, 2, 2, 4, 3}));
    EXPECT_EQ(triangles({0, 1, 2, 3, 4}, "6"), (std::vector<uint32_t>{1, 2, 0, 2, 3, 0, 3, 4, 0}));
}

// Without scenes all nodes that have no parent are shown; a byte order mark may come first.
TEST(ReadGltf, NoScenes) {
    const std::vector<double> positions = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    Gltf gltf = gltf_of(positions, {0, 1, 2});
    expect_same(read_mesh("\xef\xbb\xbf" + gltf.embedded(), Format::gltf), positions, {0, 1, 2});
    gltf.scene = "";
    expect_same(read_mesh(gltf.embedded(), Format::gltf), positions, {0, 1, 2});
    gltf.nodes = "{\"mesh\":0},{\"children\":[0],\"translation\":[8,0,0]}";
    expect_same(read_mesh(gltf.embedded(), Format::gltf), {9, 0, 0, 8, 1, 0, 8, 0, 1}, {0, 1, 2});
    gltf.nodes = "";
    expect_same(read_mesh(gltf.embedded(), Format::gltf), positions, {0, 1, 2});
}

TEST(ReadGltf, Transforms) {
    // A quarter turn round z, twice as large, shifted; then a mirror and a shift.  All numbers are exact.
    const std::vector<double> positions = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    Gltf gltf = gltf_of(positions, {0, 1, 2});
    const auto read = [&](const std::string& nodes) {
        gltf.nodes = nodes;
        return read_mesh(gltf.embedded(), Format::gltf);
    };
    const double root = std::sqrt(0.5);
    const std::string turn = "\"rotation\":[0,0," + digits17(root) + "," + digits17(root) + "]";
    const TriangleMesh turned = read("{\"mesh\":0,\"scale\":[2,2,4],\"translation\":[10,20,30]," + turn + "}");
    const double expected[] = {10, 22, 30, 8, 20, 30, 10, 20, 34};
    for (size_t k = 0; k < 9; ++k) EXPECT_NEAR(turned.positions[k], expected[k], 1e-14);
    expect_same(read("{\"mesh\":0,\"matrix\":[0,2,0,0, -2,0,0,0, 0,0,4,0, 10,20,30,1]}"),
                std::vector<double>(expected, expected + 9), {0, 1, 2});
    expect_same(read("{\"children\":[1],\"scale\":[-1,1,1],\"translation\":[1,0,0]},"
                     "{\"mesh\":0,\"matrix\":[0,2,0,0, -2,0,0,0, 0,0,4,0, 10,20,30,1]}"),
                {-9, 22, 30, -7, 20, 30, -9, 20, 34}, {0, 2, 1}); // mirrored, so turned round
    // An identity changes nothing, not even -0.
    const std::vector<double> zeros = {1, -0.0, 0, 0, 1, 0, -0.0, 0, 1};
    Gltf still = gltf_of(zeros, {0, 1, 2});
    still.nodes = "{\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}";
    expect_same(read_mesh(still.glb(), Format::gltf), zeros, {0, 1, 2});
    // The same mesh twice; and the default scene is not the first one.
    gltf.scene = "\"scene\":1,\"scenes\":[{\"nodes\":[9]},{\"nodes\":[2,0]}],";
    expect_same(read("{\"mesh\":0,\"translation\":[8,0,0]},{\"mesh\":0},{\"mesh\":0}"),
                {1, 0, 0, 0, 1, 0, 0, 0, 1, 9, 0, 0, 8, 1, 0, 8, 0, 1}, {0, 1, 2, 3, 4, 5});
}

TEST(ReadGltf, Quantized) {
    Gltf gltf;
    const std::string corners = std::string("\x80\x7f\x00\x00\x7f\x00\x00\x00\x00\x40\x00\x00", 12);
    const int points = gltf.add(corners, 3, 5120, "VEC3", 4, ",\"normalized\":true");
    gltf.add_primitive(points, -1);
    gltf.more = "\"extensionsRequired\":[\"KHR_mesh_quantization\",\"KHR_materials_unlit\"],";
    expect_same(read_mesh(gltf.glb(), Format::gltf), {-1, 1, 0, 1, 0, 0, 0, 64.0 / 127, 0}, {0, 1, 2});
}

TEST(ReadGltf, Refusals) {
    const Sample s = make_sample();
    const Gltf gltf = gltf_of(s.positions, s.triangles);
    const std::string good = gltf.embedded(), glb = gltf.glb();
    const auto refused = [](const std::string& file, const std::vector<std::string>& says) {
        expect_refused(file, Format::gltf, says);
    };
    const auto changed = [&](const std::string& from, const std::string& to, const std::vector<std::string>& says) {
        refused(replaced(good, from, to), says);
    };
    refused("{\"asset\":\n{,", {":2:", "JSON cannot be read"});
    refused(good.substr(0, good.size() / 2), {"JSON cannot be read", "cut"});
    refused("[]", {"no object"});
    refused("{}", {"version 2"});
    refused("{\"asset\":{\"version\":\"1.0\"}}", {"version 2"});
    refused("{\"asset\":{\"version\":\"2.0\"}}", {"no triangles"});
    refused("{\"asset\":{\"version\":\"2.0\"},\"scene\":0}", {"scenes[0] does not exist"});
    refused(std::string(1000, '['), {"nested too deeply"});
    refused("[1e999]", {"too large"});
    changed("\"scene\":0", "\"scene\":-1", {"default scene"});
    changed("\"scene\":0", "\"scene\":7", {"scenes[7] does not exist"});
    changed("\"nodes\":[0]", "\"nodes\":[1]", {"nodes[1] does not exist"});
    changed("\"nodes\":[0]", "\"nodes\":[0,0]", {"nodes[0] has two parents"});
    changed("{\"mesh\":0}", "{\"mesh\":0,\"children\":[0]}", {"nodes[0] has two parents"});
    changed("{\"mesh\":0}", "{\"mesh\":1}", {"meshes[1] does not exist"});
    changed("{\"mesh\":0}", "{\"mesh\":0,\"matrix\":[1]}", {"nodes[0]", "16 numbers"});
    changed("{\"mesh\":0}", "{\"mesh\":0,\"scale\":[1e308,1,1]}", {"not finite"});
    changed("{\"mesh\":0}", "{}", {"no triangles"});
    changed("\"indices\":1", "\"indices\":5", {"accessors[5] does not exist"});
    changed("\"indices\":1", "\"indices\":0", {"accessors[0]", "SCALAR"});
    changed("\"POSITION\":0", "\"POSITION\":1", {"accessors[1]", "VEC3"});
    changed("\"POSITION\"", "\"NORMAL\"", {"meshes[0] has no \"POSITION\""});
    changed("\"indices\":1", "\"mode\":9", {"mode 9"});
    changed("\"count\":225", "\"count\":224", {"meshes[0] has 224 corners"});
    changed("\"count\":225", "\"count\":228", {"accessors[1] ends behind its bufferView"});
    changed("\"count\":225", "\"count\":4000000000", {"accessors[1] ends behind its bufferView"});
    changed("\"count\":225", "\"count\":40000000000", {"accessors[1]", "\"count\"", "2^32"});
    changed("\"count\":225", "\"count\":-3", {"accessors[1]", "\"count\""});
    changed("\"count\":35", "\"count\":34", {"meshes[0] names vertex 34", "there are 34"});
    changed("\"byteLength\":420", "\"byteLength\":4000", {"bufferViews[0] ends behind its buffer"});
    changed("\"byteOffset\":0", "\"byteStride\":8", {"bufferViews[0]", "byteStride"});
    changed("\"type\":\"VEC3\"", "\"type\":\"VEC3\",\"sparse\":{}", {"accessors[0] is sparse", "not read"});
    changed("\"bufferView\":0,", "", {"accessors[0] has no bufferView"});
    changed("\"byteLength\":1320", "\"byteLength\":1321", {"buffers[0] declares 1321 bytes, but has 1320"});
    changed("base64,", "base64,!", {"buffers[0]", "not base64"});
    changed("{\"asset\"", "{\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\"",
            {" \"KHR_draco_mesh_compression\",", "without compression"});
    refused(gltf.json("data.bin"), {"buffers[0]", "\"data.bin\"", ".glb"});
    for (const char* name :
         {"/etc/passwd", "../secret", "a/../b", "./a", "a//b", "http://a/b", "a\\\\b", "%2fa", "%00"})
        refused(gltf.json(name), {"only files beside this one"});
    refused(glb.substr(0, glb.size() - 1), {"declares", "cut"});
    refused(glb.substr(0, 15), {"header of the .glb"});
    refused(replaced(glb, "\"asset\"", "'asset'"), {"JSON cannot be read at byte 22"});
    std::string wrong = glb;
    wrong[4] = 1;
    refused(wrong, {"only version 2"});
    wrong = glb;
    wrong[glb.find("BIN") - 1] = '\x7f';
    refused(wrong, {"binary chunk at byte", "cut"});
}

TEST(ReadMesh, NodesThatRepeatAMesh) {
    const test::TriMesh torus = test::torus(60, 50, 2, 0.8);
    Gltf gltf = with_nodes(torus, 20000, ",{\"mesh\":0}");
    std::string numbers = "0";
    for (int node = 1; node < 20000; ++node) numbers += "," + std::to_string(node);
    gltf.scene = "\"scenes\":[{\"nodes\":[" + numbers + "]}],";
    expect_refused(gltf.glb(), Format::gltf, {"meshes[0] is shown so often", "transforms applied"});
}

} // namespace test_readers_gltf
