/*
 * hmf/pool.h - a pool of threads for hmf_control
 *
 * The library hmf starts no thread; a host with a pool of its own gives that
 * (see hmf_parallel_for_fn in hmf.h).  For the others this one lies in a library
 * beside it, hmf_pool, on the threads of the C++ standard library:
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

/* Threads that wait for tasks. */
typedef struct hmf_pool hmf_pool;

/* A pool of so many threads, the calling one of each hmf_pool_run included:
   1 starts none.  0 = one for each processor; at most 256.  Fewer where the
   system gives no more.  NULL: no memory, which every function here takes as a
   pool of 1. */
HMF_API hmf_pool *hmf_pool_create(uint32_t threads);

/* Ends the threads; no call may use the pool any more.  NULL is allowed. */
HMF_API void hmf_pool_destroy(hmf_pool *pool);

/* The number of threads, the calling one included; 1 for NULL. */
HMF_API uint32_t hmf_pool_threads(const hmf_pool *pool);

/* An hmf_parallel_for_fn; user is a pool or NULL.  Any number of threads may
   call it at the same time: the tasks of one call at a time are shared, those
   of the others run on the threads that call. */
HMF_API void hmf_pool_run(void *pool, hmf_task_fn task, void *context, uint32_t count);

#ifdef __cplusplus
}
#endif

#endif /* HMF_POOL_H */
