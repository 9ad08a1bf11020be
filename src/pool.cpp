// The pool of hmf/pool.h: threads that sleep between two jobs.
//
// A job is one call of hmf_pool_run.  Its tasks are numbers that caller and threads take from a counter; a second
// counter, of the tasks that have ended, releases the caller. Jobs of one solve follow each other within microseconds,
// so a thread spins for a short while before it sleeps, and so does the caller.
#include "../include/hmf/pool.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>

struct hmf_pool {
    static constexpr uint32_t MOST = 256;

    std::mutex busy;  // held during a job
    std::mutex mutex; // of what follows
    std::condition_variable wake, done;
    std::atomic<uint64_t> job{0}; // counts the jobs, changed under the mutex; odd: a job may be joined
    std::atomic<bool> ending{false};
    uint32_t inside = 0;              // threads that have joined the job
    std::atomic<uint32_t> outside{0}; // tasks that have not ended
    hmf_task_fn task = nullptr;
    void* context = nullptr;
    uint32_t count = 0;
    std::atomic<uint32_t> next{0};
    uint32_t started = 0;
    std::thread thread[MOST];

    // Takes tasks until none is left.
    void take() {
        uint32_t ended = 0;
        for (uint32_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count; ++ended) task(context, i);
        if (ended) outside.fetch_sub(ended, std::memory_order_acq_rel);
    }

    void work() {
        uint64_t seen = 0;
        for (;;) {
            for (uint32_t look = 0; look < 200 && job.load(std::memory_order_acquire) == seen && !ending; ++look)
                std::this_thread::yield();
            std::unique_lock<std::mutex> lock(mutex);
            wake.wait(lock, [&] { return ending || job.load(std::memory_order_relaxed) != seen; });
            if (ending) return;
            seen = job.load(std::memory_order_relaxed);
            if (seen % 2 == 0) continue;
            ++inside;
            lock.unlock();
            take();
            lock.lock();
            if (--inside == 0) done.notify_one();
        }
    }

    void run(hmf_task_fn given, void* given_context, uint32_t given_count) {
        {
            const std::lock_guard<std::mutex> lock(mutex);
            task = given;
            context = given_context;
            count = given_count;
            next.store(0, std::memory_order_relaxed);
            outside.store(given_count, std::memory_order_relaxed);
            job.fetch_add(1, std::memory_order_release);
        }
        if (given_count > 2) wake.notify_all();
        else wake.notify_one();
        take();
        for (uint32_t look = 0; look < 200 && outside.load(std::memory_order_acquire) > 0; ++look)
            std::this_thread::yield();
        // No thread joins from here on, and those inside leave.
        std::unique_lock<std::mutex> lock(mutex);
        job.fetch_add(1, std::memory_order_release);
        done.wait(lock, [&] { return inside == 0; });
    }
};

extern "C" {

hmf_pool* hmf_pool_create(uint32_t threads) {
    hmf_pool* const pool = new (std::nothrow) hmf_pool;
    if (!pool) return nullptr;
    if (threads == 0) threads = std::thread::hardware_concurrency();
    if (threads > hmf_pool::MOST) threads = hmf_pool::MOST;
    while (pool->started + 1 < threads) {
        try {
            pool->thread[pool->started] = std::thread([pool] { pool->work(); });
        } catch (...) {
            break; // the system gives no more
        }
        ++pool->started;
    }
    return pool;
}

void hmf_pool_destroy(hmf_pool* pool) {
    if (!pool) return;
    {
        const std::lock_guard<std::mutex> lock(pool->mutex);
        pool->ending = true;
    }
    pool->wake.notify_all();
    for (uint32_t i = 0; i < pool->started; ++i) pool->thread[i].join();
    delete pool;
}

uint32_t hmf_pool_threads(const hmf_pool* pool) { return pool ? pool->started + 1 : 1; }

void hmf_pool_run(void* user, hmf_task_fn task, void* context, uint32_t count) {
    hmf_pool* const pool = static_cast<hmf_pool*>(user);
    if (pool && pool->started > 0 && count > 1) {
        const std::unique_lock<std::mutex> lock(pool->busy, std::try_to_lock);
        if (lock) {
            pool->run(task, context, count);
            return;
        }
    }
    for (uint32_t i = 0; i < count; ++i) task(context, i);
}

} // extern "C"
