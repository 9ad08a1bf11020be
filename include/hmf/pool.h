/*
 * hmf/pool.h - a thread pool for hmf_control
 *
 * The library hmf never creates threads.  If your program has a pool, pass it (see
 * hmf_parallel_for_fn in hmf.h).  If not, use this one.  It is a library of its own,
 * hmf_pool, on the threads of the C++ standard library:
 *
 *     hmf_pool *pool = hmf_pool_create(0);
 *     hmf_control control = {sizeof control};
 *     control.workers = hmf_pool_threads(pool);
 *     control.parallel_for = hmf_pool_run;
 *     control.parallel_user = pool;
 *     hmf_solve(hierarchy, loops, NULL, &control, &foliation, &error);
 *     hmf_pool_destroy(pool);
 */
#ifndef HMF_POOL_H
#define HMF_POOL_H

#include <hmf/hmf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A thread pool. */
typedef struct hmf_pool hmf_pool;

/* Creates a pool.  threads includes the thread that calls hmf_pool_run; 1 creates none,
   0 = one thread per processor, at most 256.  The pool is smaller if the system provides
   fewer threads.  Returns NULL without memory; every function here takes NULL as a pool
   of one thread. */
HMF_API hmf_pool *hmf_pool_create(uint32_t threads);

/* Ends the threads.  No call may use the pool during or after this.  NULL is allowed. */
HMF_API void hmf_pool_destroy(hmf_pool *pool);

/* Returns the number of threads, including the calling one; 1 for NULL. */
HMF_API uint32_t hmf_pool_threads(const hmf_pool *pool);

/* An hmf_parallel_for_fn; user is a pool or NULL.  Any number of threads may call it at the
   same time: one call at a time uses the threads of the pool, the tasks of the others run
   on the threads that call. */
HMF_API void hmf_pool_run(void *pool, hmf_task_fn task, void *context, uint32_t count);

#ifdef __cplusplus
}
#endif

#endif /* HMF_POOL_H */
