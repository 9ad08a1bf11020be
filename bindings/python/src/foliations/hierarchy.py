"""The hierarchy of a mesh, its levels, and solving on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import (
    Floats,
    Indices,
    ProgressOption,
    as_count,
    as_floats,
    as_indices,
    as_positions,
    call,
    constant,
    frozen,
    part,
    pointer,
    progress_callback,
    run,
    structure,
    view,
)
from ._native import ffi, lib
from ._options import RelaxOptions, SolveOptions, solve_options, takes
from .errors import Element, MeshError, MeshWarning, Status, warn
from .foliation import STOPPED, Foliation, solved
from .forms import harmonic_forms
from .loops import Loops, loop_structure
from .meshes import MeshLike, as_mesh
from .report import boundary_words

if TYPE_CHECKING:
    from typing_extensions import Unpack

Collapse = Literal["midpoint", "endpoint", "qslim"]
#: Loops that the library makes on a mesh with its marked vertices.
LoopsKind = Literal["cut", "handle", "tunnel", "pants"]
#: What a solve takes for its loops.
LoopsLike = Union[Loops, Sequence[ArrayLike], Literal["cut", "handle", "tunnel", "pants", "even"], None]
#: Vertices, "suggest" (those of :func:`suggest_marks`), or None: suggested on spheres and disks, else none.
MarksLike = Union[Sequence[int], NDArray[Any], Literal["suggest"], None]
_FEW_EDGES = 4  # a boundary of so many is rarely meant
_SHORT_BOUNDARY = 0.01  # of the diagonal of the box

# Share of the build in the progress of foliations.solve, about its share of the time.
_BUILD_SHARE = 0.25
# And of the design, where there is one.
_DESIGN_SHARE = 0.8


def _build_options(collapse: Collapse | None = None, marked_vertices: Indices | None = None, **others: Any) -> Any:
    """hmf_hierarchy_options; the caller keeps the marked vertices alive."""
    if marked_vertices is not None and len(marked_vertices):
        others.update(marked_vertices=pointer(marked_vertices, "uint32_t *"), marked_count=len(marked_vertices))
    return structure("hmf_hierarchy_options", collapse=constant("COLLAPSE", collapse, "collapse"), **others)


def _marks(vertices: Sequence[int] | NDArray[Any]) -> Indices:
    """A copy of our own, read-only."""
    return frozen(as_indices(vertices, "marked_vertices").copy())


def _mesh(positions: Any, triangles: ArrayLike | None) -> tuple[Floats, Indices]:
    if triangles is None:
        return as_mesh(positions)
    return as_positions(positions), as_indices(triangles, "triangles", 3)


def _arrays(points: Floats, corners: Indices) -> tuple[Any, ...]:
    """The arguments that a function of the library begins with that takes a mesh; for the stride: _stride."""
    return pointer(points, "double *"), len(points), pointer(corners, "uint32_t *"), len(corners)


def _stride(points: Floats) -> int | None:
    return points.strides[0] if len(points) > 1 else None


def _without_unused(points: Floats, corners: Indices) -> tuple[Floats, Indices, Indices]:
    """The mesh without vertices that no triangle has, and the numbers that the others had."""
    kept, numbers = np.unique(corners, return_inverse=True)
    return np.ascontiguousarray(points[kept]), numbers.reshape(corners.shape).astype(np.uint32), kept.astype(np.uint32)


def _take(
    component: Literal["largest"] | int, points: Floats, corners: Indices, marks: MarksLike
) -> tuple[Floats, Indices, MarksLike, Indices | None]:
    """One component of a mesh, the marked vertices on it, and the numbers that its vertices had; None: the same."""
    from .components import Components

    if isinstance(component, str) and component != "largest":
        raise ValueError(f'component is {component!r}; give "largest", or a number.')
    given = not (marks is None or isinstance(marks, str))
    parts = Components(points, corners, marked_vertices=_marks(marks) if given else None)  # type: ignore[arg-type]
    number = int(np.bincount(parts.triangle_component).argmax()) if component == "largest" else int(component)
    if not 0 <= number < len(parts):
        raise ValueError(f"component is {component}; the mesh has {len(parts)}, counted from 0.")
    part = parts[number]
    kept = frozen(part.whole_vertices.copy()) if len(part.whole_vertices) < len(points) else None
    return part.positions, part.triangles, part.marked_vertices if given else marks, kept


def _is_unused(error: MeshError) -> bool:
    return error.status == Status.ERROR_MESH_UNUSED_VERTEX


class Level:
    """One level of a hierarchy; made by :attr:`Hierarchy.levels`.

    Level 0 is your mesh.  Its edges are numbered by their first appearance in
    the triangle array (sides 0-1, 1-2, 2-0 of triangle 0, then of triangle 1,
    and so on).  Arrays are made when first asked for, kept, and read-only.
    """

    # functools.cached_property would hold one lock for all objects before
    # Python 3.12; here two threads may both make an array, and one is kept.

    def __init__(self, hierarchy: Hierarchy, number: int) -> None:
        info = lib.hmf_hierarchy_describe(hierarchy._pointer).levels[number]
        # Not the Python object, which holds its levels: a cycle would keep the memory.
        self._pointer = hierarchy._pointer
        self._arrays: dict[str, NDArray[Any]] = {}
        self.number = number
        self.vertex_count = int(info.vertex_count)
        self.edge_count = int(info.edge_count)
        self.triangle_count = int(info.triangle_count)
        #: Edges whose weight was below the floor and was raised to it.
        self.raised_count = int(info.raised_count)

    def _array(self, name: str) -> NDArray[Any]:
        if not self._arrays:
            mesh = call(lib.hmf_level, self._pointer, self.number)
            self._arrays = {
                "positions": view(mesh, mesh.positions, self.vertex_count, 3),
                "edge_vertices": view(mesh, mesh.edge_vertices, self.edge_count, 2),
                "triangle_vertices": view(mesh, mesh.triangle_vertices, self.triangle_count, 3),
                "triangle_edges": view(mesh, mesh.triangle_edges, self.triangle_count, 3),
                "weights": view(mesh, mesh.weights, self.edge_count),
            }
        return self._arrays[name]

    @property
    def positions(self) -> Floats:
        """(vertex_count, 3) float64, in the unit of the input."""
        return self._array("positions")

    @property
    def edges(self) -> Indices:
        """(edge_count, 2) uint32: the vertices of each edge.  On coarse levels two vertices may have several edges."""
        return self._array("edge_vertices")

    @property
    def triangles(self) -> Indices:
        """(triangle_count, 3) uint32: the vertices of each triangle."""
        return self._array("triangle_vertices")

    @property
    def triangle_edges(self) -> Indices:
        """(triangle_count, 3) uint32: side s of a triangle joins its corners s and s + 1."""
        return self._array("triangle_edges")

    @property
    def weights(self) -> Floats:
        """(edge_count,) float64: half the sum of the two opposite cotangents, without unit.

        On level 0 those of your triangulation, which may be negative; the
        solver uses the intrinsic Delaunay triangulation instead.
        """
        return self._array("weights")

    def __repr__(self) -> str:
        counts = f"{self.vertex_count} vertices, {self.edge_count} edges, {self.triangle_count} triangles"
        return f"<level {self.number}: {counts}>"


class Hierarchy:
    """An immutable hierarchy of triangle meshes over yours; any number of threads may use it.

    Parameters
    ----------
    positions : (n, 3) floats, or a mesh
        A file name or a mesh object (:func:`foliations.as_mesh`) needs no ``triangles``.
        Otherwise coordinates in any unit.  float64 with rows of three contiguous
        numbers is read in place, also with a stride between rows (the first
        three columns of a wider array); anything else is copied first.
    triangles : (m, 3) ints, optional
        Vertex indices from 0, all counter-clockwise or all clockwise.  uint32
        or int32 in C order is read in place; anything else is copied first.
    ratio : float, optional
        Edges of a level / edges of the finer one, in [0.05, 0.95]; default 0.5.
    coarsest : int, optional
        Vertices of the coarsest level to aim for; default a sixteenth of all, and 1000 at most.
    collapse : "midpoint", "endpoint" or "qslim", optional
        "midpoint" (default): shortest edge, to its midpoint; "endpoint":
        shortest edge, to one end; "qslim": least quadric error.
    memory_limit : int, optional
        Largest number of bytes in use, also during later calls; default none.
    mollify : float, optional
        In [0, 0.1], default 0 = off; 1e-5 is a good value.  Accepts triangles of
        zero area and edges of length 0: adds a length to all edges, the smallest
        with which every triangle inequality holds with a margin of mollify *
        mean length.  Only the weights of level 0 change.
    marked_vertices : sequence of int or "suggest", optional
        Vertices that may be poles.  A sphere needs at least four, a disk four on
        its boundary or two inside.  By default a sphere or disk gets those of
        :func:`suggest_marks`, other meshes none; "suggest" requests them.  ``[]``: none.
    closed : bool
        True: a mesh with a boundary is refused.
    component : "largest" or int, optional
        Of a mesh of several components the one with the most triangles, or that of this number.  Default: such a
        mesh is refused, see :func:`solve_components`.
    progress : bool or function, optional
        True shows a bar on standard error (of tqdm if it is installed).  A
        function gets the fraction done, 0 to 1, at most every 10 ms, and may
        return a member of :class:`foliations.Progress`.

    The arrays are not used after the call, but must not change during it.

    Raises
    ------
    MeshError
        The mesh is not connected (see :func:`solve_components`), oriented and manifold, or it is a sphere or a disk
        with too few marked vertices.
    OptionsError, OutOfMemoryError, Cancelled
        See there.
    KeyboardInterrupt
        Control-C cancels; it takes at most some 50 ms.
    TypeError, ValueError
        An array has the wrong dtype or shape.
    """

    def __init__(
        self,
        positions: ArrayLike | MeshLike,
        triangles: ArrayLike | None = None,
        *,
        ratio: float | None = None,
        coarsest: int | None = None,
        collapse: Collapse | None = None,
        memory_limit: int | None = None,
        mollify: float | None = None,
        marked_vertices: MarksLike = None,
        closed: bool = False,
        component: Literal["largest"] | int | None = None,
        progress: ProgressOption = None,
    ) -> None:
        points, corners = _mesh(positions, triangles)
        #: (n,) uint32: where vertices were left out, the numbers that the others had in the mesh that was given; else None.
        self.kept_vertices: Indices | None = None
        if component is not None:
            points, corners, marked_vertices, self.kept_vertices = _take(component, points, corners, marked_vertices)
        limits: dict[str, Any] = {"memory_limit": memory_limit, "mollify": mollify}
        suggests = marked_vertices is None
        if isinstance(marked_vertices, str):
            if marked_vertices != "suggest":
                raise ValueError(f'marked_vertices is {marked_vertices!r}; give "suggest", or vertices.')
            marked_vertices = suggest_marks(points, corners, **limits)
        self._options: dict[str, Any] = {
            "ratio": ratio,
            "coarsest": coarsest,
            "collapse": collapse,
            **limits,
            "marked_vertices": None if marked_vertices is None else _marks(marked_vertices),
        }

        def build() -> Any:
            options = _build_options(**self._options, position_stride=_stride(points))
            return call(lib.hmf_hierarchy_create, *_arrays(points, corners), options, progress=progress)

        try:
            self._pointer = build()
        except MeshError as error:
            if error.status == Status.ERROR_MESH_UNUSED_VERTEX:
                points, corners = self._drop_unused(points, corners)
            elif error.status != Status.ERROR_MESH_GENUS or not suggests:
                raise
            if suggests:
                self._options["marked_vertices"] = _suggested(points, corners, error, limits)
            self._pointer = build()
        # Valid as long as the pointer.
        self._info = lib.hmf_hierarchy_describe(self._pointer)
        self._levels = tuple(Level(self, number) for number in range(self._info.level_count))
        if self.boundary_count:
            self._look_at_boundaries(closed)

    def _drop_unused(self, points: Floats, corners: Indices) -> tuple[Floats, Indices]:
        used, numbers, kept = _without_unused(points, corners)
        marks = self._options["marked_vertices"]
        if marks is not None:
            unknown = np.setdiff1d(marks, kept)
            if len(unknown):
                raise ValueError(f"marked vertex {unknown[0]} belongs to no triangle.")
            self._options["marked_vertices"] = frozen(np.searchsorted(kept, marks).astype(np.uint32))
        dropped = len(points) - len(kept)
        warn(
            f"dropped {dropped} {'vertex' if dropped == 1 else 'vertices'} without a triangle; the others are numbered "
            "without them, Hierarchy.kept_vertices has their numbers in the mesh that was given.",
            MeshWarning,
        )
        self.kept_vertices = frozen(kept)
        return used, numbers

    @property
    def boundaries(self) -> tuple[Indices, ...]:
        """The vertices of each boundary curve, in their order along it; by their first edge."""
        mesh = self.levels[0]
        sides = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
        edges = mesh.triangle_edges.reshape(-1)
        single = np.bincount(edges, minlength=mesh.edge_count)[edges] == 1
        following: dict[int, int] = {b: a for a, b in sides[single].tolist()}
        curves = []
        while following:
            start = next(iter(following))
            curve = [start]
            while (vertex := following.pop(curve[-1])) != start:
                curve.append(vertex)
            curves.append(frozen(np.array(curve, dtype=np.uint32)))
        return tuple(curves)

    def _look_at_boundaries(self, closed: bool) -> None:
        curves = self.boundaries
        if closed:
            raise MeshError(
                f"The mesh has {boundary_words(len(curves))[:-2]}, the first with {len(curves[0])} edges, "
                f"and closed=True was given. Close it, for example with repair(mesh, fill_holes={len(curves[0])}).",
                Status.ERROR_MESH_BOUNDARY,
                Element.VERTEX,
                int(curves[0][0]),
            )
        points = self.levels[0].positions
        short = _SHORT_BOUNDARY * float(np.linalg.norm(np.ptp(points, axis=0)))
        lengths = [float(np.linalg.norm(points[c] - points[np.roll(c, -1)], axis=1).sum()) for c in curves]
        holes = [len(c) for c, length in zip(curves, lengths) if len(c) <= _FEW_EDGES or length < short]
        if holes:
            looks = "1 boundary looks like a hole" if len(holes) == 1 else f"{len(holes)} boundaries look like holes"
            warn(
                f"{looks} by accident, the smallest with {min(holes)} edges; a hole changes the answer: "
                f"repair(mesh, fill_holes={min(holes)}) closes such ones, closed=True refuses them.",
                MeshWarning,
            )

    @classmethod
    def _rebuild(cls, positions: Floats, triangles: Indices, options: dict[str, Any]) -> Hierarchy:
        return cls(positions, triangles, **options)

    def __reduce__(self) -> tuple[Any, ...]:
        # The same input gives the same hierarchy, bit for bit.
        mesh = self.levels[0]
        return Hierarchy._rebuild, (mesh.positions, mesh.triangles, self._options)

    @property
    def levels(self) -> tuple[Level, ...]:
        """All levels; ``levels[0]`` is your mesh, ``levels[-1]`` the coarsest."""
        return self._levels

    @property
    def genus(self) -> int:
        """Genus of the surface; 0 only with marked vertices."""
        return int(self._info.genus)

    @property
    def marked_vertices(self) -> Indices:
        """(n,) uint32: the marked vertices, given or suggested."""
        marks = self._options["marked_vertices"]
        return frozen(np.empty(0, np.uint32)) if marks is None else marks

    @property
    def boundary_count(self) -> int:
        """Number of boundary curves."""
        return int(self._info.boundary_count)

    @property
    def memory(self) -> int:
        """Bytes held by the hierarchy."""
        return int(self._info.memory_bytes)

    harmonic_forms = harmonic_forms

    def loops(self, kind: LoopsKind = "cut", *, level: int | None = None, progress: ProgressOption = None) -> Loops:
        """Loops made by the library, as loops of triangles.

        Parameters
        ----------
        kind : "cut", "handle", "tunnel" or "pants"
            "cut": genus loops that together cut the surface into one planar piece.
        "handle", "tunnel": the same, and each loop bounds a surface inside or
        outside the solid.  "pants": 3 genus - 3 + marked vertices loops (one on a
        torus without marked vertices) that cut the surface into pairs of pants.
        On genus 0 "cut" goes around pairs of marked vertices.  With boundary
        "cut" also has one loop along each boundary and, on a disk, arcs;
        "handle" and "tunnel" are not available.
        level : int, optional
            Default 0, your mesh; the search is fastest on the coarsest, ``len(levels) - 1``.
        progress : bool or function, optional
            As for :class:`Hierarchy`.
        """
        number = 0 if level is None else as_count(level, "level")
        value = constant("LOOPS", kind, "kind of loops")
        made = call(lib.hmf_loops, self._pointer, number, value, progress=progress)
        return Loops._of(made, made)

    def initialize(
        self,
        loops: LoopsLike = None,
        weights: ArrayLike | None = None,
        *,
        progress: ProgressOption = None,
    ) -> Foliation:
        """The initial foliation of loops on their level: each value is the sum of the weights of the crossing loops.

        Parameters
        ----------
        loops, weights, progress
            As for :meth:`solve`.

        Raises
        ------
        LoopError
            A loop is not closed, simple and essential, or two of them cross or are freely homotopic.
        """
        chosen = self._loops_of(loops, "cut", weights, None)
        given, alive = loop_structure(chosen, weights)
        made = call(lib.hmf_foliation_from_loops, self._pointer, given, progress=progress)
        kind = loops if isinstance(loops, str) and loops != "even" else "cut" if loops is None else alive
        return Foliation._of(self, made)._belongs_to(kind, None if alive is None else alive.weights)

    def _loops_of(
        self, loops: LoopsLike, default: LoopsKind | None, weights: ArrayLike | None, method: str | None
    ) -> Loops | Sequence[ArrayLike] | None:
        """Loops of a kind, on the level where the search is fastest."""
        kind = default if loops is None else loops
        if kind is None or not isinstance(kind, str):
            return kind
        if kind == "even":
            mesh = self.levels[0]
            marks = self.marked_vertices
            return even_design(
                mesh.positions, mesh.triangles, marked_vertices=marks if len(marks) else None, no_poles=True
            ).loops
        constant("LOOPS", kind, 'loops, beside "even",')  # refuses other names
        fine = self.boundary_count > 0 or method == "single_level"
        of_library: Any = kind
        return self.loops(of_library, level=0 if fine else len(self.levels) - 1)

    def foliation(self, values: ArrayLike, *, level: int = 0, progress: ProgressOption = None) -> Foliation:
        """A foliation from your own values, for example from a file.

        Parameters
        ----------
        values : (edge_count of the level,) floats
            Copied, and checked: finite, not negative and closed.

        Raises
        ------
        FoliationError
            They are not.
        """
        number = as_count(level, "level")
        if number >= len(self._levels):
            call(lib.hmf_level, self._pointer, number)  # raises the error of the library
        given = as_floats(values, self._levels[number].edge_count, "values", "edge of the level")
        made = call(
            lib.hmf_foliation_from_values, self._pointer, number, pointer(given, "double *"), len(given), progress=progress
        )
        return Foliation._of(self, made)

    @takes(RelaxOptions, SolveOptions)
    def solve(
        self,
        loops: LoopsLike = None,
        weights: ArrayLike | None = None,
        *,
        initial: Foliation | None = None,
        progress: ProgressOption = None,
        **options: Unpack[SolveOptions],
    ) -> Foliation:
        """The harmonic foliation in the class of the loops.

        Parameters
        ----------
        loops : Loops, sequence of sequences of int, or a kind; optional
            On any level; plain sequences are closed paths along the edges of
            your mesh, as vertices.  A kind: "cut" (default), "handle", "tunnel" or "pants", see :meth:`loops`; "even":
            those of :func:`even_design` for these marked vertices, with its weights.
        weights : (number of loops,) floats, optional
            Positive, the unit of the values; default those of the loops.
        initial : Foliation, optional
            Start from this foliation instead of loops, and keep its class.  It may
            lie on another hierarchy of the same triangles, for example of the
            previous frame of an animation.  All levels are solved, so that it takes
            as long as from loops; see :meth:`Foliation.relax`.
        {options}
        progress : bool or function, optional
            As for :class:`Hierarchy`.  ``Progress.FINISH`` ends the solve with the best
        foliation so far, with ``status`` CANCELLED.

        Returns
        -------
        Foliation
            On ``stop_level``.  If a limit stops the solve, ``status`` names the limit and
        :class:`foliations.LimitWarning` is issued; the values are still closed and
        without poles.

        Raises
        ------
        LoopError, FoliationError, OptionsError, LevelError, OutOfMemoryError, Cancelled
            See there.
        KeyboardInterrupt
            Control-C cancels; it takes at most some 50 ms.
        """
        if initial is not None and (loops is not None or weights is not None):
            raise ValueError("initial values have a class and weights of their own: give no loops and no weights.")
        if isinstance(loops, str) and loops == "cut":
            loops = None
        kind: LoopsKind | None = "cut" if weights is not None and initial is None else None
        chosen = self._loops_of(loops, kind, weights, options.get("method"))
        given, alive = loop_structure(chosen, weights)
        start = None if initial is None else initial._pointer
        level = options.get("stop_level")
        if level is not None and -len(self._levels) <= level < 0:  # from the coarsest, as in a list
            options["stop_level"] = len(self._levels) + level
        settings = solve_options(options, start=start)
        if alive is None and start is None:
            outcome = run(lib.hmf_solve_cut_system, self._pointer, settings, progress=progress, accept=STOPPED)
        else:
            outcome = run(lib.hmf_solve, self._pointer, given, settings, progress=progress, accept=STOPPED)
        if initial is not None:
            return solved(self, outcome, initial._loops, initial._weights)
        if alive is None or (isinstance(loops, str) and loops != "even") or loops is None:
            known: Loops | str = loops if isinstance(loops, str) else "cut"
            return solved(self, outcome, known, None if alive is None else alive.weights)
        return solved(self, outcome, alive, alive.weights)

    def __repr__(self) -> str:
        mesh = self.levels[0]
        return (
            f"<Hierarchy: genus {self.genus}, {boundary_words(self.boundary_count)}{mesh.vertex_count} vertices, "
            f"{mesh.triangle_count} triangles, "
            f"{len(self.levels)} levels>"
        )


def _suggested(points: Floats, corners: Indices, error: MeshError, limits: dict[str, Any]) -> Indices | None:
    """Marked vertices for a mesh that needs some; otherwise the error is raised."""
    try:
        marks = suggest_marks(points, corners, **limits)
    except MeshError:
        marks = None
    if error.status == Status.ERROR_MESH_GENUS and (marks is None or len(marks) == 0):
        raise error
    return marks if marks is not None and len(marks) else None


def suggest_marks(
    positions: ArrayLike | MeshLike,
    triangles: ArrayLike | None = None,
    *,
    memory_limit: int | None = None,
    mollify: float | None = None,
    progress: ProgressOption = None,
) -> Indices:
    """Marked vertices for a mesh of genus 0, as (n,) uint32: two at the tip of each limb, 4 to 24.

    None for genus 1 up.

    Of several components each gets its own.

    Parameters, progress and errors as for :class:`Hierarchy`, which takes the
    result as ``marked_vertices``.  The same mesh gives the same marks.
    """
    points, corners = _mesh(positions, triangles)
    limits: dict[str, Any] = {"memory_limit": memory_limit, "mollify": mollify}
    try:
        made = call(
            lib.hmf_suggest_marks,
            *_arrays(points, corners),
            _build_options(**limits, position_stride=_stride(points)),
            progress=progress,
        )
    except MeshError as error:
        if not _is_unused(error):
            raise
        points, corners, kept = _without_unused(points, corners)
        return frozen(kept[suggest_marks(points, corners, memory_limit=memory_limit, mollify=mollify, progress=progress)])
    return view(made, made.marked_vertices, made.marked_count)


@dataclass(frozen=True, repr=False)
class Design:
    """Marked vertices, loops and weights of an even design; made by :func:`even_design`."""

    marked_vertices: Indices  #: for :class:`Hierarchy`
    loops: Loops  #: with weights, for :meth:`Hierarchy.solve` on a hierarchy with these marked vertices
    unevenness: float  #: on the coarse mesh of the search, see :attr:`Foliation.unevenness`
    unevenness_before: float  #: there, of the loops "cut" with weights 1
    solves: int  #: of the search

    def __repr__(self) -> str:
        return (
            f"<Design: {len(self.loops)} loops, {len(self.marked_vertices)} marked vertices, unevenness "
            f"{self.unevenness:.3g} instead of {self.unevenness_before:.3g}>"
        )


def even_design(
    positions: ArrayLike | MeshLike,
    triangles: ArrayLike | None = None,
    *,
    marked_vertices: Sequence[int] | NDArray[Any] | None = None,
    no_poles: bool = False,
    solve_limit: int | None = None,
    memory_limit: int | None = None,
    mollify: float | None = None,
    progress: ProgressOption = None,
) -> Design:
    """Chooses marked vertices, loops and weights with a nearly constant scale.

    Stripes and quads have nearly equal width.

    ``solve(mesh, loops="even")`` does this and solves.

    Parameters
    ----------
    marked_vertices : sequence of int, optional
        Become part of the design.
    no_poles : bool
        Adds no other marked vertices, if possible.
    solve_limit : int, optional
        Budget of the search, in solves of a coarse mesh; the default takes about ten solves of your mesh.
    positions, triangles, memory_limit, mollify, progress
        And the errors: as for :class:`Hierarchy`.
    """
    points, corners = _mesh(positions, triangles)
    marks = None if marked_vertices is None else _marks(marked_vertices)
    build = _build_options(
        memory_limit=memory_limit,
        mollify=mollify,
        marked_vertices=marks,
        position_stride=_stride(points),
    )
    try:
        made = call(
            lib.hmf_even_design,
            *_arrays(points, corners),
            structure("hmf_design_options", build=build, no_poles=int(no_poles), solve_limit=solve_limit),
            progress=progress,
        )
    except MeshError as error:
        if not _is_unused(error):
            raise
        points, corners, kept = _without_unused(points, corners)
        own = None if marks is None else np.searchsorted(kept, marks)  # those of no triangle were refused
        design = even_design(
            points,
            corners,
            marked_vertices=own,
            no_poles=no_poles,
            solve_limit=solve_limit,
            memory_limit=memory_limit,
            mollify=mollify,
            progress=progress,
        )
        return replace(design, marked_vertices=frozen(kept[design.marked_vertices]))  # loops are of triangles
    return Design(
        view(made, made.marked_vertices, made.marked_count),
        Loops._of(made.loops, made),
        made.unevenness,
        made.unevenness_before,
        made.solves,
    )


def memory_estimate(
    vertex_count: int,
    triangle_count: int,
    *,
    ratio: float | None = None,
    coarsest: int | None = None,
    collapse: Collapse | None = None,
    mollify: float | None = None,
) -> int:
    """Upper bound of the bytes that building a :class:`Hierarchy` uses at its peak; 0 if the counts are unusable."""
    options = _build_options(ratio=ratio, coarsest=coarsest, collapse=collapse, mollify=mollify)
    vertices, triangles = as_count(vertex_count, "vertex_count"), as_count(triangle_count, "triangle_count")
    return int(lib.hmf_hierarchy_memory_estimate(vertices, triangles, options))


@takes(SolveOptions)
def solve(
    positions: ArrayLike | MeshLike,
    triangles: ArrayLike | None = None,
    loops: LoopsLike = None,
    weights: ArrayLike | None = None,
    *,
    ratio: float | None = None,
    coarsest: int | None = None,
    collapse: Collapse | None = None,
    memory_limit: int | None = None,
    mollify: float | None = None,
    marked_vertices: MarksLike = None,
    closed: bool = False,
    component: Literal["largest"] | int | None = None,
    initial: Foliation | None = None,
    progress: ProgressOption = None,
    **options: Unpack[SolveOptions],
) -> Foliation:
    """The harmonic foliation of a mesh in one call: a :class:`Hierarchy`, and :meth:`Hierarchy.solve` on it.

    ``solve(positions, triangles)``, ``solve("mesh.obj")``, or of a mesh of trimesh, meshio, pyvista or Open3D.
    For the parameters, the result and the errors see these two; ``time_limit``
    is for the solve alone.  The hierarchy is ``hierarchy`` of the result.
    ``loops="even"``: those of :func:`even_design`, which chooses marked vertices and weights as well.
    """
    with progress_callback(progress, "foliations") as callback:
        begin = 0.0
        kept = None
        if isinstance(loops, str) and loops == "even":
            begin = _DESIGN_SHARE
            positions, triangles = _mesh(positions, triangles)
            if component is not None:
                positions, triangles, marked_vertices, kept = _take(component, positions, triangles, marked_vertices)
                component = None
            design = even_design(
                positions,
                triangles,
                marked_vertices=None if isinstance(marked_vertices, str) else marked_vertices,
                memory_limit=memory_limit,
                mollify=mollify,
                progress=part(callback, 0.0, begin),
            )
            loops, marked_vertices = design.loops, design.marked_vertices
        hierarchy = Hierarchy(
            positions,
            triangles,
            ratio=ratio,
            coarsest=coarsest,
            collapse=collapse,
            memory_limit=memory_limit,
            mollify=mollify,
            marked_vertices=marked_vertices,
            closed=closed,
            component=component,
            progress=part(callback, begin, begin + (1 - begin) * _BUILD_SHARE),
        )
        if kept is not None:
            hierarchy.kept_vertices = kept
        return hierarchy.solve(
            loops,
            weights,
            initial=initial,
            progress=part(callback, begin + (1 - begin) * _BUILD_SHARE, 1.0),
            **options,
        )
