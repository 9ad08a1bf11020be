/// <reference lib="esnext.disposable" />
/**
 * hmf - harmonic measured foliations on closed triangle meshes.
 *
 * Arrays that the library returns are copies that belong to the caller. Arrays that you pass are copied and
 * never changed.  All calls are
 * synchronous: in a page, make them in a Worker (examples/worker.js).  Calls that can take long accept a
 * progress function, which can cancel them.
 */
import type { BuildNumbers, SolveNumbers } from "../dist/options.js";

/**
 * Where hmf.wasm comes from: its address (string or URL), its bytes, a compiled
 * WebAssembly.Module, or a Response of fetch.  (Not by their names: projects for
 * Node have no types of the browser.)
 */
export type Source = string | object;

/**
 * Loads the library.  Without a source it takes the hmf.wasm of the package,
 * by `fetch` in a browser and from the file system in Node.  Each call makes
 * an instance with a memory of its own.
 */
export function load(source?: Source | Promise<Source>): Promise<Hmf>;

/** Float64Array, Float32Array, Uint32Array, Uint16Array or another typed array of numbers, or an ordinary array. */
export type Numbers = ArrayLike<number>;

export interface Hmf {
    /** "major.minor.patch" */
    readonly version: string;
    readonly Hierarchy: new (positions: Numbers, triangles: Numbers, options?: HierarchyOptions) => Hierarchy;
    /** Upper bound of the bytes that building a hierarchy uses at its peak; 0 if the counts are unusable. */
    memoryEstimate(vertexCount: number, triangleCount: number, options?: BuildOptions): number;
    /** The connected components of a mesh, each with numbers of its own.  A defect of one is its status, not an error. */
    components(positions: Numbers, triangles: Numbers, options?: BuildOptions): Components;
    /**
     * One foliation over all components of a mesh: each is built and solved on its own. Errors of a component
     * or its loops are in its row.
     */
    solveComponents(positions: Numbers, triangles: Numbers, options?: SolveComponentsOptions): ComponentSolutions;
    /**
     * Chooses marked vertices for a mesh of genus 0: two at the tip of each limb (a protrusion), so that
     * loops can go around it, 4 to 24 in all. None for genus 1 and more. Each of several components gets its
     * own.
     */
    suggestMarks(positions: Numbers, triangles: Numbers, options?: BuildOptions): Uint32Array;
    /**
     * Chooses marked vertices, loops and weights with a nearly constant scale, so that stripes and quads have
     * nearly equal width: for `new Hierarchy(.., { markedVertices })` and `solve({ loops })`.
     */
    evenDesign(positions: Numbers, triangles: Numbers, options?: DesignOptions): Design;
    /** A short English text for any status. */
    statusText(status: number): string;
    /** "HMF_ERROR_MESH_BOUNDARY" and so on, as in hmf.h. */
    statusName(status: number): string;
    /** Bytes that hierarchies, foliations and running calls use, and the size of the WebAssembly memory, which never shrinks. */
    readonly memory: { readonly inUse: number; readonly size: number };
}

/** As for a hierarchy (also as `build` in C); its marked vertices become part of the design. */
export interface DesignOptions extends BuildOptions {
    /** Marks no other vertices, if possible. */
    noPoles?: boolean;
    /** Budget of the search in solves of a coarse mesh; default: about ten solves of the whole mesh. */
    solveLimit?: number;
}

export interface Design {
    markedVertices: Uint32Array;
    /** With weights, to solve for on a hierarchy with these marked vertices. */
    loops: LoopSet;
    /** On the coarse mesh of the search. */
    unevenness: number;
    /** The same, of default loops with weights 1. */
    unevennessBefore: number;
    solves: number;
}

/**
 * Answer of a callback: nothing or "continue"; "cancel" ends the call; "finish" ends a solve with the best
 * foliation so far, carried to the requested level. Calls other than `solve` and `relax` treat it as
 * "cancel".
 */
export type ProgressAnswer = void | "continue" | "cancel" | "finish";

/**
 * Called during the call with a fraction that rises from 0 to 1.  An exception
 * ends the call and is thrown from it.  It must not use the same hierarchy.
 */
export type Progress = (fraction: number) => ProgressAnswer;

export interface ProgressOptions {
    progress?: Progress;
}

/** The numbers, among them `ratio`, `coarsest`, `memoryLimit` and `mollify`, are those of the header. */
export interface BuildOptions extends ProgressOptions, BuildNumbers {
    /** Which edges are collapsed, and to which point; default "midpoint". */
    collapse?: "default" | "midpoint" | "endpoint" | "qslim";
    /**
     * Vertices that may be poles; a sphere needs at least four. They never move, and the report does not
     * count them as poles. By default spheres and disks get those of `suggestMarks`; "suggest" requests them
     * for any mesh; `[]`: none.
     */
    markedVertices?: Numbers | "suggest";
}

export interface WarnOptions {
    /** Called with a sentence about what looks wrong: small holes, vertices without a triangle. Default: `console.warn`. */
    warn?: (sentence: string) => void;
}

export interface HierarchyOptions extends BuildOptions, WarnOptions {
    /** Refuse a mesh with a boundary, with "HMF_ERROR_MESH_BOUNDARY". */
    closed?: boolean;
}

/** One component of a mesh, with numbers of its own. */
export interface Component {
    /** 0; HMF_ERROR_MESH_GENUS if it carries no foliation; otherwise its defect. */
    readonly status: number;
    readonly statusName: string;
    /** What the defect is about, by its number in the whole mesh. */
    readonly element: "vertex" | "edge" | "triangle" | "loop" | "level" | "option" | null;
    readonly index: number;
    /** 0 if the status is a defect, like `boundaryCount`. */
    readonly genus: number;
    readonly boundaryCount: number;
    /** For `new Hierarchy`, like the next two. */
    readonly positions: Float64Array;
    readonly triangles: Uint32Array;
    readonly markedVertices: Uint32Array;
    /** Number in the whole mesh of each vertex. */
    readonly wholeVertices: Uint32Array;
    /** Number in the whole mesh of each edge of level 0. */
    readonly wholeEdges: Uint32Array;
    /** Number in the whole mesh of each triangle. */
    readonly wholeTriangles: Uint32Array;
}

export interface Components {
    /** In the order of their first triangles. */
    readonly components: Component[];
    /** Of the whole mesh. */
    readonly edgeCount: number;
    /** Component of each vertex of the whole mesh; 2^32 - 1: it has no triangle. */
    readonly vertexComponent: Uint32Array;
    /** Its number there. */
    readonly vertexPart: Uint32Array;
    /** Component of each triangle. */
    readonly triangleComponent: Uint32Array;
    /** Its number there. */
    readonly trianglePart: Uint32Array;
}

/** Loops lie on level 0 of the whole mesh; a component without loops gets no foliation. By default the library chooses loops. */
export interface SolveComponentsOptions extends BuildOptions, WarnOptions, Omit<SolveOptions, "start" | "stopLevel"> {}

export interface ComponentSolution extends Component {
    /** Why there is no report, or why the solve stopped early; otherwise empty. */
    readonly message: string;
    readonly report: Report | null;
}

export interface ComponentSolutions {
    /** One for each edge of the whole mesh; 0 on components without a foliation. */
    readonly values: Float64Array;
    readonly components: ComponentSolution[];
}

/**
 * A connected, oriented triangle mesh with its coarser levels; a sphere with four
 * or more marked vertices, a disk with four on its boundary or two inside.  It may
 * be used for any number of solves.
 *
 * It and its foliations hold memory of WebAssembly until `dispose()`; `using`
 * works as well.  A hierarchy that is forgotten is freed at some later time.
 */
export interface Hierarchy extends Disposable {
    readonly genus: number;
    /** Number of boundary curves. */
    readonly boundaryCount: number;
    /** The vertices of each boundary curve, in their order along it. */
    boundaries(): Uint32Array[];
    /** The marked vertices that were given or suggested. */
    readonly markedVertices: Uint32Array;
    /**
     * Unused vertices are dropped and the others renumbered; these are the original numbers of the others.
     * null: none was dropped.
     */
    readonly keptVertices: Uint32Array | null;
    /** What `warn` was called with. */
    readonly warnings: readonly string[];
    /** Level 0 is the mesh of the caller, higher levels are coarser. */
    readonly levels: readonly Level[];
    readonly memoryBytes: number;
    readonly disposed: boolean;

    /** Chooses loops; default: a cut system on the coarsest level. */
    loops(options?: LoopsOptions): LoopSet;
    /** A basis of the harmonic 1-forms of a closed surface, and its period matrix; default: on level 0. */
    harmonicForms(options?: ProgressOptions & { level?: number }): HarmonicForms;
    /**
     * Loops through picked vertices or points, for each loop at least three, in order and on all sides of what it goes
     * around: the shortest path along edges to each next one, and back.  Of a point the next vertex is taken.
     */
    loopsThrough(picked: readonly (Numbers | readonly Numbers[])[], options?: PickOptions): LoopSet;
    /** The closed initial foliation of loops on their level; default: "cut". */
    initialize(loops?: LoopSet | LoopsKind | "even", options?: ProgressOptions): Foliation;
    /**
     * The harmonic foliation in the class of the loops.  Limits do not throw: see `report.status`.
     * `stopLevel` is the finest level to solve; negative ones are counted from the coarsest, so that -1 gives a preview:
     * the energy and the values of the coarsest level.
     */
    solve(options?: SolveOptions): Foliation;
    /**
     * A foliation of values, one for each edge of a level (default 0): results of
     * the library, perhaps from a file with 17 digits.
     */
    foliation(values: Numbers, options?: number | FoliationOptions): Foliation;

    /** Frees the memory, also of all its foliations; calling it again does nothing. */
    dispose(): void;
}

export interface PickOptions {
    /** Points further from the surface are refused, in the unit of the positions; default a tenth of the diagonal of its box. */
    within?: number;
    /** As those of a LoopSet. */
    weights?: Numbers;
}

export interface LoopsOptions extends ProgressOptions {
    kind?: LoopsKind;
    /** Default 0, your mesh; the search is fastest on the coarsest. */
    level?: number;
}

export interface FoliationOptions extends ProgressOptions {
    level?: number;
}

export interface Level {
    readonly index: number;
    readonly vertexCount: number;
    readonly edgeCount: number;
    readonly triangleCount: number;
    /** Edges whose weight was below the lower bound and was set to it. */
    readonly raisedCount: number;
    /** Two vertices for each edge.  Level 0 numbers edges by their first appearance in the triangles. */
    edgeVertices(): Uint32Array;
    /** Three edges for each triangle; side s joins the corners s and s + 1. */
    triangleEdges(): Uint32Array;
    /** Three vertices for each triangle. */
    triangleVertices(): Uint32Array;
    /** Half the sum of the two opposite cotangents, for each edge. */
    weights(): Float64Array;
    /** Three coordinates for each vertex. */
    positions(): Float64Array;
}

/**
 * "cut": genus loops that together cut the surface into one planar piece; on a sphere around pairs of marked
 * vertices;
 * "handle", "tunnel": the same, and each loop bounds a surface inside or outside the solid, which must not
 * intersect itself; "pants": 3 genus - 3 + marked vertices loops (genus 1
 * without those: one) that cut it into pairs of pants.
 */
export type LoopsKind = "cut" | "handle" | "tunnel" | "pants";

/** Disjoint closed curves on a level. */
export interface LoopSet {
    /** Neighboring triangles, or vertices joined by edges; the last and the first as well. */
    elementKind: "triangles" | "vertices";
    /** Of the elements; default 0, the mesh of the caller. */
    level?: number;
    loops: Numbers[];
    /** Positive, one for each loop; default all 1. */
    weights?: Numbers;
    /** One for each loop, with boundary: not 0 for an arc from boundary to boundary; default none. */
    arcs?: Numbers;
    /**
     * Two for each loop, for arcs of triangles: the side of the first triangle, 0 to 2, where the arc begins, and that of
     * the last one where it ends; 0xffffffff and default: the first side on the boundary.
     */
    arcSides?: Numbers;
}

/** The numbers, among them `tolerance`, `energyTolerance`, `timeLimit` and `iterationLimit`, are those of the header. */
export interface OptimizeOptions extends ProgressOptions, Omit<SolveNumbers, "stopLevel"> {
    /** Default "newton", the most exact. */
    method?: "default" | "newton" | "whitehead" | "single-level" | "paper";
}

export interface SolveOptions extends OptimizeOptions, Pick<SolveNumbers, "stopLevel"> {
    /**
     * Loops, or a kind of them; "even": those of `evenDesign` for the marked vertices
     * of the hierarchy, with their weights.  Default "cut".
     */
    loops?: LoopSet | LoopsKind | "even";
    /**
     * A foliation to start from, whose class is then that of the result, instead
     * of loops: of this hierarchy, or on level 0 of one with the same triangles at other positions (the
     * previous frame of an animation).  All levels are solved, so that it takes as long as from loops; to go on from
     * values near the minimum, `hierarchy.foliation(previous.values).relax()` takes 0.4 to 0.8 of that.
     */
    start?: Foliation;
}

/**
 * One value for each edge of a level: the distance of its ends in a tree.
 *
 * It holds memory of WebAssembly until `dispose()`, or until its hierarchy is
 * disposed of.  `values` and `report` stay.
 */
export interface Foliation extends Disposable {
    readonly hierarchy: Hierarchy;
    readonly level: number;
    readonly values: Float64Array;
    /** The power of two that all values are multiples of. */
    readonly unit: number;
    /** Bytes held by the foliation, without its hierarchy; grows once, at the first `parameterize`, `quads` or `trace`. */
    readonly memoryBytes: number;
    /** Report of the call that made it; null for `initialize`, `foliation` and `interpolate`. */
    readonly report: Report | null;
    readonly disposed: boolean;
    /** The loops of the solve, with their weights, those of the library on level 0; null if the values came without loops. */
    readonly loops: LoopSet | null;
    /** Carried exactly to any other level, finer or coarser. */
    interpolate(level: number, options?: ProgressOptions): Foliation;
    /**
     * Solves on the level of this foliation alone, starting from it; returns a new foliation.  For values near the minimum,
     * such as those of a mesh before it was deformed; `solve({ start })` is for a start that is far from it.
     */
    relax(options?: OptimizeOptions): Foliation;
    /** Dirichlet energy. */
    energy(options?: ProgressOptions): number;
    /** Violation of harmonicity at each vertex; if all are 0, this is the unique minimum. */
    residuals(options?: ProgressOptions): Float64Array;
    /** Natural logarithm of the length of the gradient on each triangle: the local scale of a conformal (u, v). */
    conformalScale(options?: ProgressOptions): Float64Array;
    /** Standard deviation of `conformalScale` over the surface; 0: the same scale everywhere. */
    unevenness(options?: ProgressOptions): number;
    singularities(options?: ProgressOptions): Singularities;
    /** A global conformal parameterization (u, v) with |du| the foliation; the foliation must be harmonic up to the tolerance. */
    parameterize(options?: ParameterizeOptions): Parameterization;
    /** Leaves as polylines; without options those between zeros. */
    trace(options?: TraceOptions): Lines;
    /**
     * The critical leaves cut the surface into one cylinder for each loop,
     * filled with closed leaves of its class.  Each cylinder names its loop.
     */
    cylinders(options?: CylinderOptions): Cylinders;
    /** A closed quad mesh along the leaves. */
    quads(options?: QuadOptions): QuadMesh;
    /** Charts without overlap in the unit square, for painting and baking.  `evenDesign` gives fewer and larger ones. */
    atlas(options?: AtlasOptions): Atlas;
    /** Frees the memory; calling it again does nothing. */
    dispose(): void;
}

export interface CylinderOptions extends ProgressOptions {
    /** Those that the foliation belongs to, on any level; default: its `loops`; null: none. */
    loops?: LoopSet | null;
}

export interface QuadOptions extends ProgressOptions {
    /** Target for the mean edge length, in the unit of the positions; default: about half as many quads as triangles. */
    edgeLength?: number;
    /** Target number of quads instead; met as closely as the grids allow. */
    count?: number;
    /** A critical leaf shorter than half an edge gets no quad, and its zeros become one vertex. */
    merge?: boolean;
    /** A pole stays a vertex with two edges; else one quad lies over it, between two vertices with 3. */
    keepPoles?: boolean;
    /** Rounds that move vertices on the surface to improve angles and sides; default: none. */
    relax?: number;
}

/**
 * The first vertices are the zeros, in the order of `singularities()`; a zero of
 * order m has 2 m + 4 edges, every other vertex has 4.  Zeros that only
 * discretization keeps apart can become one, with the sum of their orders.
 */
export interface QuadMesh {
    /** Three coordinates for each vertex. */
    positions: Float64Array;
    /** Four vertices a, b, c, d for each quad; the sides a-d and b-c lie on leaves. */
    quads: Uint32Array;
    /** Vertices that do not have 4 edges. */
    irregularCount: number;
    /** Quads with a corner of 0, or of 180 degrees or more, seen from outside the surface where they lie. */
    invertedCount: number;
    /** Square root of (area of the surface / number of quads). */
    edgeLength: number;
    /** Area of the quads / area of the surface. */
    areaRatio: number;
    /** Greatest distance of a vertex of the surface from the quads near it. */
    distance: number;
}

export interface AtlasOptions extends ProgressOptions {
    /** Least distance of two charts, as a fraction of the side of the square, at most 1/16; default 1/512. */
    margin?: number;
}

/** Every triangle belongs to one chart; charts are conformal, with areas proportional to areas on the surface. */
export interface Atlas {
    /** Two coordinates for each corner of each triangle. */
    cornerUv: Float64Array;
    /** The chart of each triangle. */
    triangleChart: Uint32Array;
    chartCount: number;
    /** Part of the square that the triangles cover. */
    usedArea: number;
    /** In the unit of the positions, each side between two triangles once. */
    seamLength: number;
    /** Edges whose two triangles do not meet in the square. */
    seamEdgeCount: number;
    /** Triangles whose image has no positive area, where the foliation is nearly 0. */
    collapsedCount: number;
    /** Standard deviation over the surface of the logarithm of the scale. */
    unevenness: number;
    /** Triangles that the check of overlaps leaves out: those without area in the square, and those less than a millionth of it across. */
    speckCount: number;
    /** Edges of charts that the check compared. */
    comparedCount: number;
}

export interface Cylinders {
    /** In the order of `Line.cylinder`. */
    list: Cylinder[];
    /** The leaf in the middle of each, as a loop of triangles of the level; weights: the heights. */
    leaves: LoopSet;
    /** Relative difference of the sum of height * circumference and the energy. */
    areaError: number;
    /** From the point opposite to the base of the first side to the base of the second side, along the leaves, with the second side on the right; in [0, circumference). NaN where there is none. */
    twists: Float64Array;
    /** Corners of side s (0 or 1) of cylinder k: from entry 2 k + s to the next entry, the base first. */
    cornerOffsets: BigUint64Array;
    /** For each corner the vertex of its zero, or the vertex of the triangle with the zero that lies ahead of the zero inside the cylinder. The base is the corner with the lowest one. */
    cornerVertices: Uint32Array;
    /** For each corner its distance from the base of the first side, in [0, circumference). For other bases subtract their places. */
    cornerPlaces: Float64Array;
}

/** In the flat metric du^2 + dv^2. */
export interface Cylinder {
    /** Which of the loops; null without. */
    loop: number | null;
    /** The weight of the loop, exactly. */
    height: number;
    circumference: number;
    /** height / circumference */
    modulus: number;
    /** All areas add up to the energy. */
    area: number;
}

export interface ParameterizeOptions extends ProgressOptions {
    /** Largest residual of the foliation; default 1e-2. */
    tolerance?: number;
    /** Edges where seams cost nothing, so that they run there if they can. */
    seamEdges?: Numbers;
}

/**
 * A basis of the harmonic 1-forms of a closed surface: n = 2 genus forms a[0], a[1], ..., then b[0], b[1], ...
 * In each triangle the three numbers of a form add up to exactly 0, along a closed path of edges they add up to an
 * integer. Matrices are stored by rows: entry (i, j) of an n x n matrix is at n * i + j.
 */
export interface HarmonicForms {
    level: number;
    genus: number;
    formCount: number;
    edgeCount: number;
    /** formCount x edgeCount: the integral of each form along each edge, from its first vertex to its second. */
    values: Float64Array;
    /** n x n: the integral of form i ^ form j over the surface: 1 for a[k], b[k], -1 for b[k], a[k], else 0. */
    intersections: Int32Array;
    /** n x n: symmetric and positive definite. */
    innerProducts: Float64Array;
    /** n x n: the conjugate of form j is the sum over i of entry (i, j) times form i, up to discretization. */
    conjugation: Float64Array;
    /** genus x genus: real part of the period matrix, symmetric. */
    periodReal: Float64Array;
    /** genus x genus: imaginary part of the period matrix, symmetric and positive definite. */
    periodImaginary: Float64Array;
    /** Largest divergence at the vertices, relative to the fluxes; at most 1e-8. */
    residual: number;
    /** Largest absolute entry of conjugation^2 + identity. */
    conjugationError: number;
}

/**
 * The surface is cut along short seams through the zeros; in the cut surface
 * every corner has one (u, v).  Of a point of an edge, (u, v) in the second of
 * its triangles (the one with the higher number) is exactly
 * sign * (u, v) + (du, dv) of the first.
 */
export interface Parameterization {
    /** u and v of each corner: six numbers for each triangle. */
    cornerUv: Float64Array;
    /** sign (1 or -1), du and dv of each edge; 1, 0, 0 off the seams. */
    transition: Float64Array;
    /** 1 for each edge where the layout is cut. */
    seam: Uint8Array;
    /** Cone angle of each vertex as a multiple of pi; 2 = regular. */
    cone: Int32Array;
    /** Ratio of the singular values of the map of each triangle: at least 1, negative where the image is flipped, infinite where it is degenerate. */
    dilatation: Float64Array;
    /** Real and imaginary part of the quadratic differential of each triangle, in the frame with x along its side 0 and y to the left. */
    differential: Float64Array;
    /** Of the absolute value, weighted by area, without degenerate triangles. */
    dilatationMean: number;
    dilatationMedian: number;
    dilatationP99: number;
    flippedCount: number;
    degenerateCount: number;
    seamEdgeCount: number;
    /** In the unit of the positions. */
    seamLength: number;
    /** Of the image: the energy, up to discretization. */
    area: number;
    linearIterations: number;
    seconds: number;
    /** Energy of du / energy of the foliation; not 1 where zeros move to vertices. */
    energyRatio: number;
    /** Relative difference of the area of the image and the energy of du. */
    areaError: number;
    /** Circumference of a cylinder by du / by the foliation, the smallest of all. */
    circumferenceLeast: number;
    /** And the largest. */
    circumferenceMost: number;
}

/** Leaves, and what their check measured. */
export interface Lines extends Array<Line> {
    /** Pairs of points that were checked: whether both lie on one leaf. */
    comparedCount: number;
    /** Largest difference of the values at both points of a pair. */
    deviation: number;
}

export interface TraceOptions extends ProgressOptions {
    /** "foliation" (default): u is constant; "conjugate": v is constant, for harmonic foliations only. */
    leaves?: "default" | "foliation" | "conjugate";
    /** All leaves out of zeros. */
    critical?: boolean;
    /** Level sets, about so far apart, in the unit of the values. */
    spacing?: number;
    /**
     * Where a leaf stops, in each direction from where it starts, in the unit of
     * the positions; default 0: no limit, and for conjugate leaves ten times the
     * root of the area of the surface.
     */
    lengthLimit?: number;
    /** Leaves through points: a triangle each, and three barycentric coordinates that add up to 1. */
    through?: { triangles: Numbers; barycentrics: Numbers };
}

/** A leaf.  Consecutive points lie in one triangle; no two leaves cross. */
export interface Line {
    /** A closed leaf at a height of its cylinder, a leaf between two zeros, the leaf through a given point. */
    kind: "level" | "critical" | "point";
    /** The last point joins the first, which is not repeated. */
    closed: boolean;
    /** How it begins and ends: "critical" on a critical leaf, where the cylinder of a conjugate line ends; "nowhere" if the given point lies where the foliation is 0; "boundary" on the boundary of the surface. */
    begin: "closed" | "zero" | "limit" | "nowhere" | "critical" | "boundary";
    end: "closed" | "zero" | "limit" | "nowhere" | "critical" | "boundary";
    /** Which zero, in the list of `singularities()`. */
    beginZero: number | null;
    endZero: number | null;
    cylinder: number | null;
    /** Number of the point; of the level from the lower side of its cylinder; of the critical leaf. */
    source: number;
    /** Above the lower side of the cylinder, in the unit of the values. */
    height: number;
    /** In the unit of the positions. */
    length: number;
    /** Three coordinates for each point. */
    points: Float64Array;
    /** The edge that each point lies on; 0xffffffff for the middle of a zero in a triangle. */
    edges: Uint32Array;
}

export interface Singularities {
    /** Vertices and clusters, then triangles, each by number; then the marked vertices that are no zeros. */
    list: Singularity[];
    /** Index of each vertex; of a cluster at its lowest vertex. */
    vertexIndex: Int32Array;
    /** 0 or -1 for each triangle. */
    triangleIndex: Int32Array;
    /** Lowest vertex of the cluster of each vertex. */
    vertexCluster: Uint32Array;
}

export interface Singularity {
    /** cluster: vertices joined by edges of value 0. */
    kind: "vertex" | "triangle" | "cluster";
    /** Below 0: a zero of order -index; above 0: a pole; 0: a marked vertex that is no zero. */
    index: number;
    /** The vertex, the triangle, or the lowest vertex of the cluster. */
    element: number;
    /** Vertices of a cluster, else 1. */
    size: number;
    /** Three coordinates: of the vertex; the middle of the triangle; the mean of the cluster, with boundary its vertex nearest to that. */
    position: number[];
}

export interface Report {
    /** "HMF_OK", or why the optimization ended early: "HMF_LIMIT_ITERATIONS", "HMF_LIMIT_TIME", "HMF_LIMIT_STALLED", "HMF_LIMIT_CLASS" (no step that stays in the class of the loops reaches the minimum), "HMF_CANCELLED". */
    status: string;
    /** Where it ended early, more about it as in HmfError: for "HMF_LIMIT_CLASS" a loop that the others lose.  Else null. */
    stopped: Pick<HmfError, "element" | "index" | "advice"> | null;
    method: string;
    converged: boolean;
    energy: number;
    /** Largest of `residuals()`, on the intrinsic Delaunay triangulation; negative: not evaluated, as the call was cancelled before. */
    residualMax: number;
    residualMean: number;
    poles: number;
    /** Counted with their orders: 4 * genus - 4 + marked vertices; with boundary those of the surface. */
    zeros: number;
    /** 4 - 4 * genus - marked vertices; with boundary the sum over the surface. */
    indexSum: number;
    /** Closed curves that the boundary of the surface consists of. */
    boundaries: number;
    badFlips: number;
    badFlipsLeft: number;
    solveSeconds: number;
    /** Of the call, without the hierarchy. */
    peakMemoryBytes: number;
    /**
     * Do the values belong to the loops?  "proven", exactly: one cylinder of closed
     * leaves for each loop, as high as its weight, and freely homotopic to it;
     * "lost": never with "HMF_OK"; "unknown": not checked, as in
     * `relax`, cancelled, or a start with values that no loops have.
     */
    classState: "unknown" | "proven" | "lost";
    /** Levels that were solved once more, as the first result had left the class. */
    classRepeats: number;
    /** For the certificate, part of `solveSeconds`. */
    classSeconds: number;
    /** Finest first. */
    levels: LevelReport[];
    /** In order of time. */
    history: HistoryEntry[];
}

export interface LevelReport {
    vertexCount: number;
    edgeCount: number;
    /** Edges with a raised weight. */
    raisedCount: number;
    sweepCount: number;
    linearSolveCount: number;
    optimizeSeconds: number;
    interpolateSeconds: number;
}

export interface HistoryEntry {
    seconds: number;
    energy: number;
    /** null: not evaluated. */
    residualMax: number | null;
    level: number;
    kind: "interpolation" | "sweep" | "linear-solve";
}

/** A refusal of the library.  Arguments of a wrong type or length are TypeErrors instead. */
export class HmfError extends Error {
    readonly name: "HmfError";
    /** The value of hmf.h. */
    readonly status: number;
    /** "HMF_ERROR_MESH_BOUNDARY" and so on. */
    readonly statusName: string;
    /** What the error is about, or null. */
    readonly element: "vertex" | "edge" | "triangle" | "loop" | "level" | "option" | null;
    /** Of the element; without one, of what the advice names (a point of `trace`, say), else 0. */
    readonly index: number;
    /** What is wrong and what to do. */
    readonly advice: string;
}
