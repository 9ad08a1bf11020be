// Memory and call state of the core: allocator hooks, memory limit, arrays that report failure instead of throwing, and
// the arena of a hierarchy.
//
// The core is compiled without exceptions. A function that can fail only because memory ran out or the call was
// cancelled returns Done. A function that can fail for other reasons returns hmf_status. Neither may be ignored. The
// first failure decides the status of the call.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "../../../include/hmf/hmf.h"
#include "exact_arithmetic.hpp"
#include "parallel.hpp"

namespace hmf {

// Whether the work was done. false: out of memory, or cancelled; Call::stopped() says which. Read it like a bool; the
// compiler warns if it is ignored.
class [[nodiscard]] Done {
public:
    constexpr Done(bool done) : done_(done) {}
    constexpr explicit operator bool() const { return done_; }

private:
    bool done_;
};

// Allocator hooks with accounting.  Not thread-safe: each call owns one.
class Memory {
public:
    Memory(hmf_allocate_fn allocate, hmf_release_fn release, void* user, uint64_t limit, uint64_t used_before = 0);
    // A part of another account: blocks taken here count there, and the limit of that account holds.
    explicit Memory(Memory& whole) :
        allocate_(whole.allocate_), release_(whole.release_), user_(whole.user_), limit_(0), used_(0), peak_(0),
        whole_(&whole) {}
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
    ~Memory() { release_kept(); }

    void* take(size_t bytes);             // nullptr on failure; see failure()
    void give(void* block, size_t bytes); // nullptr is allowed
    // For arrays: bytes becomes the size of the block, which may be slightly larger than requested.
    void* take_array(size_t& bytes);
    void give_array(void* block, size_t bytes);
    // Keeps large blocks of arrays for other arrays of about the same size, because the system clears fresh memory page
    // by page, which takes longer than most passes over it. Blocks kept and in use together never exceed the peak of
    // those in use; limit and peak count the blocks in use.
    void keep_arrays() { keeps_ = true; }
    void release_kept();                            // and keeps no more
    hmf_status failure() const { return failure_; } // HMF_OK, HMF_ERROR_MEMORY or HMF_ERROR_MEMORY_LIMIT
    uint64_t used() const { return used_; }
    uint64_t peak() const { return peak_; }

private:
    hmf_allocate_fn allocate_;
    hmf_release_fn release_;
    void* user_;
    uint64_t limit_, used_, peak_;
    Memory* whole_ = nullptr;
    hmf_status failure_ = HMF_OK;

    struct Kept {
        void* block;
        size_t bytes;
    };
    static constexpr size_t MOST_KEPT = 64, SMALLEST_KEPT = 65536, PAGE = 4096;
    Kept pick(size_t i);
    void drop_oldest();
    size_t find_kept(size_t bytes) const; // kept_count_: none
    void count(size_t bytes) {
        used_ += bytes;
        if (used_ > peak_) peak_ = used_;
    }
    bool keeps_ = false;
    size_t kept_count_ = 0;
    uint64_t kept_bytes_ = 0;
    Kept kept_[MOST_KEPT] = {}; // the oldest first
};

// Owning array of a trivially copyable type.
template <class T>
class Array {
public:
    Array() = default;
    ~Array() { release(); }
    Array(const Array&) = delete;
    Array& operator=(const Array&) = delete;
    Array(Array&& other) noexcept { swap(other); }
    Array& operator=(Array&& other) noexcept {
        swap(other);
        return *this;
    }

    // Sets size and capacity to n; the content is undefined.
    Done allocate(Memory& memory, size_t n) {
        release();
        memory_ = &memory;
        if (n == 0) return true;
        if (n > SIZE_MAX / sizeof(T)) {
            memory.take(SIZE_MAX);
            return false;
        }
        size_t bytes = n * sizeof(T);
        data_ = static_cast<T*>(memory.take_array(bytes));
        if (!data_) return false;
        bytes_ = bytes;
        size_ = capacity_ = n;
        return true;
    }
    Done allocate_filled(Memory& memory, size_t n, T value) {
        if (!allocate(memory, n)) return false;
        for (size_t i = 0; i < n; ++i) data_[i] = value;
        return true;
    }
    // In blocks: the threads of the host share the first touch of fresh memory.
    Done allocate_filled(Memory& memory, size_t n, T value, const Parallel& parallel) {
        if (!allocate(memory, n)) return false;
        T* const to = data_;
        parallel.for_blocks(n, [=](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) to[i] = value;
        });
        return true;
    }
    // An empty array that grows by push.
    void start(Memory& memory) {
        release();
        memory_ = &memory;
    }
    Memory& memory() const { return *memory_; } // of an array that was started or allocated
    Done push(T value) {
        if (!reserve_one()) return false;
        data_[size_++] = value;
        return true;
    }
    Done reserve_one() { return size_ < capacity_ ? Done(true) : reserve(capacity_ ? 2 * capacity_ : 16); }
    // Where room for it has been reserved.
    void add(T value) {
        assert(size_ < capacity_);
        data_[size_++] = value;
    }
    Done reserve(size_t n) {
        if (n <= capacity_) return true;
        size_t bytes = n * sizeof(T);
        T* block = static_cast<T*>(memory_->take_array(bytes));
        if (!block) return false;
        if (size_) std::memcpy(static_cast<void*>(block), data_, size_ * sizeof(T));
        if (data_) memory_->give_array(data_, bytes_);
        data_ = block;
        bytes_ = bytes;
        capacity_ = n;
        return true;
    }
    void pop() {
        assert(size_);
        --size_;
    }
    void clear() { size_ = 0; }
    void release() {
        if (data_) memory_->give_array(data_, bytes_);
        data_ = nullptr;
        size_ = capacity_ = bytes_ = 0;
    }
    void swap(Array& other) {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
        std::swap(bytes_, other.bytes_);
        std::swap(memory_, other.memory_);
    }
    T& operator[](size_t i) {
        assert(i < size_);
        return data_[i];
    }
    const T& operator[](size_t i) const {
        assert(i < size_);
        return data_[i];
    }
    T& back() {
        assert(size_);
        return data_[size_ - 1];
    }
    const T& back() const {
        assert(size_);
        return data_[size_ - 1];
    }
    T* data() { return data_; }
    const T* data() const { return data_; }
    size_t size() const { return size_; }
    size_t capacity() const { return capacity_; }
    bool empty() const { return size_ == 0; }
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }

private:
    T* data_ = nullptr;
    size_t size_ = 0, capacity_ = 0;
    size_t bytes_ = 0; // of the block
    Memory* memory_ = nullptr;
};

// Arrays that are freed together: those of a hierarchy.  Small ones lie one
// after the other in blocks, large ones in blocks of their own.
//
//     | block | array | array | array |  free  |    newest block first
//                                      ^ at_   ^ end_
class Arena {
public:
    explicit Arena(Memory& memory) : memory_(memory) {}
    ~Arena() { clear(); }
    void clear();
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;

    // n elements, not set; never nullptr for n = 0 unless out of memory.
    template <class T>
    T* take(size_t n) {
        return static_cast<T*>(take_bytes(n, sizeof(T)));
    }

private:
    struct Block {
        Block* next;
        size_t bytes;
    };
    static constexpr size_t SMALLEST_BLOCK = 4096, LARGEST_BLOCK = 32768;
    char* new_block(size_t bytes); // where its content begins
    void* take_bytes(size_t count, size_t size);
    Memory& memory_;
    Block* blocks_ = nullptr;
    char *at_ = nullptr, *end_ = nullptr; // free part of the block that is being filled
    size_t block_bytes_ = SMALLEST_BLOCK;
};

// State of one call of the interface: memory, error, progress, time.
class Call {
public:
    Call(Memory& memory, hmf_error* error, const hmf_control& control);
    Call(Memory& memory, hmf_error* error, hmf_progress_fn progress, void* progress_user);
    // Part of another call that may fail without it: reports to that call and is cancelled with it.
    // error: of the part.
    explicit Call(Call* whole, hmf_error* error = nullptr);

    Memory& memory;
    const Parallel parallel; // what the host lends of its threads

    // Records the first failure (later ones are ignored) and returns status.
    hmf_status fail(hmf_status status, int32_t element, uint64_t index, const char* format, ...)
#if defined(__GNUC__)
        __attribute__((format(printf, 5, 6)))
#endif
        ;
    hmf_status out_of_memory(); // status and sentence of memory.failure(), or of was_cancelled()
    hmf_status was_cancelled(); // HMF_CANCELLED and its sentence
    // Of a stage that is not Done: cancelled, or out of memory.
    hmf_status stopped() { return out_of_memory(); }
    hmf_status status() const { return status_; }

    // Reports progress, mapped into the current range; false: cancelled.  With
    // can_finish the answer HMF_PROGRESS_FINISH only sets finishing().
    // Call it every few thousand elementary steps.
    Done tick(double fraction, bool can_finish = false);
    // Adds elementary steps to those since the last report, and reports when they are a unit of work; false:
    // cancelled.  What walks a star, a cluster, a loop or a polygon adds what it walked, so that the time between
    // two reports does not depend on the input.
    Done work(uint64_t steps, double fraction = 0, bool can_finish = true) {
        steps_ += steps;
        return steps_ < UNIT_OF_WORK || tick(fraction, can_finish);
    }
    // Calls f(begin, end) for the blocks of a pass over n elements, on the threads of the host, and reports progress at
    // regular numbers of blocks; false: cancelled.
    template <class F>
    Done pass(size_t n, double fraction, F f, bool can_finish = false) {
        const size_t block = Parallel::pass_block(n), stride = BLOCKS_BETWEEN_REPORTS * block;
        for (size_t first = 0; first < n; first += stride) {
            if (!tick(fraction, can_finish)) return false;
            parallel.for_blocks(n - first < stride ? n - first : stride, block,
                                [&](size_t begin, size_t end) { f(first + begin, first + end); });
        }
        return true;
    }
    void range(double from, double to) {
        from_ = from;
        to_ = to;
    }                // where the fractions 0 and 1 of tick lie
    void finished(); // reports 1; nothing is left to cancel
    double reached() const { return last_; }
    bool cancelled() const { return cancelled_; }
    bool finishing() const { return finishing_; } // the callback asked to stop improving
    void never_finish() { may_finish_ = false; }  // HMF_PROGRESS_FINISH is as CANCEL

    double seconds() const; // since the construction
    void set_time_limit(double limit) { time_limit_ = limit; }
    bool out_of_time() const { return time_limit_ > 0 && seconds() > time_limit_; }

private:
    static constexpr uint64_t UNIT_OF_WORK = 16384;     // elementary steps
    static constexpr size_t BLOCKS_BETWEEN_REPORTS = 8; // 32 768 elements, up to a million of them

    hmf_error* error_;
    hmf_progress_fn progress_;
    void* progress_user_;
    hmf_status status_ = HMF_OK;
    bool cancelled_ = false, finishing_ = false, may_finish_ = true;
    uint64_t steps_ = 0; // since the last report
    double from_ = 0, to_ = 1, last_ = 0, time_limit_ = 0;
    int64_t start_; // nanoseconds of the steady clock
};

} // namespace hmf
