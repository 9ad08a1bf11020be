// glTF 2.0 of Khronos: .gltf (JSON; its numbers inside as base64, or in files beside it) and .glb (both in one file).
//
// All triangles of the default scene, moved by the transforms of its nodes, as one mesh.  glTF splits a vertex where
// its normal or texture breaks: equal points become one vertex again, and vertices without triangle are left out.
// Numbers are floats, or whole numbers as KHR_mesh_quantization allows.  Skins, morph targets and animations are not
// applied; sparse accessors and compressed meshes are refused.  Format: glTF 2.0 specification, ISO/IEC 12113:2022.
#include <array>
#include <cmath>
#include <map>

#include "byte_order.hpp"
#include "json.hpp"
#include "mesh_formats.hpp"
#include "point_numbers.hpp"
#include "text_cursor.hpp"

namespace readers {

namespace {

constexpr uint32_t chunk_json = 0x4e4f534a, chunk_bin = 0x004e4942; // "JSON", "BIN\0"

// Nodes may repeat a mesh many times. Above this many corners of triangles for each byte of the file, the scene is
// refused.
constexpr uint64_t corners_for_a_byte = 2;

// An element of one of the arrays at the top of the JSON, for sentences: "accessors[3]".
struct Place {
    const char* array;
    uint64_t index;
};

[[noreturn]] void fail(Place place, const std::string& sentence) {
    throw MeshError(std::string(place.array) + "[" + std::to_string(place.index) + "] " + sentence);
}

// A whole number; without fallback it has to be there.
uint64_t whole(const Json& object, const char* key, Place place, std::optional<uint64_t> fallback = {}) {
    const Json* const found = object.find(key);
    if (!found) {
        if (!fallback) fail(place, std::string("has no \"") + key + "\"");
        return *fallback;
    }
    // Sums and products of these numbers with sizes of files fit.
    if (!found->whole() || *found->whole() > UINT32_MAX)
        fail(place, std::string("has a \"") + key + "\" that is not a whole number below 2^32");
    return *found->whole();
}

// An array of so many numbers; empty where there is none.
template <size_t count>
bool read_numbers(const Json& node, const char* key, Place place, std::array<double, count>& n) {
    const Json* const found = node.find(key);
    if (!found) return false;
    bool good = found->elements().size() == count;
    for (size_t k = 0; good && k < count; ++k) {
        good = found->elements()[k].is_number();
        n[k] = found->elements()[k].number();
    }
    if (!good) fail(place, std::string("has a \"") + key + "\" that is not " + std::to_string(count) + " numbers");
    return true;
}

// x -> linear x + shift
struct Transform {
    double row[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

    // Points that stay where they are keep the sign of a zero.
    bool is_identity() const {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 4; ++j)
                if (row[i][j] != (i == j)) return false;
        return true;
    }
    double determinant() const {
        return row[0][0] * (row[1][1] * row[2][2] - row[1][2] * row[2][1])
             - row[0][1] * (row[1][0] * row[2][2] - row[1][2] * row[2][0])
             + row[0][2] * (row[1][0] * row[2][1] - row[1][1] * row[2][0]);
    }
    std::array<double, 3> operator()(const std::array<double, 3>& p) const {
        std::array<double, 3> q;
        for (size_t i = 0; i < 3; ++i) q[i] = row[i][0] * p[0] + row[i][1] * p[1] + row[i][2] * p[2] + row[i][3];
        return q;
    }
    // First `inner`, then this one.
    Transform after(const Transform& inner) const {
        Transform result;
        for (size_t i = 0; i < 3; ++i)
            for (size_t j = 0; j < 4; ++j)
                result.row[i][j] = row[i][0] * inner.row[0][j] + row[i][1] * inner.row[1][j]
                                 + row[i][2] * inner.row[2][j] + (j == 3 ? row[i][3] : 0);
        return result;
    }
};

Transform transform_of(const Json& node, Place place) {
    Transform result;
    std::array<double, 16> matrix;
    if (read_numbers(node, "matrix", place, matrix)) {
        for (size_t i = 0; i < 3; ++i)
            for (size_t j = 0; j < 4; ++j) result.row[i][j] = matrix[4 * j + i]; // column after column
        return result;
    }
    std::array<double, 3> shift{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> turn{0, 0, 0, 1};
    read_numbers(node, "translation", place, shift);
    read_numbers(node, "rotation", place, turn);
    read_numbers(node, "scale", place, scale);
    const auto [x, y, z, w] = turn;
    const double rotation[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                                   {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                                   {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (size_t i = 0; i < 3; ++i) {
        for (size_t j = 0; j < 3; ++j) result.row[i][j] = rotation[i][j] * scale[j];
        result.row[i][3] = shift[i];
    }
    return result;
}

// Numbers of a mesh in a buffer.
struct Accessor {
    const char* data;
    uint64_t count, stride;
    uint64_t type; // 5120 int8, 5121 uint8, 5122 int16, 5123 uint16, 5125 uint32, 5126 float32
    bool normalized;

    uint32_t index(uint64_t i) const {
        const char* const at = data + i * stride;
        if (type == 5121) return load<uint8_t>(at);
        return type == 5123 ? load<uint16_t>(at) : load<uint32_t>(at);
    }
    double coordinate(uint64_t i, size_t k) const {
        const char* const at = data + i * stride;
        switch (type) {
        case 5120: return fraction(load<int8_t>(at + k), 127);
        case 5121: return fraction(load<uint8_t>(at + k), 255);
        case 5122: return fraction(load<int16_t>(at + 2 * k), 32767);
        case 5123: return fraction(load<uint16_t>(at + 2 * k), 65535);
        default: return load<float>(at + 4 * k);
        }
    }

private:
    double fraction(int value, int one) const {
        if (!normalized) return value;
        return value < -one ? -1 : static_cast<double>(value) / one;
    }
};

uint64_t size_of_type(uint64_t type) {
    switch (type) {
    case 5120:
    case 5121: return 1;
    case 5122:
    case 5123: return 2;
    case 5125:
    case 5126: return 4;
    default: return 0;
    }
}

std::string decode_base64(std::string_view text, Place place) {
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        uint32_t digit = 0;
        if (c >= 'A' && c <= 'Z') digit = static_cast<uint32_t>(c - 'A');
        else if (c >= 'a' && c <= 'z') digit = static_cast<uint32_t>(c - 'a' + 26);
        else if (c >= '0' && c <= '9') digit = static_cast<uint32_t>(c - '0' + 52);
        else if (c == '+' || c == '/') digit = c == '+' ? 62 : 63;
        else fail(place, "has a data URI that is not base64");
        bits = bits << 6 | digit;
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes += static_cast<char>(bits >> count & 0xff);
    }
    return bytes;
}

// "%20" -> " "
std::string decode_percent(const std::string& text) {
    std::string result;
    for (size_t i = 0; i < text.size(); ++i) {
        unsigned value = 0;
        if (text[i] == '%' && i + 2 < text.size()
            && std::from_chars(&text[i + 1], &text[i + 3], value, 16).ptr == &text[i + 3]) {
            result += static_cast<char>(value);
            i += 2;
        } else result += text[i];
    }
    return result;
}

class GltfReader {
public:
    GltfReader(std::string_view bytes, const Neighbor& neighbor) :
        neighbor_(neighbor), size_(bytes.size()), points_(mesh_.positions) {
        parse(bytes.substr(0, 4) == "glTF" ? split(bytes) : bytes, bytes);
        const Json* const asset = root_.find("asset");
        if (!asset || text_of(*asset, "version").substr(0, 2) != "2.")
            throw MeshError("the file is not glTF of version 2; save it as glTF 2.0");
        for (const Json& extension : list(root_, "extensionsRequired")) {
            const std::string name = extension.text() ? *extension.text() : extension.dump();
            if (!is_harmless(name))
                throw MeshError("the mesh needs the extension " + in_quotes(name)
                                + ", which is not read; save it without compression and extensions");
        }
    }

    TriangleMesh read() {
        Place scene = {"scenes", 0};
        if (const Json* const number = root_.find("scene")) {
            if (!number->whole()) throw MeshError("the default scene is not named by a whole number");
            scene.index = *number->whole();
        }
        std::vector<bool> met(list(root_, "nodes").size());
        const bool has_scenes = root_.find("scene") || !list(root_, "scenes").empty();
        Json::Array roots;
        if (!has_scenes) roots = nodes_without_parent();
        if (!has_scenes && roots.empty())
            for (uint64_t mesh = 0; mesh < list(root_, "meshes").size(); ++mesh)
                add_mesh({"meshes", mesh}, Transform());
        std::vector<Branch> path = {{has_scenes ? &list(item(scene), "nodes") : &roots, 0, Transform()}};
        while (!path.empty()) {
            Branch& branch = path.back();
            if (branch.next == branch.nodes->size()) {
                path.pop_back();
                continue;
            }
            const Json& number = (*branch.nodes)[branch.next++];
            if (!number.whole()) throw MeshError("a node is named by " + in_quotes(number.dump()));
            const Place place = {"nodes", *number.whole()};
            const Json& node = item(place);
            if (met[place.index]) fail(place, "has two parents; save the mesh with a tree of nodes");
            met[place.index] = true;
            const Transform transform = branch.transform.after(transform_of(node, place));
            if (node.find("mesh")) add_mesh({"meshes", whole(node, "mesh", place)}, transform);
            if (const Json::Array& children = list(node, "children"); !children.empty())
                path.push_back({&children, 0, transform});
        }
        return std::move(mesh_);
    }

private:
    // Nodes whose parent has been visited, and how many of them are done.
    struct Branch {
        const Json::Array* nodes;
        size_t next;
        Transform transform;
    };

    struct Buffer {
        std::string decoded; // from base64
        std::string_view bytes;
    };

    // Of a file without scenes; none where there are no nodes.
    Json::Array nodes_without_parent() const {
        const Json::Array& nodes = list(root_, "nodes");
        std::vector<bool> is_child(nodes.size());
        for (const Json& node : nodes)
            for (const Json& child : list(node, "children"))
                if (child.whole() && *child.whole() < nodes.size()) is_child[*child.whole()] = true;
        Json::Array roots;
        for (size_t n = 0; n < nodes.size(); ++n)
            if (!is_child[n]) roots.emplace_back(n);
        return roots;
    }

    // Of a .glb: keeps its bytes, gives its JSON.
    std::string_view split(std::string_view bytes) {
        const auto word = [&](size_t place) { return load<uint32_t>(bytes.data() + place); };
        if (bytes.size() < 20 || word(4) != 2 || word(16) != chunk_json)
            throw MeshError("the header of the .glb is wrong; only version 2 is read");
        if (word(8) > bytes.size() || word(12) > bytes.size() - 20)
            throw MeshError("the header declares " + std::to_string(word(8)) + " bytes, but the file has "
                            + std::to_string(bytes.size()) + "; it is cut");
        const std::string_view text = bytes.substr(20, word(12));
        const size_t next = 20 + text.size();
        if (bytes.size() - next < 8) return text;
        if (word(next) > bytes.size() - next - 8)
            throw MeshError("the binary chunk at byte " + std::to_string(next) + " declares "
                            + std::to_string(word(next)) + " bytes, but the file ends; it is cut");
        if (word(next + 4) == chunk_bin) chunk_ = bytes.substr(next + 8, word(next));
        return text;
    }

    void parse(std::string_view text, std::string_view bytes) {
        try {
            root_ = parse_json(text);
        } catch (const JsonError& error) {
            const std::string_view before = text.substr(0, error.byte);
            const std::string sentence = std::string(": ") + error.what() + "; the file is cut, or is not glTF";
            if (text.size() < bytes.size())
                throw MeshError("the JSON cannot be read at byte "
                                + std::to_string(static_cast<size_t>(text.data() - bytes.data()) + error.byte + 1)
                                + sentence);
            throw MeshError("the JSON cannot be read here" + sentence,
                            1 + static_cast<size_t>(std::count(before.begin(), before.end(), '\n')));
        }
        if (!root_.is_object()) throw MeshError("the JSON is no object; the file is not glTF");
    }

    // Extensions that say how a surface looks, not where it is.
    static bool is_harmless(const std::string& extension) {
        for (const char* known : {"KHR_mesh_quantization", "KHR_materials_", "KHR_texture_", "EXT_texture_",
                                  "MSFT_texture_", "KHR_lights_", "KHR_animation_", "KHR_xmp"})
            if (extension.rfind(known, 0) == 0) return true;
        return false;
    }

    // An array or a text in an object, or an empty one.
    static const Json::Array& list(const Json& object, const char* key) {
        static const Json none;
        const Json* const found = object.find(key);
        return (found ? *found : none).elements();
    }

    static const std::string& text_of(const Json& object, const char* key) {
        static const std::string empty;
        const Json* const found = object.find(key);
        return found && found->text() ? *found->text() : empty;
    }

    const Json& item(Place place) const {
        const Json::Array& array = list(root_, place.array);
        if (place.index >= array.size() || !array[place.index].is_object()) fail(place, "does not exist");
        return array[place.index];
    }

    std::string_view buffer(uint64_t index) {
        const Place place = {"buffers", index};
        const Json& object = item(place);
        const uint64_t length = whole(object, "byteLength", place);
        const std::string_view bytes = loaded_buffer(object, place);
        if (length > bytes.size())
            fail(place, "declares " + std::to_string(length) + " bytes, but has " + std::to_string(bytes.size())
                            + "; the file is cut");
        return bytes.substr(0, length);
    }

    std::string_view loaded_buffer(const Json& object, Place place) {
        const Json* const uri = object.find("uri");
        if (!uri) return place.index == 0 ? chunk_ : std::string_view();
        const auto [found, is_new] = buffers_.try_emplace(place.index);
        Buffer& buffer = found->second;
        if (!is_new) return buffer.bytes;
        if (!uri->text()) fail(place, "has a \"uri\" that is no text");
        const std::string& text = *uri->text();
        if (text.rfind("data:", 0) == 0) {
            const size_t comma = text.find(',');
            if (comma == text.npos || text.substr(0, comma).find(";base64") == text.npos)
                fail(place, "has a data URI that is not base64");
            buffer.decoded = decode_base64(std::string_view(text).substr(comma + 1), place);
            buffer.bytes = buffer.decoded;
            return buffer.bytes;
        }
        const std::string name = decode_percent(text);
        if (!lies_beside(name))
            fail(place, "names the file " + in_quotes(name) + "; only files beside this one are read, put it there");
        if (!neighbor_)
            fail(place, "lies in another file, " + in_quotes(name) + "; save the mesh as .glb, which is one file");
        buffer.bytes = neighbor_(name);
        largest_neighbor_ = std::max<uint64_t>(largest_neighbor_, buffer.bytes.size());
        return buffer.bytes;
    }

    // In the folder of the file or below, named in one way only.
    static bool lies_beside(const std::string& name) {
        return !name.empty() && name[0] != '/' && name.find("..") == name.npos && name.find("./") == name.npos
            && name.find("//") == name.npos && name.find_first_of(std::string_view(":\\\0", 3)) == name.npos;
    }

    // components: 1 for indices, 3 for points.
    Accessor accessor(uint64_t index, size_t components) {
        const Place place = {"accessors", index};
        const Json& object = item(place);
        if (object.find("sparse")) fail(place, "is sparse, which is not read; save the mesh without sparse data");
        if (!object.find("bufferView")) fail(place, "has no bufferView; save the mesh without compression");
        const Place view_place = {"bufferViews", whole(object, "bufferView", place)};
        const Json& view = item(view_place);
        Accessor result{};
        result.count = whole(object, "count", place);
        result.type = whole(object, "componentType", place);
        const Json* const normalized = object.find("normalized");
        result.normalized = normalized && normalized->is_true();
        const bool whole_type = result.type == 5121 || result.type == 5123 || result.type == 5125;
        const uint64_t size = size_of_type(result.type) * components;
        if (text_of(object, "type") != (components == 1 ? "SCALAR" : "VEC3") || size == 0
            || (components == 1 ? !whole_type : result.type == 5125))
            fail(place, components == 1 ? "should be SCALAR of unsigned whole numbers, for it is used as indices"
                                        : "should be VEC3 of floats, for it is used as positions");
        result.stride = whole(view, "byteStride", view_place, size);
        if (result.stride < size) fail(view_place, "has a byteStride that is less than the size of its elements");
        const std::string_view bytes = buffer(whole(view, "buffer", view_place));
        const uint64_t view_begin = whole(view, "byteOffset", view_place, 0);
        const uint64_t view_size = whole(view, "byteLength", view_place);
        if (view_begin + view_size > bytes.size()) fail(view_place, "ends behind its buffer; the file is cut or wrong");
        const uint64_t begin = whole(object, "byteOffset", place, 0);
        const uint64_t length = result.count > 0 ? (result.count - 1) * result.stride + size : 0;
        if (begin + length > view_size) fail(place, "ends behind its bufferView; the file is cut or wrong");
        result.data = bytes.data() + view_begin + begin;
        return result;
    }

    void add_mesh(Place place, const Transform& transform) {
        for (const Json& primitive : list(item(place), "primitives")) {
            const uint64_t mode = whole(primitive, "mode", place, 4);
            if (mode < 4) continue; // points and lines
            if (mode > 6) fail(place, "has a primitive of mode " + std::to_string(mode) + ", which does not exist");
            const Json* const attributes = primitive.find("attributes");
            if (!attributes) fail(place, "has a primitive without attributes");
            const Accessor positions = accessor(whole(*attributes, "POSITION", place), 3);
            std::optional<Accessor> indices;
            if (primitive.find("indices")) indices = accessor(whole(primitive, "indices", place), 1);
            add_triangles(positions, indices, mode, transform, place);
        }
    }

    void add_triangles(const Accessor& positions, const std::optional<Accessor>& indices, uint64_t mode,
                       const Transform& transform, Place place) {
        const uint64_t count = indices ? indices->count : positions.count;
        if (mode == 4 && count % 3 != 0)
            fail(place, "has " + std::to_string(count) + " corners of triangles, which three does not divide");
        const uint64_t triangles = count < 3 ? 0 : mode == 4 ? count / 3 : count - 2;
        corners_ += 3 * triangles;
        const uint64_t size = size_ + largest_neighbor_;
        if (corners_ > corners_for_a_byte * size)
            fail(place, "is shown so often that the scene has more than " + std::to_string(corners_)
                            + " corners in a file of " + std::to_string(size)
                            + " bytes; save the mesh with its transforms applied");
        const auto index = [&](uint64_t corner) { return indices ? indices->index(corner) : corner; };
        uint64_t first = UINT64_MAX, last = 0;
        for (uint64_t corner = 0; corner < count; ++corner) {
            const uint64_t vertex = index(corner);
            if (vertex >= positions.count)
                fail(place, "names vertex " + std::to_string(vertex) + ", which does not exist; there are "
                                + std::to_string(positions.count) + ", counted from 0");
            first = std::min(first, vertex);
            last = std::max(last, vertex);
        }
        const bool moved = !transform.is_identity();
        const auto number_of = [&](uint64_t vertex) {
            const std::array<double, 3> stored = {positions.coordinate(vertex, 0), positions.coordinate(vertex, 1),
                                                  positions.coordinate(vertex, 2)};
            const auto [x, y, z] = moved ? transform(stored) : stored;
            if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
                fail(place, "has a vertex " + std::to_string(vertex) + " that is not finite; repair it");
            return points_.number_of(x, y, z);
        };
        // The order of the file is kept, unless few of many vertices are used.
        constexpr uint32_t unused = UINT32_MAX, used = UINT32_MAX - 1;
        std::vector<uint32_t> number(triangles > 0 && last - first < count ? last - first + 1 : 0, unused);
        if (!number.empty()) {
            for (uint64_t corner = 0; corner < count; ++corner) number[index(corner) - first] = used;
            for (uint64_t v = 0; v < number.size(); ++v)
                if (number[v] == used) number[v] = number_of(first + v);
        }
        const bool mirrored = transform.determinant() < 0;
        for (uint64_t t = 0; t < triangles; ++t) {
            std::array<uint64_t, 3> corner = {3 * t, 3 * t + 1, 3 * t + 2};
            if (mode == 5) corner = {t, t + 1 + t % 2, t + 2 - t % 2};
            if (mode == 6) corner = {t + 1, t + 2, 0};
            if (mirrored) std::swap(corner[1], corner[2]);
            for (uint64_t& c : corner) c = index(c);
            // Strips are joined by triangles that have a corner twice.
            if (mode == 5 && (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])) continue;
            for (const uint64_t c : corner)
                mesh_.triangles.push_back(number.empty() ? number_of(c) : number[c - first]);
        }
    }

    const Neighbor& neighbor_;
    uint64_t size_;                 // of the file
    uint64_t largest_neighbor_ = 0; // of the files beside it
    uint64_t corners_ = 0;          // of triangles so far
    std::string_view chunk_;        // binary data of a .glb
    Json root_;
    std::map<uint64_t, Buffer> buffers_; // those that were needed
    TriangleMesh mesh_;
    PointNumbers points_;
};

} // namespace

TriangleMesh read_gltf(std::string_view bytes, const Neighbor& neighbor) {
    if (bytes.substr(0, 3) == "\xef\xbb\xbf") bytes.remove_prefix(3); // byte order mark
    return GltfReader(bytes, neighbor).read();
}

} // namespace readers
