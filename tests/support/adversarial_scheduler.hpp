// A host whose threads are as bad as the contract allows: tasks begin in
// another order each time, wait a while, and several run at once.
#pragma once

#include <hmf/hmf.h>

#include <atomic>
#include <thread>
#include <utility>
#include <vector>

#include "meshes.hpp"

namespace test {

class AdversarialScheduler {
public:
    explicit AdversarialScheduler(uint32_t workers, uint64_t seed = 1) : workers_(workers), random_(seed) {}

    // Adds the threads to a control, for as long as this object lives.
    hmf_control lend(hmf_control control = {}) {
        control.struct_size = sizeof control;
        control.workers = workers_;
        control.parallel_for = run;
        control.parallel_user = this;
        return control;
    }
    uint64_t calls = 0;      // of parallel_for
    uint64_t violations = 0; // of its contract: from a task, or with a count that may not be

private:
    static void run(void* user, hmf_task_fn task, void* context, uint32_t count) {
        AdversarialScheduler& self = *static_cast<AdversarialScheduler*>(user);
        if (self.running_.exchange(true) || count < 2 || count > self.workers_) ++self.violations;
        ++self.calls;
        std::vector<uint32_t> order(count);
        for (uint32_t i = 0; i < count; ++i) order[i] = i;
        for (uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[self.random_.below(i)]);
        // Few calls have threads of their own, which are slow to start; the others differ in order.
        const bool threads = self.calls % (self.calls < 64 ? 16 : 128) < 2;
        const uint64_t waits = self.random_.bits();
        std::vector<std::thread> started;
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t index = order[i];
            const auto late = [=] {
                if (threads && waits >> (i % 64) & 1)
                    for (uint32_t k = 0; k < 20 * (i + 1); ++k) std::this_thread::yield();
                task(context, index);
            };
            if (threads && i + 1 < count) started.emplace_back(late);
            else late();
        }
        for (std::thread& t : started) t.join();
        self.running_ = false;
    }

    uint32_t workers_;
    Random random_;
    std::atomic<bool> running_{false};
};

} // namespace test
