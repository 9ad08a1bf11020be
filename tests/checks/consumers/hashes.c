/* Hashes of what the library gives on a few made surfaces: the same numbers on
   every machine, compiler and optimization.  One line for each surface:
   values, (u, v), leaves, conjugate leaves, quads, measures; for an even design
   values, (u, v), charts, relaxed quads, measures.

   A surface is the boundary of a plate of voxels with holes, its vertices
   shifted by less than a quarter of an edge: integers over 4096, so that the
   input is the same everywhere.  An open one has no faces below. */
#include <hmf/applications.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_VERTICES 10000
#define MAX_TRIANGLES 20000

static double positions[3 * MAX_VERTICES];
static uint32_t triangles[3 * MAX_TRIANGLES];
static size_t vertex_count, triangle_count;
static uint32_t number_at[64 * 64 * 16];
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
    uint32_t* number = &number_at[(x * 64 + y) * 16 + z];
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

static void make_plate(int hole_count, int side, int height, int open) {
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
                    if (here != beside[k] && !(open && k == 2 && z == 0)) add_side(sides[k], here);
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

/* One hash for each use of a foliation; 0 if one of them fails. */
static int print_map(const hmf_foliation* foliation, hmf_error* error) {
    hmf_parameterization* map = NULL;
    if (check("hmf_parameterize", hmf_parameterize(foliation, NULL, NULL, &map, error), error)) return 0;
    print_hash(hash_reals(map->corner_uv, 6 * (size_t)map->triangle_count));
    hmf_free(map);
    return 1;
}

static int print_leaves(const hmf_foliation* foliation, const hmf_trace_options* options, hmf_error* error) {
    hmf_lines* lines = NULL;
    if (check("hmf_trace", hmf_trace(foliation, options, NULL, &lines, error), error)) return 0;
    print_hash(hash_reals(lines->points, 3 * (size_t)lines->point_count));
    hmf_free(lines);
    return 1;
}

static int print_quads(const hmf_foliation* foliation, uint64_t relax, hmf_error* error) {
    hmf_quad_mesh* quads = NULL;
    hmf_quad_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = (uint32_t)sizeof options;
    options.relax = relax;
    if (check("hmf_quads", hmf_quads(foliation, &options, NULL, &quads, error), error)) return 0;
    print_hash(hash_reals(quads->positions, 3 * (size_t)quads->vertex_count)
               ^ hash_numbers(quads->quads, 4 * (size_t)quads->quad_count));
    hmf_free(quads);
    return 1;
}

/* Residuals, conformal scale, circumferences. */
static int print_measures(const hmf_foliation* foliation, const hmf_loop_set* loops, hmf_error* error) {
    hmf_residual_set* residuals = NULL;
    hmf_scale* scale = NULL;
    hmf_cylinder_set* cylinders = NULL;
    uint64_t hash;
    size_t i;
    if (check("hmf_residuals", hmf_residuals(foliation, NULL, &residuals, error), error)
        || check("hmf_conformal_scale", hmf_conformal_scale(foliation, NULL, &scale, error), error)
        || check("hmf_cylinders", hmf_cylinders(foliation, loops, NULL, &cylinders, error), error))
        return 0;
    hash = hash_reals(residuals->values, vertex_count) ^ 3 * hash_reals(scale->log_scale, triangle_count)
         ^ 5 * hash_reals(&scale->unevenness, 1);
    for (i = 0; i < cylinders->count; ++i) hash = 7 * hash ^ hash_reals(&cylinders->list[i].circumference, 1);
    print_hash(hash);
    hmf_free(residuals);
    hmf_free(scale);
    hmf_free(cylinders);
    return 1;
}

static int print_charts(const hmf_foliation* foliation, hmf_error* error) {
    hmf_chart_set* charts = NULL;
    if (check("hmf_atlas", hmf_atlas(foliation, NULL, NULL, &charts, error), error)) return 0;
    print_hash(hash_reals(charts->corner_uv, 6 * (size_t)charts->triangle_count));
    hmf_free(charts);
    return 1;
}

static hmf_hierarchy_options build_options(const uint32_t* marks, size_t mark_count) {
    hmf_hierarchy_options build;
    memset(&build, 0, sizeof build);
    build.struct_size = (uint32_t)sizeof build;
    build.coarsest = 200;
    build.marked_vertices = marks;
    build.marked_count = mark_count;
    return build;
}

/* Relaxed quads and an atlas take the place of leaves for an even design. */
static int uses(const char* name, const hmf_hierarchy* hierarchy, const hmf_loop_set* loops, int even) {
    hmf_foliation* foliation = NULL;
    hmf_trace_options across, along;
    hmf_error error;
    const double* values;
    size_t count;
    int good;
    static const uint32_t point_triangle[1] = {17};
    static const double point_barycentric[3] = {0.25, 0.25, 0.5};

    memset(&error, 0, sizeof error);
    memset(&along, 0, sizeof along);
    along.struct_size = (uint32_t)sizeof along;
    along.critical = 1;
    across = along;
    along.spacing = 0.25;
    across.leaves = HMF_LEAVES_CONJUGATE;
    across.point_count = 1;
    across.point_triangles = point_triangle;
    across.point_barycentrics = point_barycentric;

    if (check("hmf_solve", hmf_solve(hierarchy, loops, NULL, NULL, &foliation, &error), &error)) return 1;
    printf("%s %lu %lu", name, (unsigned long)vertex_count, (unsigned long)loops->count);
    values = hmf_foliation_values(foliation, &count);
    print_hash(hash_reals(values, count));
    good = print_map(foliation, &error)
        && (even ? print_charts(foliation, &error)
                 : print_leaves(foliation, &along, &error) && print_leaves(foliation, &across, &error))
        && print_quads(foliation, even ? 5 : 0, &error) && print_measures(foliation, loops, &error);
    printf("\n");
    hmf_foliation_destroy(foliation);
    return !good;
}

static int one(const char* name, int kind, const uint32_t* marks, size_t mark_count) {
    const hmf_hierarchy_options build = build_options(marks, mark_count);
    hmf_hierarchy* hierarchy = NULL;
    hmf_loop_set* loops = NULL;
    hmf_error error;
    int failed;

    memset(&error, 0, sizeof error);
    if (check(
            "hmf_hierarchy_create",
            hmf_hierarchy_create(positions, vertex_count, triangles, triangle_count, &build, NULL, &hierarchy, &error),
            &error))
        return 1;
    failed = check("hmf_loops", hmf_loops(hierarchy, 0, kind, NULL, &loops, &error), &error)
          || uses(name, hierarchy, loops, 0);
    hmf_free(loops);
    hmf_hierarchy_destroy(hierarchy);
    return failed;
}

static int even(const char* name) {
    hmf_design* design = NULL;
    hmf_hierarchy* hierarchy = NULL;
    hmf_hierarchy_options build;
    hmf_error error;
    int failed;

    memset(&error, 0, sizeof error);
    if (check("hmf_even_design",
              hmf_even_design(positions, vertex_count, triangles, triangle_count, NULL, NULL, &design, &error), &error))
        return 1;
    build = build_options(design->marked_vertices, (size_t)design->marked_count);
    failed = check("hmf_hierarchy_create",
                   hmf_hierarchy_create(positions, vertex_count, triangles, triangle_count, &build, NULL, &hierarchy,
                                        &error),
                   &error)
          || uses(name, hierarchy, design->loops, 1);
    hmf_hierarchy_destroy(hierarchy);
    hmf_free(design);
    return failed;
}

int main(void) {
    static const uint32_t marks[] = {0, 100, 200, 300, 400, 500};
    int failed = 0;
    make_plate(1, 4, 4, 0);
    failed |= one("torus", HMF_LOOPS_CUT, NULL, 0);
    make_plate(2, 4, 2, 0);
    failed |= one("genus2", HMF_LOOPS_HANDLE, NULL, 0);
    failed |= even("even-genus2");
    make_plate(3, 5, 3, 0);
    failed |= one("genus3", HMF_LOOPS_PANTS, NULL, 0);
    make_plate(0, 6, 12, 0);
    failed |= one("sphere", HMF_LOOPS_PANTS, marks, 6);
    failed |= even("even-sphere");
    make_plate(1, 5, 5, 0);
    failed |= one("marked-torus", HMF_LOOPS_PANTS, marks, 2);
    make_plate(2, 5, 3, 1);
    failed |= one("boundary", HMF_LOOPS_PANTS, NULL, 0);
    /* From 8192 vertices on a sweep goes by blocks. */
    make_plate(1, 20, 7, 0);
    failed |= one("large-torus", HMF_LOOPS_CUT, NULL, 0);
    return failed;
}
