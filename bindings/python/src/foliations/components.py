"""Meshes of several components: each carries a foliation of its own, or none."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import Floats, Indices, ProgressOption, call, frozen, part, progress_callback, view
from ._native import lib
from ._options import SolveOptions, takes
from .errors import Cancelled, Element, Error, LevelError, OptionsError, OutOfMemoryError, Status
from .foliation import Foliation
from .hierarchy import (
    Collapse,
    Hierarchy,
    LoopsLike,
    _arrays,
    _build_options,
    _marks,
    _mesh,
    _stride,
    suggest_marks,
)
from .loops import Loops, as_loops
from .meshes import MeshLike

if TYPE_CHECKING:
    from typing_extensions import Unpack

# Share of the build in the progress of a component.
_BUILD_SHARE = 0.25
# Share of the division in that of solve_components.
_DIVIDE_SHARE = 0.1


@dataclass(frozen=True)
class Component:
    """One connected component of a mesh, with numbers of its own; made by :class:`Components`."""

    status: Status  #: OK; ERROR_MESH_GENUS if it carries no foliation; else its defect
    element: Element  #: that the defect is about
    index: int | None  #: of the element, in the whole mesh
    genus: int  #: 0 where the status is a defect
    boundary_count: int  #: likewise
    positions: Floats  #: (n, 3), for a :class:`Hierarchy` like the next two
    triangles: Indices  #: (m, 3)
    marked_vertices: Indices  #: those that lie on it
    whole_vertices: Indices  #: (n,): number in the whole mesh of each vertex
    whole_edges: Indices  #: likewise of each edge of level 0
    whole_triangles: Indices  #: (m,)

    def __repr__(self) -> str:
        what = f"genus {self.genus}" if self.status == Status.OK else self.status.text
        return f"<Component: {what}, {len(self.positions)} vertices, {len(self.triangles)} triangles>"


class Components(Sequence[Component]):
    """The connected components of a mesh, in the order of their first triangles.

    Parameters
    ----------
    positions, triangles
        As for :class:`Hierarchy`.  Vertices without a triangle are in no component.
    marked_vertices : sequence of int, optional
        Of the whole mesh, such as those of :func:`suggest_marks`.
    memory_limit, mollify, progress
        As for :class:`Hierarchy`.

    Raises
    ------
    MeshError
        There are no triangles, or one names a vertex that does not exist.  Other
        defects are the ``status`` of their component.
    """

    def __init__(
        self,
        positions: ArrayLike | MeshLike,
        triangles: ArrayLike | None = None,
        *,
        memory_limit: int | None = None,
        mollify: float | None = None,
        marked_vertices: Sequence[int] | NDArray[Any] | None = None,
        progress: ProgressOption = None,
    ) -> None:
        points, corners = _mesh(positions, triangles)
        marks = None if marked_vertices is None else _marks(marked_vertices)
        made = call(
            lib.hmf_components,
            *_arrays(points, corners),
            _build_options(
                memory_limit=memory_limit, mollify=mollify, marked_vertices=marks, position_stride=_stride(points)
            ),
            progress=progress,
        )
        self._options: dict[str, Any] = {"memory_limit": memory_limit, "mollify": mollify}
        self._made = made
        self._list = view(made, made.list, made.count)
        #: Number of edges of the whole mesh.
        self.edge_count = int(made.edge_count)
        #: Component of each vertex of the whole mesh; 2^32 - 1: it has no triangle.
        self.vertex_component: Indices = view(made, made.vertex_component, made.vertex_count)
        #: Its number there.
        self.vertex_part: Indices = view(made, made.vertex_part, made.vertex_count)
        #: Component of each triangle.
        self.triangle_component: Indices = view(made, made.triangle_component, made.triangle_count)
        #: Its number there.
        self.triangle_part: Indices = view(made, made.triangle_part, made.triangle_count)
        self._positions: Floats = view(made, made.part_positions, made.used_vertex_count, 3)
        self._triangles: Indices = view(made, made.part_triangles, made.triangle_count, 3)
        self._marks: Indices = view(made, made.part_marks, made.marked_count)
        self._vertices: Indices = view(made, made.whole_vertices, made.used_vertex_count)
        self._edges: Indices = view(made, made.whole_edges, made.edge_count)
        self._faces: Indices = view(made, made.whole_triangles, made.triangle_count)

    def __len__(self) -> int:
        return len(self._list)

    @overload
    def __getitem__(self, which: int) -> Component: ...
    @overload
    def __getitem__(self, which: slice) -> tuple[Component, ...]: ...
    def __getitem__(self, which: int | slice) -> Component | tuple[Component, ...]:
        chosen = range(len(self))[which]
        if isinstance(chosen, range):
            return tuple(self[k] for k in chosen)
        c = self._list[chosen]
        element = Element(int(c["element"]))

        def own(array: NDArray[Any], first: str, count: str) -> NDArray[Any]:
            return array[int(c[first]) : int(c[first]) + int(c[count])]

        return Component(
            Status(int(c["status"])),
            element,
            None if element is Element.NONE else int(c["index"]),
            int(c["genus"]),
            int(c["boundary_count"]),
            own(self._positions, "first_vertex", "vertex_count"),
            own(self._triangles, "first_triangle", "triangle_count"),
            own(self._marks, "first_mark", "marked_count"),
            own(self._vertices, "first_vertex", "vertex_count"),
            own(self._edges, "first_edge", "edge_count"),
            own(self._faces, "first_triangle", "triangle_count"),
        )

    def split(self, loops: Loops | Sequence[ArrayLike], weights: ArrayLike | None = None) -> list[Loops]:
        """Loops of the whole mesh, on its level 0: for each component those on it, in its numbers.

        Raises
        ------
        ValueError
            A loop lies on several components, or on none.
        """
        whole = as_loops(loops, weights)
        if whole.level != 0:
            raise ValueError(f"the loops are of level {whole.level}; give loops of level 0, your mesh.")
        triangles = whole.kind == "triangles"
        component = self.triangle_component if triangles else self.vertex_component
        number = self.triangle_part if triangles else self.vertex_part
        chosen: list[list[int]] = [[] for _ in self._list]
        for i, path in enumerate(whole):
            if len(path) == 0 or path.max() >= len(component):
                raise ValueError(f"loop {i} is empty or names {whole.kind} that the mesh does not have.")
            on = np.unique(component[path])
            if len(on) != 1 or on[0] >= len(self):
                raise ValueError(f"loop {i} does not lie on one component; it meets {on.tolist()}.")
            chosen[int(on[0])].append(i)
        return [
            Loops(
                [number[whole[i]] for i in own],
                kind=whole.kind,
                weights=whole.weights[own],
                arcs=whole.arcs[own] if whole.arcs.any() else None,
                arc_sides=whole.arc_sides[own] if whole.arcs.any() else None,
            )
            for own in chosen
        ]

    @takes(SolveOptions)
    def solve(
        self,
        loops: LoopsLike = None,
        weights: ArrayLike | None = None,
        *,
        ratio: float | None = None,
        coarsest: int | None = None,
        collapse: Collapse | None = None,
        progress: ProgressOption = None,
        **options: Unpack[SolveOptions],
    ) -> ComponentFoliations:
        """One foliation over all components: each is built and solved on its own.

        Parameters
        ----------
        loops : Loops, sequence of sequences of int, or a kind of loops; optional
            Of the whole mesh, on its level 0; a component without any gets no
            foliation.  Default: those of the library on each, "cut".
        weights : (number of loops,) floats, optional
            For own loops.
        ratio, coarsest, collapse, progress
            As for :class:`Hierarchy`.
        {options}

        Errors of one component or its loops are in its row; other failures are raised.
        """
        if options.get("stop_level"):
            raise ValueError("components have levels of their own: stop_level is always 0.")
        if weights is not None and (loops is None or isinstance(loops, str)):
            raise ValueError("weights are for loops: give both.")
        given = None
        kind = "cut"
        if isinstance(loops, str):
            kind = loops
        elif loops is not None:
            given = self.split(loops, weights)
        values = np.zeros(self.edge_count)
        rows: list[ComponentRow] = []
        building = {**self._options, "ratio": ratio, "coarsest": coarsest, "collapse": collapse}
        with progress_callback(progress, "foliations") as callback:
            done = 0.0
            for k, component in enumerate(self):
                share = len(component.triangles) / max(1, len(self.triangle_component))
                middle = done + _BUILD_SHARE * share
                row = ComponentRow(k, component, component.status, component.status.text, None)
                try:
                    if component.status == Status.OK and given is not None and len(given[k]) == 0:
                        row = ComponentRow(k, component, Status.ERROR_LOOP_COUNT, "No loop lies on it.", None)
                    elif component.status == Status.OK:
                        hierarchy = Hierarchy(
                            component.positions,
                            component.triangles,
                            marked_vertices=component.marked_vertices,
                            progress=part(callback, done, middle),
                            **building,
                        )
                        own = kind if given is None else given[k]
                        foliation = hierarchy.solve(own, progress=part(callback, middle, done + share), **options)
                        values[component.whole_edges] = foliation.values
                        message = "" if foliation.status == Status.OK else foliation.status.text
                        row = ComponentRow(k, component, foliation.status, message, foliation)
                except (Cancelled, OptionsError, OutOfMemoryError, LevelError):
                    raise
                except Error as error:
                    row = ComponentRow(k, component, error.status, error.message, None)
                rows.append(row)
                done += share
            if callback is not None:
                callback(1.0)
        return ComponentFoliations(frozen(values), tuple(rows))

    def __repr__(self) -> str:
        return f"<Components: {len(self)}, {len(self.vertex_component)} vertices, {self.edge_count} edges>"


@dataclass(frozen=True)
class ComponentRow:
    """Result for one component; made by :meth:`Components.solve`."""

    number: int
    component: Component
    status: Status  #: of its foliation; without one, why there is none
    message: str  #: likewise; empty if it was solved
    foliation: Foliation | None  #: on a hierarchy of this component alone

    @property
    def row(self) -> dict[str, Any]:
        """The result as a row of a table, with the columns of :func:`solve_row`."""
        report = None if self.foliation is None else self.foliation.report
        return {
            "component": self.number,
            "ok": self.foliation is not None,
            "status": self.status.name,
            "message": self.message,
            "vertices": len(self.component.positions),
            "edges": len(self.component.whole_edges),
            "triangles_count": len(self.component.triangles),
            "genus": self.component.genus,
            "boundaries": self.component.boundary_count,
            "zeros": -1 if report is None else report.zeros,
            "energy": float("nan") if report is None else report.energy,
            "residual_max": float("nan") if report is None else report.residual_max,
            "class": "none" if report is None else report.class_state,
        }


@dataclass(frozen=True)
class ComponentFoliations(Sequence[ComponentRow]):
    """One foliation over all components of a mesh; a sequence of one row for each."""

    values: Floats  #: (edges of the whole mesh,); 0 on components without a foliation
    rows: tuple[ComponentRow, ...]

    @property
    def energy(self) -> float:
        """The sum over the components."""
        return sum(row.foliation.energy for row in self.rows if row.foliation is not None)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[ComponentRow]:
        return iter(self.rows)

    @overload
    def __getitem__(self, which: int) -> ComponentRow: ...
    @overload
    def __getitem__(self, which: slice) -> tuple[ComponentRow, ...]: ...
    def __getitem__(self, which: int | slice) -> ComponentRow | tuple[ComponentRow, ...]:
        return self.rows[which]

    def __repr__(self) -> str:
        solved = sum(row.foliation is not None for row in self.rows)
        return f"<ComponentFoliations: {solved} of {len(self.rows)} components solved, {len(self.values)} edges>"


@takes(SolveOptions)
def solve_components(
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
    marked_vertices: Sequence[int] | NDArray[Any] | Literal["suggest"] | None = None,
    progress: ProgressOption = None,
    **options: Unpack[SolveOptions],
) -> ComponentFoliations:
    """The harmonic foliation of a mesh of one or several components in one call.

    A :class:`Components`, and :meth:`Components.solve` of it; for the parameters
    see these two.  ``marked_vertices``: default and "suggest": those of :func:`suggest_marks`; ``[]``: none.
    """
    mesh = _mesh(positions, triangles)
    limits: dict[str, Any] = {"memory_limit": memory_limit, "mollify": mollify}
    with progress_callback(progress, "foliations") as callback:
        marks = marked_vertices
        begin = 0.0
        if marks is None:
            marks = "suggest"
        if isinstance(marks, str):
            if marks != "suggest":
                raise ValueError(f'marked_vertices is {marks!r}; give "suggest", or vertices.')
            begin = _DIVIDE_SHARE
            marks = suggest_marks(*mesh, **limits, progress=part(callback, 0.0, begin))
        middle = begin + _DIVIDE_SHARE
        components = Components(*mesh, **limits, marked_vertices=marks, progress=part(callback, begin, middle))
        return components.solve(
            loops,
            weights,
            ratio=ratio,
            coarsest=coarsest,
            collapse=collapse,
            progress=part(callback, middle, 1.0),
            **options,
        )
