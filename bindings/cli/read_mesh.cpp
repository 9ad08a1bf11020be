// Reads meshes with the polygon soup readers of CGAL.  They keep the order of
// the file, but say only yes or no; the stream buffer below, which hands them
// one line at a time, knows the line where they stopped.
#include "read_mesh.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <istream>
#include <memory>
#include <streambuf>

#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>

#include "failure.hpp"

namespace cli {

namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Polygon = std::vector<std::size_t>;

class LineBuffer : public std::streambuf {
public:
    // skip_polylines: leave out lines that begin with "l", which the OBJ
    // reader does not know.
    LineBuffer(std::string& text, bool skip_polylines) : text_(text), skip_polylines_(skip_polylines) {
        setg(text_.data(), text_.data(), text_.data());
    }
    size_t line() const { return line_; }
    bool read_past_end() const { return read_past_end_; }

protected:
    int_type underflow() override {
        char* const end = text_.data() + text_.size();
        char* begin = egptr();
        while (begin != end) {
            void* found = std::memchr(begin, '\n', static_cast<size_t>(end - begin));
            char* stop = found ? static_cast<char*>(found) + 1 : end;
            ++line_;
            const bool polyline = skip_polylines_ && stop - begin > 1 && begin[0] == 'l' && (begin[1] == ' ' || begin[1] == '\t');
            if (!polyline) {
                // The area before stays readable, for unget.
                setg(text_.data(), begin, stop);
                return traits_type::to_int_type(*begin);
            }
            begin = stop;
        }
        setg(text_.data(), end, end);
        read_past_end_ = true;
        return traits_type::eof();
    }

    pos_type seekoff(off_type offset, std::ios_base::seekdir direction, std::ios_base::openmode mode) override {
        off_type base = 0;
        if (direction == std::ios_base::cur) base = gptr() - text_.data();
        if (direction == std::ios_base::end) base = static_cast<off_type>(text_.size());
        return seekpos(pos_type(base + offset), mode);
    }

    pos_type seekpos(pos_type position, std::ios_base::openmode) override {
        const off_type at = position;
        if (at < 0 || at > static_cast<off_type>(text_.size())) return pos_type(off_type(-1));
        char* const here = text_.data() + at;
        if (here != gptr()) {
            line_ = static_cast<size_t>(std::count(text_.data(), here, '\n'));
            setg(text_.data(), here, here);
        }
        read_past_end_ = false;
        return position;
    }

private:
    std::string& text_;
    bool skip_polylines_, read_past_end_ = false;
    size_t line_ = 0;
};

[[noreturn]] void bad_mesh(const std::string& path, const std::string& sentence) {
    throw Failure(EXIT_BAD_INPUT, path + ": " + sentence);
}

} // namespace

std::string read_file(const std::string& path) {
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file) throw Failure(EXIT_RESOURCES, path + ": cannot be opened (" + std::strerror(errno) + "); check the name and the rights");
    std::string text;
    std::vector<char> block(1u << 20);
    while (size_t count = std::fread(block.data(), 1, block.size(), file.get())) text.append(block.data(), count);
    if (std::ferror(file.get())) throw Failure(EXIT_RESOURCES, path + ": cannot be read (" + std::strerror(errno) + ")");
    return text;
}

std::string extension_of(const std::string& path) {
    const size_t dot = path.find_last_of("./\\");
    if (dot == std::string::npos || path[dot] != '.') return "";
    std::string extension = path.substr(dot);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
    return extension;
}

TriangleMesh read_mesh(const std::string& path) {
    const std::string extension = extension_of(path);
    const bool obj = extension == ".obj", off = extension == ".off", ply = extension == ".ply", stl = extension == ".stl";
    if (!(obj || off || ply || stl))
        throw Failure(EXIT_USAGE, path + ": unknown mesh format \"" + extension + "\"; give .obj, .off, .ply or .stl");

    std::string text = read_file(path);
    if (text.empty()) bad_mesh(path, "the file is empty");
    std::vector<Point> points;
    std::vector<Polygon> polygons;
    LineBuffer buffer(text, obj);
    std::istream stream(&buffer);
    // CGAL prints warnings about skipped parts of a file even when asked to be quiet.
    struct Quiet {
        std::streambuf* saved = std::cerr.rdbuf(nullptr);
        ~Quiet() { std::cerr.rdbuf(saved); std::cerr.clear(); }
    };
    bool read = false;
    {
        Quiet quiet;
        try {
            if (obj) read = CGAL::IO::read_OBJ(stream, points, polygons);
            if (off) read = CGAL::IO::read_OFF(stream, points, polygons);
            if (ply) read = CGAL::IO::read_PLY(stream, points, polygons);
            if (stl) read = CGAL::IO::read_STL(stream, points, polygons);
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception&) {
            read = false;
        }
    }
    if (points.empty() || polygons.empty()) {
        if (!read && !buffer.read_past_end())
            bad_mesh(path, "line " + std::to_string(buffer.line()) + " cannot be read as " + extension.substr(1));
        bad_mesh(path, "no vertices or no faces were found; is this an " + extension.substr(1) + " file?");
    }
    // An OBJ that was read to its end can only be refused for an index, which
    // is looked for below.
    if (!read && !(obj && buffer.read_past_end())) {
        const std::string where = buffer.read_past_end() ? "the file ends too early" : "line " + std::to_string(buffer.line());
        bad_mesh(path, where + ", after " + std::to_string(points.size()) + " vertices and " + std::to_string(polygons.size()) +
                           " faces: cannot be read as " + extension.substr(1));
    }

    if (points.size() > 0x7fffffffu || polygons.size() > 0x7fffffffu)
        bad_mesh(path, "more than 2^31 vertices or faces; indices have 32 bits");
    TriangleMesh mesh;
    mesh.positions.reserve(3 * points.size());
    for (const Point& p : points) mesh.positions.insert(mesh.positions.end(), {p.x(), p.y(), p.z()});
    mesh.triangles.reserve(3 * polygons.size());
    for (size_t f = 0; f < polygons.size(); ++f) {
        const Polygon& polygon = polygons[f];
        if (polygon.size() < 3)
            bad_mesh(path, "face " + std::to_string(f) + " has fewer than three corners; remove it");
        for (size_t index : polygon)
            if (index >= points.size())
                bad_mesh(path, "face " + std::to_string(f) + " names a vertex that does not exist; the file has " +
                                   std::to_string(points.size()) + " vertices");
        for (size_t c = 2; c < polygon.size(); ++c)
            for (size_t index : {polygon[0], polygon[c - 1], polygon[c]})
                mesh.triangles.push_back(static_cast<uint32_t>(index));
    }
    return mesh;
}

} // namespace cli
