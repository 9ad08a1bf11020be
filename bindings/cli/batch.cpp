#include "batch.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <thread>

#include "children.hpp"
#include "counted.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "read_mesh.hpp"
#include "solve.hpp"

namespace cli {

namespace {

using readers::Json;

// null: not JSON.
Json parsed(std::string_view text) {
    try {
        return readers::parse_json(text);
    } catch (const readers::JsonError&) { return {}; }
}

int status_in(const Json& result) {
    const Json* const status = result.find("exit_status");
    return status ? static_cast<int>(status->number()) : EXIT_RESOURCES;
}

// skipped: files that the tool does not read.
std::vector<std::string> meshes_in(const std::string& folder, std::map<std::string, size_t>& skipped) {
    std::vector<std::string> meshes;
    std::error_code code;
    for (const auto& entry : std::filesystem::directory_iterator(folder, code))
        if (!entry.is_regular_file(code)) continue;
        else if (readers::format_of_extension(mesh_extension(entry.path().string())))
            meshes.push_back(entry.path().string());
        else ++skipped[extension_of(entry.path().string())];
    if (code) throw Failure(EXIT_RESOURCES, folder + ": is not a folder that can be read; check its name");
    if (meshes.empty()) throw Failure(EXIT_BAD_INPUT, folder + ": there is no mesh in it");
    std::sort(meshes.begin(), meshes.end());
    return meshes;
}

// Of the bytes of a mesh and the options: a line with another one is of what has changed since.
std::string key_of(const std::string& mesh, const std::vector<std::string>& how) {
    uint64_t hash = 0xcbf29ce484222325u; // FNV-1a
    const auto add = [&](const std::string& text) {
        for (const char c : text + '\0') hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    };
    for (const std::string& word : how) add(word);
    try {
        add(read_file(mesh));
    } catch (const Failure&) {} // the solve says so
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

// The meshes that the file has lines of, with the key of the last one; a last line that is cut off is removed from it.
std::map<std::string, std::string> done_in(const std::string& path) {
    std::map<std::string, std::string> done;
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code)) return done;
    const std::string text = read_file(path);
    size_t begin = 0, line = 1;
    for (size_t end; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1, ++line) {
        const Json row = parsed(std::string_view(text).substr(begin, end - begin));
        const Json *const input = row.find("input"), *const key = row.find("batch");
        if (!input || !input->text())
            throw Failure(EXIT_BAD_INPUT,
                          path + ":" + std::to_string(line) + ": not a line of hmf batch; give another name to --out");
        done[*input->text()] = key && key->text() ? *key->text() : "";
    }
    if (begin < text.size()) std::filesystem::resize_file(path, begin, code);
    return done;
}

} // namespace

std::string report_of_failure(const std::string& mesh, int exit_status, const std::string& sentence) {
    return Json{{"version", version_text()},
                {"input", mesh},
                {"exit_status", exit_status},
                {"errors", std::vector<std::string>{sentence}},
                {"class", "none"}}
        .dump();
}

ExitStatus batch(const std::vector<std::string>& words, const Describe* help) {
    std::string folder, out;
    uint64_t jobs = 1;
    SolveRequest unused;
    Options options = {
        Option{"DIR", &folder, "", "folder of meshes"},
        Option{"--jobs", &jobs, "N", "number of meshes at a time"}.in("[1, 1024]"),
        Option{"--out", &out, "FILE.ndjson",
               "one JSON report per line; meshes that have a line and have not changed\n"
               "are skipped"}
            .writes(".ndjson .jsonl"),
    };
    // Options of solve that say how, not what to write.
    const size_t own = options.size();
    for (const Option& o : solve_options(unused))
        if (o.name[0] == '-' && o.role != Option::OUTPUT
            && (!o.needs[0] || std::strcmp(o.needs, "--report") == 0 || std::strcmp(o.needs, "--repair") == 0))
            options.push_back(o);
    if (help) {
        (*help)(options, "batch", "Solves every mesh of a folder; the exit status is 0 if all were tried.");
        return EXIT_SOLVED;
    }
    parse(options, words, "batch");
    if (out.empty() || out == "-") throw Failure(EXIT_USAGE, "--out is missing; write --out FILE.ndjson");
    if (jobs > Children::most())
        throw Failure(EXIT_USAGE, "--jobs: on this system meshes are solved one after the other; leave it out");
    std::vector<std::string> how;
    for (size_t i = own; i < options.size(); ++i)
        for (const std::string& value : options[i].given) {
            if (unused.threads == 0 && std::strcmp(options[i].name, "--threads") == 0) continue; // see below
            const bool flag = std::holds_alternative<bool*>(options[i].target);
            how.push_back(flag ? options[i].name : std::string(options[i].name) + "=" + value);
        }

    std::vector<std::string> asked = how; // that change results
    asked.erase(std::remove_if(asked.begin(), asked.end(),
                               [](const std::string& word) { return word.rfind("--threads=", 0) == 0; }),
                asked.end());
    // The meshes at a time share the processors.
    if (unused.threads == 0) {
        const uint64_t processors = std::max(std::thread::hardware_concurrency(), 1u);
        how.push_back("--threads=" + std::to_string(std::clamp<uint64_t>(processors / jobs, 1, 256)));
    }

    std::map<std::string, size_t> skipped;
    std::vector<std::string> meshes = meshes_in(folder, skipped);
    const std::map<std::string, std::string> done = done_in(out);
    const size_t all = meshes.size();
    std::map<std::string, std::string> keys;
    for (const std::string& mesh : meshes) keys[mesh] = key_of(mesh, asked);
    const auto is_done = [&](const std::string& mesh) {
        const auto line = done.find(mesh);
        return line != done.end() && line->second == keys[mesh];
    };
    const auto changed = static_cast<size_t>(std::count_if(
        meshes.begin(), meshes.end(), [&](const std::string& m) { return done.count(m) > 0 && !is_done(m); }));
    meshes.erase(std::remove_if(meshes.begin(), meshes.end(), is_done), meshes.end());
    check_writable(out);
    std::FILE* const file = std::fopen(out.c_str(), "ab");
    if (!file) throw Failure(EXIT_RESOURCES, out + ": cannot be written");

    const Progress interrupts; // no bar, but Control-C
    Children children(out + ".part.json");
    const size_t before = all - meshes.size();
    size_t next = 0, count = before, failed = 0;
    bool written = true;
    while (written && (children.count() > 0 || (next < meshes.size() && !was_interrupted()))) {
        while (next < meshes.size() && children.count() < jobs && !was_interrupted())
            children.start(meshes[next++], how);
        for (const Ended& child : children.wait()) {
            Json result = parsed(child.report);
            // What was interrupted is tried again the next time, also what ended before it could listen.
            if (was_interrupted() && (!result.is_object() || status_in(result) == EXIT_LIMIT)) continue;
            if (!result.is_object()) result = parsed(report_of_failure(child.mesh, EXIT_RESOURCES, child.how));
            result.set("batch", keys[child.mesh]);
            const std::string line = result.dump() + "\n";
            written =
                std::fwrite(line.data(), 1, line.size(), file) == line.size() && std::fflush(file) == 0 && written;
            const Json* const errors = result.find("errors");
            const bool solved = status_in(result) == EXIT_SOLVED || !errors || errors->elements().empty();
            const std::string* const sentence = solved ? nullptr : errors->elements()[0].text();
            failed += !solved;
            const std::string prefix = child.mesh + ": ", text = sentence ? *sentence : "solved";
            const bool named = text.compare(0, child.mesh.size() + 1, child.mesh + ":") == 0;
            std::printf("[%zu/%zu] %s%s\n", ++count, all, named ? "" : prefix.c_str(), text.c_str());
            std::fflush(stdout);
        }
    }
    written = std::fclose(file) == 0 && written;
    if (!written) throw Failure(EXIT_RESOURCES, out + ": cannot be written to the end; check the free space");
    std::string summary = counted(all, "mesh", "meshes") + ": " + std::to_string(count - before - failed) + " solved, "
                        + std::to_string(failed) + " not, " + std::to_string(before) + " had a line";
    if (changed > 0) summary += "; " + std::to_string(changed) + " had one of another mesh or other options";
    for (const auto& [extension, files] : skipped)
        summary += "; skipped " + counted(files, "file") + " " + (extension.empty() ? "without extension" : extension);
    std::printf("%s\n", summary.c_str());
    if (was_interrupted()) throw Failure(EXIT_LIMIT, "interrupted; run the same command again to resume");
    return EXIT_SOLVED;
}

} // namespace cli
