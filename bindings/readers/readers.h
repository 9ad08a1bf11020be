/*
 * The readers and repairs of mesh files for bindings of other languages: C, no exceptions.  Not part of the interface
 * of the library; each binding is compiled together with them.
 */
#ifndef HMF_READERS_H
#define HMF_READERS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A mesh, what was noted about it, or why there is none. */
typedef struct hmf_mesh_file {
    uint64_t vertex_count;
    uint64_t triangle_count;
    const double *positions;     /* 3 for each vertex */
    const uint32_t *triangles;   /* 3 for each triangle */
    const uint32_t *vertices;    /* of each vertex its number in the file, or in the mesh that was given */
    const uint32_t *faces;       /* of each triangle its face there; UINT32_MAX of new ones, as above */
    const char *notes;           /* a sentence a line */
    const char *error;           /* empty: there is a mesh */
    uint64_t line;               /* of the error, 0 where none is known */
    void *owner;
} hmf_mesh_file;

/* Reads a file from its bytes; extension: in lower case with its dot, without .gz; folder: where files lie that a .gltf
   names.  Vertices without a face are dropped.  Returns NULL without memory; free it with hmf_mesh_file_free. */
hmf_mesh_file *hmf_mesh_file_read(const char *bytes, uint64_t size, const char *extension, const char *folder);

/* Repairs a mesh: repairs that lose nothing, unless `repair` is 0; points that are not further apart than
   `join_distance` become one first, where that is not negative; holes of at most `fill_edges` edges are closed. */
hmf_mesh_file *hmf_mesh_file_repair(const double *positions, uint64_t vertex_count, const uint32_t *triangles,
                                    uint64_t triangle_count, int32_t repair, double join_distance, uint64_t fill_edges);

void hmf_mesh_file_free(hmf_mesh_file *file);

#ifdef __cplusplus
}
#endif

#endif
