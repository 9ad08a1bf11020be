/* The calls of bench_calls through the interface of the first version, where
 * each question was asked twice: once for the counts, once to fill arrays.
 * Prints "name seconds", processor time of both together; smallest of N runs.
 *
 *     calls N MESH.obj
 *
 * Compiled by bench/calls_against.sh with the headers of that version.
 */
#include <hmf/hmf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double* positions;
static uint32_t* triangles;
static size_t vertex_count, triangle_count;

static void* grow(void* block, size_t count, size_t* room, size_t bytes) {
    if (count < *room) return block;
    *room = *room ? 2 * *room : 1024;
    block = realloc(block, *room * bytes);
    if (!block) exit(1);
    return block;
}

static void read_obj(const char* path) {
    FILE* file = fopen(path, "r");
    char line[1024];
    size_t vertex_room = 0, triangle_room = 0;
    if (!file) exit(2);
    while (fgets(line, sizeof line, file)) {
        if (line[0] == 'v' && line[1] == ' ') {
            double* p;
            positions = grow(positions, vertex_count, &vertex_room, 3 * sizeof *positions);
            p = positions + 3 * vertex_count++;
            if (sscanf(line + 2, "%lf %lf %lf", p, p + 1, p + 2) != 3) exit(2);
        } else if (line[0] == 'f' && line[1] == ' ') {
            char* at = line + 1;
            int k;
            triangles = grow(triangles, triangle_count, &triangle_room, 3 * sizeof *triangles);
            for (k = 0; k < 3; ++k) {
                triangles[3 * triangle_count + (size_t)k] = (uint32_t)(strtol(at, &at, 10) - 1);
                while (*at && *at != ' ') ++at;
            }
            ++triangle_count;
        }
    }
    fclose(file);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static hmf_error error;
static void must(hmf_status status) {
    if (status == HMF_OK) return;
    fprintf(stderr, "%s\n", error.message);
    exit(1);
}

#define ROWS 8
static const char* const names[ROWS] = {"build",           "loops cut", "solve", "trace",
                                        "trace conjugate", "cylinders", "quads", "parameterize"};

static void run(double* seconds) {
    hmf_hierarchy* h;
    hmf_level_info info;
    size_t loop_count, size, n, lines, points, count, quad_vertices, quad_count, k;
    double start = now();
    must(hmf_build(positions, vertex_count, 0, triangles, triangle_count, NULL, &h, &error));
    seconds[0] = now() - start;
    start = now();
    must(hmf_loops(h, 0, HMF_LOOPS_CUT, NULL, 0, NULL, 0, &loop_count, &size, &error));
    uint64_t* offsets = malloc((loop_count + 1) * sizeof *offsets);
    uint32_t* elements = malloc(size * sizeof *elements);
    must(hmf_loops(h, 0, HMF_LOOPS_CUT, offsets, loop_count + 1, elements, size, &loop_count, &size, &error));
    seconds[1] = now() - start;
    hmf_loop_set loops = {sizeof loops, HMF_LOOP_TRIANGLES, 0, loop_count, offsets, elements, NULL};
    must(hmf_level_counts(h, 0, &info, &error));
    n = info.edge_count;
    double* values = malloc(n * sizeof *values);
    start = now();
    must(hmf_solve(h, &loops, NULL, values, n, NULL, &error));
    seconds[2] = now() - start;
    for (k = 0; k < 2; ++k) {
        hmf_trace_options options = {sizeof options, 1, 0.05, 0, 0, NULL, NULL, k ? HMF_LEAVES_CONJUGATE : 0, 0};
        start = now();
        must(hmf_trace(h, 0, values, n, &options, NULL, 0, NULL, 0, NULL, NULL, 0, &lines, &points, &error));
        hmf_line* line = malloc((lines + 1) * sizeof *line);
        uint64_t* line_offsets = malloc((lines + 1) * sizeof *line_offsets);
        double* point = malloc(3 * points * sizeof *point);
        uint32_t* edge = malloc(points * sizeof *edge);
        must(hmf_trace(h, 0, values, n, &options, line, lines, line_offsets, lines + 1, point, edge, points, &lines,
                       &points, &error));
        seconds[3 + k] = now() - start;
        free(line), free(line_offsets), free(point), free(edge);
    }
    start = now();
    must(hmf_cylinders(h, 0, values, n, &loops, NULL, 0, NULL, 0, NULL, 0, &count, &size, &error));
    hmf_cylinder* list = malloc(count * sizeof *list);
    uint64_t* leaf_offsets = malloc((count + 1) * sizeof *leaf_offsets);
    uint32_t* leaves = malloc(size * sizeof *leaves);
    must(hmf_cylinders(h, 0, values, n, &loops, list, count, leaf_offsets, count + 1, leaves, size, &count, &size,
                       &error));
    seconds[5] = now() - start;
    free(list), free(leaf_offsets), free(leaves);
    start = now();
    must(hmf_quads(h, 0, values, n, NULL, NULL, 0, NULL, 0, &quad_vertices, &quad_count, &error));
    double* corners = malloc(3 * quad_vertices * sizeof *corners);
    uint32_t* quads = malloc(4 * quad_count * sizeof *quads);
    must(hmf_quads(h, 0, values, n, NULL, corners, quad_vertices, quads, quad_count, &quad_vertices, &quad_count,
                   &error));
    seconds[6] = now() - start;
    free(corners), free(quads);
    hmf_parameterization out;
    memset(&out, 0, sizeof out);
    out.struct_size = sizeof out;
    out.vertex_capacity = vertex_count;
    out.edge_capacity = n;
    out.triangle_capacity = triangle_count;
    out.corner_uv = malloc(6 * triangle_count * sizeof(double));
    out.transition = malloc(3 * n * sizeof(double));
    out.seam = malloc(n);
    out.cone = malloc(vertex_count * sizeof(int32_t));
    out.dilatation = malloc(triangle_count * sizeof(double));
    out.differential = malloc(2 * triangle_count * sizeof(double));
    start = now();
    must(hmf_parameterize(h, 0, values, n, NULL, &out, &error));
    seconds[7] = now() - start;
    free(out.corner_uv), free(out.transition), free(out.seam), free(out.cone), free(out.dilatation);
    free(out.differential), free(values), free(offsets), free(elements);
    hmf_destroy(h);
}

int main(int argc, char** argv) {
    double best[ROWS], seconds[ROWS];
    int r, k;
    if (argc != 3) return 2;
    read_obj(argv[2]);
    for (r = 0; r < atoi(argv[1]); ++r) {
        run(seconds);
        for (k = 0; k < ROWS; ++k)
            if (r == 0 || seconds[k] < best[k]) best[k] = seconds[k];
    }
    for (k = 0; k < ROWS; ++k) printf("%s %.6f\n", names[k], best[k]);
    return 0;
}
