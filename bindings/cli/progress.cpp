#include "progress.hpp"

#ifdef _WIN32
#include <io.h>
#define isatty _isatty
#define STDERR_FILENO 2
#else
#include <unistd.h>
#endif

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace cli {

namespace {

volatile std::sig_atomic_t interrupted = 0;
extern "C" void on_interrupt(int) {
    // A second interrupt ends the process at once.
    if (interrupted) std::_Exit(130);
    interrupted = 1;
}

} // namespace

bool was_interrupted() { return interrupted != 0; }

Progress::Progress() : visible_(isatty(STDERR_FILENO) != 0), previous_(std::signal(SIGINT, on_interrupt)) {
    control_.struct_size = sizeof control_;
    control_.progress = callback;
    control_.progress_user = this;
}

Progress::~Progress() {
    clear();
    std::signal(SIGINT, previous_ == SIG_ERR ? SIG_DFL : previous_);
}

uint32_t Progress::use_threads(uint64_t count) {
    if (count == 1) return 1;
    pool_.reset(hmf_pool_create(static_cast<uint32_t>(count)));
    control_.workers = hmf_pool_threads(pool_.get());
    if (control_.workers == 1) return 1;
    control_.parallel_for = hmf_pool_run;
    control_.parallel_user = pool_.get();
    return control_.workers;
}

const hmf_control* Progress::part(const char* label, double from, double to) {
    label_ = label;
    from_ = from;
    to_ = to;
    draw(0);
    return &control_;
}

void Progress::clear() {
    if (visible_ && drawn_) std::fprintf(stderr, "\r\033[K");
    drawn_ = false;
}

int32_t Progress::callback(void* user, double fraction) {
    Progress& progress = *static_cast<Progress*>(user);
    progress.draw(fraction);
    return interrupted && progress.heeds_interrupt_ ? HMF_PROGRESS_FINISH : HMF_PROGRESS_CONTINUE;
}

void Progress::draw(double fraction) {
    if (!visible_ || (drawn_ && fraction < 1 && seconds_since(last_) < 0.05)) return;
    constexpr int WIDTH = 40;
    const double all = from_ + (to_ - from_) * std::clamp(fraction, 0.0, 1.0);
    const int filled = static_cast<int>(std::lround(all * WIDTH));
    std::fprintf(stderr, "\r\033[K%-8s [", label_);
    for (int i = 0; i < WIDTH; ++i) std::fputc(i < filled ? '#' : '.', stderr);
    std::fprintf(stderr, "] %3d%%", static_cast<int>(all * 100));
    std::fflush(stderr);
    last_ = Clock::now();
    drawn_ = true;
}

} // namespace cli
