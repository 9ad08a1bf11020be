/*
 * hmf - harmonic measured foliations on triangle meshes
 *
 * A measured foliation gives every edge of a triangle mesh a number F >= 0, the
 * transverse measure of the edge: how far apart the leaves through its two ends are.
 * The harmonic foliation of a class minimizes the Dirichlet energy
 *
 *     D(F) = sum over edges of  weight(edge) * F(edge)^2.
 *
 * The class is given by loops: disjoint closed curves with positive weights.  On
 * a surface with boundary there may also be arcs from boundary to boundary.
 * Conformal parameterizations, quad meshes and stripe patterns follow from F.
 *
 * In short:
 *
 *     hmf_hierarchy_create  positions + triangles  -> hierarchy
 *     hmf_loops             hierarchy              -> loops; in hmf/applications.h, or your own
 *     hmf_solve             hierarchy, loops       -> foliation
 *     hmf_foliation_values                         -> one number per edge
 *     hmf_foliation_destroy, hmf_free, hmf_hierarchy_destroy
 *
 * This header declares the core, the library hmf_core.  hmf/applications.h chooses
 * loops, and computes parameterizations, leaves, cylinders, quads and charts.
 *
 * Rules for every function
 *
 *   errors    A function that can fail returns hmf_status; 0 is success.  Its last
 *             argument is an optional hmf_error, which receives the element
 *             concerned and a sentence with the remedy.  On failure
 *             outputs are left unchanged, except that object pointers are set to
 *             NULL; other exceptions are documented.  Each function lists the
 *             classes of errors that it can return: class 100 stands for
 *             HMF_ERROR_NULL to HMF_ERROR_QUADS, and so on.  Any function
 *             can return HMF_ERROR_INTERNAL, a defect of the library.
 *   pointers  Options, control, error and arguments documented as optional may be
 *             NULL; any other NULL is refused with HMF_ERROR_NULL.  Arrays and
 *             structures that you pass are read during the call only.
 *   objects   hmf_hierarchy and hmf_foliation are immutable: any number of
 *             threads may use them.  A foliation keeps what it needs of its
 *             hierarchy, so destroy them in any order.  There is no global state.
 *   results   A result is one structure with counts and flat arrays, in one block:
 *             free it with hmf_free.  What hmf_hierarchy_describe, hmf_foliation_values and
 *             hmf_foliation_report return belongs to the object: do not free it.
 *   types     Indices are uint32_t from 0, counts size_t or uint64_t, reals double.
 *             Values of an enumeration are passed and stored as int32_t, so that
 *             layouts do not depend on the compiler.  HMF_X_* means the values of the
 *             enumeration hmf_x.
 *   memory    All memory comes from the allocator of the hierarchy options.  It
 *             must be thread-safe if objects are shared between threads, and must
 *             outlive the objects and results.
 *   options   Structures begin with struct_size = sizeof(structure), so that they
 *             can grow.  A function for each sets struct_size and the defaults:
 *                 hmf_solve_options options;
 *                 hmf_solve_options_init(&options, sizeof options);
 *             Zero in any field also means its default, so
 *             hmf_solve_options options = {sizeof options} is the same.  NULL
 *             means all defaults.  In results, struct_size says which fields exist.
 *   control   Calls that can take long accept an optional hmf_control with progress,
 *             cancellation and threads of the host.  All of them return
 *             HMF_CANCELLED if the progress function asks for it.
 *   levels    Level 0 is your mesh; higher levels are coarser.  Edges of level 0
 *             are numbered by their first appearance in the triangle array
 *             (sides 0-1, 1-2, 2-0 of triangle 0, then of triangle 1, and so on).
 *             Vertices and triangles keep your numbers.
 *   boundary  A surface with boundary is solved on its closed double: the surface
 *             and its mirror image, glued along the boundary.  Leaves run along
 *             the boundary or meet it at right angles.  On level 0 you see the
 *             surface only, and energies and areas are those of the surface.
 *             Coarser levels, and counts and orders of poles and zeros, are those of
 *             the double.  hmf_solve gives both halves of level 0 exactly the same
 *             values, unless a part where all values are 0 contains a boundary and
 *             also a handle or a marked vertex.  You receive the values of your half,
 *             and hmf_foliation_from_values accepts them.  Energy and residual are
 *             those of the intrinsic triangulation; its values differ between the
 *             halves by up to the residual.
 *   sources   [W] Wang, Ma, Zhao, Wang: A multigrid approach for generating
 *             harmonic measured foliations, Computers & Graphics 2021.
 */
#ifndef HMF_HMF_H
#define HMF_HMF_H

#include <stddef.h>
#include <stdint.h>

#define HMF_VERSION_MAJOR 0
#define HMF_VERSION_MINOR 1
#define HMF_VERSION_PATCH 0

#if defined(_WIN32) && defined(HMF_SHARED)
#  ifdef HMF_BUILDING
#    define HMF_API __declspec(dllexport)
#  else
#    define HMF_API __declspec(dllimport)
#  endif
#elif defined(__GNUC__)
#  define HMF_API __attribute__((visibility("default")))
#else
#  define HMF_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------
 * Status and errors
 * --------------------------------------------------------------------- */

/* Result of every call that can fail.  Values never change; new ones may be added. */
typedef int32_t hmf_status;

typedef enum hmf_status_code {
    HMF_OK = 0,

    /* stopped early: the foliation is valid, closed and without poles, but not yet
       harmonic to the tolerance (hmf_solve and hmf_relax still give it) */
    HMF_LIMIT_ITERATIONS = 10,
    HMF_LIMIT_TIME = 11,
    HMF_LIMIT_STALLED = 12,
    HMF_CANCELLED = 13,
    HMF_LIMIT_CLASS = 14,        /* no step within the class of the loops reaches the minimum; error->index is a loop
                                    whose class would be lost. report->class_state describes the values */

    /* the call itself */
    HMF_ERROR_NULL = 100,        /* a required pointer is NULL */
    HMF_ERROR_OPTIONS = 101,     /* an option is out of range or from a newer header */
    HMF_ERROR_COUNT = 102,       /* an array has the wrong number of elements */
    HMF_ERROR_LEVEL = 103,       /* no such level */
    HMF_ERROR_UNSUPPORTED = 104, /* not available in this version, or for this input */
    HMF_ERROR_QUADS = 105,       /* these leaves carry no good quads of this size */

    /* resources */
    HMF_ERROR_MEMORY = 200,      /* the allocator returned NULL */
    HMF_ERROR_MEMORY_LIMIT = 201, /* the memory limit of the options was reached */

    /* the mesh */
    HMF_ERROR_MESH_COUNTS = 300, /* no vertices, no triangles, or more than 2^31 / 3 of either */
    HMF_ERROR_MESH_INDEX = 301, /* a triangle names a vertex that does not exist */
    HMF_ERROR_MESH_NOT_FINITE = 302, /* a coordinate is infinite or not a number */
    HMF_ERROR_MESH_REPEATED_VERTEX = 303, /* a triangle names one vertex twice */
    HMF_ERROR_MESH_DEGENERATE = 304, /* a triangle of zero area (see mollify in hmf_hierarchy_options) */
    HMF_ERROR_MESH_BOUNDARY = 305, /* the surface has a boundary, and the call needs a closed one */
    HMF_ERROR_MESH_NON_MANIFOLD_EDGE = 306, /* an edge with three or more triangles */
    HMF_ERROR_MESH_ORIENTATION = 307, /* neighboring triangles have opposite orientations */
    HMF_ERROR_MESH_NON_MANIFOLD_VERTEX = 308, /* a vertex with several fans of triangles */
    HMF_ERROR_MESH_UNUSED_VERTEX = 309, /* a vertex without a triangle */
    HMF_ERROR_MESH_COMPONENTS = 310, /* more than one connected component: see hmf_components */
    HMF_ERROR_MESH_GENUS = 311, /* genus 0 with too few marked vertices: no measured foliation */
    HMF_ERROR_MESH_NOT_EMBEDDED = 312, /* the surface intersects itself, so inside and outside are not defined */
    HMF_ERROR_MESH_NOT_DELAUNAY = 313, /* the intrinsic Delaunay triangulation was not reached: triangles are too thin,
                                    or more than 16 flips per edge are needed */

    /* loops and weights */
    HMF_ERROR_LOOP_COUNT = 400, /* no loops */
    HMF_ERROR_LOOP_INDEX = 401, /* an element that does not exist on the level */
    HMF_ERROR_LOOP_NOT_CLOSED = 402, /* consecutive elements are not neighbors */
    HMF_ERROR_LOOP_NOT_SIMPLE = 403, /* a loop crosses itself */
    HMF_ERROR_LOOP_CROSSING = 404, /* two loops cross */
    HMF_ERROR_LOOP_TRIVIAL = 405, /* a loop bounds a disk */
    HMF_ERROR_LOOP_PARALLEL = 406, /* two loops are freely homotopic */
    HMF_ERROR_LOOP_WEIGHT = 407, /* a weight is not in [1e-100, 1e100), or the weights span more than 2^20 */

    /* values */
    HMF_ERROR_VALUE_NOT_FINITE = 500, /* a value is negative, not a number or above 1e300, or the largest is
                                          below 1e-270 */
    HMF_ERROR_VALUE_NOT_CLOSED = 501, /* a triangle inequality is violated, or a value is not a multiple of the unit */
    HMF_ERROR_VALUE_POLE = 502, /* the values have a pole, or are all 0 */
    HMF_ERROR_VALUE_NOT_HARMONIC = 503, /* the values are too far from the minimum */
    HMF_ERROR_VALUE_CLASS = 504, /* the values are those of other loops than given, or their leaves do not close */

    /* a defect of the library itself */
    HMF_ERROR_INTERNAL = 900
} hmf_status_code;

/* No element, where an index is expected. */
#define HMF_NONE 0xffffffffu

/* What an error is about. */
typedef enum hmf_element {
    HMF_ELEMENT_NONE = 0,
    HMF_ELEMENT_VERTEX = 1,
    HMF_ELEMENT_EDGE = 2,
    HMF_ELEMENT_TRIANGLE = 3,
    HMF_ELEMENT_LOOP = 4,
    HMF_ELEMENT_LEVEL = 5,
    HMF_ELEMENT_OPTION = 6
} hmf_element;

/* Filled by a call that fails; left unchanged by a call that succeeds. */
typedef struct hmf_error {
    hmf_status status;
    int32_t element;             /* HMF_ELEMENT_*: what the error is about */
    uint64_t index;        /* of the element */
    char message[240];           /* what is wrong and what to do; zero-terminated */
} hmf_error;

/* Returns the version of the library as major * 10000 + minor * 100 + patch. */
HMF_API uint32_t hmf_version(void);

/* Returns a short English text for any value; never NULL.  Do not free it. */
HMF_API const char *hmf_status_string(hmf_status status);

/* ------------------------------------------------------------------------
 * Callbacks
 * --------------------------------------------------------------------- */

/* Returns a block aligned for any type, or NULL.  user: allocator_user. */
typedef void *(*hmf_allocate_fn)(void *user, size_t size);

/* Frees a block; size is the requested size. */
typedef void (*hmf_release_fn)(void *user, void *block, size_t size);

/* Answer of a progress function. */
typedef enum hmf_progress {
    HMF_PROGRESS_CONTINUE = 0,
    /* This, and any value that is not listed: return HMF_CANCELLED, within 50 ms on
       a mesh of a million edges. */
    HMF_PROGRESS_CANCEL = 1,
    /* hmf_solve, hmf_relax: stop improving, carry the foliation to the level of the
       options, return it with the status HMF_CANCELLED.  Elsewhere as CANCEL. */
    HMF_PROGRESS_FINISH = 2
} hmf_progress;

/* Called on the calling thread.  fraction rises from 0 to 1.  Returns an hmf_progress.
   The callback must not call hmf with the same objects. */
typedef int32_t (*hmf_progress_fn)(void *user, double fraction);

/* A part of the work of a call.  It neither allocates nor calls back. */
typedef void (*hmf_task_fn)(void *context, uint32_t index);

/* Calls task(context, index) exactly once for each index from 0 to count - 1, on any
   threads and in any order, and returns when all calls have ended.  The tasks may run
   at the same time or one after the other.  What a task has written must be visible
   after the return, as after joining threads or with a mutex.  The function cannot
   fail: without a free thread it runs the tasks itself.

   hmf calls it on the calling thread only, never from a task, and with
   2 <= count <= hmf_control.workers.  hmf_pool_run of hmf/pool.h is such a function; with OpenMP:

       void run(void *user, hmf_task_fn task, void *context, uint32_t count)
       {
           int i, n = (int)count;
           #pragma omp parallel for schedule(static, 1)
           for (i = 0; i < n; ++i) task(context, (uint32_t)i);
       } */
typedef void (*hmf_parallel_for_fn)(void *user, hmf_task_fn task, void *context, uint32_t count);

/* Progress, cancellation and threads for one call; NULL = none.

   hmf never creates threads.  With parallel_for it shares the work of a call among
   threads of the host.  Results are bit-identical with and without it, and for any
   number of workers: the problem alone decides how work is divided, and sums are added
   in the order of the parts.  Each worker needs some memory during the call.  The progress
   function and the allocator are called on the calling thread only. */
typedef struct hmf_control {
    uint32_t struct_size;
    uint32_t workers;            /* number of tasks that parallel_for can run at once; 0 = 16; at most 256 are used */
    hmf_progress_fn progress;    /* NULL = none */
    void *progress_user;
    hmf_parallel_for_fn parallel_for; /* NULL = everything runs on the calling thread */
    void *parallel_user;
} hmf_control;

/* Sets struct_size (pass sizeof(hmf_control)) and all other fields to their defaults.  NULL is allowed. */
HMF_API void hmf_control_init(hmf_control *control, uint32_t struct_size);

/* Frees a result of hmf_level, hmf_residuals, hmf_singularities or a call of
   applications.h; NULL is allowed. */
HMF_API void hmf_free(const void *result);

/* ------------------------------------------------------------------------
 * Build
 * --------------------------------------------------------------------- */

typedef enum hmf_collapse {
    HMF_COLLAPSE_DEFAULT = 0,
    HMF_COLLAPSE_MIDPOINT = 1,   /* shortest edge first, to its midpoint (default) */
    HMF_COLLAPSE_ENDPOINT = 2,   /* shortest edge first, to one end */
    HMF_COLLAPSE_QSLIM = 3       /* least quadric error first, to the best point */
} hmf_collapse;

typedef struct hmf_hierarchy_options {
    uint32_t struct_size;
    int32_t collapse;            /* HMF_COLLAPSE_* */
    double ratio;                /* number of edges of a level / of the next finer level; in [0.05, 0.95], default
                                    0.5 */
    uint64_t coarsest;           /* target number of vertices of the coarsest level; default a sixteenth of all, at most
                                    1000. Raised to 40 * genus + 10 * marked_count */
    uint64_t memory_limit;       /* in bytes, 0 = none. hmf_hierarchy_create counts all memory in use; later calls count
                                    the hierarchy and their own, without stored foliations and results */
    hmf_allocate_fn allocate;    /* NULL = malloc; set both functions or none */
    hmf_release_fn release;
    void *allocator_user;
    uint64_t position_stride;    /* bytes from one vertex to the next, 0 = packed (24); at least 24, a multiple of 8 */
    double mollify;              /* in [0, 0.1], 0 = off; 1e-5 is a good value. Accepts triangles of zero area and edges
                                    of length 0: all edges of level 0 get longer by the same length, just enough for
                                    every triangle inequality to hold with a margin of mollify * mean length.
                                    Only the weights of level 0 change; meshes that have the margin already do not
                                    change */
    const uint32_t *marked_vertices; /* vertices that may be poles. A sphere needs at least four; a disk needs four on
                                    its boundary; one in its interior counts as two. They never move, and the report
                                    does not count them as poles. See hmf_singularities for the sum of all indices */
    uint64_t marked_count;
} hmf_hierarchy_options;

/* Sets the defaults, see hmf_control_init. */
HMF_API void hmf_hierarchy_options_init(hmf_hierarchy_options *options, uint32_t struct_size);

/* An immutable hierarchy of triangle meshes. */
typedef struct hmf_hierarchy hmf_hierarchy;

/* An immutable measured foliation on one level of a hierarchy. */
typedef struct hmf_foliation hmf_foliation;

/*
 * Validates a mesh and builds its hierarchy ([W] 4.1).
 *
 *   positions   vertex_count x 3, in any unit; see options->position_stride
 *   triangles   triangle_count x 3 vertex indices, all counter-clockwise or all
 *               clockwise
 *   out         the hierarchy; NULL on failure
 *
 * The mesh must be a connected, oriented manifold, with or without boundary.  A
 * sphere or a disk needs marked vertices, see hmf_hierarchy_options.
 *
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200, 300.
 *
 * Inputs are copied.  Time is linear: about 0.3 s per million edges, twice as
 * much with boundary.
 */
HMF_API hmf_status hmf_hierarchy_create(const double *positions, size_t vertex_count, const uint32_t *triangles,
                                        size_t triangle_count, const hmf_hierarchy_options *options,
                                        const hmf_control *control, hmf_hierarchy **out, hmf_error *error);

/* Destroys a hierarchy; NULL is allowed.  Its memory is freed with the last of
   its foliations. */
HMF_API void hmf_hierarchy_destroy(hmf_hierarchy *hierarchy);

/* Returns an upper bound of the memory in bytes that hmf_hierarchy_create uses at
   its peak with the given options (NULL = defaults); 0 if the counts are unusable.
   For a mesh with boundary pass twice the counts, because its double is built. */
HMF_API uint64_t hmf_hierarchy_memory_estimate(size_t vertex_count, size_t triangle_count,
                                               const hmf_hierarchy_options *options);

/* ------------------------------------------------------------------------
 * Levels
 * --------------------------------------------------------------------- */

typedef struct hmf_level_info {
    uint64_t vertex_count;
    uint64_t edge_count;
    uint64_t triangle_count;
    uint64_t raised_count;       /* edges whose weight was raised to a lower bound; 0 on level 0, where the solver
                                    uses the weights of the intrinsic Delaunay triangulation */
} hmf_level_info;

typedef struct hmf_hierarchy_info {
    uint64_t level_count;        /* at least 1 */
    uint64_t genus;              /* of the surface with its boundary curves filled in */
    uint64_t boundary_count;     /* number of boundary curves */
    uint64_t memory_bytes;       /* held by the hierarchy */
    const hmf_level_info *levels; /* level_count, finest first */
} hmf_hierarchy_info;

/* Returns counts of a hierarchy, valid until it is destroyed; NULL for NULL. */
HMF_API const hmf_hierarchy_info *hmf_hierarchy_describe(const hmf_hierarchy *hierarchy);

/* The mesh of one level. */
typedef struct hmf_level_mesh {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t vertex_count;
    uint64_t edge_count;
    uint64_t triangle_count;
    const double *positions;     /* vertex_count x 3, in the unit of the input */
    const uint32_t *edge_vertices; /* edge_count x 2; on coarse levels several edges may join two vertices */
    const uint32_t *triangle_vertices; /* triangle_count x 3 corners */
    const uint32_t *triangle_edges; /* triangle_count x 3; side s of a triangle joins its corners s and s+1 */
    const double *weights;       /* edge_count, half the sum of the opposite cotangents (one on the boundary), without
                                    unit. On level 0 those of your triangulation, which may be negative; the solver
                                    uses those of the intrinsic Delaunay triangulation */
} hmf_level_mesh;

/* Copies the mesh of a level.  Free it with hmf_free.
   Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200. */
HMF_API hmf_status hmf_level(const hmf_hierarchy *hierarchy, size_t level, const hmf_control *control,
                             hmf_level_mesh **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Loops
 * --------------------------------------------------------------------- */

/* What the elements of a loop are. */
typedef enum hmf_path {
    HMF_PATH_TRIANGLES = 1,      /* consecutive triangles share an edge; the last and the first as well */
    HMF_PATH_VERTICES = 2        /* consecutive vertices share an edge; the last and the first as well */
} hmf_path;

/* A set of loops on one level, as flat arrays.

   On a surface with boundary, loops lie on level 0.  Leaves run along a boundary
   if a loop can be pushed into it, and meet it at right angles if an arc ends
   there.  An arc of vertices leads along edges from one boundary vertex to
   another.  An arc of triangles leads through triangles, and crosses a boundary
   side of its first and of its last triangle. */
typedef struct hmf_loop_set {
    uint32_t struct_size;
    int32_t element_kind;        /* HMF_PATH_TRIANGLES or HMF_PATH_VERTICES */
    uint64_t level;              /* level whose elements are named; with boundary 0. hmf_solve carries the loops
                                    exactly to the levels where it needs them, finer or coarser */
    uint64_t count;              /* number of loops, at least 1 */
    const uint64_t *offsets;     /* count + 1, increasing from 0, otherwise HMF_ERROR_LOOP_COUNT; loop c is
                                    elements[offsets[c]] .. elements[offsets[c+1]-1] */
    const uint32_t *elements;    /* offsets[count]; NULL here or in offsets is HMF_ERROR_NULL */
    const double *weights;       /* count, each in [1e-100, 1e100); the largest is at most 2^20 times the smallest;
                                    NULL = all 1 */
    const uint8_t *arcs;         /* count; not 0 = an arc, whose first and last element lie at the boundary (on a
                                    closed surface HMF_ERROR_LOOP_NOT_CLOSED); NULL = all are closed */
    const uint32_t *arc_sides;   /* count x 2, for arcs of triangles: the side (0 to 2) of the first triangle where the
                                    arc begins, and of the last one where it ends; HMF_NONE = the first side on the
                                    boundary; NULL = HMF_NONE for all */
} hmf_loop_set;

/*
 * Makes the initial foliation of the loops ([W] 3.3): the value of an edge is the
 * sum of the weights of the loops that cross it.
 *
 *   loops      on any level; with boundary on level 0, otherwise HMF_ERROR_LEVEL
 *   out        the foliation on loops->level, without a report
 *
 * Loops must not cross themselves or each other.  No loop may bound a disk with fewer
 * than two marked vertices, and no two loops may be deformable into each other (freely
 * homotopic) on the surface without its marked vertices.  A path of vertices must not
 * pass through a marked vertex.  Loops may touch themselves and each other, at elements
 * and along stretches, if they can be pushed apart there.  A loop may double back on
 * itself: such detours are removed first, so that the result has no poles.
 *
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100 (HMF_ERROR_UNSUPPORTED as in
 * hmf_solve), 200, 400.  For class 400 error->index is the loop.
 */
HMF_API hmf_status hmf_foliation_from_loops(const hmf_hierarchy *hierarchy, const hmf_loop_set *loops,
                                            const hmf_control *control, hmf_foliation **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Foliation
 * --------------------------------------------------------------------- */

/*
 * Makes a foliation from values, one for each edge of a level.
 *
 *   values     one for each edge of the level, in its order
 *   count      edge_count of the level, otherwise HMF_ERROR_COUNT
 *   out        the foliation on the level, without a report
 *
 * Values must be results of the library.  They may have been written with 17
 * digits and read again, or multiplied by a power of two.  They are copied and
 * validated: none is negative or above 1e300, the largest is at least 1e-270, all are
 * multiples of one power of two, and every triangle inequality holds ("closed").  On
 * level 0 of a surface with boundary you pass your half; the mirror image gets the same
 * values.  On coarser levels you pass the values of the double.
 *
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200, 500.  Values that are
 * all 0 give HMF_ERROR_VALUE_POLE.
 *
 * Do not round other numbers edge by edge: many triangle inequalities hold with
 * equality, and rounding breaks them.  Start from loops instead.  Values with poles are
 * accepted, but only hmf_singularities, hmf_energy and hmf_conformal_scale take such a
 * foliation; other calls return HMF_ERROR_VALUE_POLE.
 */
HMF_API hmf_status hmf_foliation_from_values(const hmf_hierarchy *hierarchy, size_t level, const double *values,
                                             size_t count, const hmf_control *control, hmf_foliation **out,
                                             hmf_error *error);

/* Destroys a foliation; NULL is allowed. */
HMF_API void hmf_foliation_destroy(hmf_foliation *foliation);

/* Returns one value for each edge of the level, in the unit of the weights, valid
   until the foliation is destroyed; NULL for NULL.  count, if not NULL, receives
   the number of values.  All values are exact multiples of hmf_foliation_unit, and
   every triangle inequality holds exactly. */
HMF_API const double *hmf_foliation_values(const hmf_foliation *foliation, size_t *count);

/* Returns the level of the foliation; 0 for NULL. */
HMF_API size_t hmf_foliation_level(const hmf_foliation *foliation);

/* Returns the power of two of which all values are multiples; 0 for NULL. */
HMF_API double hmf_foliation_unit(const hmf_foliation *foliation);

/* Returns the bytes held by the foliation, without its hierarchy; 0 for NULL.  The
   number grows at most once: if residual_max is at most 1e-8, the first call of
   hmf_parameterize, hmf_atlas or hmf_trace (conjugate leaves) stores data for later
   calls.  Several threads may make these calls at the same time. */
HMF_API uint64_t hmf_foliation_memory(const hmf_foliation *foliation);

/* ------------------------------------------------------------------------
 * Solve
 * --------------------------------------------------------------------- */

typedef enum hmf_method {
    HMF_METHOD_DEFAULT = 0,
    HMF_METHOD_NEWTON = 1,       /* Newton's method, level by level (default) */
    HMF_METHOD_WHITEHEAD = 2,    /* Whitehead moves, level by level ([W] section 4) */
    HMF_METHOD_SINGLE_LEVEL = 3, /* Whitehead moves on the input mesh alone ([W] 3.3); stop_level must be 0 */
    HMF_METHOD_PAPER = 4         /* for comparison: WHITEHEAD with "case 4" of [W] 4.2.2 as printed, where a flip may
                                    make a pole. A result with poles or of another class has HMF_LIMIT_CLASS, unless
                                    another limit ended it; with poles only hmf_singularities, hmf_energy and
                                    hmf_conformal_scale accept it. Without such flips the result is that of
                                    WHITEHEAD, bit for bit */
} hmf_method;

typedef struct hmf_solve_options {
    uint32_t struct_size;
    int32_t method;              /* HMF_METHOD_* */
    double tolerance;            /* residual_max to reach on stop_level, below 1; 0 = 1e-8. The report calls results up
                                    to it converged. Whitehead methods: 0 = sweeps (one visit of every vertex) end
                                    by energy_tolerance, and the residual may stay above 1e-8 */
    double energy_tolerance;     /* Whitehead methods: sweeps end when one lowers the energy by less than this fraction;
                                    default 1e-6. Used on levels coarser than stop_level, and there if tolerance is
                                    0. It does not bound the residual */
    double time_limit;           /* seconds from the start of the call, 0 = none; then HMF_LIMIT_TIME. The result is
                                    still carried to stop_level, which takes a little longer */
    uint64_t iteration_limit;    /* Whitehead methods: sweeps per level, default 100000; HMF_LIMIT_ITERATIONS if it
                                    ends stop_level */
    uint64_t stop_level;         /* finest level to solve, default 0 = the input mesh */
    const hmf_foliation *start;  /* hmf_solve: start from this foliation; NULL = from loops. With loops as well:
                                    HMF_ERROR_OPTIONS; neither: HMF_ERROR_NULL. It belongs to this hierarchy, or to
                                    level 0 of another one of the same triangles (other levels: HMF_ERROR_LEVEL,
                                    other edges: HMF_ERROR_COUNT) */
    uint64_t step_limit;         /* NEWTON: most steps on stop_level, then HMF_LIMIT_ITERATIONS; 0 = no limit. Unlike
                                    time_limit, it gives the same result on every machine */
} hmf_solve_options;

/* Sets the defaults, see hmf_control_init.  Fields whose default depends on the method stay 0. */
HMF_API void hmf_solve_options_init(hmf_solve_options *options, uint32_t struct_size);

typedef struct hmf_level_report {
    uint64_t vertex_count;
    uint64_t edge_count;
    uint64_t raised_count;       /* edges with a raised weight, see hmf_level_info */
    uint64_t sweep_count;        /* sweeps of Whitehead moves */
    uint64_t linear_solve_count; /* linear solves on this level */
    double optimize_seconds;
    double interpolate_seconds;  /* from the next coarser level to this one */
} hmf_level_report;

typedef enum hmf_history_kind {
    HMF_HISTORY_INTERPOLATION = 0,
    HMF_HISTORY_SWEEP = 1,
    HMF_HISTORY_LINEAR_SOLVE = 2
} hmf_history_kind;

/* One entry of the history, after each interpolation, sweep or linear solve. */
typedef struct hmf_history_entry {
    double seconds;              /* since the start of the call */
    double energy;
    double residual_max;         /* negative: not evaluated */
    uint32_t level;
    uint32_t kind;               /* HMF_HISTORY_* */
} hmf_history_entry;

/* Whether a result belongs to its loops.  Its closed leaves fill cylinders (see
   hmf_cylinders).  Proven means: there is one cylinder for each loop, as high as the
   weight of the loop, and its leaves can be deformed into the loop on the surface
   without its marked vertices.  The test is exact. */
typedef enum hmf_class_state {
    HMF_CLASS_UNKNOWN = 0,       /* not tested: the call was canceled, or its start belongs to no loops */
    HMF_CLASS_PROVEN = 1,
    HMF_CLASS_LOST = 2           /* never with HMF_OK */
} hmf_class_state;

/* Report of hmf_solve and hmf_relax. */
typedef struct hmf_report {
    uint32_t struct_size;
    int32_t method;
    int32_t converged;           /* 1 if residual_max is at most the tolerance, for any method and status; otherwise
                                    0 */
    int32_t reserved;            /* 0 */
    double energy;               /* of the result, on the finest level solved; on level 0 measured on the intrinsic
                                    triangulation, before the values are carried to your edges */
    double residual_max;         /* largest residual, see hmf_residuals; negative if HMF_PROGRESS_CANCEL came first */
    double residual_mean;        /* mean over the vertices of the level; negative like residual_max */
    uint64_t poles;              /* of the result, each counted with its index; see hmf_singularities */
    uint64_t zeros;              /* of the result, each counted with its order: a zero of index -2 counts twice */
    int64_t index_sum;           /* sum of all indices: 4 - 4 * genus - M, where M is the number of marked vertices.
                                    With boundary that of the double: 8 - 8 * genus - 4 * boundaries - M, where
                                    marked vertices inside count twice */
    uint64_t bad_flips;          /* flips that needed a correction to make no pole ("case 4" of [W] 4.2.2) */
    uint64_t bad_flips_left;     /* flips that made a pole, even if a later move removed it; only HMF_METHOD_PAPER */
    double solve_seconds;
    uint64_t peak_memory_bytes;  /* of this call, without the hierarchy */
    const hmf_level_report *levels; /* level_count, finest first: levels[k] is level stop_level + k */
    uint64_t level_count;        /* number of levels used */
    const hmf_history_entry *history; /* history_count, in order of time */
    uint64_t history_count;
    int32_t class_state;         /* HMF_CLASS_* */
    uint32_t class_repeats;      /* levels that were solved again because the first result had left the class */
    double class_seconds;        /* time of the tests of the class, part of solve_seconds */
} hmf_report;

/* Returns the report of a foliation that hmf_solve or hmf_relax made, otherwise NULL.
   Valid until the foliation is destroyed. */
HMF_API const hmf_report *hmf_foliation_report(const hmf_foliation *foliation);

/*
 * Computes the harmonic foliation in the class of the loops.
 *
 *   loops      on any level, with boundary on level 0 (otherwise HMF_ERROR_LEVEL); NULL if,
 *              and only if, options->start is given
 *   out        the foliation on options->stop_level, with its report
 *
 * With options->start the class is that of the given foliation, which is carried to the
 * coarsest level and solved from there.  It may come from another hierarchy of the same
 * triangles at other positions, for example the previous frame of an animation.  On its
 * own hierarchy hmf_relax is faster if it is close to the minimum.
 *
 * Returns
 *   HMF_OK         the result has converged and is in the class.  Exceptions: Whitehead
 *                  methods without a tolerance have met energy_tolerance only (see
 *                  report->converged); a start without loops is not tested for its class
 *   HMF_LIMIT_*    with the best foliation so far, closed and without poles
 *   HMF_CANCELLED  with such a foliation after HMF_PROGRESS_FINISH, or if stop_level had
 *                  been reached; otherwise *out is NULL
 *   an error of classes 100, 200, 400, with start also 500, without a foliation.
 *                  HMF_ERROR_UNSUPPORTED: loops cross an edge more than 32 times the
 *                  largest weight, too often for a double; or a vertex (error->index)
 *                  has more than 50 000 neighbors after the flips to level 0
 * See HMF_METHOD_PAPER for the exceptions of that method.
 *
 * Level 0 is solved on its intrinsic Delaunay triangulation: edges of your mesh are
 * flipped on the unchanged surface.  The foliation stores this solution; the report,
 * hmf_energy, hmf_residuals and the calls of applications.h use it.  The values are
 * carried back to your edges.  Where that would make a pole, values near it are changed
 * to avoid it (counted in bad_flips).  The class is the same on both triangulations.
 */
HMF_API hmf_status hmf_solve(const hmf_hierarchy *hierarchy, const hmf_loop_set *loops,
                             const hmf_solve_options *options, const hmf_control *control, hmf_foliation **out,
                             hmf_error *error);

/*
 * Solves on the level of a foliation, starting from it, within its class.
 *
 *   options    start and stop_level are not used, but stop_level must be valid
 *   out        the foliation on the same level, with its report
 *
 * If the given foliation has a report that is not HMF_CLASS_PROVEN, the result is not
 * either.  If it has no report, Newton steps are tested against its own values, and
 * after Whitehead moves class_state is HMF_CLASS_UNKNOWN.  Returns as hmf_solve;
 * HMF_ERROR_VALUE_POLE for a foliation with poles.
 */
HMF_API hmf_status hmf_relax(const hmf_foliation *foliation, const hmf_solve_options *options,
                             const hmf_control *control, hmf_foliation **out, hmf_error *error);

/* Carries a foliation to another level of its hierarchy ([W] 4.2).  The result is in
   the same class, closed and without poles, exactly.  It has no report.
   Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200, or
   HMF_ERROR_VALUE_POLE. */
HMF_API hmf_status hmf_interpolate(const hmf_foliation *foliation, size_t level, const hmf_control *control,
                                   hmf_foliation **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * What a foliation is like
 * --------------------------------------------------------------------- */

/* Computes the Dirichlet energy ([W] Eq. 5), in the squared unit of the weights.  Level 0:
   on the intrinsic Delaunay triangulation, to which values of your edges are carried exactly.
   Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200. */
HMF_API hmf_status hmf_energy(const hmf_foliation *foliation, const hmf_control *control, double *energy,
                              hmf_error *error);

typedef struct hmf_residual_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t vertex_count;       /* of the level */
    const double *values;        /* vertex_count, not negative; 0 at marked vertices */
} hmf_residual_set;

/* Computes how far each vertex is from balance ([W] Eq. 4), a number without unit:
   max(0, 2 max_k P_k - P) / max(P, 0.01 * mean of all P).  P is the sum of weight * value
   over the edges at the vertex, P_k its part in sector k: the edges on one side of the
   leaves through the vertex.  Vertices joined by edges of value 0 form a cluster; sectors
   that are connected around it count as one.  If all residuals are 0, the foliation is
   the unique minimum.  On meshes with extreme triangles (needles, caps) hmf_solve may
   store a solution that is finer than the values; the residuals are those of that
   solution.  Free the result with hmf_free.
   Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200, or
   HMF_ERROR_VALUE_POLE. */
HMF_API hmf_status hmf_residuals(const hmf_foliation *foliation, const hmf_control *control, hmf_residual_set **out,
                                 hmf_error *error);

typedef enum hmf_singular_kind {
    HMF_SINGULAR_VERTEX = 1,
    HMF_SINGULAR_TRIANGLE = 2,
    HMF_SINGULAR_CLUSTER = 3     /* vertices joined by zero edges; element is its lowest vertex */
} hmf_singular_kind;

typedef struct hmf_singularity {
    int32_t kind;                /* HMF_SINGULAR_* */
    int32_t index;               /* negative: a zero of order -index; positive: a pole at a vertex that is not marked;
                                    0: a marked vertex in no zero (with one prong: a leaf ends there) */
    uint32_t element;
    uint32_t size;               /* number of vertices of a cluster, otherwise 1 */
    double position[3];          /* of the vertex, of the center of the triangle, or of the mean of the cluster; with
                                    boundary, of the vertex of the cluster nearest to the mean */
} hmf_singularity;

typedef struct hmf_singularity_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t count;
    const hmf_singularity *list; /* count: first vertices and clusters with an index, then triangles, then marked
                                    vertices that belong to no zero (index 0); each group by number */
    const int32_t *vertex_index; /* vertex_count: index of each vertex; a cluster has its index at its lowest vertex and
                                    0 at the others */
    const uint32_t *vertex_cluster; /* vertex_count: lowest vertex of its cluster; the vertex itself if it is alone */
    const int32_t *triangle_index;  /* triangle_count: 0 or -1 */
} hmf_singularity_set;

/*
 * Lists zeros, poles and marked vertices ([W] Eq. 1 and 3).  Free the result with
 * hmf_free.
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200.
 *
 * The index of a cluster is twice its Euler characteristic minus the number of its closed
 * corners, where the value of the opposite side is the sum of the values of the two sides
 * at the corner.  A marked vertex counts as one.  On a closed surface all indices add
 * up to 4 - 4 * genus - marked vertices.  With boundary the list has only the singularities
 * of the double that lie on the surface or its boundary, so the sum differs from
 * report->index_sum.
 */
HMF_API hmf_status hmf_singularities(const hmf_foliation *foliation, const hmf_control *control,
                                     hmf_singularity_set **out, hmf_error *error);

#ifdef __cplusplus
}
#endif

#endif /* HMF_HMF_H */
