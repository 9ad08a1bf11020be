/*
 * hmf/pool.hpp - the pool of hmf/pool.h as a C++17 class, header only
 *
 *     const hmf::Pool pool;                  // all processors
 *     const hmf::Solution solution = hierarchy.solve(loops);
 *
 * Link hmf::pool beside hmf::hmf.
 */
#ifndef HMF_POOL_HPP
#define HMF_POOL_HPP

#include <hmf/hmf.hpp>
#include <hmf/pool.h>

namespace hmf {
inline namespace cpp {

/* A thread pool.  While the object lives, all calls of the thread that created it use
   the pool.  Another thread uses it through an object of its own,
   Threads(hmf_pool_run, pool.get(), pool.size()). */
class Pool {
public:
    /* threads: including the calling one; 0 = one per processor. */
    explicit Pool(uint32_t threads = 0) :
        pool_(hmf_pool_create(threads)), lent_(hmf_pool_run, pool_.get(), hmf_pool_threads(pool_.get())) {}

    uint32_t size() const noexcept { return hmf_pool_threads(pool_.get()); }
    hmf_pool* get() const noexcept { return pool_.get(); }

private:
    struct Delete {
        void operator()(hmf_pool* pool) const noexcept { hmf_pool_destroy(pool); }
    };
    std::unique_ptr<hmf_pool, Delete> pool_;
    Threads lent_;
};

} // namespace cpp
} // namespace hmf

#endif /* HMF_POOL_HPP */
