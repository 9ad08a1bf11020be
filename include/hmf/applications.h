/*
 * hmf/applications.h - loops for a harmonic measured foliation, and what one does with it
 *
 *     hmf_components     the components of a mesh
 *     hmf_suggest_marks  marked vertices for genus 0
 *     hmf_loops          loops to solve for
 *     hmf_even_design    marked vertices, loops and weights for even quads
 *     hmf_parameterize   (u, v) for each corner, conformal up to discretization
 *     hmf_trace          leaves as polylines
 *     hmf_cylinders      heights, circumferences, moduli, areas
 *     hmf_quads          a quad mesh along the leaves
 *     hmf_atlas          charts without overlap in the unit square
 *
 * The rules are those of hmf.h.  Every result is one structure with counts and
 * flat arrays in one block, to be freed with hmf_free.  All start from the
 * minimum that hmf_solve found on the intrinsic triangulation.
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

/* One of the components of a mesh: its parts of the arrays of hmf_component_set.
   first_* say where they begin. */
typedef struct hmf_component {
    hmf_status status;           /* what hmf_hierarchy_create says of it with the default options, mollify and the
                                    marked vertices: HMF_OK, HMF_ERROR_MESH_GENUS if it carries no foliation, or
                                    its defect */
    int32_t element;             /* HMF_ELEMENT_* that the defect is about */
    uint64_t index;              /* of the element, in the whole mesh */
    uint64_t genus;              /* this and the next: 0 where the status is a defect */
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

/* The components of a mesh, each with numbers of its own, in one block.  Arrays
   named part_* and whole_* have one component after the other: a part, as
   hmf_hierarchy_create takes it and numbers it on level 0, and its numbers in the whole mesh. */
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
    const uint32_t *vertex_component; /* vertex_count: component of each vertex; HMF_NONE: it has no triangle */
    const uint32_t *vertex_part; /* vertex_count: its number there */
    const uint32_t *triangle_component; /* triangle_count, likewise */
    const uint32_t *triangle_part;
} hmf_component_set;

/*
 * Divides a mesh into its connected components (triangles that share a vertex are
 * in one), which are then built and solved one by one, each with its own loops:
 *
 *     for (k = 0; k < set->count; ++k) {
 *         const hmf_component *c = &set->list[k];
 *         if (c->status) continue;                        it carries no foliation: values 0
 *         options.marked_vertices = set->part_marks + c->first_mark;
 *         options.marked_count = c->marked_count;
 *         hmf_hierarchy_create(set->part_positions + 3 * c->first_vertex, c->vertex_count,
 *                              set->part_triangles + 3 * c->first_triangle, c->triangle_count, &options, ...);
 *         hmf_solve(...);
 *         for (e = 0; e < c->edge_count; ++e)
 *             values[set->whole_edges[c->first_edge + e]] = own_values[e];
 *     }
 *
 * Elements of a component keep the order that they have in the whole mesh.  Edges
 * are numbered as on level 0.  Each component is checked as hmf_hierarchy_create does; a
 * defect is its status, not an error of this call.  Vertices without a triangle
 * are in no component.
 *
 * Of the options, position_stride, mollify, the marked vertices (of the whole
 * mesh) and the memory count.  Free with hmf_free.
 * Returns HMF_OK, HMF_CANCELLED, or an error of classes 100 and 200, or
 * HMF_ERROR_MESH_COUNTS, HMF_ERROR_MESH_INDEX.
 */
HMF_API hmf_status hmf_components(const double *positions, size_t vertex_count, const uint32_t *triangles,
                                  size_t triangle_count, const hmf_hierarchy_options *options,
                                  const hmf_control *control, hmf_component_set **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Suggested marked vertices
 * --------------------------------------------------------------------- */

/* Vertices that hmf_suggest_marks proposes, in one block. */
typedef struct hmf_mark_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t count;
    const uint32_t *vertices;    /* count, at most 24 on each component */
} hmf_mark_set;

/*
 * Marked vertices for a mesh of genus 0 whose owner names none: two at the tip of
 * each limb, so that loops go round the limbs, at least four and at most 24.
 * A disk gets its four corners, or four vertices that divide its boundary into
 * equal lengths, corners near these where there are; or, where that is short (its
 * square less than twice the area), tips as a sphere.
 * None where none are needed.  The same input gives the same marks.
 * Of several components each gets its own, but for those that hmf_hierarchy_create refuses
 * whatever is marked.
 *
 * Of the options, position_stride, mollify and the memory count.  Free with
 * hmf_free.  Errors: as hmf_hierarchy_create.
 */
HMF_API hmf_status hmf_suggest_marks(const double *positions, size_t vertex_count, const uint32_t *triangles,
                                     size_t triangle_count, const hmf_hierarchy_options *options,
                                     const hmf_control *control, hmf_mark_set **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Loops made by the library
 * --------------------------------------------------------------------- */

/* Which loops to make. */
typedef enum hmf_loops_kind {
    HMF_LOOPS_CUT = 1,           /* genus many, together they cut the surface into one planar piece; genus 0: round
                                    pairs of marked vertices */
    HMF_LOOPS_HANDLE = 2,        /* a cut system whose loops bound inside the surface: they go round the handles */
    HMF_LOOPS_TUNNEL = 3,        /* a cut system whose loops bound outside: they go round the holes */
    HMF_LOOPS_PANTS = 4          /* 3 genus - 3 + marked vertices (genus 1 without those: one), together they cut the
                                    surface into pairs of pants */
} hmf_loops_kind;
/* With boundary: CUT has genus many loops (genus 0 with marked vertices inside: round pairs of those, or of one and a
   boundary) and one along each boundary (an annulus: one); a disk with fewer than two marked vertices inside has arcs
   instead, each round two neighboring marked vertices of the boundary.  PANTS has, together with the mirror images,
   the most loops that the double can have.  There is no HANDLE and no TUNNEL: HMF_ERROR_MESH_BOUNDARY. */

/*
 * Loops made by the library on a level, as triangle loops: simple, disjoint,
 * essential, pairwise not freely homotopic, and short.  Loop c is in the same class on
 * every level, and for every ratio, collapse and coarsest; a hierarchy with other
 * options than the default ones costs the time and memory of another
 * hmf_hierarchy_create.  Other triangles of the same shape may have other classes
 * where those are as long, within 1 % in total for CUT and PANTS, or where detail is
 * as small as triangles of a coarse level.  With boundary: level 0 only.
 *
 *   kind           HMF_LOOPS_*.  HANDLE and TUNNEL are decided by linking
 *                  numbers in space on level 0, exactly, with positions
 *                  rounded to 1e-10 of the size of the object: each loop is
 *                  null-homologous inside, or outside.  Inside is where
 *                  the surface encloses volume, whichever way the triangles
 *                  turn.  A surface that meets itself may have no such loops,
 *                  or only such as no search of bounded length finds:
 *                  HMF_ERROR_MESH_NOT_EMBEDDED.
 *   out            loops that can be given to hmf_solve as they are (weights
 *                  are NULL: all 1); free with hmf_free
 *
 * Deterministic.
 * Returns HMF_OK; HMF_ERROR_MESH_GENUS for HANDLE and TUNNEL on genus 0,
 * HMF_ERROR_MESH_BOUNDARY, HMF_ERROR_MESH_NOT_EMBEDDED; HMF_ERROR_UNSUPPORTED if
 * triangles of a coarse level share several edges and so do not name a loop; or an
 * error of classes 100, 200.
 */
HMF_API hmf_status hmf_loops(const hmf_hierarchy *hierarchy, size_t level, int32_t kind, const hmf_control *control,
                             hmf_loop_set **out, hmf_error *error);

/*
 * hmf_solve with the loops that hmf_loops makes (HMF_LOOPS_CUT) on the coarsest
 * level, with boundary and for HMF_METHOD_SINGLE_LEVEL on level 0; weights 1.
 * options->start must be NULL.  Returns what hmf_loops and hmf_solve return.
 */
HMF_API hmf_status hmf_solve_cut_system(const hmf_hierarchy *hierarchy, const hmf_solve_options *options,
                                        const hmf_control *control, hmf_foliation **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Even design
 * --------------------------------------------------------------------- */

typedef struct hmf_design_options {
    uint32_t struct_size;
    int32_t no_poles;            /* 1: no marked vertices but those of `build`, where that can be; else 0 */
    const hmf_hierarchy_options *build; /* NULL = defaults.  Used: position_stride, mollify, memory_limit, allocator,
                                    and marked vertices, which are then part of every design */
    uint64_t solve_limit;        /* of the search, in solves of a mesh of about 1000 vertices, 3 ms each; a solve with n
                                    loops counts 1 + n / 8.  Default 120, or edges / 400 where that is more: about ten
                                    solves of the whole mesh, and again up to 150 where the
                                    unevenness is above .28 then.  It is passed by a few */
} hmf_design_options;

/* The defaults, see hmf_control_init. */
HMF_API void hmf_design_options_init(hmf_design_options *options, uint32_t struct_size);

/* Marked vertices, loops and weights that suit each other, in one block. */
typedef struct hmf_design {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t marked_count;
    const uint32_t *marked_vertices; /* marked_count, for hmf_hierarchy_options */
    const hmf_loop_set *loops;   /* triangle loops of level 0 for hmf_solve on a hierarchy with these marked vertices.
                                    Weights are whole numbers, so that patterns of period 1 match everywhere; 1 is
                                    about 1/44 of the size.  Part of this block: not to be freed on its own */
    double unevenness;           /* of the design on the coarse mesh of the search, see hmf_conformal_scale */
    double unevenness_before;    /* there, of HMF_LOOPS_CUT with weights 1 (genus 0: with first marked vertices) */
    uint64_t solves;             /* of the search; derivatives are counted as well */
} hmf_design;

/*
 * Marked vertices, loops and weights for a mesh of any genus, such that the
 * conformal scale of the harmonic foliation is as even as a search in the given
 * time gets it: stripes and quads are then about equally wide everywhere.
 *
 * At the tip of a limb that no loop goes round the scale decays; there the design
 * marks one vertex or two.  The loops are pants loops (HMF_LOOPS_PANTS) of the
 * surface with its marked vertices, without those whose weight would be 0.
 * With boundary marked vertices are those of `build` or of hmf_suggest_marks; if
 * there are none, none and a pair at the tip of each limb are compared. The
 * weights alone are searched; solve_limit then bounds the rounds.
 *
 *     hmf_even_design       -> design
 *     hmf_hierarchy_create  with design->marked_vertices
 *     hmf_solve             with design->loops
 *
 * Deterministic: the search counts solves, not time.
 * Returns HMF_OK, HMF_CANCELLED, HMF_ERROR_UNSUPPORTED if no loops were found,
 * or an error as hmf_hierarchy_create.  Free with hmf_free.
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
    double tolerance;            /* largest residual_max of the values, default 1e-2 */
    const uint32_t *seam_edges;  /* edges where seams cost nothing, so that they run there if they can; NULL = none */
    uint64_t seam_edge_count;
} hmf_parameterize_options;

/* The defaults, see hmf_control_init. */
HMF_API void hmf_parameterize_options_init(hmf_parameterize_options *options, uint32_t struct_size);

typedef struct hmf_parameterization {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t vertex_count;
    uint64_t edge_count;
    uint64_t triangle_count;
    const double *corner_uv;     /* triangle_count x 3 x 2: (u, v) of each corner */
    const double *transition;    /* edge_count x 3: sign, du, dv; see below */
    const uint8_t *seam;         /* edge_count: 1 where the layout is cut */
    const int32_t *cone;         /* vertex_count: cone angle as a multiple of pi, 2 = regular */
    const double *dilatation;    /* triangle_count: ratio of the singular values of the map, >= 1, negative where the
                                    image is flipped, infinite where it is degenerate (above 1000) */
    const double *differential;  /* triangle_count x 2: quadratic differential, real and imaginary part */
    double dilatation_mean;      /* of its absolute value, weighted by area, without degenerate triangles */
    double dilatation_median;    /* quantiles by area, of all triangles */
    double dilatation_p99;
    uint64_t flipped_triangles;
    uint64_t degenerate_triangles; /* dilatation above 1000, or an image too small to tell */
    uint64_t seam_edge_count;
    double seam_length;          /* in the unit of the positions */
    double area;                 /* of the image: the energy, up to discretization */
    uint64_t linear_iterations;
    double seconds;
    /* What the checks measured; the bounds are below. */
    double energy_ratio;         /* energy of du / energy of the foliation; not 1 where zeros move to vertices */
    double area_error;           /* relative difference of the area of the image and the energy of du */
    double circumference_least;  /* circumference of a cylinder by du / by the foliation, the smallest of all */
    double circumference_most;   /* and the largest */
} hmf_parameterization;

/*
 * The global conformal parameterization of a harmonic foliation ([W] section 5):
 * |du| is the foliation, v its harmonic conjugate.  The surface is cut along
 * short seams through the zeros; in the cut surface every corner has one (u, v).
 *
 *   foliation   harmonic up to options->tolerance
 *
 * Transition of an edge: with (u, v) of a point of the edge in the first of its
 * two triangles (the one with the lower number), the second one has
 *
 *     (u', v') = sign * (u, v) + (du, dv),      sign = +1 or -1,
 *
 * exactly: all are multiples of one power of two below 2^53 of it.  Edges off
 * the seams and on the boundary have (1, 0, 0).  The linear parts are +-1, so (du + i dv)^2 has no
 * seams: it is the holomorphic quadratic differential, given per triangle as the
 * square of d(u + i v) / dz with z = x + i y in the frame of the triangle: x
 * along its side 0, y to the left of it.
 *
 * Zeros in triangles move to a corner, or to a vertex further away where the
 * corners serve other zeros or are too far; so does one of two zeros on a vertex, and
 * one on a marked vertex.  Cone angles are (2 + order) * pi, at vertices, and
 * the sum of (2 - cone) is 4 - 4 * genus.  At a vertex of the
 * boundary it is the angle in the double: 2 where the boundary is straight, and 1
 * at a corner of 90 degrees.
 * A marked vertex that is a pole has the cone angle pi.  Near the zeros u differs
 * from the foliation by that much.  Where the foliation is 0 (limbs that no loop
 * goes round) triangles are degenerate.
 *
 * Checked before it is returned: u is harmonic where the foliation is; the energy of du
 * is between 0.9 and 1.5 times that of the foliation; the circumference of every
 * cylinder is between 0.5 and 2 times that of the foliation, and the sum of height *
 * circumference is the energy of du up to 1e-4, which tests the periods of du on every
 * handle; du and dv are closed in every triangle; the linear solves have converged; the
 * area of the image is the energy of du up to 1e-4.
 *
 * Returns HMF_OK, HMF_CANCELLED, HMF_ERROR_VALUE_NOT_HARMONIC,
 * HMF_ERROR_UNSUPPORTED if the mesh is so coarse that it has no vertex for each
 * zero or that moving them there changes the energy or a cylinder by more, or an error
 * of classes 100, 200, 500.
 */
HMF_API hmf_status hmf_parameterize(const hmf_foliation *foliation, const hmf_parameterize_options *options,
                                    const hmf_control *control, hmf_parameterization **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Scale
 * --------------------------------------------------------------------- */

typedef struct hmf_scale {
    uint64_t triangle_count;     /* of the level */
    const double *log_scale;     /* triangle_count, natural logarithm of |grad u| on each triangle, |du| being the
                                    foliation: by how much a conformal (u, v) stretches there, in the unit of the
                                    values / the unit of the positions.  Not less than the largest - 16.1 */
    double unevenness;           /* its standard deviation over the surface, 0 if the scale is the same everywhere */
} hmf_scale;

/* The conformal scale of any foliation, measured on the values of its level and the
   positions there.  Free with hmf_free.
   Returns HMF_OK, or an error of classes 100, 200. */
HMF_API hmf_status hmf_conformal_scale(const hmf_foliation *foliation, const hmf_control *control, hmf_scale **out,
                                       hmf_error *error);

/* ------------------------------------------------------------------------
 * Leaves, cylinders, quads
 * --------------------------------------------------------------------- */

typedef enum hmf_line_kind {
    HMF_LINE_LEVEL = 1,          /* a closed leaf at a given height of its cylinder */
    HMF_LINE_CRITICAL = 2,       /* a leaf between two zeros */
    HMF_LINE_POINT = 3           /* the leaf through a given point */
} hmf_line_kind;

typedef enum hmf_line_end {
    HMF_END_CLOSED = 0,          /* none: the last point joins the first */
    HMF_END_ZERO = 1,            /* at a zero */
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
    int32_t critical;            /* not 0: all leaves out of zeros */
    double spacing;              /* > 0: level sets, about so far apart, in the unit of the values; 0 = none */
    double length_limit;         /* where a leaf stops, in each direction from where it starts, in the unit of the
                                    positions; 0: none, for conjugate leaves ten times the root of the area of the
                                    surface */
    uint64_t point_count;        /* leaves through points; 0 = none */
    const uint32_t *point_triangles;      /* point_count */
    const double *point_barycentrics;     /* point_count x 3, for the corners of the triangle; not negative, sum 1 */
    int32_t leaves;              /* HMF_LEAVES_* */
    uint32_t reserved;           /* 0 */
} hmf_trace_options;

/* The defaults, see hmf_control_init. */
HMF_API void hmf_trace_options_init(hmf_trace_options *options, uint32_t struct_size);

typedef struct hmf_line {
    int32_t kind;                /* HMF_LINE_* */
    int32_t closed;              /* 1: the last point joins the first, which is not repeated; 0 */
    int32_t begin, end;          /* HMF_END_* */
    uint32_t begin_zero, end_zero; /* which zero, in the list of hmf_singularities; else HMF_NONE */
    uint32_t cylinder;           /* in the list of hmf_cylinders; HMF_NONE for critical leaves, and for all on a surface
                                    with boundary where a part that no leaf crosses holds a boundary and more */
    uint32_t source;             /* number of the point; of the level from the lower side of its cylinder; of the
                                    critical leaf */
    double height;               /* above the lower side of the cylinder, in the unit of the values; 0 for critical
                                    leaves */
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
    const uint32_t *point_edges; /* point_count edges of the level that the points lie on; HMF_NONE for the middle of
                                    a zero in a triangle */
    uint64_t compared_count;     /* pairs of neighboring points that were checked, see below */
    double deviation;            /* largest difference of the values at both points of a pair, in the unit of the
                                    values */
} hmf_lines;

/*
 * Leaves of a foliation as polylines.
 *
 *   options     which leaves; NULL or all 0: the critical ones
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
 * Checked before they are returned, against the values and by the coordinates: both
 * points of a pair lie on sides of one triangle, and on one leaf up to rounding.  Pairs
 * are the ends of closed leaves, and neighbors evenly spread over all lines: about one
 * for 64 edges of the level and one for 128 points, or all if there are fewer.  Each
 * cylinder has as many level sets as stated, all of them closed unless there is a length
 * limit; conjugate ones go from side to side.
 *
 * With boundary the leaves are those of the double, cut at the boundary (level 0):
 * a leaf can give several lines, with the same source, in the order along it;
 * begin_zero, end_zero and cylinder are HMF_NONE, and heights are those in the
 * double.  Where leaves run along the boundary, one of them may go to and fro
 * across it within the residual; parts below 1e-6 of a leaf are left out.
 *
 * The foliation need not be harmonic, but for conjugate leaves, as for
 * hmf_cylinders.
 * Errors: classes 100, 200, 500; of a bad point error->index is its number
 * (HMF_ERROR_OPTIONS).
 */
HMF_API hmf_status hmf_trace(const hmf_foliation *foliation, const hmf_trace_options *options,
                             const hmf_control *control, hmf_lines **out, hmf_error *error);

typedef struct hmf_cylinder {
    uint32_t loop;               /* its loop; HMF_NONE if no loops were given */
    uint32_t reserved;           /* 0 */
    double height;               /* the weight of the loop, rounded to a multiple of hmf_foliation_unit */
    double circumference;        /* of the flat metric du^2 + dv^2, in the unit of the values */
    double modulus;              /* height / circumference */
    double area;                 /* in the flat metric; areas add up to the energy */
} hmf_cylinder;

typedef struct hmf_cylinder_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t count;
    const hmf_cylinder *list;    /* count; the order is that of hmf_line.cylinder */
    const hmf_loop_set *leaves;  /* the leaf in the middle of each as a triangle loop of the level; weights: the
                                    heights.  Part of this block: not to be freed on its own */
    double area_error;           /* relative difference of the sum of height * circumference and the energy, at most
                                    1e-4; with boundary those of the double */
} hmf_cylinder_set;

/*
 * The cylinders of a harmonic foliation: the critical leaves cut the surface
 * into one for each loop, filled with closed leaves of its class.
 *
 *   loops       those that the foliation belongs to, on any level, or NULL: which
 *               loop each cylinder belongs to is not wanted
 *
 * With boundary, on level 0 and with the loops given: an arc has a strip, with the
 * length of a leaf from boundary to boundary as its circumference, and a loop round
 * a boundary the half of its cylinder on the surface; leaves are arcs for strips.
 *
 * Heights are those of the leaves, in integers.  Circumference, modulus and area are those of the minimum;
 * at the minimum energy = sum of height * circumference = sum of areas, which is checked.
 * Loop and cylinder are matched by their free homotopy classes, exactly; with
 * marked vertices that takes two runs like hmf_solve on the coarsest level.
 *
 * Errors: classes 100, 200, 400; HMF_ERROR_VALUE_CLASS if the values do not
 * belong to the loops, HMF_ERROR_VALUE_NOT_HARMONIC if their energy is 1 % above
 * the minimum, and others of class 500.
 */
HMF_API hmf_status hmf_cylinders(const hmf_foliation *foliation, const hmf_loop_set *loops,
                                 const hmf_control *control, hmf_cylinder_set **out, hmf_error *error);

typedef struct hmf_quad_options {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    double edge_length;          /* wished mean length of an edge, in the unit of the positions; default: about as
                                    many quads as triangles / 2 */
    uint64_t count;              /* wished number of quads instead of edge_length; 0 = none */
    int32_t merge;               /* not 0: a critical leaf shorter than half an edge gets no quad, its zeros become one
                                    vertex; others get at least one instead of 2, cylinders at least 2 rows */
    int32_t keep_poles;          /* not 0: a pole stays a vertex with two edges */
    uint64_t relax;              /* steps in which vertices move on the surface, at most 1000; 0 = they stay on their
                                    leaves */
} hmf_quad_options;

/* The defaults, see hmf_control_init. */
HMF_API void hmf_quad_options_init(hmf_quad_options *options, uint32_t struct_size);

typedef struct hmf_quad_mesh {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t vertex_count;
    uint64_t quad_count;
    const double *positions;     /* vertex_count x 3; points of the surface, but see relax */
    const uint32_t *quads;       /* quad_count x 4 vertices, oriented as the triangles */
    uint64_t irregular_count;    /* vertices with another number of edges than 4, on the boundary than 3 */
    uint64_t inverted_count;     /* quads with a corner of 0, or of 180 degrees or more, seen from outside the surface
                                    where they lie: those that are folded over count as well */
    double edge_length;          /* root of the area of the surface / number of quads */
    double area_ratio;           /* area of the quads / area of the surface; far above 1 where quads lie upon others */
    double distance;             /* greatest distance of a vertex of the surface from the quads near it */
} hmf_quad_mesh;

/*
 * A quad mesh along the leaves: a grid on each cylinder, glued along the
 * critical leaves.
 *
 * The first vertices are the zeros, in the order of hmf_singularities; a zero of
 * order m has 2 m + 4 edges, every other vertex has 4.  Zeros that only
 * discretization keeps apart can become one, with the sum of their orders.  A
 * marked vertex with one prong is left out: one quad lies over it, and the two
 * vertices beside it have 3 edges; where a leaf of two columns joins two of them,
 * one quad with four such vertices closes the end.
 * Oriented and manifold by construction, genus as before; no two edges
 * have the same ends.
 * In quad (a, b, c, d) the sides a-d and b-c lie on leaves.  All edges are about
 * equally long in the metric du^2 + dv^2: longer in space where the foliation is
 * thin.  Numbers are rounded so that the grids match, with at least 3 quads
 * across a cylinder and 2 along a critical leaf; fewer with `merge`.
 *
 * With a count the edge length is searched for, then rows are added or taken
 * away; the number of quads is as near as the grids allow, and at least what each
 * cylinder needs.  relax evens out angles and sides, in at most so many sweeps at a
 * time (about 40 do): the sides lie on leaves no longer, but vertices stay on the
 * surface; where a row or column runs along edges sharper than 40 degrees, its
 * vertices move onto them and slide along them from then on, the vertex nearest to a
 * corner of such edges goes there, and where the surface sticks out of the quads by
 * half a side or more, a vertex reaches for its tip.  No step turns a corner over that
 * is not.  Where quads are inverted all the same, the best of several results is
 * returned, unrelaxed as the last resort; inverted_count counts what is left.
 *
 * With boundary (level 0): the boundary of the quads lies on that of the surface,
 * row by row where leaves run along it, and where they meet it column by column.
 * With relax a vertex goes to each corner of the boundary of more than 45 degrees, one
 * with a single quad if it is near, and the others slide along the boundary.  A marked
 * vertex of the boundary with one prong is a corner, and zeros of the boundary are
 * vertices of it: a rectangle becomes a grid.  Closed otherwise.  Triangles at the boundary that no leaf crosses
 * (all of their corners on it, as a rule) may be left out.
 *
 * HMF_ERROR_UNSUPPORTED if a zero goes round a part of the surface that no leaf
 * crosses, or if no numbers of columns match on all cylinders, for edges so long or
 * on a mesh so coarse, or if of 100 relaxed quads and more one in 20 stays inverted,
 * or they have less than 3/4 or more than 4/3 of the area of the surface;
 * HMF_ERROR_OPTIONS if there would be more than 2^28 quads.  Other errors: classes 100, 200, 500.
 */
HMF_API hmf_status hmf_quads(const hmf_foliation *foliation, const hmf_quad_options *options,
                             const hmf_control *control, hmf_quad_mesh **out, hmf_error *error);

/* ------------------------------------------------------------------------
 * Atlas
 * --------------------------------------------------------------------- */

typedef struct hmf_atlas_options {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    double margin;               /* least distance of two charts, as a part of the side of the square, at most 1/16;
                                    half of it is left free along the border; 0 = 1/512 */
} hmf_atlas_options;

/* The defaults, see hmf_control_init. */
HMF_API void hmf_atlas_options_init(hmf_atlas_options *options, uint32_t struct_size);

typedef struct hmf_chart_set {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    uint64_t triangle_count;
    uint64_t chart_count;
    const double *corner_uv;     /* triangle_count x 3 x 2: place of each corner in the unit square */
    const uint32_t *triangle_chart; /* triangle_count: which chart it belongs to */
    double used_area;            /* part of the square that the triangles cover */
    double seam_length;          /* in the unit of the positions, each side between two triangles once */
    uint64_t seam_edge_count;    /* edges whose two triangles do not meet in the square */
    uint64_t collapsed_triangles; /* whose image has no positive area: smaller than a millionth of the square across,
                                    where the foliation is nearly 0 */
    double unevenness;           /* standard deviation over the surface of the logarithm of the scale, which is the root
                                    of (area in the square / area in space); collapsed triangles left out */
    uint64_t speck_count;        /* triangles that the check of overlaps leaves out: those without area in the square,
                                    and those less than a millionth of it across */
    uint64_t compared_edges;     /* edges of charts that the check compared */
} hmf_chart_set;

/*
 * Charts without overlap in the unit square, for painting and baking: every
 * triangle has its own place there.
 *
 *   foliation   harmonic up to a residual_max of 1e-2; with boundary on level 0
 *
 * Each cylinder of the foliation is a rectangle in (u, v) of hmf_parameterize.
 * Rectangles are cut open, joined along critical leaves where that saves seams
 * and room, cut where they fit better so, and packed into the square.  A triangle
 * goes to one chart as a whole, so the edge of a chart is ragged by one triangle.
 * Charts are images of (u, v) under a turn by a multiple of 90 degrees and a scale
 * of their own, with which areas of all charts are in proportion to those in
 * space: conformal as (u, v) is.  Triangles that (u, v) turns over are turned back
 * by moving a vertex, or lie next to a neighbor as they are in space, flatter where
 * there is no room for that; those that overlap another one lie next to a neighbor,
 * too.  What finds no room becomes a chart of its own.  Orientation is that of the triangles.
 *
 * No two triangles have common inner points, but for specks (speck_count), and all others
 * have positive area.  That is checked before the charts are returned, in integers, on a
 * grid of 2^28 units along the root of the area: no two edges of charts cross, and the
 * winding number is 1 on their inner side, 0 on the outer one.
 * Charts are as far apart as the margin along u or along v.  Fewer, larger charts
 * come from even loops and weights: hmf_even_design.  Of a surface with boundary charts
 * are straight where they end at it, and edges of the boundary are no seams.
 *
 * Errors: HMF_ERROR_UNSUPPORTED on coarser levels of a surface with boundary, if the margin is too large for so many
 * charts, or if a chart is 1000 times as long as the square, as triangles nearly without
 * area make it; HMF_ERROR_VALUE_NOT_HARMONIC; classes 100, 200, 500.
 */
HMF_API hmf_status hmf_atlas(const hmf_foliation *foliation, const hmf_atlas_options *options,
                             const hmf_control *control, hmf_chart_set **out, hmf_error *error);

#ifdef __cplusplus
}
#endif

#endif /* HMF_APPLICATIONS_H */
