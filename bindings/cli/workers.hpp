// The threads that a control lends, for what the tool computes itself.
#pragma once

#include <hmf/hmf.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>

namespace cli {

class Workers {
public:
    // NULL, or a control without threads: the calling thread.
    explicit Workers(const hmf_control* control = nullptr) {
        if (!control || !control->parallel_for) return;
        run_ = control->parallel_for;
        user_ = control->parallel_user;
        count_ = control->workers ? std::min(control->workers, 256u) : 16;
    }

    // work(k) once for each k below count, on any thread, in any order.  The first exception of a part is thrown again
    // when all have ended.
    template <class Work>
    void each(size_t count, const Work& work) const {
        Job<Work> job(work, count);
        const auto tasks = static_cast<uint32_t>(std::min<size_t>(count, count_));
        if (tasks > 1) run_(user_, Job<Work>::take, &job, tasks);
        else if (tasks == 1) Job<Work>::take(&job, 0);
        if (job.failure) std::rethrow_exception(job.failure);
    }

private:
    template <class Work>
    struct Job {
        Job(const Work& w, size_t c) : work(w), count(c) {}
        const Work& work;
        const size_t count;
        std::atomic<size_t> next{0};
        std::mutex mutex;
        std::exception_ptr failure;

        static void take(void* context, uint32_t) {
            Job& job = *static_cast<Job*>(context);
            try {
                for (size_t k = job.next++; k < job.count; k = job.next++) job.work(k);
            } catch (...) {
                const std::lock_guard<std::mutex> lock(job.mutex);
                if (!job.failure) job.failure = std::current_exception();
            }
        }
    };

    hmf_parallel_for_fn run_ = nullptr;
    void* user_ = nullptr;
    uint32_t count_ = 1;
};

} // namespace cli
