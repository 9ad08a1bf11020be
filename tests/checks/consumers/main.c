/* A user of the installed library: the five calls on a torus.  Prints a
   checksum of the bits of the result, which depends on nothing else. */
#include <hmf/applications.h>

#include <stdio.h>
#include <string.h>

#define N 24 /* around */
#define M 12 /* across */

static double positions[3 * N * M];
static uint32_t triangles[3 * 2 * N * M];

static uint32_t at(int i, int j) { return (uint32_t)((i % N) * M + j % M); }

/* Points on a circle without the mathematical library, so that a missing -lm
   of hmf itself is seen; on a grid of 1/4096, so that the last bit does not matter. */
static void circle(int n, double step_cos, double step_sin, double* x, double* y) {
    double c = 1, s = 0;
    int i;
    for (i = 0; i < n; ++i) {
        const double t = c * step_cos - s * step_sin;
        x[i] = (double)(long)(c * 4096 + 4096.5) / 4096 - 1;
        y[i] = (double)(long)(s * 4096 + 4096.5) / 4096 - 1;
        s = s * step_cos + c * step_sin;
        c = t;
    }
}

static void make_torus(void) {
    double x[N], y[N], u[M], v[M];
    int i, j;
    uint32_t* t = triangles;
    circle(N, 0.9659258262890683, 0.25881904510252074, x, y); /* 15 degrees */
    circle(M, 0.8660254037844387, 0.5, u, v);                 /* 30 degrees */
    for (i = 0; i < N; ++i) {
        for (j = 0; j < M; ++j) {
            double* p = positions + 3 * at(i, j);
            p[0] = (3 + u[j]) * x[i];
            p[1] = (3 + u[j]) * y[i];
            p[2] = v[j];
            *t++ = at(i, j);
            *t++ = at(i + 1, j);
            *t++ = at(i + 1, j + 1);
            *t++ = at(i, j);
            *t++ = at(i + 1, j + 1);
            *t++ = at(i, j + 1);
        }
    }
}

static int fail(const char* what, hmf_status status, const hmf_error* error) {
    fprintf(stderr, "%s: %s: %s\n", what, hmf_status_string(status), error->message);
    return 1;
}

int main(void) {
    hmf_hierarchy* hierarchy = NULL;
    hmf_error error;
    hmf_status status;
    hmf_loop_set* loops = NULL;
    hmf_foliation* foliation = NULL;
    hmf_singularity_set* zeros = NULL;
    const double* values;
    uint64_t hash = 0xcbf29ce484222325u;
    size_t edge_count, i;
    int wrong;

    memset(&error, 0, sizeof error);
    if (hmf_version() != HMF_VERSION_MAJOR * 10000 + HMF_VERSION_MINOR * 100 + HMF_VERSION_PATCH) {
        fprintf(stderr, "header and library have different versions\n");
        return 1;
    }
    make_torus();
    status = hmf_hierarchy_create(positions, N * M, triangles, 2 * N * M, NULL, NULL, &hierarchy, &error);
    if (status != HMF_OK) return fail("hmf_hierarchy_create", status, &error);
    if (hmf_hierarchy_describe(hierarchy)->genus != 1)
        return fail("hmf_hierarchy_describe", HMF_ERROR_INTERNAL, &error);

    status =
        hmf_loops(hierarchy, hmf_hierarchy_describe(hierarchy)->level_count - 1, HMF_LOOPS_CUT, NULL, &loops, &error);
    if (status != HMF_OK) return fail("hmf_loops", status, &error);
    status = hmf_solve(hierarchy, loops, NULL, NULL, &foliation, &error);
    if (status != HMF_OK) return fail("hmf_solve", status, &error);
    status = hmf_singularities(foliation, NULL, &zeros, &error);
    if (status != HMF_OK) return fail("hmf_singularities", status, &error);

    values = hmf_foliation_values(foliation, &edge_count);
    for (i = 0; i < edge_count; ++i) {
        uint64_t bits;
        int byte;
        memcpy(&bits, values + i, sizeof bits);
        for (byte = 0; byte < 8; ++byte) hash = (hash ^ ((bits >> (8 * byte)) & 255u)) * 0x100000001b3u;
    }
    printf("%lu loops, %lu singularities, checksum %08lx%08lx\n", (unsigned long)loops->count,
           (unsigned long)zeros->count, (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
    wrong = edge_count != 3 * N * M || zeros->count != 0; /* a harmonic foliation of a torus has none */
    hmf_free(loops);
    hmf_free(zeros);
    hmf_foliation_destroy(foliation);
    hmf_hierarchy_destroy(hierarchy);
    return wrong;
}
