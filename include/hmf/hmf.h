/*
 * hmf - harmonic measured foliations on closed triangle meshes
 *
 * A measured foliation gives every edge of a closed triangle mesh one number
 * F >= 0, the distance that its end points have in a metric tree.  The
 * harmonic one in its class minimises the Dirichlet energy
 *
 *     D(F) = sum over edges of  weight(edge) * F(edge)^2.
 *
 * The class is given by disjoint closed curves with positive weights.  From F
 * follow conformal parameterisations, quad meshes and stripe patterns.
 *
 * In five calls:
 *
 *     hmf_build   positions + triangles   -> hierarchy (immutable, reusable)
 *     hmf_loops   hierarchy               -> loops, flat arrays
 *     hmf_solve   hierarchy, loops        -> one value per edge
 *     hmf_singularities                   -> zeros (and poles: there are none)
 *     hmf_destroy
 *
 * Rules that hold for every function here
 *
 *   errors    Fallible functions return hmf_status, 0 is success.  The last
 *             argument is an optional hmf_error that the caller owns; it gets
 *             the element and a sentence with the remedy.  On failure nothing
 *             is written to any output, but for a handle, which becomes NULL,
 *             and where a function says otherwise.
 *   arrays    The caller allocates.  Where the size is not known beforehand,
 *             call once with a NULL array to get the count, then again with
 *             its capacity in elements.  Too small: HMF_ERROR_CAPACITY.
 *   types     uint32_t indices from 0, size_t counts, double reals.
 *   threads   A hierarchy is immutable: any number of threads may use it.
 *             There is no global state.
 *   memory    All through the allocator of the build options, which must
 *             then be thread-safe if the hierarchy is shared.  Everything
 *             that a call allocates is returned before it ends; a hierarchy
 *             keeps its memory until hmf_destroy.
 *   options   Structures of options begin with struct_size.  Fill them with
 *             the init function; zero in a field means its default.
 *   levels    Level 0 is the caller's mesh, higher levels are coarser.
 *             Edges of level 0 are numbered by their first appearance in
 *             the triangle array (sides 0-1, 1-2, 2-0 of triangle 0, then of
 *             triangle 1, and so on); vertices and triangles keep the
 *             caller's numbers.
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

/* Result of every fallible call.  Values never change; new ones are added. */
typedef int32_t hmf_status;

/* success */
#define HMF_OK 0

/* stopped early: results are valid, closed and without poles, but not yet
   harmonic to the tolerance (hmf_solve and hmf_relax still write them) */
#define HMF_LIMIT_ITERATIONS 10
#define HMF_LIMIT_TIME 11
#define HMF_LIMIT_STALLED 12
#define HMF_CANCELLED 13

/* the call itself */
#define HMF_ERROR_NULL 100       /* a pointer that must not be NULL is */
#define HMF_ERROR_OPTIONS 101    /* an option is out of range or from a newer header */
#define HMF_ERROR_CAPACITY 102   /* an output array is too small */
#define HMF_ERROR_LEVEL 103      /* no such level */
#define HMF_ERROR_UNSUPPORTED 104 /* not available in this version */

/* resources */
#define HMF_ERROR_MEMORY 200     /* the allocator returned NULL */
#define HMF_ERROR_MEMORY_LIMIT 201 /* the memory limit of the options was reached */

/* the mesh */
#define HMF_ERROR_MESH_COUNTS 300 /* no vertices or triangles, or more than 2^31 / 3 */
#define HMF_ERROR_MESH_INDEX 301 /* a triangle names a vertex that does not exist */
#define HMF_ERROR_MESH_NOT_FINITE 302 /* a coordinate is infinite or not a number */
#define HMF_ERROR_MESH_REPEATED_VERTEX 303 /* a triangle names one vertex twice */
#define HMF_ERROR_MESH_DEGENERATE 304 /* a triangle without area (see mollify in hmf_build_options) */
#define HMF_ERROR_MESH_BOUNDARY 305 /* an edge with one triangle */
#define HMF_ERROR_MESH_NON_MANIFOLD_EDGE 306 /* an edge with three or more triangles */
#define HMF_ERROR_MESH_ORIENTATION 307 /* neighbouring triangles turn in opposite senses */
#define HMF_ERROR_MESH_NON_MANIFOLD_VERTEX 308 /* a vertex with several fans of triangles */
#define HMF_ERROR_MESH_UNUSED_VERTEX 309 /* a vertex without a triangle */
#define HMF_ERROR_MESH_COMPONENTS 310 /* more than one connected component */
#define HMF_ERROR_MESH_GENUS 311 /* genus 0 with fewer than four marked vertices: no measured foliation */
#define HMF_ERROR_MESH_NOT_EMBEDDED 312 /* the surface meets itself, so that inside and outside have no meaning */

/* loops and weights */
#define HMF_ERROR_LOOP_COUNT 400 /* no loops */
#define HMF_ERROR_LOOP_INDEX 401 /* an element that does not exist on the level */
#define HMF_ERROR_LOOP_NOT_CLOSED 402 /* consecutive elements are not neighbours */
#define HMF_ERROR_LOOP_NOT_SIMPLE 403 /* a loop meets itself */
#define HMF_ERROR_LOOP_CROSSING 404 /* two loops cross */
#define HMF_ERROR_LOOP_TRIVIAL 405 /* a loop bounds a disk */
#define HMF_ERROR_LOOP_PARALLEL 406 /* two loops are freely homotopic */
#define HMF_ERROR_LOOP_WEIGHT 407 /* a weight is not finite, not positive, or the weights span more than 2^20 */

/* values */
#define HMF_ERROR_VALUE_NOT_FINITE 500 /* a value is negative, infinite or not a number */
#define HMF_ERROR_VALUE_NOT_CLOSED 501 /* a triangle inequality is violated, or a value is not a multiple of the unit */
#define HMF_ERROR_VALUE_POLE 502 /* the values have a pole */
#define HMF_ERROR_VALUE_NOT_HARMONIC 503 /* the values are too far from the minimum */
#define HMF_ERROR_VALUE_CLASS 504 /* the values do not belong to the given loops, or to no loops that can be followed */

/* a defect of the library itself */
#define HMF_ERROR_INTERNAL 900

/* No element, where an index is expected. */
#define HMF_NONE 0xffffffffu

/* What an error is about. */
#define HMF_ELEMENT_NONE 0
#define HMF_ELEMENT_VERTEX 1
#define HMF_ELEMENT_EDGE 2
#define HMF_ELEMENT_TRIANGLE 3
#define HMF_ELEMENT_LOOP 4
#define HMF_ELEMENT_LEVEL 5
#define HMF_ELEMENT_OPTION 6

/* Filled by a failing call; untouched by a successful one. */
typedef struct hmf_error {
    hmf_status status;
    int32_t element;       /* HMF_ELEMENT_* */
    uint64_t index;        /* of the element */
    char message[240];     /* what is wrong and what to do; ends with 0 */
} hmf_error;

/* Run-time version as major * 10000 + minor * 100 + patch. */
HMF_API uint32_t hmf_version(void);

/* A short English text for any value; never NULL, never to be freed. */
HMF_API const char *hmf_status_string(hmf_status status);

/* ------------------------------------------------------------------------
 * Callbacks
 * --------------------------------------------------------------------- */

/* Returns a block aligned for any type, or NULL.  user: allocator_user. */
typedef void *(*hmf_allocate_fn)(void *user, size_t size);

/* Takes back a block; size is the size that was asked for. */
typedef void (*hmf_release_fn)(void *user, void *block, size_t size);

/* Called on the calling thread; fraction rises from 0 to 1.  Returns one of
   the values below.  The callback must not call hmf with the same objects. */
#define HMF_PROGRESS_CONTINUE 0
/* Any other value: return HMF_CANCELLED at once, within 50 ms on a mesh of a
   million edges. */
#define HMF_PROGRESS_CANCEL 1
/* hmf_solve, hmf_relax: stop improving, carry the foliation to the asked
   level, write it and return HMF_CANCELLED.  Elsewhere as CANCEL. */
#define HMF_PROGRESS_FINISH 2
typedef int32_t (*hmf_progress_fn)(void *user, double fraction);

/* ------------------------------------------------------------------------
 * Build
 * --------------------------------------------------------------------- */

#define HMF_COLLAPSE_DEFAULT 0
#define HMF_COLLAPSE_MIDPOINT 1  /* shortest edge, to its midpoint (default) */
#define HMF_COLLAPSE_ENDPOINT 2  /* shortest edge, to one end */
#define HMF_COLLAPSE_QSLIM 3     /* least quadric error, to its best point */

typedef struct hmf_build_options {
    uint32_t struct_size;
    int32_t collapse;            /* HMF_COLLAPSE_* */
    double ratio;                /* edges of a level / edges of the finer one; in [0.05, 0.95], default 0.5 */
    uint64_t coarsest;           /* vertices of the coarsest level to aim for; default 1000, at least 40 * genus +
                                    10 * marked_count */
    uint64_t memory_limit;       /* bytes in use at any time, 0 = none; also bounds each later call on the hierarchy */
    hmf_allocate_fn allocate;    /* NULL = malloc; give both or none */
    hmf_release_fn release;
    void *allocator_user;
    hmf_progress_fn progress;    /* NULL = none */
    void *progress_user;
    double mollify;              /* in [0, 0.1], 0 = off: accept triangles without area and edges without length; the
                                    edges of level 0 get longer by the least amount, the same for all, with which every
                                    triangle inequality holds by a margin of mollify * mean length (try 1e-5).  Only the
                                    weights of level 0 change; meshes that keep the margin anyway stay as they are */
    const uint32_t *marked_vertices; /* vertices that may carry a pole; a sphere needs four or more.  They never move
                                    and are no poles of the report; indices add up to 4 - 4 * genus - marked_count */
    uint64_t marked_count;
} hmf_build_options;

/* An immutable hierarchy of triangle meshes. */
typedef struct hmf_hierarchy hmf_hierarchy;

/* Fills in the defaults.  NULL is allowed and does nothing. */
HMF_API void hmf_build_options_init(hmf_build_options *options);

/*
 * Validates a closed, connected, oriented manifold mesh of genus 1 or more, or
 * of genus 0 with four or more marked vertices,
 * makes it intrinsically Delaunay and builds the hierarchy ([W] 4.1).
 *
 *   positions        vertex_count x 3, any unit; vertex i starts
 *                    i * position_stride bytes from the first
 *   position_stride  bytes, 0 = packed (24); at least 24 and a multiple of 8
 *   triangles        triangle_count x 3 vertex indices, counter-clockwise
 *                    or all clockwise
 *   options          NULL = defaults
 *   out              the hierarchy, NULL on failure
 *
 * Inputs are copied.  Time is linear, about 0.3 s per million edges.
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200, 300.
 */
HMF_API hmf_status hmf_build(const double *positions, size_t vertex_count, size_t position_stride,
                             const uint32_t *triangles, size_t triangle_count,
                             const hmf_build_options *options, hmf_hierarchy **out, hmf_error *error);

/*
 * Marked vertices for a mesh of genus 0 whose owner names none: two at the tip of
 * each limb, so that loops go round the limbs, at least four and at most 24.
 * None for genus 1 and more.  The same input gives the same marks.
 *
 *   marks, capacity  room for the vertices (24 are always enough), or NULL
 *   count            set on success
 *
 * Of the options, mollify, the memory and the progress function count.
 * Errors: as hmf_build.
 */
HMF_API hmf_status hmf_suggest_marks(const double *positions, size_t vertex_count, size_t position_stride,
                                     const uint32_t *triangles, size_t triangle_count,
                                     const hmf_build_options *options, uint32_t *marks, size_t capacity,
                                     size_t *count, hmf_error *error);

/* Frees a hierarchy; NULL is allowed. */
HMF_API void hmf_destroy(hmf_hierarchy *hierarchy);

/* Upper bound of the bytes that hmf_build will use at its peak with the given
   options (NULL = defaults); 0 if the counts are unusable. */
HMF_API uint64_t hmf_memory_estimate(size_t vertex_count, size_t triangle_count, const hmf_build_options *options);

/* Bytes held by the hierarchy; 0 for NULL. */
HMF_API uint64_t hmf_hierarchy_memory(const hmf_hierarchy *hierarchy);

/* ------------------------------------------------------------------------
 * Levels
 * --------------------------------------------------------------------- */

typedef struct hmf_level_info {
    uint64_t vertex_count;
    uint64_t edge_count;
    uint64_t triangle_count;
    uint64_t non_delaunay_count; /* edges whose weight was below the floor and was raised to it; 0 on level 0, the
                                    intrinsic Delaunay triangulation */
} hmf_level_info;

/* Number of levels, at least 1; 0 for NULL. */
HMF_API size_t hmf_level_count(const hmf_hierarchy *hierarchy);

/* Genus of the surface; 0 for NULL. */
HMF_API size_t hmf_genus(const hmf_hierarchy *hierarchy);

/* Counts of one level.  Errors: NULL, LEVEL. */
HMF_API hmf_status hmf_level_counts(const hmf_hierarchy *hierarchy, size_t level, hmf_level_info *out, hmf_error
                                    *error);

/* edge_vertices: edge_count x 2 vertices of each edge.  capacity counts
   uint32_t.  On coarse levels two vertices may have several edges. */
HMF_API hmf_status hmf_level_edge_vertices(const hmf_hierarchy *hierarchy, size_t level,
                                           uint32_t *edge_vertices, size_t capacity, hmf_error *error);

/* triangle_edges: triangle_count x 3; side s of a triangle joins its corners s and s+1. */
HMF_API hmf_status hmf_level_triangle_edges(const hmf_hierarchy *hierarchy, size_t level,
                                            uint32_t *triangle_edges, size_t capacity, hmf_error *error);

/* triangle_vertices: triangle_count x 3, corners in the order of the sides above. */
HMF_API hmf_status hmf_level_triangle_vertices(const hmf_hierarchy *hierarchy, size_t level,
                                               uint32_t *triangle_vertices, size_t capacity, hmf_error *error);

/* weights: edge_count, half the sum of the two opposite cotangents, without
   unit.  Level 0: of the caller's triangulation, may be negative there (the
   solver uses the intrinsic Delaunay triangulation instead). */
HMF_API hmf_status hmf_level_weights(const hmf_hierarchy *hierarchy, size_t level,
                                     double *weights, size_t capacity, hmf_error *error);

/* positions: vertex_count x 3, in the unit of the input. */
HMF_API hmf_status hmf_level_positions(const hmf_hierarchy *hierarchy, size_t level,
                                       double *positions, size_t capacity, hmf_error *error);

/* ------------------------------------------------------------------------
 * Loops
 * --------------------------------------------------------------------- */

/* What the elements of a loop are. */
#define HMF_LOOP_TRIANGLES 1     /* consecutive triangles share an edge; the last and the first as well */
#define HMF_LOOP_VERTICES 2      /* consecutive vertices share an edge; the last and the first as well */

/* Which loops to make. */
#define HMF_LOOPS_CUT 1          /* genus many, together they cut the surface into one planar piece; genus 0: round
                                    pairs of marked vertices */
#define HMF_LOOPS_HANDLE 2       /* a cut system whose loops bound inside the surface: they go round the handles */
#define HMF_LOOPS_TUNNEL 3       /* a cut system whose loops bound outside: they go round the holes */
#define HMF_LOOPS_PANTS 4        /* 3 genus - 3 + marked vertices (genus 1 without those: one), together they cut the
                                    surface into pairs of pants */

/* A set of closed curves on a level, as flat arrays. */
typedef struct hmf_loop_set {
    uint32_t struct_size;
    int32_t element_kind;        /* HMF_LOOP_TRIANGLES or HMF_LOOP_VERTICES */
    uint64_t level;              /* of the elements; loops of fine levels are restricted exactly */
    uint64_t count;
    const uint64_t *offsets;     /* count + 1; loop c is elements[offsets[c]] .. elements[offsets[c+1]-1] */
    const uint32_t *elements;    /* offsets[count] */
    const double *weights;       /* count, > 0; NULL = all 1 */
} hmf_loop_set;

/*
 * Loops made by the library on a level, as triangle loops: simple, disjoint,
 * essential, pairwise not freely homotopic, and short.  They are found on the
 * coarsest level and carried to the finer ones, shortened on each, so that
 * loop c is in the same class on every level.
 *
 *   kind           HMF_LOOPS_*.  HANDLE and TUNNEL are decided by linking
 *                  numbers in space on level 0, exactly, with positions
 *                  rounded to 1e-10 of the size of the object: each loop is
 *                  null-homologous inside, or outside.  Inside is where
 *                  the surface encloses volume, whichever way the triangles
 *                  turn.  A surface that meets itself may have no such loops:
 *                  HMF_ERROR_MESH_NOT_EMBEDDED.
 *   loop_count, element_count   set in every call that succeeds
 *   offsets        loop_count + 1 values, or NULL
 *   elements       element_count triangle indices of the level, or NULL
 *
 * With both arrays NULL it only counts.  Deterministic.
 */
HMF_API hmf_status hmf_loops(const hmf_hierarchy *hierarchy, size_t level, int32_t kind,
                             uint64_t *offsets, size_t offset_capacity,
                             uint32_t *elements, size_t element_capacity,
                             size_t *loop_count, size_t *element_count, hmf_error *error);

/*
 * Closed initial foliation of the loops on their level ([W] 3.3): the sum of
 * the weights of the loops that cross an edge.
 *
 *   values     edge_count of the level, in the unit of the weights
 *
 * Checks that every loop is closed, simple and essential, that they are
 * disjoint and pairwise not freely homotopic (class 400; error->index is the
 * loop).  Loops may touch themselves and each other, in elements and along
 * stretches, as long as they can be pushed apart there; they may go back and
 * forth.  They are pulled tight first: no edge is crossed twice by what can be
 * pulled off it, so that there are no poles.
 */
HMF_API hmf_status hmf_initialize(const hmf_hierarchy *hierarchy, const hmf_loop_set *loops,
                                  double *values, size_t capacity, hmf_error *error);

/* ------------------------------------------------------------------------
 * Solve
 * --------------------------------------------------------------------- */

#define HMF_METHOD_DEFAULT 0
#define HMF_METHOD_NEWTON 1       /* Newton steps on the twisted Laplacian, cascadic */
#define HMF_METHOD_WHITEHEAD 2    /* Whitehead moves, cascadic ([W] section 4) */
#define HMF_METHOD_SINGLE_LEVEL 3 /* Whitehead moves on the input mesh ([W] 3.3) */

typedef struct hmf_solve_options {
    uint32_t struct_size;
    int32_t method;              /* HMF_METHOD_*; default: the most exact of this version */
    double tolerance;            /* newton: residual_max, default 1e-8; others: relative change of the energy per
                                    sweep, default 1e-6 */
    double time_limit;           /* seconds, 0 = none */
    uint64_t iteration_limit;    /* sweeps per level, default 100000 */
    uint64_t stop_level;         /* finest level to solve, default 0 = the input mesh */
    hmf_progress_fn progress;    /* NULL = none */
    void *progress_user;
    const double *initial_values; /* hmf_solve: a foliation to start from instead of loops, which are then NULL; NULL
                                     = none */
    uint64_t initial_count;      /* number of initial values: edges of their level */
    uint64_t initial_level;      /* of the initial values, default 0 = the input mesh */
} hmf_solve_options;

typedef struct hmf_level_report {
    uint64_t vertices;
    uint64_t edges;
    uint64_t nld;                /* edges with a raised weight */
    uint64_t iterations;         /* sweeps of Whitehead moves */
    uint64_t linear_solves;      /* a solve that goes on with some unknowns held is one */
    double optimize_seconds;
    double interpolate_seconds;  /* from the next coarser level to this one */
} hmf_level_report;

/* One line of the history: after each sweep or linear solve. */
typedef struct hmf_history_entry {
    double seconds;              /* since the start of the call */
    double energy;
    double residual_max;         /* negative: not evaluated */
    uint32_t level;
    uint32_t kind;               /* 0 interpolation, 1 sweep, 2 linear solve */
} hmf_history_entry;

/* Filled by hmf_solve and hmf_relax.  The caller sets struct_size and, where
   wanted, the two arrays with their capacities. */
typedef struct hmf_report {
    uint32_t struct_size;
    int32_t method;
    int32_t converged;           /* 1 or 0 */
    int32_t values_written;      /* 1 or 0: the foliation was written to values */
    double energy;               /* of the result, on the finest level solved; level 0: on the intrinsic
                                    triangulation, before
                                    the values are carried to the caller's edges */
    double residual_max;         /* relative coclosedness residual, see hmf_residuals; negative: not evaluated, as the
                                    callback said HMF_PROGRESS_CANCEL before */
    double residual_mean;
    uint64_t poles;              /* of the result, each as often as its index says; see hmf_singularities */
    uint64_t zeros;              /* likewise: a zero of index -2 counts twice */
    int64_t index_sum;           /* 4 - 4 * genus - marked vertices */
    uint64_t bad_flips;          /* flips of "case 4" of [W] 4.2.2 that would have made a pole */
    uint64_t bad_flips_left;     /* and did */
    double solve_seconds;
    uint64_t peak_memory_bytes;  /* of this call, without the hierarchy */
    hmf_level_report *levels;    /* finest first, or NULL */
    uint64_t level_capacity;
    uint64_t level_count;        /* number of levels used; min(level_count, level_capacity) are written */
    hmf_history_entry *history;  /* in order of time, or NULL */
    uint64_t history_capacity;
    uint64_t history_count;      /* number of events; min(history_count, history_capacity) are written */
} hmf_report;

/* Fills in the defaults.  NULL is allowed and does nothing. */
HMF_API void hmf_solve_options_init(hmf_solve_options *options);

/*
 * The harmonic foliation in the class of the loops.
 *
 *   loops      on any level; NULL = those of hmf_loops on the coarsest level
 *              (level 0 with single_level), weights 1
 *   options    NULL = defaults
 *   values     edge_count of the level options->stop_level (default 0: the
 *              caller's edges), in the unit of the weights; exact multiples
 *              of a power of two, every triangle inequality holds exactly
 *   report     NULL = not wanted
 *
 * With options->initial_values the class is that of the values: a result for
 * the same triangles, perhaps at other positions (the last frame of an
 * animation), made by the library.  They are validated as in hmf_relax (class
 * 500), restricted to the coarsest level, and solved from there.  Where they
 * are close to the minimum, hmf_relax is faster, which starts on their level.
 *
 * The report describes the foliation where it is solved; on level 0 that is the
 * intrinsic triangulation.  On the caller's edges a vertex whose neighbours
 * then lie all in one direction would be a pole and is moved to the next branch
 * (counted in bad_flips).  If there was none, hmf_energy and hmf_residuals of the
 * values give the numbers of the report, the residuals up to rounding; else they
 * tell what the moves cost.  The class and its minimum are the same in any case: hmf_relax
 * finds it again.
 *
 * Returns HMF_OK; HMF_LIMIT_* with the best foliation so far in values, closed
 * and without poles; HMF_CANCELLED, with values in the same way if the callback
 * said HMF_PROGRESS_FINISH, or if the asked level had been reached and the
 * values were at hand (then report->values_written is 1), else with nothing
 * written; or an error of classes 100, 200, 400.  HMF_ERROR_UNSUPPORTED: an edge
 * is crossed so often (by more than 32 of the largest weights) that a double
 * cannot hold its value exactly.
 */
HMF_API hmf_status hmf_solve(const hmf_hierarchy *hierarchy, const hmf_loop_set *loops,
                             const hmf_solve_options *options, double *values, size_t capacity,
                             hmf_report *report, hmf_error *error);

/* Optimises given values on one level, in place; otherwise as hmf_solve.
   The values must be closed and without poles (class 500): results of the
   library, also written with 17 digits and read again, or multiplied by a
   power of two.  Other numbers cannot be rounded edge by edge, for that breaks
   triangle inequalities that hold with equality; start from loops instead. */
HMF_API hmf_status hmf_relax(const hmf_hierarchy *hierarchy, size_t level, const hmf_solve_options *options,
                             double *values, size_t count, hmf_report *report, hmf_error *error);

/* Carries values from any level to any other: to finer ones by flip and split
   reversal ([W] 4.2), to coarser ones by restriction, where a collapse moves
   one vertex to the image of the other.  Exact: closed and without poles
   before and after, in the same class. */
HMF_API hmf_status hmf_interpolate(const hmf_hierarchy *hierarchy, size_t from_level, const double *values, size_t
                                   count,
                                   size_t to_level, double *out_values, size_t out_capacity, hmf_error *error);

/* ------------------------------------------------------------------------
 * What a foliation is like
 * --------------------------------------------------------------------- */

/* Dirichlet energy of values on a level, [W] Eq. 5 (level 0: on the intrinsic
   Delaunay triangulation, to which closed values are carried exactly). */
HMF_API hmf_status hmf_energy(const hmf_hierarchy *hierarchy, size_t level, const double *values, size_t count,
                              double *energy, hmf_error *error);

/* residuals: vertex_count of the level.  Violation of [W] Eq. 4 at each vertex,
   max(0, 2 max_k P_k - P) / max(P, 0.01 mean P), where P_k is the sum of
   weight * F over sector k and P over all edges; sectors that are one
   direction around a cluster of zero edges count as one.  0 everywhere means:
   this is the unique minimum. */
HMF_API hmf_status hmf_residuals(const hmf_hierarchy *hierarchy, size_t level, const double *values, size_t count,
                                 double *residuals, size_t capacity, hmf_error *error);

#define HMF_SINGULAR_VERTEX 1
#define HMF_SINGULAR_TRIANGLE 2
#define HMF_SINGULAR_CLUSTER 3   /* vertices joined by zero edges; element is its lowest vertex */

typedef struct hmf_singularity {
    int32_t kind;                /* HMF_SINGULAR_* */
    int32_t index;               /* < 0 a zero of order -index, > 0 a pole, 0 a marked vertex that is no zero */
    uint32_t element;
    uint32_t size;               /* vertices of a cluster, else 1 */
} hmf_singularity;

/*
 * Zeros and poles of values on a level ([W] Eq. 1 and 3; a cluster has
 * twice its Euler characteristic minus the number of its closed corners).
 *
 *   vertex_index    vertex_count, or NULL: index of each vertex; for the
 *                   vertices of a cluster the index of the cluster at its
 *                   lowest vertex and 0 at the others
 *   triangle_index  triangle_count, or NULL: 0 or -1
 *   vertex_cluster  vertex_count, or NULL: lowest vertex of the cluster
 *   list            zeros and poles, and behind them the marked vertices that
 *                   are none, or NULL; capacity list_capacity
 *   list_count      set on success
 *
 * The indices add up to 4 - 4 * genus - marked vertices.
 */
HMF_API hmf_status hmf_singularities(const hmf_hierarchy *hierarchy, size_t level, const double *values, size_t count,
                                     int32_t *vertex_index, size_t vertex_capacity,
                                     int32_t *triangle_index, size_t triangle_capacity,
                                     uint32_t *vertex_cluster, size_t cluster_capacity,
                                     hmf_singularity *list, size_t list_capacity, size_t *list_count, hmf_error *error);

/* ------------------------------------------------------------------------
 * Parameterisation
 * --------------------------------------------------------------------- */

typedef struct hmf_parameterize_options {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    double tolerance;            /* largest residual_max of the values, default 1e-2 */
    const uint32_t *seam_edges;  /* edges where seams cost nothing, so that they run there if they can; NULL = none */
    uint64_t seam_edge_count;
    hmf_progress_fn progress;    /* NULL = none */
    void *progress_user;
} hmf_parameterize_options;

/*
 * A global conformal parameterisation.  The caller sets struct_size, the three
 * capacities and, where wanted, the arrays; the call fills the rest.
 */
typedef struct hmf_parameterization {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t vertex_capacity;    /* elements that the arrays below have room for: at least the counts of the level */
    uint64_t edge_capacity;
    uint64_t triangle_capacity;
    double *corner_uv;           /* triangle_count x 3 x 2: (u, v) of each corner, or NULL */
    double *transition;          /* edge_count x 3: sign, du, dv, or NULL; see below */
    uint8_t *seam;               /* edge_count: 1 where the layout is cut, or NULL */
    int32_t *cone;               /* vertex_count: cone angle as a multiple of pi, 2 = regular, or NULL */
    double *dilatation;          /* triangle_count: ratio of the singular values of the map, >= 1, negative where the
                                    image is flipped, infinite where it is degenerate (above 1000), or NULL */
    double *differential;        /* triangle_count x 2: quadratic differential, real and imaginary part, or NULL */
    double dilatation_mean;      /* of its absolute value, weighted by area, without degenerate triangles */
    double dilatation_median;    /* quantiles by area, of all triangles */
    double dilatation_p99;
    uint64_t flipped_triangles;
    uint64_t degenerate_triangles; /* dilatation above 1000, or an image too small to tell */
    uint64_t seam_edge_count;
    double seam_length;          /* in the unit of the positions */
    double area;                 /* of the image: the energy, up to discretisation */
    uint64_t linear_iterations;
    double seconds;
} hmf_parameterization;

/* Fills in the defaults.  NULL is allowed and does nothing. */
HMF_API void hmf_parameterize_options_init(hmf_parameterize_options *options);

/*
 * The global conformal parameterisation of a harmonic foliation ([W] section 5):
 * |du| is the foliation, v its harmonic conjugate.  The surface is cut along
 * short seams through the zeros; in the cut surface every corner has one (u, v).
 *
 *   level, values, count   as for hmf_energy; values must be harmonic up to
 *                          options->tolerance
 *   options                NULL = defaults
 *   out                    see above
 *
 * Transition of an edge: with (u, v) of a point of the edge in the first of its
 * two triangles (the one with the lower number), the second one has
 *
 *     (u', v') = sign * (u, v) + (du, dv),      sign = +1 or -1,
 *
 * exactly: all are multiples of one power of two below 2^53 of it.  Edges off
 * the seams have (1, 0, 0).  The linear parts are +-1, so (du + i dv)^2 has no
 * seams: it is the holomorphic quadratic differential, given per triangle as the
 * square of d(u + i v) / dz with z = x + i y in the frame of the triangle: x
 * along its side 0, y to the left of it.
 *
 * Zeros in triangles move to a corner: cone angles are (2 + order) * pi, at
 * vertices, and the sum of (2 - cone) is 4 - 4 * genus.  At a marked vertex the
 * cone angle is pi; where a zero lies in its star, a neighbour may have the pole
 * instead.  Near the zeros u differs
 * from the foliation by that much.  Where the foliation is 0 (limbs that no loop
 * goes round) triangles are degenerate.
 *
 * Returns HMF_OK, HMF_CANCELLED, HMF_ERROR_VALUE_NOT_HARMONIC,
 * HMF_ERROR_UNSUPPORTED if the mesh is so coarse that two zeros need the same
 * vertex, or an error of classes 100, 200, 500.
 */
HMF_API hmf_status hmf_parameterize(const hmf_hierarchy *hierarchy, size_t level, const double *values, size_t count,
                                    const hmf_parameterize_options *options, hmf_parameterization *out, hmf_error
                                    *error);

/* ------------------------------------------------------------------------
 * Leaves, cylinders, quads
 * --------------------------------------------------------------------- */

#define HMF_LINE_LEVEL 1         /* a closed leaf at a given height of its cylinder */
#define HMF_LINE_CRITICAL 2      /* a leaf between two zeros */
#define HMF_LINE_POINT 3         /* the leaf through a given point */

#define HMF_END_CLOSED 0         /* none: the last point joins the first */
#define HMF_END_ZERO 1           /* at a zero */
#define HMF_END_LIMIT 2          /* at the length limit */
#define HMF_END_NOWHERE 3        /* the given point lies where the foliation is 0: a line without points */
#define HMF_END_CRITICAL 4       /* of a conjugate line: on a critical leaf, where its cylinder ends */

#define HMF_LEAVES_DEFAULT 0
#define HMF_LEAVES_FOLIATION 1   /* of the foliation itself (default): u is constant */
#define HMF_LEAVES_CONJUGATE 2   /* of its conjugate: v is constant; see hmf_parameterize */

typedef struct hmf_trace_options {
    uint32_t struct_size;
    int32_t critical;            /* not 0: all leaves out of zeros */
    double spacing;              /* > 0: level sets, about so far apart, in the unit of the values; 0 = none */
    double length_limit;         /* where a leaf stops, in each direction from where it starts, in the unit of the
                                    positions; 0: none,
                                    for conjugate leaves ten times the root of the area of the surface */
    uint64_t point_count;        /* leaves through points; 0 = none */
    const uint32_t *point_triangles;      /* point_count */
    const double *point_barycentrics;     /* point_count x 3, for the corners of the triangle; not negative, sum 1 */
    int32_t leaves;              /* HMF_LEAVES_* */
    uint32_t reserved;           /* 0 */
} hmf_trace_options;

typedef struct hmf_line {
    int32_t kind;                /* HMF_LINE_* */
    int32_t closed;              /* 1: the last point joins the first, which is not repeated; 0 */
    int32_t begin, end;          /* HMF_END_* */
    uint32_t begin_zero, end_zero; /* which zero, in the list of hmf_singularities; else HMF_NONE */
    uint32_t cylinder;           /* in the list of hmf_cylinders; HMF_NONE for critical leaves */
    uint32_t source;             /* number of the point; of the level from the lower side of its cylinder; of the
                                    critical leaf */
    double height;               /* above the lower side of the cylinder, in the unit of the values; 0 for critical
                                    leaves */
    double length;               /* in the unit of the positions */
} hmf_line;

/* Fills in the defaults.  NULL is allowed and does nothing. */
HMF_API void hmf_trace_options_init(hmf_trace_options *options);

/*
 * Leaves of values on a level as polylines.
 *
 *   options       which leaves; NULL or all 0: the critical ones
 *   lines         line_capacity, or NULL: first the level sets, cylinder by
 *                 cylinder, then the critical leaves, then those through points
 *   offsets       line_capacity + 1, or NULL; line k has the points from
 *                 offsets[k] to offsets[k+1] - 1
 *   points        point_capacity x 3 coordinates, or NULL
 *   point_edges   point_capacity edges of the level that the points lie on, or
 *                 NULL; HMF_NONE for the middle of a zero in a triangle
 *   line_count, point_count   set on success
 *
 * Consecutive points lie in one triangle.  Leaves are followed in exact
 * integers: no two cross, each closes exactly, and only critical leaves end, at
 * zeros.  A cylinder gets round(height / spacing) level sets, at least one,
 * evenly spaced with half a space at either side: so they match across critical
 * leaves.  The leaf through a point is less than 2^-48 of the largest value away
 * from it; the middle of a triangle with a zero goes to the nearest leaf.
 * Genus 1 has no critical leaves.
 *
 * Conjugate leaves do not close in general.  Level sets are then lines across
 * each cylinder from one side to the other, round(circumference / spacing) of
 * them; together with those of the foliation they form a grid.  Leaves out of
 * zeros end at another zero or at the length limit, those through points close or
 * end at the limit.  begin_zero, end_zero, height and, but for level sets,
 * cylinder are not set.
 *
 * Values need not be harmonic, but for conjugate leaves, as for hmf_cylinders.
 * Errors: classes 100, 200, 500; of a bad point error->index is its number
 * (HMF_ERROR_OPTIONS).
 */
HMF_API hmf_status hmf_trace(const hmf_hierarchy *hierarchy, size_t level, const double *values, size_t count,
                             const hmf_trace_options *options, hmf_line *lines, size_t line_capacity,
                             uint64_t *offsets, size_t offset_capacity,
                             double *points, uint32_t *point_edges, size_t point_capacity,
                             size_t *line_count, size_t *point_count, hmf_error *error);

typedef struct hmf_cylinder {
    uint32_t loop;               /* its loop; HMF_NONE if no loops were given */
    uint32_t reserved;           /* 0 */
    double height;               /* the weight of the loop, exactly */
    double circumference;        /* of the flat metric du^2 + dv^2, in the unit of the values */
    double modulus;              /* height / circumference */
    double area;                 /* in the flat metric; areas add up to the energy */
} hmf_cylinder;

/*
 * The cylinders of a harmonic foliation: the critical leaves cut the surface
 * into one for each loop, filled with closed leaves of its class.
 *
 *   loops             those that the values belong to, on any level, or NULL:
 *                     not wanted.  NULL does not stand for hmf_loops here
 *   list              capacity, or NULL; the order is that of hmf_line.cylinder
 *   leaf_offsets      offset_capacity >= cylinder count + 1, or NULL
 *   leaf_triangles    triangle_capacity, or NULL: the leaf in the middle of each
 *                     cylinder as a triangle loop of the level, as in hmf_loop_set
 *   cylinder_count, triangle_count   set on success
 *
 * Heights are exact.  Circumference, modulus and area are those of the minimum;
 * at the minimum energy = sum of height * circumference = sum of areas.
 * Loop and cylinder are matched by their classes: that takes two runs like
 * hmf_solve on the coarsest level.
 *
 * Errors: classes 100, 200, 400; HMF_ERROR_VALUE_CLASS if the values do not
 * belong to the loops, HMF_ERROR_VALUE_NOT_HARMONIC if their energy is 1 % above
 * the minimum, and others of class 500.
 */
HMF_API hmf_status hmf_cylinders(const hmf_hierarchy *hierarchy, size_t level, const double *values, size_t count,
                                 const hmf_loop_set *loops, hmf_cylinder *list, size_t capacity,
                                 uint64_t *leaf_offsets, size_t offset_capacity,
                                 uint32_t *leaf_triangles, size_t triangle_capacity,
                                 size_t *cylinder_count, size_t *triangle_count, hmf_error *error);

typedef struct hmf_quad_options {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    double edge_length;          /* wished mean length of an edge, in the unit of the positions; default: about as
                                    many quads as triangles / 2 */
} hmf_quad_options;

/* Fills in the defaults.  NULL is allowed and does nothing. */
HMF_API void hmf_quad_options_init(hmf_quad_options *options);

/*
 * A closed quad mesh along the leaves: a grid on each cylinder, glued along the
 * critical leaves.
 *
 *   options     NULL = defaults
 *   positions   position_capacity x 3, or NULL; points of the surface
 *   quads       quad_capacity x 4 vertices, or NULL; oriented as the triangles
 *   vertex_count, quad_count   set on success
 *
 * The first vertices are the zeros, in the order of hmf_singularities; a zero of
 * order m has 2 m + 4 edges, every other vertex has 4; at each marked vertex with
 * one prong lies a quad over the tip, with two corners of 3 edges instead.  Zeros that only
 * discretisation keeps apart can become one, with the sum of their orders.  Closed, oriented and
 * manifold by construction, genus as before; no two edges have the same ends.
 * In quad (a, b, c, d) the sides a-d and b-c lie on leaves.  All edges are about
 * equally long in the metric du^2 + dv^2: longer in space where the foliation is
 * thin.  Numbers are rounded so that the grids match, with at least 3 quads
 * across a cylinder and 2 along a critical leaf.
 *
 * HMF_ERROR_UNSUPPORTED if a zero goes round a part of the surface that no leaf
 * crosses, or if there is no match for edges so long.  Other errors: classes
 * 100, 200, 500.
 */
HMF_API hmf_status hmf_quads(const hmf_hierarchy *hierarchy, size_t level, const double *values, size_t count,
                             const hmf_quad_options *options, double *positions, size_t position_capacity,
                             uint32_t *quads, size_t quad_capacity, size_t *vertex_count, size_t *quad_count,
                             hmf_error *error);

#ifdef __cplusplus
}
#endif

#endif /* HMF_HMF_H */
