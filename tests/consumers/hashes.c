/* Hashes of what the library gives on a few made surfaces: the same numbers on
   every machine, compiler and optimisation.  One line for each surface:
   values, (u, v), leaves, conjugate leaves, quads.

   A surface is the boundary of a plate of voxels with holes, its vertices
   shifted by less than a quarter of an edge: integers over 4096, so that the
   input is the same everywhere. */
#include <hmf/uses.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_VERTICES 6000
#define MAX_TRIANGLES 12000

static double positions[3 * MAX_VERTICES];
static uint32_t triangles[3 * MAX_TRIANGLES];
static size_t vertex_count, triangle_count;
static uint32_t number_at[64 * 32 * 16];
static int size_x, size_y, size_z, hole_size, holes;
static uint64_t state;

static double shift(void) { /* at most 1/4 */
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)((int)(state >> 53) - 1024) / 4096;
}

/* A plate of voxels; every second stretch of hole_size voxels in the middle row is a hole. */
static int full(int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= size_x || y >= size_y || z >= size_z) return 0;
    return !(holes && y / hole_size == 1 && x / hole_size % 2 == 1);
}

static uint32_t vertex(int x, int y, int z) {
    uint32_t* number = &number_at[(x * 32 + y) * 16 + z];
    if (*number == HMF_NONE) {
        double* p = positions + 3 * vertex_count;
        p[0] = x + shift();
        p[1] = y + shift();
        p[2] = z + shift();
        *number = (uint32_t)vertex_count++;
    }
    return *number;
}

/* The corners of a side one after the other: the order of arguments is the compiler's. */
static void add_side(const int corner[4][3], int turn) {
    uint32_t v[4], *t = triangles + 3 * triangle_count;
    int i;
    for (i = 0; i < 4; ++i) v[i] = vertex(corner[i][0], corner[i][1], corner[i][2]);
    t[0] = v[0];
    t[1] = v[turn ? 3 : 1];
    t[2] = v[2];
    t[3] = v[0];
    t[4] = v[2];
    t[5] = v[turn ? 1 : 3];
    triangle_count += 2;
}

static void make_plate(int hole_count, int side, int height) {
    int x, y, z;
    holes = hole_count;
    hole_size = side;
    size_x = (2 * hole_count + 1) * side;
    size_y = 3 * side;
    size_z = height;
    vertex_count = triangle_count = 0;
    state = 12345;
    memset(number_at, 0xff, sizeof number_at);
    for (x = 0; x <= size_x; ++x)
        for (y = 0; y <= size_y; ++y)
            for (z = 0; z <= size_z; ++z) {
                const int here = full(x, y, z);
                const int sides[3][4][3] = {{{x, y, z}, {x, y + 1, z}, {x, y + 1, z + 1}, {x, y, z + 1}},
                                            {{x, y, z}, {x, y, z + 1}, {x + 1, y, z + 1}, {x + 1, y, z}},
                                            {{x, y, z}, {x + 1, y, z}, {x + 1, y + 1, z}, {x, y + 1, z}}};
                const int beside[3] = {full(x - 1, y, z), full(x, y - 1, z), full(x, y, z - 1)};
                int k;
                for (k = 0; k < 3; ++k)
                    if (here != beside[k]) add_side(sides[k], here);
            }
}

/* FNV-1a over the numbers' bytes from the lowest on, whatever the order in memory. */
static uint64_t hash_word(uint64_t hash, uint64_t word, int bytes) {
    int i;
    for (i = 0; i < bytes; ++i) hash = (hash ^ ((word >> (8 * i)) & 255u)) * 0x100000001b3u;
    return hash;
}

static uint64_t hash_reals(const double* values, size_t count) {
    uint64_t hash = 0xcbf29ce484222325u, word;
    size_t i;
    for (i = 0; i < count; ++i) {
        memcpy(&word, values + i, sizeof word);
        hash = hash_word(hash, word, 8);
    }
    return hash;
}

static uint64_t hash_numbers(const uint32_t* values, size_t count) {
    uint64_t hash = 0xcbf29ce484222325u;
    size_t i;
    for (i = 0; i < count; ++i) hash = hash_word(hash, values[i], 4);
    return hash;
}

static void print_hash(uint64_t hash) {
    printf(" %08lx%08lx", (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
}

static int check(const char* what, hmf_status status, const hmf_error* error) {
    if (status == HMF_OK) return 0;
    printf("%s: %s: %s\n", what, hmf_status_string(status), error->message);
    return 1;
}

static int one(const char* name, int kind, const uint32_t* marks, size_t mark_count) {
    hmf_hierarchy* hierarchy = NULL;
    hmf_foliation* foliation = NULL;
    hmf_loop_set* loops = NULL;
    hmf_parameterization* map = NULL;
    hmf_lines *leaves = NULL, *conjugate = NULL;
    hmf_quad_mesh* quads = NULL;
    static const uint32_t point_triangle[1] = {17};
    static const double point_barycentric[3] = {0.25, 0.25, 0.5};
    hmf_build_options build;
    hmf_trace_options trace;
    hmf_error error;
    const double* values;
    size_t count;
    int failed = 1;

    memset(&error, 0, sizeof error);
    memset(&build, 0, sizeof build);
    memset(&trace, 0, sizeof trace);
    build.struct_size = (uint32_t)sizeof build;
    build.coarsest = 200;
    build.marked_vertices = marks;
    build.marked_count = mark_count;
    trace.struct_size = (uint32_t)sizeof trace;
    trace.critical = 1;
    trace.spacing = 0.25;
    if (check("hmf_build",
              hmf_build(positions, vertex_count, triangles, triangle_count, &build, NULL, &hierarchy, &error), &error))
        return 1;
    do {
        if (check("hmf_loops", hmf_loops(hierarchy, 0, kind, NULL, &loops, &error), &error)) break;
        if (check("hmf_solve", hmf_solve(hierarchy, loops, NULL, NULL, &foliation, &error), &error)) break;
        if (check("hmf_parameterize", hmf_parameterize(foliation, NULL, NULL, &map, &error), &error)) break;
        if (check("hmf_trace", hmf_trace(foliation, &trace, NULL, &leaves, &error), &error)) break;
        trace.leaves = HMF_LEAVES_CONJUGATE;
        trace.spacing = 0;
        trace.point_count = 1;
        trace.point_triangles = point_triangle;
        trace.point_barycentrics = point_barycentric;
        if (check("hmf_trace", hmf_trace(foliation, &trace, NULL, &conjugate, &error), &error)) break;
        if (check("hmf_quads", hmf_quads(foliation, NULL, NULL, &quads, &error), &error)) break;
        values = hmf_foliation_values(foliation, &count);
        printf("%s %lu %lu", name, (unsigned long)vertex_count, (unsigned long)loops->count);
        print_hash(hash_reals(values, count));
        print_hash(hash_reals(map->corner_uv, 6 * triangle_count));
        print_hash(hash_reals(leaves->points, 3 * (size_t)leaves->point_count));
        print_hash(hash_reals(conjugate->points, 3 * (size_t)conjugate->point_count));
        print_hash(hash_reals(quads->positions, 3 * (size_t)quads->vertex_count)
                   ^ hash_numbers(quads->quads, 4 * (size_t)quads->quad_count));
        printf("\n");
        failed = 0;
    } while (0);
    hmf_free(loops);
    hmf_free(map);
    hmf_free(leaves);
    hmf_free(conjugate);
    hmf_free(quads);
    hmf_foliation_destroy(foliation);
    hmf_destroy(hierarchy);
    return failed;
}

int main(void) {
    static const uint32_t marks[] = {0, 100, 200, 300, 400, 500};
    int failed = 0;
    make_plate(1, 4, 4);
    failed |= one("torus", HMF_LOOPS_CUT, NULL, 0);
    make_plate(2, 4, 2);
    failed |= one("genus2", HMF_LOOPS_HANDLE, NULL, 0);
    make_plate(3, 5, 3);
    failed |= one("genus3", HMF_LOOPS_PANTS, NULL, 0);
    make_plate(0, 6, 12);
    failed |= one("sphere", HMF_LOOPS_PANTS, marks, 6);
    make_plate(1, 5, 5);
    failed |= one("marked-torus", HMF_LOOPS_PANTS, marks, 2);
    return failed;
}
