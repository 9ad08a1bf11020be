#include "memory.hpp"

#include <algorithm>
#include <new>

#include <chrono>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

// A kept block is out of bounds for the address sanitizer, as one that was given back is.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HMF_ADDRESS_SANITIZER
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define HMF_ADDRESS_SANITIZER
#endif
#if defined(HMF_ADDRESS_SANITIZER)
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(block, bytes) ((void)0)
#define ASAN_UNPOISON_MEMORY_REGION(block, bytes) ((void)0)
#endif

namespace hmf {

namespace {
void* default_allocate(void*, size_t size) { return std::malloc(size); }
void default_release(void*, void* block, size_t) { std::free(block); }

int64_t now() {
    using namespace std::chrono;
    return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}
} // namespace

Memory::Memory(hmf_allocate_fn allocate, hmf_release_fn release, void* user, uint64_t limit, uint64_t used_before) :
    allocate_(allocate ? allocate : default_allocate), release_(allocate ? release : default_release), user_(user),
    limit_(limit), used_(used_before), peak_(used_before) {}

void* Memory::take(size_t bytes) {
    if (limit_ && (bytes > limit_ || used_ > limit_ - bytes)) {
        if (!failure_) failure_ = HMF_ERROR_MEMORY_LIMIT;
        return nullptr;
    }
    while (kept_count_ > 0 && used_ + kept_bytes_ + bytes > peak_) drop_oldest();
    void* block = whole_ ? whole_->take(bytes) : bytes > SIZE_MAX / 2 ? nullptr : allocate_(user_, bytes);
    if (!block) {
        if (!failure_) failure_ = whole_ ? whole_->failure() : HMF_ERROR_MEMORY;
        return nullptr;
    }
    count(bytes);
    return block;
}

void Memory::give(void* block, size_t bytes) {
    if (!block) return;
    used_ -= bytes;
    if (whole_) whole_->give(block, bytes);
    else release_(user_, block, bytes);
}

// Takes a kept block out of the list.
Memory::Kept Memory::pick(size_t i) {
    const Kept kept = kept_[i];
    for (size_t k = i + 1; k < kept_count_; ++k) kept_[k - 1] = kept_[k];
    --kept_count_;
    kept_bytes_ -= kept.bytes;
    ASAN_UNPOISON_MEMORY_REGION(kept.block, kept.bytes);
    return kept;
}

void Memory::drop_oldest() {
    const Kept kept = pick(0);
    release_(user_, kept.block, kept.bytes);
}

void Memory::release_kept() {
    while (kept_count_ > 0) drop_oldest();
    keeps_ = false;
}

// The smallest block that is large enough, and not larger by more than a part.
size_t Memory::find_kept(size_t bytes) const {
    const size_t most = bytes + bytes / 16;
    size_t best = kept_count_;
    for (size_t i = 0; i < kept_count_; ++i)
        if (kept_[i].bytes >= bytes && kept_[i].bytes <= (best < kept_count_ ? kept_[best].bytes - 1 : most)) best = i;
    return best;
}

void* Memory::take_array(size_t& bytes) {
    if (whole_) {
        void* const block = whole_->take_array(bytes);
        if (block) count(bytes);
        else if (!failure_) failure_ = whole_->failure();
        return block;
    }
    if (!keeps_ || bytes < SMALLEST_KEPT || bytes > SIZE_MAX / 2) return take(bytes);
    bytes = (bytes + PAGE - 1) / PAGE * PAGE;
    const size_t found = find_kept(bytes);
    if (found == kept_count_) return take(bytes);
    const Kept kept = pick(found);
    bytes = kept.bytes;
    count(bytes);
    return kept.block;
}

void Memory::give_array(void* block, size_t bytes) {
    if (whole_) {
        used_ -= bytes;
        whole_->give_array(block, bytes);
    } else if (!keeps_ || bytes < SMALLEST_KEPT) {
        give(block, bytes);
    } else {
        if (kept_count_ == MOST_KEPT) drop_oldest();
        used_ -= bytes;
        ASAN_POISON_MEMORY_REGION(block, bytes);
        kept_[kept_count_++] = {block, bytes};
        kept_bytes_ += bytes;
    }
}

static constexpr size_t aligned(size_t bytes) { return (bytes + 15) / 16 * 16; }

void Arena::clear() {
    while (blocks_) {
        Block* block = blocks_;
        blocks_ = block->next;
        memory_.give(block, block->bytes);
    }
    at_ = end_ = nullptr;
    block_bytes_ = SMALLEST_BLOCK;
}

char* Arena::new_block(size_t bytes) {
    bytes += aligned(sizeof(Block));
    void* block = memory_.take(bytes);
    if (!block) return nullptr;
    blocks_ = new (block) Block{blocks_, bytes};
    return static_cast<char*>(block) + aligned(sizeof(Block));
}

void* Arena::take_bytes(size_t count, size_t size) {
    if (count > (SIZE_MAX / 4) / size) {
        memory_.take(SIZE_MAX);
        return nullptr;
    }
    const size_t bytes = aligned(count * size);
    if (bytes > block_bytes_ / 4) return new_block(bytes);
    if (!at_ || static_cast<size_t>(end_ - at_) < bytes) {
        char* const fresh = new_block(block_bytes_);
        if (!fresh) return nullptr;
        at_ = fresh;
        end_ = fresh + block_bytes_;
        if (block_bytes_ < LARGEST_BLOCK) block_bytes_ *= 2;
    }
    void* const taken = at_;
    at_ += bytes;
    return taken;
}

Call::Call(Memory& m, hmf_error* error, const hmf_control& control) :
    memory(m), parallel(control.parallel_for, control.parallel_user, control.workers), error_(error),
    progress_(control.progress), progress_user_(control.progress_user), start_(now()) {}

Call::Call(Memory& m, hmf_error* error, hmf_progress_fn progress, void* progress_user) :
    memory(m), error_(error), progress_(progress), progress_user_(progress_user), start_(now()) {}

Call::Call(Call* whole, hmf_error* error) :
    Call(
        whole->memory, error,
        [](void* user, double) -> int32_t {
            return static_cast<Call*>(user)->tick(0, true) ? HMF_PROGRESS_CONTINUE : HMF_PROGRESS_CANCEL;
        },
        whole) {}

hmf_status Call::fail(hmf_status status, int32_t element, uint64_t index, const char* format, ...) {
    if (status_ != HMF_OK) return status_;
    status_ = status;
    if (error_) {
        error_->status = status;
        error_->element = element;
        error_->index = index;
        va_list arguments;
        va_start(arguments, format);
        std::vsnprintf(error_->message, sizeof error_->message, format, arguments);
        va_end(arguments);
    }
    return status;
}

hmf_status Call::out_of_memory() {
    if (cancelled_) return was_cancelled();
    if (memory.failure() == HMF_ERROR_MEMORY_LIMIT)
        return fail(
            HMF_ERROR_MEMORY_LIMIT, HMF_ELEMENT_NONE, 0,
            "The memory limit is too low. Raise memory_limit; hmf_hierarchy_memory_estimate gives a sufficient value.");
    return fail(HMF_ERROR_MEMORY, HMF_ELEMENT_NONE, 0,
                "The allocator returned no memory. Free some, or use a smaller mesh.");
}

hmf_status Call::was_cancelled() {
    return fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0, "Cancelled by the progress callback.");
}

Done Call::tick(double fraction, bool can_finish) {
    steps_ = 0;
    if (cancelled_) return false;
    if (!progress_) return true;
    double at = from_ + (to_ - from_) * (fraction < 0 ? 0 : fraction > 1 ? 1 : fraction);
    at = std::max(at, last_);
    last_ = at;
    const int32_t answer = progress_(progress_user_, at);
    if (answer == HMF_PROGRESS_FINISH && can_finish && may_finish_) finishing_ = true;
    else if (answer != HMF_PROGRESS_CONTINUE) cancelled_ = true;
    return !cancelled_;
}

void Call::finished() {
    range(1, 1);
    (void)tick(1, true);
}

double Call::seconds() const { return 1e-9 * static_cast<double>(now() - start_); }

} // namespace hmf
