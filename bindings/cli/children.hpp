// Meshes of hmf batch, each solved by a process of its own, so that one that takes all memory or dies ends alone.
// Windows has no fork: there they are solved one after the other in this process.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace cli {

struct Ended {
    std::string mesh;
    std::string report; // JSON, of hmf solve --report; cut off or empty where the process died
    std::string how;    // it ended, where there is no report
};

// What a child writes where there is no report of its own.
std::string report_of_failure(const std::string& mesh, int exit_status, const std::string& sentence);

class Children {
public:
    // scratch: the name of a file that may be written while a mesh is solved, and is removed.
    explicit Children(const std::string& scratch);
    ~Children();
    Children(const Children&) = delete;
    Children& operator=(const Children&) = delete;

    // How many may run at a time.
    static size_t most();
    size_t count() const;
    // Solves a mesh with these words of hmf solve.  Throws Failure.
    void start(const std::string& mesh, const std::vector<std::string>& words);
    // Waits for an event; returns the children that have ended, perhaps none.
    std::vector<Ended> wait();

private:
    struct Child;
    std::string scratch_;
    std::vector<std::unique_ptr<Child>> children_;
};

} // namespace cli
