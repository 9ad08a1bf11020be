/*
 * Between the progress calls of hmf and Python: the interpreter lock is taken
 * at most once in each interval.  A solve reports some thousand times a
 * second, and with another Python thread at work each time would cost a
 * switch of threads.
 */
#include <hmf/pool.h>
#include <hmf/applications.h>

#include "readers.h"

#ifdef _WIN32
#include <windows.h>
static double hmf_python_seconds(void) { return (double)GetTickCount64() * 1e-3; }
#else
#include <time.h>
static double hmf_python_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}
#endif

typedef struct hmf_python_throttle {
    double interval; /* seconds between two calls into Python */
    double last;     /* when the last one ended */
    int32_t answer;  /* the last one; "cancel" and "finish" stay */
    void* watch;     /* the Python object */
} hmf_python_throttle;

static int32_t hmf_python_progress(void* watch, double fraction);

static int32_t hmf_python_throttled(void* user, double fraction) {
    hmf_python_throttle* throttle = (hmf_python_throttle*)user;
    if (throttle->answer != HMF_PROGRESS_CANCEL && hmf_python_seconds() - throttle->last >= throttle->interval) {
        const int32_t answer = hmf_python_progress(throttle->watch, fraction);
        if (answer != HMF_PROGRESS_CONTINUE) throttle->answer = answer;
        throttle->last = hmf_python_seconds();
    }
    return throttle->answer;
}
