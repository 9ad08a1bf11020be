// Progress bar and Control-C of a command.
#pragma once

#include <hmf/hmf.h>
#include <hmf/pool.h>

#include <chrono>
#include <memory>

namespace cli {

using Clock = std::chrono::steady_clock;
inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// One bar for several calls; each fills its part.  While it lives the first Control-C ends the call that runs, the
// second one the program.
class Progress {
public:
    Progress();
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // For the calls of this part.
    const hmf_control* part(const char* label, double from, double to);
    void clear();
    // Lends threads to these calls, 0: one for each processor; returns how many.
    uint32_t use_threads(uint64_t count);
    // What follows an interrupted solve is not interrupted by the same Control-C.
    void finish_quietly() { heeds_interrupt_ = false; }

private:
    static int32_t callback(void* user, double fraction);
    void draw(double fraction);

    const char* label_ = "";
    bool visible_, drawn_ = false, heeds_interrupt_ = true;
    double from_ = 0, to_ = 1;
    Clock::time_point last_;
    hmf_control control_ = {};
    std::unique_ptr<hmf_pool, decltype(&hmf_pool_destroy)> pool_{nullptr, hmf_pool_destroy};
    void (*previous_)(int);
};

// Control-C was pressed.
bool was_interrupted();

} // namespace cli
