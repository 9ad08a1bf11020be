// hmf: harmonic measured foliations from the command line.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <new>

#include "failure.hpp"
#include "read_mesh.hpp"
#include "sample.hpp"
#include "solve.hpp"
#include "write_results.hpp"

namespace {

using namespace cli;
using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void expect_extension(const char* option, const std::string& path, std::initializer_list<const char*> allowed) {
    if (path.empty()) return;
    std::string list;
    for (const char* extension : allowed) {
        if (extension_of(path) == extension) return;
        list += list.empty() ? extension : std::string(" or ") + extension;
    }
    throw Failure(EXIT_USAGE, std::string(option) + ": \"" + path + "\" must end in " + list);
}

void check_outputs(const std::string& mesh, const SolveRequest& request) {
    std::vector<std::string> outputs = request.values;
    for (const std::string& path : {request.report, request.history, request.image, request.leaves, request.quads})
        if (!path.empty()) outputs.push_back(path);
    if (!request.obj.empty())
        for (const char* extension : {".obj", ".mtl", ".png"})
            outputs.push_back(with_extension(request.obj, extension));
    for (size_t i = 0; i < outputs.size(); ++i) {
        std::error_code code;
        for (const std::string& input : {mesh, request.loops, request.start, request.marks})
            if (outputs[i] == input || std::filesystem::equivalent(outputs[i], input, code))
                throw Failure(EXIT_USAGE, outputs[i] + ": is an input as well; give another name to the output");
        for (size_t j = 0; j < i; ++j)
            if (outputs[i] == outputs[j])
                throw Failure(EXIT_USAGE, outputs[i] + ": is asked for by two options; give two names");
    }
}

int demo(const std::string& folder) {
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    if (!std::filesystem::is_directory(folder))
        throw Failure(EXIT_RESOURCES, folder + ": the folder cannot be made; give another one");
    const auto in_folder = [&](const char* file) { return (std::filesystem::path(folder) / file).string(); };
    const std::string mesh_path = in_folder("sample.obj");
    const TriangleMesh sample = make_sample();
    write_mesh_obj(mesh_path, sample);

    // Through the file, so that `hmf solve` on it gives the same bits.
    const Clock::time_point start = Clock::now();
    const TriangleMesh mesh = read_mesh(mesh_path);
    SolveRequest request;
    request.mesh_name = mesh_path;
    request.values = {in_folder("values.csv"), in_folder("values.npy")};
    request.report = in_folder("report.json");
    request.history = in_folder("history.csv");
    request.image = in_folder("image.png");
    request.leaves = in_folder("leaves.obj");
    request.conjugate = true;
    request.quads = in_folder("quads.obj");
    request.obj = in_folder("textured.obj");
    const int status = solve(mesh, seconds_since(start), request);
    std::printf("The picture is in %s\n", request.image.c_str());
    return status;
}

int run(int argc, char** argv) {
    CLI::App app{"Harmonic measured foliations on closed triangle meshes", "hmf"};
    app.require_subcommand(1);
    const uint32_t version = hmf_version();
    app.set_version_flag("--version", "hmf " + std::to_string(version / 10000) + "."
                                          + std::to_string(version / 100 % 100) + "." + std::to_string(version % 100));
    app.footer("exit status: 0 solved; 2 usage; 3 bad input; 4 limit reached before convergence\n"
               "(the best result is still written); 5 out of memory or file error");

    std::string folder = "./hmf-demo";
    CLI::App* demo_command = app.add_subcommand("demo", "make the built-in sample, solve it, write every output");
    demo_command->add_option("DIR", folder, "folder of the results")->capture_default_str();

    std::string mesh_path;
    bool json = false;
    CLI::App* info_command = app.add_subcommand("info", "validate a mesh; counts, genus, quality");
    info_command->add_option("MESH", mesh_path, ".obj .off .ply .stl")->required();
    info_command->add_flag("--json", json, "print JSON");

    SolveRequest request;
    std::string values;
    CLI::App* solve_command = app.add_subcommand("solve", "the harmonic foliation in the class of some loops");
    solve_command->add_option("MESH", mesh_path, ".obj .off .ply .stl (stl: equal points are joined)")->required();
    solve_command
        ->add_option(
            "--loops", request.loops,
            "cut: as many as the genus, together they cut the surface into one planar piece; on genus 0 round\n"
            "pairs of marked vertices;\n"
            "handle, tunnel: such that bound inside, outside; pants: 3 genus - 3 + marks that leave pairs of pants;\n"
            "or FILE: one loop a line, vertex indices from 0 (closed edge path) or t: and triangle indices")
        ->type_name("cut|handle|tunnel|pants|FILE")
        ->capture_default_str();
    solve_command
        ->add_option("--marks", request.marks,
                     "vertices that may carry a pole, at least four on genus 0; auto: suggested ones on genus 0, else\n"
                     "none; or FILE: vertex indices from 0, white space between them")
        ->type_name("auto|none|FILE")
        ->capture_default_str();
    solve_command->add_option("--weights", request.loop_weights, "one weight > 0 per loop, default all 1")
        ->delimiter(',')
        ->type_name("W,W,...");
    solve_command
        ->add_option("--start", request.start,
                     "values of --values to start from, instead of loops: the class is theirs")
        ->type_name("FILE.csv")
        ->excludes("--loops");
    std::string method, collapse;
    const std::map<std::string, int32_t> methods = {
        {"newton", HMF_METHOD_NEWTON}, {"whitehead", HMF_METHOD_WHITEHEAD}, {"single-level", HMF_METHOD_SINGLE_LEVEL}};
    solve_command->add_option("--method", method, "default: the most exact of this version")
        ->check(CLI::IsMember(methods).description(""))
        ->type_name("newton|whitehead|single-level");
    const std::map<std::string, int32_t> collapses = {
        {"midpoint", HMF_COLLAPSE_MIDPOINT}, {"endpoint", HMF_COLLAPSE_ENDPOINT}, {"qslim", HMF_COLLAPSE_QSLIM}};
    solve_command->add_option("--collapse", collapse, "how the hierarchy is made, default midpoint")
        ->check(CLI::IsMember(collapses).description(""))
        ->type_name("midpoint|endpoint|qslim");
    solve_command->add_option("--ratio", request.ratio, "edges of a level / edges of the finer one, default 0.5");
    solve_command->add_option("--coarsest", request.coarsest, "vertices of the coarsest level, default 1000");
    solve_command->add_option(
        "--mollify", request.mollify,
        "accept triangles without area: margin of the triangle inequalities,\nin mean edge lengths, e.g. 1e-5");
    solve_command->add_option("--tolerance", request.tolerance,
                              "newton: largest residual, default 1e-8; others: change of energy, default 1e-6");
    solve_command->add_option("--time-limit", request.time_limit, "seconds")->check(CLI::NonNegativeNumber);
    solve_command->add_option("--values", values, "F per edge: .csv (vertex,vertex,value) or .npy")->type_name("FILE");
    solve_command->add_option("--report", request.report, "numbers of the run, JSON")->type_name("FILE.json");
    solve_command->add_option("--history", request.history, "energy and residual over time")->type_name("FILE.csv");
    solve_command
        ->add_option(
            "--obj", request.obj,
            "mesh with (u, v) per corner as texture coordinates;\nFILE.mtl and FILE.png (a checkerboard) come with it")
        ->type_name("FILE.obj");
    solve_command
        ->add_option("--image", request.image, "stripes, zeros blue, marked vertices violet, poles yellow, loops green")
        ->type_name("FILE.png");
    solve_command
        ->add_option("--leaves", request.leaves, "leaves as polylines: level sets and the leaves between zeros")
        ->type_name("FILE.obj");
    solve_command
        ->add_option("--spacing", request.leaf_spacing,
                     "distance of level sets, in the unit of the weights; default a tenth of the least weight")
        ->check(CLI::PositiveNumber);
    std::string pattern = "stripes";
    solve_command->add_option("--pattern", pattern, "of the picture; squares are (u, v)")
        ->check(CLI::IsMember({"stripes", "checkerboard"}).description(""))
        ->type_name("stripes|checkerboard")
        ->capture_default_str();
    solve_command->add_flag("--conjugate", request.conjugate, "leaves: also the lines across, where v is constant");
    solve_command->add_option("--quads", request.quads, "quad mesh along the leaves, irregular only at the zeros")
        ->type_name("FILE.obj");
    solve_command
        ->add_option("--size", request.quad_size,
                     "wished length of an edge of a quad; default: half as many quads as triangles")
        ->check(CLI::PositiveNumber);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) { return app.exit(error) == 0 ? EXIT_SOLVED : EXIT_USAGE; }

    if (*demo_command) return demo(folder);
    const Clock::time_point start = Clock::now();
    if (*info_command) return info(read_mesh(mesh_path), mesh_path, json);

    expect_extension("--values", values, {".csv", ".npy"});
    expect_extension("--start", request.start, {".csv"});
    expect_extension("--report", request.report, {".json"});
    expect_extension("--history", request.history, {".csv"});
    expect_extension("--image", request.image, {".png"});
    expect_extension("--leaves", request.leaves, {".obj"});
    expect_extension("--quads", request.quads, {".obj"});
    expect_extension("--obj", request.obj, {".obj"});
    request.checkerboard = pattern == "checkerboard";
    if (request.checkerboard && request.image.empty())
        throw Failure(EXIT_USAGE, "--pattern says how --image looks; give --image FILE.png");
    if (!values.empty()) request.values = {values};
    if (!method.empty()) request.method = methods.at(method);
    if (!collapse.empty()) request.collapse = collapses.at(collapse);
    check_outputs(mesh_path, request);
    request.mesh_name = mesh_path;
    const TriangleMesh mesh = read_mesh(mesh_path);
    return solve(mesh, seconds_since(start), request);
}

} // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const cli::Failure& failure) {
        std::fprintf(stderr, "hmf: %s\n", failure.what());
        return failure.exit_status;
    } catch (const std::bad_alloc&) { std::fprintf(stderr, "hmf: out of memory\n"); } catch (const std::length_error&) {
        std::fprintf(stderr, "hmf: out of memory\n");
    } catch (const std::exception& error) { std::fprintf(stderr, "hmf: %s\n", error.what()); }
    return cli::EXIT_RESOURCES;
}
