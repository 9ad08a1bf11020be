/*
 * The same bits from every language: makes the three meshes of README.md,
 * solves each with the defaults and prints
 *
 *     name vertices triangles hash
 *
 * where hash is FNV-1a (64 bits) of the values as little-endian doubles.
 * The packages of the other languages make the same meshes themselves and
 * must print the same lines; tests/checks/check_bindings.sh compares them.
 *
 *     cc -Iinclude bindings/same_bits/same_bits.c libhmf.a -lstdc++ -lm
 */
#include <hmf/applications.h>

#include "plate.h"

#include <stdio.h>

static int solve_plate(const struct plate* p) {
    struct mesh m = {0};
    hmf_hierarchy* h = NULL;
    hmf_foliation* f = NULL;
    hmf_error e = {0};
    hmf_status s = HMF_ERROR_MEMORY;
    if (make_plate(p, &m))
        s = hmf_hierarchy_create(m.positions, m.vertex_count, m.triangles, m.triangle_count, NULL, NULL, &h, &e);
    if (!s) s = hmf_solve_cut_system(h, NULL, NULL, &f, &e);
    if (s) {
        fprintf(stderr, "%s: %s: %s\n", p->name, hmf_status_string(s), e.message);
    } else {
        size_t count;
        const double* values = hmf_foliation_values(f, &count);
        const uint64_t hash = fnv1a64(values, count);
        printf("%s %lu %lu %08lx%08lx\n", p->name, (unsigned long)m.vertex_count, (unsigned long)m.triangle_count,
               (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
    }
    hmf_foliation_destroy(f);
    hmf_hierarchy_destroy(h);
    free(m.positions);
    free(m.triangles);
    return s;
}

int main(void) {
    size_t i;
    for (i = 0; i < sizeof plates / sizeof *plates; ++i)
        if (solve_plate(&plates[i])) return 1;
    return 0;
}
