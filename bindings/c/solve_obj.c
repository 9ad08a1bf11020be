/* solve_obj MESH.obj VALUES.csv
 *
 * Reads a closed triangle mesh, solves with the loops of the library, prints
 * the report, and writes "vertex,vertex,value" for each edge, vertices from 0.
 * C89; link with hmf, and with the C++ runtime if hmf is a static library. */
#include <hmf/applications.h>

#include <stdio.h>
#include <stdlib.h>

struct mesh {
    double* positions;   /* vertex_count x 3 */
    uint32_t* triangles; /* triangle_count x 3 */
    size_t vertex_count, triangle_count;
};

/* Room for one more row of three; doubles at powers of two. */
static void* grow(void* rows, size_t count, size_t size) {
    if (count & (count - 1)) return rows;
    rows = realloc(rows, (count ? 2 * count : 1) * 3 * size);
    if (!rows) exit((fprintf(stderr, "out of memory\n"), 5));
    return rows;
}

static void add_vertex(struct mesh* m, double x, double y, double z) {
    double* p = m->positions = (double*)grow(m->positions, m->vertex_count, sizeof *p);
    p += 3 * m->vertex_count++;
    p[0] = x, p[1] = y, p[2] = z;
}

static void add_triangle(struct mesh* m, long a, long b, long c) {
    uint32_t* t = m->triangles = (uint32_t*)grow(m->triangles, m->triangle_count, sizeof *t);
    t += 3 * m->triangle_count++;
    t[0] = (uint32_t)a, t[1] = (uint32_t)b, t[2] = (uint32_t)c;
}

/* Lines "v x y z" and "f a b c"; what follows a slash in "a/b/c" is not used. */
static int read_obj(struct mesh* m, const char* path) {
    char line[1024];
    double x, y, z;
    long a, b, c, d;
    int corners;
    FILE* file = fopen(path, "r");
    if (!file) return 0;
    while (fgets(line, sizeof line, file)) {
        if (sscanf(line, "v %lf %lf %lf", &x, &y, &z) == 3) add_vertex(m, x, y, z);
        if (line[0] != 'f' || line[1] != ' ') continue;
        corners = sscanf(line, "f %ld%*[^ ] %ld%*[^ ] %ld%*[^ ] %ld", &a, &b, &c, &d);
        if (corners < 3) corners = sscanf(line, "f %ld %ld %ld %ld", &a, &b, &c, &d);
        if (corners != 3 || a < 1 || b < 1 || c < 1)
            exit((fprintf(stderr, "%s: this example reads triangles with positive numbers only: %s", path, line), 3));
        add_triangle(m, a - 1, b - 1, c - 1);
    }
    fclose(file);
    return 1;
}

int main(int argc, char** argv) {
    struct mesh m = {NULL, NULL, 0, 0};
    hmf_hierarchy* hierarchy = NULL;
    hmf_foliation* foliation = NULL;
    hmf_error error = {0, 0, 0, ""};
    const hmf_report* report;
    hmf_status status;
    size_t edge_count, e;
    const double* values;
    hmf_level_mesh* mesh = NULL;
    FILE* csv;

    if (argc != 3) return fprintf(stderr, "usage: %s MESH.obj VALUES.csv\n", argv[0]), 2;
    if (!read_obj(&m, argv[1])) return perror(argv[1]), 5;

    status = hmf_hierarchy_create(m.positions, m.vertex_count, m.triangles, m.triangle_count, NULL, NULL, &hierarchy,
                                  &error);
    if (!status) status = hmf_solve_cut_system(hierarchy, NULL, NULL, &foliation, &error);
    if (status) fprintf(stderr, "%s: %s\n", hmf_status_string(status), error.message);
    if (foliation) { /* also if a limit ended the optimization */
        report = hmf_foliation_report(foliation);
        values = hmf_foliation_values(foliation, &edge_count);
        printf("genus %lu, energy %.9g, largest residual %.1e, zeros %lu, poles %lu, %.2f s\n",
               (unsigned long)hmf_hierarchy_describe(hierarchy)->genus, report->energy, report->residual_max,
               (unsigned long)report->zeros, (unsigned long)report->poles, report->solve_seconds);
        if (hmf_level(hierarchy, 0, NULL, &mesh, &error)) return fprintf(stderr, "%s\n", error.message), 5;
        csv = fopen(argv[2], "w");
        for (e = 0; csv && e < edge_count; ++e)
            fprintf(csv, "%lu,%lu,%.17g\n", (unsigned long)mesh->edge_vertices[2 * e],
                    (unsigned long)mesh->edge_vertices[2 * e + 1], values[e]);
        if (!csv || fclose(csv)) return perror(argv[2]), 5;
        hmf_free(mesh);
    }
    hmf_foliation_destroy(foliation);
    hmf_hierarchy_destroy(hierarchy);
    free(m.positions);
    free(m.triangles);
    return status != HMF_OK;
}
