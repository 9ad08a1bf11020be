/* The meshes of README.md, and the hash of values, for the C programs of this folder. */
#ifndef HMF_SAME_BITS_PLATE_H
#define HMF_SAME_BITS_PLATE_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A plate of unit cubes with rectangular holes, see README.md. */
struct plate {
    const char* name;
    int holes_x, holes_y; /* their product is the genus */
    int side;             /* of a hole and of a bar, in cubes */
    int height;
};

/* The three meshes. */
static const struct plate plates[] = {{"genus1", 1, 1, 4, 4}, {"genus2", 2, 1, 8, 7}, {"genus6", 3, 2, 15, 10}};

struct mesh {
    double* positions;
    uint32_t* triangles;
    size_t vertex_count, triangle_count;
};

/* Outward normals, and the corners of each face counter-clockwise from outside. */
static const int direction[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
static const int corner[6][4][3] = {
    {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}}, {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}},
    {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, {{0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0}},
    {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

static int solid(const struct plate* p, int x, int y, int z) {
    const int width = (2 * p->holes_x + 1) * p->side, depth = (2 * p->holes_y + 1) * p->side;
    if (x < 0 || x >= width || y < 0 || y >= depth || z < 0 || z >= p->height) return 0;
    return !((x / p->side) % 2 == 1 && (y / p->side) % 2 == 1);
}

/* The arrays are filled when they are there; with NULL arrays it only counts. */
static void make_faces(const struct plate* p, uint32_t* number, struct mesh* m) {
    const int width = (2 * p->holes_x + 1) * p->side, depth = (2 * p->holes_y + 1) * p->side;
    int x, y, z, d, k;
    m->vertex_count = 0;
    m->triangle_count = 0;
    for (z = 0; z < p->height; ++z)
        for (y = 0; y < depth; ++y)
            for (x = 0; x < width; ++x) {
                if (!solid(p, x, y, z)) continue;
                for (d = 0; d < 6; ++d) {
                    uint32_t q[4];
                    if (solid(p, x + direction[d][0], y + direction[d][1], z + direction[d][2])) continue;
                    for (k = 0; k < 4; ++k) {
                        const int i = x + corner[d][k][0], j = y + corner[d][k][1], l = z + corner[d][k][2];
                        uint32_t* n =
                            number + ((size_t)l * (size_t)(depth + 1) + (size_t)j) * (size_t)(width + 1) + (size_t)i;
                        if (*n == UINT32_MAX) {
                            *n = (uint32_t)m->vertex_count++;
                            if (m->positions) {
                                double* at = m->positions + 3 * (size_t)*n;
                                at[0] = 16 * i + (3 * i + 5 * j + 6 * l + i * j) % 7 - 3;
                                at[1] = 16 * j + (5 * i + 2 * j + 3 * l + j * l) % 7 - 3;
                                at[2] = 16 * l + (2 * i + 3 * j + 5 * l + l * i) % 7 - 3;
                            }
                        }
                        q[k] = *n;
                    }
                    if (m->triangles) {
                        uint32_t* t = m->triangles + 3 * m->triangle_count;
                        t[0] = q[0], t[1] = q[1], t[2] = q[2];
                        t[3] = q[0], t[4] = q[2], t[5] = q[3];
                    }
                    m->triangle_count += 2;
                }
            }
}

static int make_plate(const struct plate* p, struct mesh* m) {
    const size_t points = (size_t)((2 * p->holes_x + 1) * p->side + 1) * (size_t)((2 * p->holes_y + 1) * p->side + 1)
                        * (size_t)(p->height + 1);
    uint32_t* number = malloc(points * sizeof *number);
    m->positions = NULL;
    m->triangles = NULL;
    if (!number) return 0;
    memset(number, 0xff, points * sizeof *number);
    make_faces(p, number, m);
    m->positions = malloc(3 * m->vertex_count * sizeof *m->positions);
    m->triangles = malloc(3 * m->triangle_count * sizeof *m->triangles);
    if (m->positions && m->triangles) {
        memset(number, 0xff, points * sizeof *number);
        make_faces(p, number, m);
    }
    free(number);
    return m->positions && m->triangles;
}

static uint64_t fnv1a64(const double* values, size_t count) {
    uint64_t hash = 14695981039346656037u;
    size_t i;
    int byte;
    for (i = 0; i < count; ++i) {
        uint64_t bits;
        memcpy(&bits, values + i, sizeof bits);
        for (byte = 0; byte < 8; ++byte) {
            hash ^= bits >> (8 * byte) & 0xff;
            hash *= 1099511628211u;
        }
    }
    return hash;
}

#endif /* HMF_SAME_BITS_PLATE_H */
