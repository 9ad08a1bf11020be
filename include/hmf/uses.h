/*
 * hmf/uses.h - what one does with a harmonic measured foliation
 *
 *     hmf_parameterize   (u, v) for each corner, conformal up to discretisation
 *     hmf_trace          leaves as polylines
 *     hmf_cylinders      heights, circumferences, moduli, areas
 *     hmf_quads          a quad mesh along the leaves
 *     hmf_atlas          charts without overlap in the unit square
 *
 * The rules are those of hmf.h.  Every result is one structure with counts and
 * flat arrays in one block, to be freed with hmf_free.  All start from the
 * minimum that hmf_solve found on the intrinsic triangulation.
 */
#ifndef HMF_USES_H
#define HMF_USES_H

#include <hmf/hmf.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------
 * Parameterisation
 * --------------------------------------------------------------------- */

typedef struct hmf_parameterize_options {
    uint32_t struct_size;
    uint32_t reserved;           /* 0 */
    double tolerance;            /* largest residual_max of the values, default 1e-2 */
    const uint32_t *seam_edges;  /* edges where seams cost nothing, so that they run there if they can; NULL = none */
    uint64_t seam_edge_count;
} hmf_parameterize_options;

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
    double area;                 /* of the image: the energy, up to discretisation */
    uint64_t linear_iterations;
    double seconds;
} hmf_parameterization;

/*
 * The global conformal parameterisation of a harmonic foliation ([W] section 5):
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
 * corners serve other zeros: cone angles are (2 + order) * pi, at vertices, and
 * the sum of (2 - cone) is 4 - 4 * genus.  At a vertex of the
 * boundary it is the angle in the double: 2 where the boundary is straight, and 1
 * at a corner of 90 degrees.
 * A marked vertex that is a pole has the cone angle pi.  Near the zeros u differs
 * from the foliation by that much.  Where the foliation is 0 (limbs that no loop
 * goes round) triangles are degenerate.
 *
 * Returns HMF_OK, HMF_CANCELLED, HMF_ERROR_VALUE_NOT_HARMONIC,
 * HMF_ERROR_UNSUPPORTED if the mesh is so coarse that it has no vertex for each
 * zero, or an error of classes 100, 200, 500.
 */
HMF_API hmf_status hmf_parameterize(const hmf_foliation *foliation, const hmf_parameterize_options *options,
                                    const hmf_control *control, hmf_parameterization **out, hmf_error *error);

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
#define HMF_END_BOUNDARY 5       /* at the boundary of the surface */

#define HMF_LEAVES_DEFAULT 0
#define HMF_LEAVES_FOLIATION 1   /* of the foliation itself (default): u is constant */
#define HMF_LEAVES_CONJUGATE 2   /* of its conjugate: v is constant; see hmf_parameterize */

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
    double height;               /* the weight of the loop, exactly */
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
 * Heights are exact.  Circumference, modulus and area are those of the minimum;
 * at the minimum energy = sum of height * circumference = sum of areas.
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
 * discretisation keeps apart can become one, with the sum of their orders.  A
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
 * cylinder needs.  relax evens out angles and sides (about 40 steps do): the sides
 * lie on leaves no longer, but vertices stay on the surface; where a row or column
 * runs along edges sharper than 40 degrees, its vertices move onto them and slide
 * along them from then on, the vertex nearest to a corner of such edges goes there,
 * and where the surface sticks out of the quads by half a side or more, a vertex
 * reaches for its tip.  Only where quads would stay inverted do vertices inside leave the
 * surface.
 *
 * With boundary (level 0): the boundary of the quads lies on that of the surface,
 * row by row where leaves run along it, and where they meet it column by column;
 * its vertices stay when others are relaxed, but before that where a side cuts off a
 * corner of the boundary by a fifth of its length, its nearer end goes there.  A marked
 * vertex of the boundary with one prong is a corner, and zeros of the boundary are
 * vertices of it: a rectangle becomes a grid.  Closed otherwise.  Triangles at the boundary that no leaf crosses
 * (all of their corners on it, as a rule) may be left out.
 *
 * HMF_ERROR_UNSUPPORTED if a zero goes round a part of the surface that no leaf
 * crosses, or if no numbers of columns match on all cylinders, for edges so long or
 * on a mesh so coarse; HMF_ERROR_OPTIONS if there
 * would be more than 2^28 quads.  Other errors: classes 100, 200, 500.
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
 * by moving a vertex, or lie next to a neighbour as they are in space, flatter where
 * there is no room for that; those that overlap another one lie next to a neighbour,
 * too.  What finds no room becomes a chart of its own.  Orientation is that of the triangles.
 *
 * No two triangles of a chart have common inner points, but for collapsed ones:
 * that is checked in integers, on a grid of 2^28 units along the root of the area.
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

#endif /* HMF_USES_H */
