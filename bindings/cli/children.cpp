#include "children.hpp"

#ifndef _WIN32
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "failure.hpp"
#include "read_mesh.hpp"
#include "solve.hpp"

namespace cli {

namespace {

// A report of some kind: by hmf solve into `report`, else as text.
int solve_one(const std::string& mesh, std::vector<std::string> words, const char* report, std::string& text) {
    int status = EXIT_RESOURCES;
    std::string sentence = "out of memory";
    try {
        words.insert(words.begin(), {mesh, "--report", report});
        status = solve(words).exit_status;
        sentence.clear();
    } catch (const Failure& failure) {
        status = failure.exit_status;
        sentence = failure.what();
    } catch (const std::exception&) {}
    if (!sentence.empty()) text = report_of_failure(mesh, status, sentence);
    return status;
}

} // namespace

Children::Children(const std::string& scratch) : scratch_(scratch) {}
Children::~Children() = default;
size_t Children::count() const { return children_.size(); }

#ifdef _WIN32

struct Children::Child {
    std::string mesh;
    std::vector<std::string> words;
};

size_t Children::most() { return 1; }

void Children::start(const std::string& mesh, const std::vector<std::string>& words) {
    children_.push_back(std::make_unique<Child>(Child{mesh, words}));
}

std::vector<Ended> Children::wait() {
    const std::unique_ptr<Child> child = std::move(children_.back());
    children_.pop_back();
    Ended ended{child->mesh, {}, "ended without a report"};
    solve_one(child->mesh, child->words, scratch_.c_str(), ended.report);
    if (ended.report.empty()) ended.report = read_file(scratch_);
    std::remove(scratch_.c_str());
    return {ended};
}

#else

struct Children::Child {
    std::string mesh;
    pid_t process;
    int pipe;
    std::string text;

    // Waits for some text; true: it has ended.
    bool listen() {
        char block[4096];
        const ssize_t size = read(pipe, block, sizeof block);
        if (size > 0) text.append(block, static_cast<size_t>(size));
        return size == 0 || (size < 0 && errno != EINTR);
    }

    Ended end() {
        close(pipe);
        int status = 0;
        while (waitpid(process, &status, 0) < 0 && errno == EINTR) {}
        std::string how = "ended without a report";
        if (WIFSIGNALED(status))
            how = "ended by signal " + std::to_string(WTERMSIG(status))
                + (WTERMSIG(status) == 9 ? ", as when memory is out" : "");
        return {mesh, text, how};
    }
};

size_t Children::most() { return 1024; }

void Children::start(const std::string& mesh, const std::vector<std::string>& words) {
    int ends[2];
    std::fflush(nullptr);
    const bool piped = pipe(ends) == 0;
    const pid_t process = piped ? fork() : -1;
    if (process < 0)
        throw Failure(EXIT_RESOURCES, std::string("no process can be started (") + std::strerror(errno) + ")");
    if (process == 0) {
        close(ends[0]);
        // Control-C is for the parent too, which then starts no other.
        dup2(ends[1], STDOUT_FILENO);
        std::freopen("/dev/null", "w", stderr);
        std::string text;
        const int status = solve_one(mesh, words, "-", text);
        std::printf("%s", text.c_str());
        std::fflush(stdout);
        std::_Exit(status);
    }
    close(ends[1]);
    children_.push_back(std::make_unique<Child>(Child{mesh, process, ends[0], {}}));
}

std::vector<Ended> Children::wait() {
    std::vector<pollfd> waits;
    for (const std::unique_ptr<Child>& child : children_) waits.push_back({child->pipe, POLLIN, 0});
    std::vector<Ended> ended;
    if (poll(waits.data(), waits.size(), -1) < 0) return ended;
    for (size_t i = children_.size(); i-- > 0;) {
        if (!waits[i].revents || !children_[i]->listen()) continue;
        ended.push_back(children_[i]->end());
        children_.erase(children_.begin() + std::ptrdiff_t(i));
    }
    return ended;
}

#endif

} // namespace cli
