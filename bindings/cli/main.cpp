// hmf: harmonic measured foliations from the command line.
#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#endif

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>

#include "batch.hpp"
#include "describe.hpp"
#include "failure.hpp"
#include "info.hpp"
#include "options.hpp"
#include "read_mesh.hpp"
#include "sample.hpp"
#include "solve.hpp"
#include "write_results.hpp"

namespace {

using namespace cli;
using Words = std::vector<std::string>;

int print_outcome(const Outcome& outcome) {
    // An output on standard output stays alone there.
    std::fprintf(outcome.uses_stdout ? stderr : stdout, "%s\n", outcome.summary.c_str());
    std::fflush(stdout);
    // A file may have thousands of components; the report names all.
    constexpr size_t most_notes = 20;
    for (size_t n = 0; n < std::min(most_notes, outcome.notes.size()); ++n)
        std::fprintf(stderr, "hmf: %s\n", outcome.notes[n].c_str());
    if (outcome.notes.size() > most_notes)
        std::fprintf(stderr, "hmf: and %zu more; --report names all\n", outcome.notes.size() - most_notes);
    for (const std::string& error : outcome.errors) std::fprintf(stderr, "hmf: %s\n", error.c_str());
    return outcome.exit_status;
}

int solve_command(const Words& words, const Describe* help) {
    if (!help) return print_outcome(solve(words));
    SolveRequest request;
    (*help)(solve_options(request), "solve",
            "Computes the harmonic foliation in the class of the loops, and what follows from it.");
    return EXIT_SOLVED;
}

int quads_command(const Words& words, const Describe* help) {
    if (!help) return print_outcome(quads(words));
    SolveRequest request;
    (*help)(quads_options(request), "quads", "Makes a quad mesh along the leaves of a foliation.");
    return EXIT_SOLVED;
}

int info_command(const Words& words, const Describe* help) {
    InfoRequest request;
    Options options = {
        Option{"MESH", &request.mesh, "", MESH_FILES}.reads(""),
        Option{"--json", &request.json, "", "print JSON"},
    };
    for (const Option& o : mesh_options(request.prepare)) options.push_back(o);
    if (help) (*help)(options, "info", "Tells whether a mesh can be used; counts, genus, quality.");
    else {
        parse(options, words, "info");
        info(request);
    }
    return EXIT_SOLVED;
}

int demo_command(const Words& words, const Describe* help) {
    std::string folder = "./hmf-demo";
    Options options = {Option{"DIR", &folder, "", "output folder"}.or_default()};
    if (help) {
        (*help)(options, "demo",
                "Makes a sample mesh, solves it, and writes pictures, leaves, quads and other results.");
        return EXIT_SOLVED;
    }
    parse(options, words, "demo");
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    if (!std::filesystem::is_directory(folder))
        throw Failure(EXIT_RESOURCES, folder + ": the folder cannot be made; give another one");
    const auto in_folder = [&](const char* file) { return (std::filesystem::path(folder) / file).string(); };
    // Through the file, so that `hmf solve` on it gives the same bits.
    write_mesh_obj(in_folder("sample.obj"), make_sample());
    const int status = solve_command({in_folder("sample.obj"),
                                      "--values",
                                      in_folder("values.csv"),
                                      "--values",
                                      in_folder("values.npy"),
                                      "--report",
                                      in_folder("report.json"),
                                      "--history",
                                      in_folder("history.csv"),
                                      "--save-loops",
                                      in_folder("loops.txt"),
                                      "--image",
                                      in_folder("image.png"),
                                      "--leaves",
                                      in_folder("leaves.obj"),
                                      "--conjugate",
                                      "--quads",
                                      in_folder("quads.obj"),
                                      "--obj",
                                      in_folder("textured.obj")},
                                     nullptr);
    std::printf("The picture is in %s\n", in_folder("image.png").c_str());
    return status;
}

int manual_command(const Words& words, const Describe* help);
int completion_command(const Words& words, const Describe* help);

struct Command {
    const char* name;
    const char* help;
    int (*run)(const Words& words, const Describe* help);
};
const Command commands[] = {
    {"demo", "make a sample mesh, solve it, write pictures, leaves, quads", demo_command},
    {"info", "validate a mesh; counts, genus, quality", info_command},
    {"solve", "compute the harmonic foliation in the class of the loops", solve_command},
    {"quads", "make a quad mesh", quads_command},
    {"batch", "solve every mesh of a folder",
     [](const Words& words, const Describe* help) { return static_cast<int>(batch(words, help)); }},
    {"completion", "print the completion of bash, zsh or fish", completion_command},
    {"manual", "print the manual page", manual_command},
};

// The tables of all commands, each of which calls this.
void describe_all(const Describe& describe) {
    for (const Command& command : commands) command.run({}, &describe);
}

int manual_command(const Words& words, const Describe* help) {
    Options options;
    if (help) (*help)(options, "manual", "Prints the manual page, for man.");
    else {
        parse(options, words, "manual");
        std::fputs(manual_page(version_text(), describe_all).c_str(), stdout);
    }
    return EXIT_SOLVED;
}

int completion_command(const Words& words, const Describe* help) {
    int32_t shell = 0;
    Options options = {
        Option{"SHELL", Choice{&shell, {{"bash", 0}, {"zsh", 1}, {"fish", 2}}}, "", "bash, zsh or fish"}};
    if (help) (*help)(options, "completion", "Prints the completion of a shell: source <(hmf completion bash)");
    else {
        parse(options, words, "completion");
        std::fputs(completion(static_cast<Shell>(shell), describe_all).c_str(), stdout);
    }
    return EXIT_SOLVED;
}

void print_commands() {
    std::printf("Harmonic measured foliations on triangle meshes\n\nusage: hmf COMMAND ...\n\n");
    for (const Command& command : commands) std::printf("  %-12s%s\n", command.name, command.help);
    std::printf("\nhmf COMMAND --help, or hmf help COMMAND, lists the options of a command; hmf --version prints the "
                "version.\n\n"
                "exit status: 0 solved; 2 wrong usage; 3 bad or unsupported input; 4 stopped at a limit (the best\n"
                "foliation so far is written); 5 out of memory or file error\n");
}

int run(const Words& words) {
    std::string names;
    for (const Command& command : commands) names += (names.empty() ? "" : ", ") + std::string(command.name);
    if (words.empty()) throw Failure(EXIT_USAGE, "a command is missing; the commands are " + names);
    const bool asks = words[0] == "help" || words[0] == "--help" || words[0] == "-h";
    if (asks && words.size() > 2) throw Failure(EXIT_USAGE, "help describes one command at a time");
    if (asks && words.size() == 1) print_commands();
    else if (words[0] == "--version") std::printf("hmf %s\n", version_text().c_str());
    else {
        const std::string& name = asks ? words[1] : words[0];
        for (const Command& command : commands) {
            if (name != command.name) continue;
            const Words rest = asks ? Words{"--help"} : Words(words.begin() + 1, words.end());
            const bool help =
                std::count(rest.begin(), rest.end(), "--help") + std::count(rest.begin(), rest.end(), "-h") > 0;
            const Describe describe = print_help;
            return command.run(rest, help ? &describe : nullptr);
        }
        throw Failure(EXIT_USAGE, "there is no command \"" + name + "\"; the commands are " + names);
    }
    return EXIT_SOLVED;
}

} // namespace

int main(int argc, char** argv) {
#ifdef _WIN32
    // Standard input and output carry files as they are.
    for (std::FILE* const stream : {stdin, stdout}) _setmode(_fileno(stream), _O_BINARY);
#endif
    try {
        return run(Words(argv + 1, argv + std::max(argc, 1)));
    } catch (const cli::Failure& failure) {
        std::fprintf(stderr, "hmf: %s\n", failure.what());
        return failure.exit_status;
    } catch (const std::bad_alloc&) { std::fprintf(stderr, "hmf: out of memory\n"); } catch (const std::length_error&) {
        std::fprintf(stderr, "hmf: out of memory\n");
    } catch (const std::exception& error) { std::fprintf(stderr, "hmf: %s\n", error.what()); }
    return cli::EXIT_RESOURCES;
}
