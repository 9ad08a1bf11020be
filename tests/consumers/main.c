/* A user of the installed library: the five calls on a torus.  Prints a
   checksum of the bits of the result, which depends on nothing else. */
#include <hmf/hmf.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define N 24 /* around */
#define M 12 /* across */

static double positions[3 * N * M];
static uint32_t triangles[3 * 2 * N * M];

static uint32_t at(int i, int j) { return (uint32_t)((i % N) * M + j % M); }

static void make_torus(void)
{
    int i, j;
    uint32_t *t = triangles;
    for (i = 0; i < N; ++i) {
        for (j = 0; j < M; ++j) {
            /* Rounded, so that the last bit of the C library's cosine does not matter. */
            const double a = 6.283185307179586 * i / N, b = 6.283185307179586 * j / M;
            double *p = positions + 3 * at(i, j);
            p[0] = floor((3 + cos(b)) * cos(a) * 4096 + 0.5) / 4096;
            p[1] = floor((3 + cos(b)) * sin(a) * 4096 + 0.5) / 4096;
            p[2] = floor(sin(b) * 4096 + 0.5) / 4096;
            *t++ = at(i, j); *t++ = at(i + 1, j); *t++ = at(i + 1, j + 1);
            *t++ = at(i, j); *t++ = at(i + 1, j + 1); *t++ = at(i, j + 1);
        }
    }
}

static int fail(const char *what, hmf_status status, const hmf_error *error)
{
    fprintf(stderr, "%s: %s: %s\n", what, hmf_status_string(status), error->message);
    return 1;
}

int main(void)
{
    hmf_hierarchy *hierarchy = NULL;
    hmf_error error;
    hmf_status status;
    hmf_loop_set loops;
    uint64_t *offsets, hash = 0xcbf29ce484222325u;
    uint32_t *elements;
    double *values;
    size_t coarsest, loop_count = 0, element_count = 0, zeros = 0, i;
    const size_t edge_count = 3 * N * M;

    memset(&error, 0, sizeof error);
    if (hmf_version() != HMF_VERSION_MAJOR * 10000 + HMF_VERSION_MINOR * 100 + HMF_VERSION_PATCH) {
        fprintf(stderr, "header and library have different versions\n");
        return 1;
    }
    make_torus();
    status = hmf_build(positions, N * M, 0, triangles, 2 * N * M, NULL, &hierarchy, &error);
    if (status != HMF_OK) return fail("hmf_build", status, &error);
    if (hmf_genus(hierarchy) != 1) return fail("hmf_genus", HMF_ERROR_INTERNAL, &error);

    coarsest = hmf_level_count(hierarchy) - 1;
    status = hmf_loops(hierarchy, coarsest, HMF_LOOPS_CUT, NULL, 0, NULL, 0, &loop_count, &element_count, &error);
    if (status != HMF_OK) return fail("hmf_loops", status, &error);
    offsets = (uint64_t *)malloc((loop_count + 1) * sizeof *offsets);
    elements = (uint32_t *)malloc(element_count * sizeof *elements);
    values = (double *)malloc(edge_count * sizeof *values);
    if (!offsets || !elements || !values) return 1;
    status = hmf_loops(hierarchy, coarsest, HMF_LOOPS_CUT, offsets, loop_count + 1, elements, element_count,
                       &loop_count, &element_count, &error);
    if (status != HMF_OK) return fail("hmf_loops", status, &error);

    memset(&loops, 0, sizeof loops);
    loops.struct_size = (uint32_t)sizeof loops;
    loops.element_kind = HMF_LOOP_TRIANGLES;
    loops.level = coarsest;
    loops.count = loop_count;
    loops.offsets = offsets;
    loops.elements = elements;
    status = hmf_solve(hierarchy, &loops, NULL, values, edge_count, NULL, &error);
    if (status != HMF_OK) return fail("hmf_solve", status, &error);
    status = hmf_singularities(hierarchy, 0, values, edge_count, NULL, 0, NULL, 0, NULL, 0, NULL, 0, &zeros, &error);
    if (status != HMF_OK) return fail("hmf_singularities", status, &error);

    for (i = 0; i < edge_count; ++i) {
        uint64_t bits;
        int byte;
        memcpy(&bits, values + i, sizeof bits);
        for (byte = 0; byte < 8; ++byte) hash = (hash ^ ((bits >> (8 * byte)) & 255u)) * 0x100000001b3u;
    }
    printf("%lu loops, %lu singularities, checksum %08lx%08lx\n", (unsigned long)loop_count, (unsigned long)zeros,
           (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
    free(offsets);
    free(elements);
    free(values);
    hmf_destroy(hierarchy);
    return zeros == 0 ? 0 : 1; /* a harmonic foliation of a torus has none */
}
