// The readers of mesh files (bindings/readers) under arbitrary bytes, in each format.  Whatever they are, there is no
// crash; a mesh that is read is consistent; a refusal is a sentence that a terminal can show and names a line that
// exists; and the memory that is held stays below a multiple of the size of the file.  What is read is repaired.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include "../bindings/readers/mesh_formats.hpp"
#include "../bindings/readers/repair.hpp"
#include "bytes.hpp"

namespace {

// The most that was found is 170, for a glTF whose nodes repeat a mesh; in the other formats it is 36.
constexpr size_t bytes_for_a_byte = 320, bytes_at_least = 1u << 16;

size_t held = 0, most = SIZE_MAX; // bytes; the file itself is not counted
constexpr size_t prefix = alignof(std::max_align_t);

void* allocate(size_t size) {
    FUZZ_ASSERT(size < most && held + size < most);
    char* const block = static_cast<char*>(std::malloc(size + prefix));
    FUZZ_ASSERT(block);
    std::memcpy(block, &size, sizeof size);
    held += size;
    return block + prefix;
}

void release(void* pointer) {
    if (!pointer) return;
    char* const block = static_cast<char*>(pointer) - prefix;
    size_t size;
    std::memcpy(&size, block, sizeof size);
    held -= size;
    std::free(block);
}

// Triangles stay where they are, each is one of before, and there is nothing to repair afterwards but what was left.
void repair_twice(readers::TriangleMesh mesh, bool join_points) {
    const readers::TriangleMesh before = mesh;
    const readers::Repairs done = readers::repair(mesh, join_points ? std::optional<double>(0) : std::nullopt);
    FUZZ_ASSERT(done.triangles.size() == mesh.triangle_count() && done.vertices.size() == mesh.vertex_count());
    for (const uint32_t vertex : mesh.triangles) FUZZ_ASSERT(vertex < mesh.vertex_count());
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        double largest[2][3] = {};
        for (size_t i = 0; i < 9; ++i) {
            const size_t corner = i / 3, c = i % 3;
            const double here = mesh.positions[3 * size_t{mesh.triangles[3 * t + corner]} + c];
            const double there =
                before.positions[3 * size_t{before.triangles[3 * size_t{done.triangles[t]} + corner]} + c];
            largest[0][c] = std::max(largest[0][c], here);
            largest[1][c] = std::max(largest[1][c], there);
        }
        for (size_t c = 0; c < 3; ++c) FUZZ_ASSERT(largest[0][c] == largest[1][c]);
    }
    for (const std::string& sentence : done.sentences()) FUZZ_ASSERT(sentence.size() > 8);
    if (done.crowded_edges > 0 || done.one_sided_patches > 0) return;
    FUZZ_ASSERT(readers::repair(mesh).count() == 0);
}

void read(std::string_view bytes, readers::Format format) {
    using namespace readers;
    const size_t lines = 1 + static_cast<size_t>(std::count(bytes.begin(), bytes.end(), '\n'));
    // Files beside a .gltf: one that is the file again, no other.
    const auto neighbor = [bytes](const std::string& name) { return name == "self" ? bytes : std::string_view(); };
    try {
        const TriangleMesh mesh = read_mesh(bytes, format, neighbor);
        FUZZ_ASSERT(!mesh.positions.empty() && mesh.positions.size() % 3 == 0);
        FUZZ_ASSERT(!mesh.triangles.empty() && mesh.triangles.size() % 3 == 0);
        for (const double x : mesh.positions) FUZZ_ASSERT(std::isfinite(x));
        for (const uint32_t vertex : mesh.triangles) FUZZ_ASSERT(vertex < mesh.vertex_count());
        most = SIZE_MAX; // what is bounded is reading
        for (const bool join_points : {false, true}) repair_twice(mesh, join_points);
    } catch (const MeshError& error) {
        FUZZ_ASSERT(error.line <= lines + 1);
        FUZZ_ASSERT(std::strlen(error.what()) > 8);
        for (const char* c = error.what(); *c; ++c) FUZZ_ASSERT(*c >= ' ' && *c <= '~');
    }
}

} // namespace

void* operator new(size_t size) { return allocate(size); }
void* operator new[](size_t size) { return allocate(size); }
void* operator new(size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void* operator new[](size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void operator delete(void* pointer) noexcept { release(pointer); }
void operator delete[](void* pointer) noexcept { release(pointer); }
void operator delete(void* pointer, size_t) noexcept { release(pointer); }
void operator delete[](void* pointer, size_t) noexcept { release(pointer); }

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using readers::Format;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const size_t before = held;
    for (const Format format :
         {Format::obj, Format::off, Format::ply, Format::stl, Format::gltf, Format::medit, Format::gmsh, Format::vtk}) {
        most = before + bytes_at_least + bytes_for_a_byte * size;
        read(bytes, format);
        most = SIZE_MAX;
        FUZZ_ASSERT(held == before);
    }
    readers::format_of_content(bytes);
    return 0;
}
