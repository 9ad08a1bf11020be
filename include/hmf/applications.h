/*
 * hmf/applications.h - loops for a harmonic measured foliation, and what follows from it
 *
 *     hmf_components     divides a mesh into its components
 *     hmf_suggest_marks  chooses marked vertices for spheres and disks
 *     hmf_loops          chooses loops
 *     hmf_even_design    chooses marked vertices, loops and weights with a nearly constant scale
 *     hmf_parameterize   (u, v) for each corner, conformal up to discretization
 *     hmf_conformal_scale  local scale of (u, v)
 *     hmf_harmonic_forms a basis of the harmonic 1-forms, and the period matrix
 *     hmf_trace          leaves as polylines
 *     hmf_cylinders      heights, circumferences, moduli, areas
 *     hmf_quads          a quad mesh along the leaves
 *     hmf_atlas          charts without overlap in the unit square
 *
 * The rules of hmf.h apply.  Every result is one structure with counts and flat
 * arrays in one block: free it with hmf_free.  The same input gives the same bits on
 * every machine and for any number of threads.  An hmf_foliation from
 * hmf_solve or hmf_relax contains the harmonic foliation beside its values, and the functions
 * below use it where they need it.  One made in another way has only values; the functions
 * then compute from those.  Classes of
 * errors (100, 200, ...) are those of hmf_status in hmf.h.
 *
 * docs/loops.md, docs/quads.md, docs/atlas.md and docs/mathematics.md explain how
 * results are found.
 */
#ifndef HMF_APPLICATIONS_H
#define HMF_APPLICATIONS_H

#include <hmf/hmf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------
 * Several components
 * --------------------------------------------------------------------- */

/* One component of a mesh, and where it lies in the arrays of hmf_component_set: the
   first entry (first_*) and the number of entries. */
typedef struct hmf_component {
    hmf_status status;           /* HMF_OK, HMF_ERROR_MESH_GENUS (the component carries no foliation), or another error
                                    of the component: what hmf_hierarchy_create returns for it alone, with your
                                    mollify and marked vertices and all other options at their defaults */
    int32_t element;             /* HMF_ELEMENT_* that is wrong */
    uint64_t index;              /* of the element, in the whole mesh */
    uint64_t genus;              /* genus and boundary_count are 0 unless status is HMF_OK or HMF_ERROR_MESH_GENUS */
    uint64_t boundary_count;
    uint64_t first_vertex;
    uint64_t vertex_count;
    uint64_t first_edge;
    uint64_t edge_count;
    uint64_t first_triangle;
    uint64_t triangle_count;
    uint64_t first_mark;
    uint64_t marked_count;
} hmf_component;

/* The components of a mesh, each with its own numbering, in one block.  Arrays named
   part_* and whole_* contain one component after the other.  part_*: the component in
   its own numbering, as hmf_hierarchy_create takes it.  whole_*: the number of each
   element in the whole mesh. */
typedef struct hmf_component_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t count;
    uint64_t vertex_count;       /* of the whole mesh, like the next two */
    uint64_t edge_count;
    uint64_t triangle_count;
    uint64_t used_vertex_count;  /* vertices that have a triangle */
    uint64_t marked_count;       /* marked vertices that have a triangle */
    const hmf_component *list;   /* count, in the order of their first triangles */
    const double *part_positions; /* used_vertex_count x 3 */
    const uint32_t *part_triangles; /* triangle_count x 3 */
    const uint32_t *part_marks;  /* marked_count */
    const uint32_t *whole_vertices; /* used_vertex_count */
    const uint32_t *whole_edges; /* edge_count */
    const uint32_t *whole_triangles; /* triangle_count */
    const uint32_t *vertex_component; /* vertex_count: component of each vertex; HMF_NONE if it has no triangle */
    const uint32_t *vertex_part; /* vertex_count: its number in that component; HMF_NONE if it has no triangle */
    const uint32_t *triangle_component; /* triangle_count: component of each triangle */
    const uint32_t *triangle_part; /* triangle_count: its number in that component */
} hmf_component_set;

/*
 * Divides a mesh into its connected components (triangles that share a vertex are
 * connected), to be solved one by one, each with its own loops:
 *
 *     for (k = 0; k < set->count; ++k) {
 *         const hmf_component *c = &set->list[k];
 *         if (c->status) continue;                        no foliation: leave its values 0
 *         options.position_stride = 0;                    part_positions is packed
 *         options.marked_vertices = set->part_marks + c->first_mark;
 *         options.marked_count = c->marked_count;
 *         hmf_hierarchy_create(set->part_positions + 3 * c->first_vertex, c->vertex_count,
 *                              set->part_triangles + 3 * c->first_triangle, c->triangle_count, &options, ...);
 *         hmf_solve(...);
 *         own_values = hmf_foliation_values(foliation, NULL);
 *         for (e = 0; e < c->edge_count; ++e)
 *             values[set->whole_edges[c->first_edge + e]] = own_values[e];
 *     }
 *
 *   positions, triangles   as for hmf_hierarchy_create
 *   options                used: position_stride, mollify, marked vertices (of the whole
 *                          mesh), memory_limit, allocator
 *   out                    free with hmf_free
 *
 * Returns HMF_OK, HMF_CANCELLED, HMF_ERROR_MESH_COUNTS, HMF_ERROR_MESH_INDEX (also for a
 * marked vertex that does not exist), or an error of classes 100, 200.
 *
 * Each component is checked as by hmf_hierarchy_create; a defect is reported in its status,
 * not as an error of this call.  Elements of a component keep the order of the whole mesh.
 * Edges are numbered by the rule for level 0 (hmf.h).  Vertices without a triangle belong to no component.
 */
HMF_API hmf_status hmf_components(const double *positions, size_t vertex_count, const uint32_t *triangles,
                                  size_t triangle_count, const hmf_hierarchy_options *options,
                                  const hmf_control *control, hmf_component_set **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Suggested marked vertices
 * --------------------------------------------------------------------- */

/* Marked vertices chosen by hmf_suggest_marks, in one block. */
typedef struct hmf_mark_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t marked_count;
    const uint32_t *marked_vertices; /* marked_count, at most 24 on each component */
} hmf_mark_set;

/*
 * Chooses marked vertices for a mesh of genus 0.
 *
 *   options   used: position_stride, mollify, memory_limit, allocator
 *   out       free with hmf_free
 *
 * A sphere gets two at the tip of each limb (a protrusion), so that loops can go around
 * it: 4 to 24 vertices.  A disk gets four on its boundary, at corners where there are
 * some; if its boundary is short, it is treated as a sphere.  Each component gets its own;
 * an invalid component, and a surface that needs no marked vertices, gets none.
 *
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200, 300 other than
 * HMF_ERROR_MESH_COMPONENTS and HMF_ERROR_MESH_GENUS.
 */
HMF_API hmf_status hmf_suggest_marks(const double *positions, size_t vertex_count, const uint32_t *triangles,
                                     size_t triangle_count, const hmf_hierarchy_options *options,
                                     const hmf_control *control, hmf_mark_set **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Loops made by the library
 * --------------------------------------------------------------------- */

/* Which loops to make. */
typedef enum hmf_loops_kind {
    HMF_LOOPS_CUT = 1,           /* as many loops as the genus; cut along them, the surface is one sphere with holes. In
                                    genus 0: loops around pairs of marked vertices instead */
    HMF_LOOPS_HANDLE = 2,        /* like CUT, but each loop goes around a handle: it bounds a surface in the
                                    solid that the mesh encloses */
    HMF_LOOPS_TUNNEL = 3,        /* like CUT, but each loop goes around a tunnel: it bounds a surface outside
                                    the solid */
    HMF_LOOPS_PANTS = 4          /* 3 * genus - 3 + marked_count loops (one on a torus without marked vertices); cut
                                    along them, the surface splits into spheres with three holes (pairs of pants), where
                                    a marked vertex counts as a hole */
} hmf_loops_kind;
/* With boundary, CUT has one loop along each boundary (an annulus: one in all) and as many others as the genus. In
   genus 0 with marked vertices inside, there are also loops that each go around two of these vertices, or around one
   and a boundary. A disk with fewer than two marked vertices inside has only arcs: each cuts off a piece with two
   neighboring marked vertices of the boundary. PANTS has as many loops and arcs as fit: together with their mirror
   images they are a pants decomposition of the double (the surface glued to its mirror image). HANDLE and TUNNEL:
   HMF_ERROR_MESH_BOUNDARY. */

/*
 * Chooses loops on a level, as loops of triangles: simple, disjoint, essential (not trivial,
 * see docs/boundary.md), pairwise not freely homotopic, and short.
 *
 *   level   any level; on a surface with boundary only 0, others return HMF_ERROR_LEVEL
 *   kind    HMF_LOOPS_*
 *   out     loops for hmf_solve, with weights NULL (all 1); free with hmf_free
 *
 * HANDLE and TUNNEL: each loop bounds a surface inside the solid, or outside.  This is
 * decided exactly for the mesh of level 0.  Inside is where the surface encloses volume,
 * for either orientation of the triangles.
 *
 * Returns HMF_OK, HMF_CANCELLED, or
 *   HMF_ERROR_MESH_GENUS         HANDLE or TUNNEL on genus 0
 *   HMF_ERROR_MESH_BOUNDARY      HANDLE or TUNNEL on a surface with boundary
 *   HMF_ERROR_MESH_NOT_EMBEDDED  HANDLE or TUNNEL, if the surface intersects itself and such
 *                                loops do not exist or are very long
 *   HMF_ERROR_UNSUPPORTED        triangles of a coarse level share several edges, so they do
 *                                not determine a loop; use a finer level
 *   an error of classes 100, 200
 *
 * The homotopy classes of the loops depend only on the mesh and its marked vertices, not on
 * the other options of the hierarchy, and loop number c has the same class on every level.  If ratio, collapse
 * or coarsest differ from the defaults, the call builds a temporary second hierarchy, which
 * takes the time and memory of hmf_hierarchy_create.  docs/loops.md describes how loops are
 * chosen, and how stable they are under remeshing.
 */
HMF_API hmf_status hmf_loops(const hmf_hierarchy *hierarchy, size_t level, int32_t kind, const hmf_control *control,
                             hmf_loop_set **out, hmf_error *error);

/*
 * Calls hmf_solve with the loops of HMF_LOOPS_CUT and weights 1.  options->start must be
 * NULL, otherwise HMF_ERROR_OPTIONS.  Returns what hmf_loops and hmf_solve return.
 */
HMF_API hmf_status hmf_solve_cut_system(const hmf_hierarchy *hierarchy, const hmf_solve_options *options,
                                        const hmf_control *control, hmf_foliation **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Even design
 * --------------------------------------------------------------------- */

typedef struct hmf_design_options {
    uint32_t struct_size;
    int32_t no_poles;            /* 1: use only the marked vertices of `build`, so that there are no other poles;
                                    without effect on a sphere or disk if `build` has none, as it needs some.
                                    0 (default): marked vertices may be added. Others: HMF_ERROR_OPTIONS */
    const hmf_hierarchy_options *build; /* NULL = defaults. Used: position_stride, mollify, memory_limit, allocator, and
                                    marked vertices, which become part of the design */
    uint64_t solve_limit;        /* limit of the search, in units of one solve of a mesh of 1000 vertices (about 3 ms);
                                    0 = chosen from the size of the mesh. A few more solves are possible */
} hmf_design_options;

/* Sets the defaults, see hmf_control_init. */
HMF_API void hmf_design_options_init(hmf_design_options *options, uint32_t struct_size);

/* Marked vertices, loops and weights of an even design, in one block. */
typedef struct hmf_design {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t marked_count;
    const uint32_t *marked_vertices; /* marked_count, for hmf_hierarchy_options */
    const hmf_loop_set *loops;   /* triangle loops of level 0, for hmf_solve on a hierarchy with these marked vertices.
                                    Weights are whole numbers, so that a pattern with period 1 in u continues across
                                    every seam. The leaves that follow a loop of weight 1 fill a strip about as wide
                                    as 1/44 of the diagonal of the bounding box.
                                    Part of this block: do not free it */
    double unevenness;           /* estimate for this design, see hmf_scale */
    double unevenness_before;    /* estimate for HMF_LOOPS_CUT with weights 1; in genus 0 with a first choice of marked
                                    vertices */
    uint64_t solves;             /* number of small solves that the search made */
} hmf_design;

/*
 * Chooses marked vertices, loops and weights for a mesh of any genus, so that the
 * conformal scale of the harmonic foliation is nearly constant.  Stripes and quads then
 * have nearly the same width everywhere.
 *
 *     hmf_even_design       -> design
 *     hmf_hierarchy_create  with design->marked_vertices
 *     hmf_solve             with design->loops
 *
 *   options   NULL = defaults
 *   out       free with hmf_free
 *
 * Tips of limbs (protrusions) that no loop goes around may be marked, because the scale
 * decays there.  The loops are those of HMF_LOOPS_PANTS or HMF_LOOPS_CUT on the surface
 * with its marked vertices, without those of weight 0.  On a surface with boundary, the
 * marked vertices are those of options->build; if there are none, those of hmf_suggest_marks,
 * or the sharp corners of the boundary or tips of limbs, if these make the scale more even.
 *
 * Returns HMF_OK, HMF_CANCELLED, HMF_ERROR_UNSUPPORTED if no loops were found, or an error
 * of hmf_hierarchy_create.
 */
HMF_API hmf_status hmf_even_design(const double *positions, size_t vertex_count, const uint32_t *triangles,
                                   size_t triangle_count, const hmf_design_options *options,
                                   const hmf_control *control, hmf_design **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Parameterization
 * --------------------------------------------------------------------- */

typedef struct hmf_parameterize_options {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    double tolerance;            /* largest residual that is accepted, default 1e-2; above it
                                    HMF_ERROR_VALUE_NOT_HARMONIC */
    const uint32_t *seam_edges;  /* seam_edge_count edges of the level along which to cut by preference; NULL = none */
    uint64_t seam_edge_count;    /* number of seam_edges. HMF_ERROR_OPTIONS if it is nonzero and seam_edges is NULL, or
                                    if an edge does not exist */
} hmf_parameterize_options;

/* Sets the defaults, see hmf_control_init. */
HMF_API void hmf_parameterize_options_init(hmf_parameterize_options *options, uint32_t struct_size);

typedef struct hmf_parameterization {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t vertex_count;
    uint64_t edge_count;
    uint64_t triangle_count;
    const double *corner_uv;     /* triangle_count x 3 x 2: (u, v) of each corner */
    const double *transition;    /* edge_count x 3: sign, a, b; see below */
    const uint8_t *seam;         /* edge_count: 1 on seams, where the (u, v) of the two sides differ */
    const int32_t *cone;         /* vertex_count: cone angle as a multiple of pi, 2 = regular */
    const double *dilatation;    /* triangle_count: ratio of the singular values of the map, >= 1; negative if the image
                                    is flipped; infinite if the triangle is degenerate: a ratio above 1000, or an
                                    image too small to measure */
    const double *differential;  /* triangle_count x 2: quadratic differential, real and imaginary part */
    double dilatation_mean;      /* mean of the absolute values, weighted by area, without degenerate triangles */
    double dilatation_median;    /* this and the next: median and 99th percentile of the absolute values, weighted by
                                    area; degenerate triangles count as infinite */
    double dilatation_p99;
    uint64_t flipped_count;      /* triangles */
    uint64_t degenerate_count;   /* triangles */
    uint64_t seam_edge_count;
    double seam_length;          /* in the unit of the positions */
    double area;                 /* of the image: the energy, up to discretization */
    uint64_t linear_iterations;  /* of the linear solver */
    double seconds;              /* duration of the call */
    /* What the checks measured.  The energy of du is the sum of cotangent weight * du^2
       over the edges. */
    double energy_ratio;         /* energy of du / energy of the foliation, in (0.9, 1.5); not exactly 1, because zeros
                                    are moved to vertices */
    double area_error;           /* relative difference of the area of the image and the energy of du, at most 1e-4 */
    double circumference_least;  /* smallest ratio of a circumference in (u, v) to that of hmf_cylinders, above 0.5 */
    double circumference_most;   /* and the largest, below 2 */
} hmf_parameterization;

/*
 * Computes the global conformal parameterization of a harmonic foliation ([W] section 5;
 * hmf.h names the paper): |du| is the foliation, and v is the harmonic conjugate of u.
 *
 *   foliation   with residuals of at most options->tolerance
 *   out         free with hmf_free
 *
 * The surface is cut along short seams through the zeros; each corner of the cut surface
 * has one (u, v).  If a point of an edge has coordinates (u, v) in the first of its two
 * triangles (the one with the lower number), then its coordinates in the second one are
 *
 *     (u', v') = sign * (u, v) + (a, b),        sign = +1 or -1.
 *
 * This holds without rounding: every number is k times one fixed power of two, with an
 * integer |k| < 2^53.  Edges that are not seams, and boundary edges, have (1, 0, 0).  The square
 * (du + i dv)^2 does not depend on the sign, so it is the same on both sides of a seam.
 * It is the holomorphic quadratic differential, given per triangle as the square of
 * d(u + i v) / dz, in the unit (values / positions) squared, where z = x + i y in the
 * frame of the triangle: x along its side 0, y to the left of it.
 *
 * Zeros in triangles are moved to vertices that are not marked, at most one to a vertex;
 * near the zeros u differs from the foliation accordingly.  The cone angle is
 * (2 + m) * pi at an unmarked zero of order m, (1 + m) * pi at a marked vertex reported as a
 * zero of order m, and pi at a marked vertex that is a pole.  On a closed surface the sum of
 * (2 - cone) is 4 - 4 * genus.  At a vertex of the boundary, cone is the angle in the
 * double (the surface and its mirror image, glued along the boundary): 2 where the
 * boundary is straight, 1 at a corner of 90 degrees.  Triangles where the foliation is 0
 * (on limbs that no loop goes around) are degenerate.
 *
 * Before the result is returned it is checked: u is harmonic and constant along the closed
 * leaves, du and dv are closed in every triangle, the linear solves have converged, energies,
 * areas and circumferences are within the bounds above, and the sum of the absolute areas of
 * the triangles is at most 1.5 times the energy of the foliation, so no large part is folded.
 * Small folds are possible; flipped_count counts their triangles.  A cylinder that is thinner
 * than the triangles may lose all its leaves when a zero is moved across it, so its circumference
 * cannot be checked alone.  All thin cylinders are checked together, as if they were one.  Its
 * area is what the other cylinders leave over: the energy of du minus their areas.
 *
 * Returns HMF_OK, HMF_CANCELLED, HMF_ERROR_VALUE_NOT_HARMONIC, an error of classes 100,
 * 200, 500, or HMF_ERROR_UNSUPPORTED: the mesh is too coarse (it has too few vertices for its
 * zeros, or moving the zeros exceeds these bounds), or the linear systems could not be solved
 * accurately enough.
 */
HMF_API hmf_status hmf_parameterize(const hmf_foliation *foliation, const hmf_parameterize_options *options,
                                    const hmf_control *control, hmf_parameterization **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Scale
 * --------------------------------------------------------------------- */

typedef struct hmf_scale {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t triangle_count;     /* of the level */
    const double *log_scale;     /* triangle_count: natural logarithm of the local scale of each triangle. The local
                                    scale of a conformal (u, v) is |grad u|, where |du| is the foliation; its unit is
                                    that of the values divided by that of the positions. Entries more than 16.1 below
                                    the largest (a factor of 1e-7) are raised to the largest minus 16.1 */
    double unevenness;           /* standard deviation of log_scale over the surface (scale distortion); 0 if the scale
                                    is constant */
} hmf_scale;

/* Computes the conformal scale of any foliation, even with poles, from the values and the
   positions of its level.  Free the result with hmf_free.
   Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200. */
HMF_API hmf_status hmf_conformal_scale(const hmf_foliation *foliation, const hmf_control *control, hmf_scale **out,
                                       hmf_error *error);

/* ------------------------------------------------------------------------
 * Harmonic 1-forms
 * --------------------------------------------------------------------- */

/* A basis of the harmonic 1-forms of a closed surface: n = 2 genus real forms a[0], ...,
   a[genus-1], b[0], ..., b[genus-1] (form i is a[i], form genus + i is b[i]).  Matrices are
   stored by rows: entry (i, j) of an n x n matrix is at n * i + j. */
typedef struct hmf_form_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t level;
    uint64_t genus;
    uint64_t form_count;         /* n = 2 genus */
    uint64_t edge_count;         /* of the level */
    const double *values;        /* n x edge_count: the integral of form i along edge e, from the first vertex of the
                                    edge to the second (edge_vertices of hmf_level) */
    const int32_t *intersections; /* n x n: the integral of form i ^ form j over the surface: 1 at (a[k], b[k]), -1 at
                                    (b[k], a[k]), else 0 */
    const double *inner_products; /* n x n: <form i, form j>, symmetric and positive definite; the diagonal contains
                                    the Dirichlet energies */
    const double *conjugation;   /* n x n: *form j = sum over i of entry (i, j) times form i, up to discretization; *
                                    turns a form by 90 degrees counter-clockwise */
    const double *period_real;   /* genus x genus, symmetric */
    const double *period_imaginary; /* genus x genus, symmetric and positive definite */
    double residual;             /* largest of all forms: divergence at the vertices, relative to the sum of absolute
                                    fluxes (root mean squares); at most 1e-8 */
    double conjugation_error;    /* largest absolute entry of conjugation^2 + identity; decreases as the triangles
                                    become smaller; depends on the basis */
} hmf_form_set;

/*
 * Computes a basis of the harmonic 1-forms of a closed surface.  A form is one number per
 * edge; in each triangle the three numbers add up to exactly 0 (closed), and the numbers
 * along a closed path of edges add up to an integer, its period.  Among all closed forms with
 * the same periods, each form has the least energy (harmonic), up to the solver and rounding.
 * On level 0 energy, inner products and residual are those of the intrinsic Delaunay
 * triangulation, where the forms are computed; the weights of hmf_level are those of your
 * triangles.  Marked vertices do not change the space of harmonic forms, but may change the
 * basis.
 *
 * With p = period_real + i period_imaginary, the forms a[k] + sum over j of p(k, j) b[j] are
 * holomorphic up to discretization, and p is the period matrix of the Riemann surface for
 * this basis.  It is computed from J (-J^2)^(-1/2), where J is the conjugation; the square of
 * this matrix is exactly -1.  Another basis, for instance on another level, has another period
 * matrix; an integer symplectic matrix leads from one basis to the other.
 *
 *   hierarchy   a closed surface; of genus 0 it has no forms, and all arrays are empty
 *   level       0 to level_count - 1
 *   control     NULL, or threads, progress and cancellation
 *   out         free with hmf_free
 *
 * Returns HMF_OK, HMF_CANCELLED, an error of classes 100, 200, or HMF_ERROR_MESH_BOUNDARY.
 * HMF_ERROR_UNSUPPORTED: the linear systems could not be solved accurately enough, because of
 * very thin triangles.
 *
 * Before the result is returned it is checked: each form is closed in every triangle, its
 * integrals with the basis are the integers above, both exactly, and residual is at most 1e-8.
 * Memory: 8 bytes for each form and edge, some 50 for each pair of forms, and what one solve
 * of a foliation needs.
 * Source: Gu and Yau, "Global conformal surface parameterization" (2003); docs/mathematics.md.
 */
HMF_API hmf_status hmf_harmonic_forms(const hmf_hierarchy *hierarchy, size_t level, const hmf_control *control,
                                      hmf_form_set **out, hmf_error *error);


/* ------------------------------------------------------------------------
 * Leaves, cylinders, quads
 * --------------------------------------------------------------------- */

typedef enum hmf_line_kind {
    HMF_LINE_LEVEL = 1,          /* a closed leaf at a given height of its cylinder */
    HMF_LINE_CRITICAL = 2,       /* a leaf that starts at a zero or at a marked vertex */
    HMF_LINE_POINT = 3           /* the leaf through a given point */
} hmf_line_kind;

typedef enum hmf_line_end {
    HMF_END_CLOSED = 0,          /* no end: the line is closed */
    HMF_END_ZERO = 1,            /* at a zero or at a marked vertex */
    HMF_END_LIMIT = 2,           /* at the length limit */
    HMF_END_NOWHERE = 3,         /* the given point lies where the foliation is 0: a line without points */
    HMF_END_CRITICAL = 4,        /* of a conjugate line: on a critical leaf, where its cylinder ends */
    HMF_END_BOUNDARY = 5         /* at the boundary of the surface */
} hmf_line_end;

typedef enum hmf_leaves_kind {
    HMF_LEAVES_DEFAULT = 0,
    HMF_LEAVES_FOLIATION = 1,    /* of the foliation itself (default): u is constant */
    HMF_LEAVES_CONJUGATE = 2     /* of its conjugate: v is constant; see hmf_parameterize */
} hmf_leaves_kind;

typedef struct hmf_trace_options {
    uint32_t struct_size;
    int32_t critical;            /* not 0: all critical leaves; also traced if spacing and point_count are 0 */
    double spacing;              /* > 0: level sets at about this distance, in the unit of the values, at most 2^20 in a
                                    cylinder, otherwise HMF_ERROR_OPTIONS; 0 = none */
    double length_limit;         /* length at which a leaf stops, in each direction, in the unit of the positions; 0 =
                                    none, for conjugate leaves ten times the square root of the area */
    uint64_t point_count;        /* number of points to trace leaves through; 0 = none */
    const uint32_t *point_triangles;      /* point_count */
    const double *point_barycentrics; /* point_count x 3, for the corners of the triangle; not negative, with sum 1
                                    (within 1e-6) */
    int32_t leaves;              /* HMF_LEAVES_* */
    uint32_t reserved;           /* 0 */
} hmf_trace_options;

/* Sets the defaults, see hmf_control_init. */
HMF_API void hmf_trace_options_init(hmf_trace_options *options, uint32_t struct_size);

typedef struct hmf_line {
    int32_t kind;                /* HMF_LINE_* */
    int32_t closed;              /* 1 if the last point joins the first, which is not repeated; otherwise 0 */
    int32_t begin, end;          /* HMF_END_* */
    uint32_t begin_zero, end_zero; /* number of the zero or marked vertex in the list of hmf_singularities, or
                                    HMF_NONE */
    uint32_t cylinder;           /* number in the list of hmf_cylinders; HMF_NONE for critical leaves, on level 0 of a
                                    surface with boundary, and with HMF_END_NOWHERE */
    uint32_t source;             /* HMF_LINE_POINT: number of the point; HMF_LINE_LEVEL: number of the level set in its
                                    cylinder, from the lower side; HMF_LINE_CRITICAL: number of the leaf */
    double height;               /* above the lower side of the cylinder (one of its two sides, always the same one),
                                    in the unit of the values; 0 for critical leaves */
    double length;               /* in the unit of the positions */
} hmf_line;

typedef struct hmf_lines {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t line_count;
    uint64_t point_count;
    const hmf_line *lines;       /* line_count: first the level sets, cylinder by cylinder, then the critical leaves,
                                    then those through points */
    const uint64_t *offsets;     /* line_count + 1; line k has the points from offsets[k] to offsets[k+1] - 1 */
    const double *points;        /* point_count x 3 coordinates */
    const uint32_t *point_edges; /* point_count: edge of the level that the point lies on; HMF_NONE inside a triangle
                                    (at a zero, or the end of a conjugate line) and at some boundary vertices */
    uint64_t compared_count;     /* pairs of consecutive points, a sample, that were checked to lie on one leaf */
    double deviation;            /* largest difference of the values at both points of a pair, in the unit of the
                                    values */
} hmf_lines;

/*
 * Traces leaves of a foliation as polylines.
 *
 *   options     which leaves; NULL: the critical ones
 *   out         free with hmf_free
 *
 * Consecutive points lie in one triangle.  Leaves are followed in exact integers, so no two
 * cross.  Leaves that are not critical close, unless length_limit or a boundary ends them.
 * A torus has no critical leaves.
 *   level sets       each cylinder gets round(height / spacing), at least one, evenly
 *                    spaced with half a space at either side, so that they match across
 *                    critical leaves
 *   through points   a leaf passes the point within 2^-48 of the largest value; the
 *                    center of a triangle with a zero is moved to the nearest leaf
 *
 * Conjugate leaves do not close in general.  Their level sets are lines across each
 * cylinder, round(circumference / spacing) of them; with the level sets of the foliation
 * they form a grid.  Leaves out of zeros end at another zero or at the length limit; leaves
 * through points close or end at the limit.  The number of points is limited as well, far
 * above any useful one; there a line ends in the same way.  begin_zero and end_zero are
 * HMF_NONE, height is 0, and cylinder is HMF_NONE except for level sets.
 *
 * With boundary (level 0) the leaves are those of the double, cut at the boundary.  A leaf
 * can give several lines with the same source, in order along the leaf.  begin_zero,
 * end_zero and cylinder are HMF_NONE, and heights are those in the double.  A leaf close to
 * the boundary may cross it many times within rounding; such tiny pieces are left out.
 *
 * The foliation need not be harmonic.  For conjugate leaves it must be, as for
 * hmf_cylinders, otherwise HMF_ERROR_VALUE_NOT_HARMONIC.
 *
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100 (HMF_ERROR_UNSUPPORTED for a
 * vertex with too many neighbors, as in hmf_solve), 200, 500.  For a bad point
 * (HMF_ERROR_OPTIONS) error->index is its number.
 */
HMF_API hmf_status hmf_trace(const hmf_foliation *foliation, const hmf_trace_options *options,
                             const hmf_control *control, hmf_lines **out, hmf_error *error);

typedef struct hmf_cylinder {
    uint32_t loop;               /* number of its loop; HMF_NONE if no loops were given */
    uint32_t reserved;           /* 0 */
    double height;               /* the weight of the loop, up to rounding: at most 64 times hmf_foliation_unit */
    double circumference;        /* of the flat metric du^2 + dv^2, in the unit of the values */
    double modulus;              /* height / circumference */
    double area;                 /* in the flat metric, measured separately: height * circumference up to
                                    discretization; areas add up to the energy */
} hmf_cylinder;

typedef struct hmf_cylinder_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t count;
    const hmf_cylinder *list;    /* count, in the order of hmf_line.cylinder */
    const hmf_loop_set *leaves;  /* the leaf in the middle of each cylinder as a triangle loop of the level, with the
                                    heights as weights. Part of this block: do not free it */
    double area_error;           /* relative difference of the sum of height * circumference and the energy, at most
                                    1e-4; with boundary those of the double */
    const double *twists;        /* count: see below, in [0, circumference), in the unit of the values; NAN where there
                                    is none */
    const uint64_t *corner_offsets; /* 2 * count + 1: corners of the first side of cylinder k begin at corner_offsets[2
                                    k], those of its second side at corner_offsets[2 k + 1] */
    const uint32_t *corner_vertices; /* per corner: the vertex of its zero, or the vertex of the triangle with the zero
                                    that lies ahead of the zero inside the cylinder */
    const double *corner_places; /* per corner: its place on the cylinder, see below, in [0, circumference) */
} hmf_cylinder_set;

/*
 * Measures the cylinders of a harmonic foliation.  The critical leaves cut the surface into
 * one cylinder for each loop, filled with closed leaves of its class.
 *
 *   loops       the loops of the foliation, on any level; NULL = do not match cylinders to
 *               loops
 *   out         free with hmf_free
 *
 * Heights are exact.  Circumference, modulus and area are those of the minimum.  There the
 * energy is the sum of height * circumference and the sum of the areas, which is checked.
 * Cylinders are matched to loops by their free homotopy classes, exactly.
 *
 * Twists are those of the minimum as well.  A corner is where a side of a cylinder passes a
 * zero or marked vertex.  The base of a side is its corner with the lowest vertex number; if
 * several corners have this vertex, the one whose last edge into the cylinder, in
 * counter-clockwise order, ends at the lowest vertex, on the triangulation where the foliation
 * is solved.  The first side of the cylinder is the one with the lower base.  The twist is the
 * distance, along the leaves, from the point opposite to the base of the first side to the
 * base of the second side, in the direction that has the second side on the right.  It is
 * modulo the circumference: a Dehn twist about the loop of the cylinder does not change it, and
 * twists near 0 and near the circumference are the same up to rounding.  Corners are listed
 * side by side, in this direction, the base first.  The place of a corner is its distance from
 * the base of the first side, so the twist is the place of the base of the second side.  For
 * other bases subtract their places.  Both sides of a critical leaf are equally long, except
 * beside a vertex of even order, where they are up to discretization.
 *
 * A cylinder of a torus without marked vertices has a twist and no corners.  The twist is NAN,
 * and there are no corners, on a surface with boundary, if a side of the cylinder has no
 * corner, and if the flux along a side differs from the circumference by more than 1e-4.
 *
 * With boundary, level 0 and loops are required, otherwise HMF_ERROR_UNSUPPORTED.  For an
 * arc the cylinder is a strip: its circumference is the length of a leaf from boundary to
 * boundary, and its leaf is an arc.  Of the cylinder around a boundary only the half on the
 * surface counts, with half the height and area.
 *
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100, 200, 400, 500;
 * HMF_ERROR_UNSUPPORTED also for a vertex with too many neighbors, as in hmf_solve,
 * HMF_ERROR_VALUE_CLASS if the values do not belong to the loops,
 * HMF_ERROR_VALUE_NOT_HARMONIC if their energy is more than 1 % above the minimum.
 */
HMF_API hmf_status hmf_cylinders(const hmf_foliation *foliation, const hmf_loop_set *loops,
                                 const hmf_control *control, hmf_cylinder_set **out, hmf_error *error);

typedef struct hmf_quad_options {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    double edge_length;          /* target for the mean edge length, in the unit of the positions; 0 = half as many
                                    quads as triangles */
    uint64_t count;              /* target number of quads; 0 = by edge_length. Both: HMF_ERROR_OPTIONS */
    int32_t merge;               /* not 0: allow coarser quads. Zeros joined by a critical leaf shorter than half an
                                    edge of a quad become one vertex; the minimum is one quad along a critical leaf
                                    (otherwise 2) and 2 rows in a cylinder (otherwise 3) */
    int32_t keep_poles;          /* not 0: a marked vertex with one prong stays a vertex with two edges */
    uint64_t relax;              /* rounds in which vertices move on the surface, at most 1000, about 40 suffice; 0 =
                                    vertices stay on their leaves */
} hmf_quad_options;

/* Sets the defaults, see hmf_control_init. */
HMF_API void hmf_quad_options_init(hmf_quad_options *options, uint32_t struct_size);

typedef struct hmf_quad_mesh {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t vertex_count;
    uint64_t quad_count;
    const double *positions;     /* vertex_count x 3, points of the surface */
    const uint32_t *quads;       /* quad_count x 4 vertices, oriented as the triangles */
    uint64_t irregular_count;    /* vertices that do not have 4 edges, on the boundary 3 */
    uint64_t inverted_count;     /* quads with a corner of at most 0 or at least 180 degrees, or that face against the
                                    surface nearest to them */
    double edge_length;          /* side of a square of the mean area: sqrt(area of the surface / number of quads) */
    double area_ratio;           /* area of the quads / area of the surface; far above 1 if quads overlap */
    double distance;             /* greatest distance from a vertex of the surface to the quads, measured to the quads
                                    around it, in the unit of the positions */
} hmf_quad_mesh;

/*
 * Makes a quad mesh along the leaves: a grid on each cylinder, glued along the critical
 * leaves.
 *
 *   options     NULL = defaults
 *   out         free with hmf_free
 *
 * The mesh is oriented and manifold, with the genus and the boundaries of the surface; no two
 * edges have the same ends.  The sides a-d and b-c of quad (a, b, c, d) lie on leaves.  Edges have
 * nearly the same length in the metric du^2 + dv^2, so they are longer in space where the
 * foliation is small.  There are at least 3 quads across a cylinder and 2 along a critical
 * leaf; fewer with `merge`.
 *
 * The first vertices are the zeros, in the order of hmf_singularities.  If zeros were
 * merged (`merge`, or zeros that only discretization keeps apart), there are fewer of them
 * and their orders add up.  A zero of order m has 2 m + 4 edges.  A marked vertex with one
 * prong is covered by one quad, two of whose vertices have 3 edges; two of them close
 * together may share a quad, all of whose vertices have 3 edges.  Every other vertex has 4
 * edges, on the boundary 3.
 *
 * With `count` the number of quads is met as nearly as the grids allow, and is at least what
 * the cylinders need (made by `count` = 1, `relax` = 0).  With `relax` vertices leave the leaves
 * and move on the surface to improve angles and sides; they also move to sharp edges, corners and
 * tips of protrusions.  inverted_count counts the quads that remain inverted.
 *
 * With boundary (level 0) boundary vertices lie on the boundary of the surface: rows end there
 * where leaves run along it, columns where leaves meet it.  Zeros of the boundary are vertices,
 * and a marked vertex with one prong is a corner, so a rectangle becomes a grid.  With `relax`
 * each corner of the boundary of more than 40 degrees gets a vertex, and the other vertices
 * slide along the boundary.  Triangles at the boundary that no leaf crosses may be left out.
 *
 * If relaxed quads are inverted or do not follow the surface, smaller ones are tried, up to
 * eight times as many as the cylinders need at least.
 *
 * The columns follow v of the flat surface of hmf_parameterize, which is computed once for each
 * foliation and kept with it.  So the foliation must be harmonic: if the energy of its values is
 * more than 1 % above the minimum, the call fails with HMF_ERROR_VALUE_NOT_HARMONIC.
 *
 * Returns HMF_OK, HMF_CANCELLED, or
 *   HMF_ERROR_QUADS        even these do not follow the surface; a part of the surface that no
 *                          leaf crosses is not a disk; or no numbers of columns fit all
 *                          cylinders at once: edges are too long, or the mesh is too coarse
 *   HMF_ERROR_UNSUPPORTED  a coarser level of a surface with boundary; or as hmf_parameterize
 *   HMF_ERROR_OPTIONS      also if there would be more than 2^28 quads
 *   an error of classes 100, 200, 500
 */
HMF_API hmf_status hmf_quads(const hmf_foliation *foliation, const hmf_quad_options *options,
                             const hmf_control *control, hmf_quad_mesh **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Atlas
 * --------------------------------------------------------------------- */

typedef struct hmf_atlas_options {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    double margin;               /* least distance of two charts, as a fraction of the side of the square, at most 1/16;
                                    half of it is left free along the border; 0 = 1/512 */
} hmf_atlas_options;

/* Sets the defaults, see hmf_control_init. */
HMF_API void hmf_atlas_options_init(hmf_atlas_options *options, uint32_t struct_size);

typedef struct hmf_chart_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t triangle_count;
    uint64_t chart_count;
    const double *corner_uv;     /* triangle_count x 3 x 2: position of each corner in the unit square */
    const uint32_t *triangle_chart; /* triangle_count: which chart it belongs to */
    double used_area;            /* part of the square covered by triangles */
    double seam_length;          /* in the unit of the positions, each side between two triangles once */
    uint64_t seam_edge_count;    /* edges whose two triangles do not meet in the square */
    uint64_t collapsed_count;    /* triangles without positive area in the square, where the foliation is nearly 0 */
    double unevenness;           /* standard deviation over the surface of the logarithm of the scale, the square root
                                    of (area in the square / area in space), without collapsed triangles */
    uint64_t speck_count;        /* triangles that the check of overlaps leaves out: without area in the square, or
                                    smaller than a millionth of it across */
    uint64_t compared_count;     /* edges of charts that the check compared */
} hmf_chart_set;

/*
 * Makes charts without overlap in the unit square, for painting and baking: every triangle
 * has a place of its own there.
 *
 *   foliation   with residuals of at most 1e-2; with boundary on level 0
 *   options     NULL = defaults
 *   out         free with hmf_free
 *
 * Each chart is the image of (u, v) of hmf_parameterize under a rotation by a multiple of 90
 * degrees and a scale of its own, so charts are as conformal as (u, v).  Areas of charts are
 * proportional to areas on the surface.  A triangle belongs to one chart, so the edge of a chart
 * is ragged by up to one triangle.  At the boundary of the surface charts are straight, and
 * boundary edges are not seams.  Triangles keep their orientation: inverted triangles of (u, v)
 * are corrected by moving a vertex, or take the shape that they have in space.
 *
 * No two triangles overlap, except those of speck_count.  Charts keep the margin from each
 * other along u or along v.  Even designs (hmf_even_design) give fewer and larger charts.
 *
 * Returns HMF_OK, HMF_CANCELLED, HMF_ERROR_VALUE_NOT_HARMONIC, an error of classes 100,
 * 200, 500, or HMF_ERROR_UNSUPPORTED: on coarser levels of a surface with boundary; if the
 * margin is too large for the number of charts; or if a chart would be 1000 times as long
 * as the square, or a cylinder too long for the integers in which it is laid out, as with
 * triangles of nearly zero area.
 */
HMF_API hmf_status hmf_atlas(const hmf_foliation *foliation, const hmf_atlas_options *options,
                             const hmf_control *control, hmf_chart_set **out, hmf_error *error);

#ifdef __cplusplus
}
#endif

#endif /* HMF_APPLICATIONS_H */
