#include "solve.hpp"

#include "output.hpp"
#include "run.hpp"

namespace cli {

namespace {

// Where the class comes from: --start, --through, or --loops.
void choose_source(const Options& options, SolveRequest& request) {
    for (const Option& option : options)
        if (std::string("--through") == option.name && !option.given.empty() && request.through.empty())
            throw Failure(EXIT_USAGE, "--through: nothing is picked; give vertices or places X,Y,Z");
    // An atlas is as even as the foliation.
    for (const Option& option : options)
        if (std::string("--loops") == option.name && option.given.empty() && !request.atlas.empty()
            && request.weights.empty())
            request.loops = "even";
    if (!request.start.empty() || !request.through.empty()) request.loops.clear();
}

} // namespace

std::string SolveRequest::name_of_loop(size_t line) const {
    if (!through.empty()) return "--through, loop " + std::to_string(line);
    return shown(loops) + ":" + std::to_string(line);
}

std::string version_text() {
    const uint32_t version = hmf_version();
    return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "."
         + std::to_string(version % 100);
}

Outcome solve(const std::vector<std::string>& words) {
    SolveRequest request;
    Options options = solve_options(request);
    parse(options, words, "solve");
    choose_source(options, request);
    if (!request.start.empty() && !request.weights.empty() && request.image.empty() && request.obj.empty()
        && request.textured.empty() && request.leaves.empty())
        throw Failure(EXIT_USAGE, "--weights: has no effect with --start, whose values have their own; leave it out");
    Run run(request, options);
    run.make();
    return run.finish();
}

Outcome quads(const std::vector<std::string>& words) {
    SolveRequest request;
    Options options = quads_options(request);
    parse(options, words, "quads");
    choose_source(options, request);
    if (request.no_poles) request.marks = "none";
    SolveRequest cut = request;
    cut.loops = "cut";
    Run run(request, options);
    run.make();
    if (!run.wants_cut_loops()) return run.finish();
    try {
        Run other(cut, options);
        other.make();
        if (other.has_better_quads_than(run)) {
            request.loops = cut.loops; // in the report
            Outcome made = other.finish();
            made.notes.push_back("even loops carry no good quads of this size; these are of --loops cut");
            return made;
        }
    } catch (const Failure&) {}
    return run.finish();
}

} // namespace cli
