/*
 * The core alone: builds the meshes of README.md, gives loops of its own, solves, carries the result to the
 * coarsest level and back, and prints
 *
 *     name level vertices hash
 *
 * for the values on each level that it was solved or carried to.
 *
 *     cc -Iinclude bindings/same_bits/own_loops.c libhmf_core.a -lstdc++ -lm
 */
#include <hmf/hmf.h>

#include "plate.h"

#include <stdio.h>

/* The vertex near a grid point: positions are 16 times as large, and shifted by 3 at most. */
static uint32_t vertex_at(const struct mesh* m, int i, int j, int k) {
    size_t v;
    for (v = 0; v < m->vertex_count; ++v) {
        const double* at = m->positions + 3 * v;
        const double x = at[0] - 16 * i, y = at[1] - 16 * j, z = at[2] - 16 * k;
        if (x >= -3 && x <= 3 && y >= -3 && y <= 3 && z >= -3 && z <= 3) return (uint32_t)v;
    }
    return HMF_NONE;
}

/* For each hole the loop around the bar on its left, along grid lines through the middle of the hole. */
static int make_loops(const struct plate* p, const struct mesh* m, hmf_loop_set* set) {
    const size_t count = (size_t)(p->holes_x * p->holes_y), length = 2 * (size_t)(p->side + p->height);
    uint64_t* offsets = malloc((count + 1) * sizeof *offsets);
    uint32_t* elements = malloc(count * length * sizeof *elements);
    size_t n = 0;
    int x, y, s;
    memset(set, 0, sizeof *set);
    set->struct_size = sizeof *set;
    set->element_kind = HMF_PATH_VERTICES;
    set->count = count;
    set->offsets = offsets;
    set->elements = elements;
    if (!offsets || !elements) return 0;
    offsets[0] = 0;
    for (y = 0; y < p->holes_y; ++y)
        for (x = 0; x < p->holes_x; ++x) {
            const int left = 2 * x * p->side, right = left + p->side, j = (2 * y + 1) * p->side + p->side / 2;
            for (s = 0; s < p->side; ++s) elements[n++] = vertex_at(m, left + s, j, 0);
            for (s = 0; s < p->height; ++s) elements[n++] = vertex_at(m, right, j, s);
            for (s = 0; s < p->side; ++s) elements[n++] = vertex_at(m, right - s, j, p->height);
            for (s = 0; s < p->height; ++s) elements[n++] = vertex_at(m, left, j, p->height - s);
            offsets[n / length] = n;
        }
    return 1;
}

static void print_values(const struct plate* p, const struct mesh* m, const hmf_foliation* f) {
    size_t count;
    const double* values = hmf_foliation_values(f, &count);
    const uint64_t hash = fnv1a64(values, count);
    printf("%s %lu %lu %08lx%08lx\n", p->name, (unsigned long)hmf_foliation_level(f), (unsigned long)m->vertex_count,
           (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
}

static int solve_plate(const struct plate* p) {
    struct mesh m = {0};
    hmf_loop_set loops = {0};
    hmf_hierarchy* h = NULL;
    hmf_foliation* made[3] = {NULL, NULL, NULL};
    hmf_error e = {0};
    hmf_status s = HMF_ERROR_MEMORY;
    int k;
    if (make_plate(p, &m) && make_loops(p, &m, &loops))
        s = hmf_hierarchy_create(m.positions, m.vertex_count, m.triangles, m.triangle_count, NULL, NULL, &h, &e);
    if (!s) s = hmf_solve(h, &loops, NULL, NULL, &made[0], &e);
    if (!s) s = hmf_interpolate(made[0], hmf_hierarchy_describe(h)->level_count - 1, NULL, &made[1], &e);
    if (!s) s = hmf_interpolate(made[1], 0, NULL, &made[2], &e);
    if (s) fprintf(stderr, "%s: %s: %s\n", p->name, hmf_status_string(s), e.message);
    for (k = 0; k < 3; ++k) {
        if (!s) print_values(p, &m, made[k]);
        hmf_foliation_destroy(made[k]);
    }
    hmf_hierarchy_destroy(h);
    free((void*)loops.offsets);
    free((void*)loops.elements);
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
