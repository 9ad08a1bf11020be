"""Sets of closed curves on a level of a hierarchy."""

from __future__ import annotations

import os
from collections.abc import Sequence
from heapq import heappop, heappush
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import (
    Floats,
    Indices,
    as_count,
    as_floats,
    as_indices,
    as_positions,
    constant,
    frozen,
    names,
    pointer,
    structure,
    view,
)
from ._native import ffi

if TYPE_CHECKING:
    from .hierarchy import Hierarchy, Level

LoopKind = Literal["vertices", "triangles"]


class Loops(Sequence[Indices]):
    """Disjoint closed curves with weights: they determine the class of a foliation.

    Parameters
    ----------
    paths : sequence of sequences of int
        One path for each loop.  Consecutive elements are neighbors, and so
        are the last and the first, which may also be repeated at the end.
    kind : "vertices" or "triangles"
        Consecutive vertices share an edge; consecutive triangles share an edge.
    level : int
        Of the hierarchy; 0 is your mesh.
    weights : (number of loops,) floats, optional
        Positive; None means 1 each.  They set the unit of the values.
    arcs : (number of loops,) bools, optional
        Which ones are arcs from boundary to boundary, on a surface that has
        one; None means none.  They are not closed.
    arc_sides : (number of loops, 2) ints, optional
        For arcs of triangles: the side of the first triangle, 0 to 2, where
        the arc begins, and that of the last one where it ends; -1 and None
        mean the first side on the boundary.

    Whether the loops are closed, simple, disjoint, essential and not parallel
    is checked by the call that uses them (:class:`foliations.LoopError`).
    """

    def __init__(
        self,
        paths: Sequence[ArrayLike],
        *,
        kind: LoopKind = "vertices",
        level: int = 0,
        weights: ArrayLike | None = None,
        arcs: ArrayLike | None = None,
        arc_sides: ArrayLike | None = None,
    ) -> None:
        is_arc = None if arcs is None else _rows(np.array(arcs, dtype=bool), (len(paths),), "arcs")
        sides = None if arc_sides is None else _rows(np.array(arc_sides, np.int32), (len(paths), 2), "arc_sides")
        arrays = [
            array if is_arc is not None and is_arc[number] else _open(array)
            for number, array in enumerate(as_indices(path, f"loop {number}") for number, path in enumerate(paths))
        ]
        offsets = np.zeros(len(arrays) + 1, dtype=np.uint64)
        np.cumsum([len(array) for array in arrays], out=offsets[1:])
        elements = np.concatenate(arrays) if arrays else np.empty(0, dtype=np.uint32)
        self._set(offsets, elements, kind, level, weights, is_arc, sides)

    def _set(
        self,
        offsets: NDArray[np.uint64],
        elements: Indices,
        kind: LoopKind,
        level: int,
        weights: ArrayLike | None,
        arcs: NDArray[np.bool_] | None,
        arc_sides: NDArray[np.int32] | None,
    ) -> Loops:
        self._arcs = None if arcs is None else frozen(arcs)
        self._arc_sides = None if arc_sides is None else frozen(arc_sides)
        self._element_kind = constant("PATH", kind, "kind of a loop")
        self._kind: LoopKind = kind
        self._offsets = frozen(offsets)
        self._elements = frozen(elements)
        self._level = as_count(level, "level")
        self._weights: Floats | None = None
        if weights is not None:
            self._weights = frozen(as_floats(weights, len(offsets) - 1, "weights", "loop").copy())
        return self

    @classmethod
    def _of(cls, given: Any, owner: Any) -> Loops:
        """The loops of an hmf_loop_set, which lies in memory that ``owner`` keeps alive."""
        offsets = view(owner, given.offsets, given.count + 1)
        elements = view(owner, given.elements, int(offsets[-1]))
        weights = None if given.weights == ffi.NULL else view(owner, given.weights, given.count)
        arcs = None if given.arcs == ffi.NULL else view(owner, given.arcs, given.count).astype(bool)
        # HMF_NONE is -1.
        sides = None if given.arc_sides == ffi.NULL else view(owner, given.arc_sides, given.count, 2).view(np.int32)
        kind = names("PATH")[given.element_kind]
        return cls.__new__(cls)._set(offsets, elements, kind, given.level, weights, arcs, sides)

    @classmethod
    def through(
        cls,
        hierarchy: Hierarchy,
        *picked: ArrayLike,
        crossing: Loops | None = None,
        weights: ArrayLike | None = None,
        within: float | None = None,
    ) -> Loops:
        """Loops through picked vertices or points: the shortest path along edges to each next one, and back.

        Parameters
        ----------
        picked : sequences of int, or (n, 3) floats
            For each loop at least three vertices, or points near them, in order and on
            all sides of what the loop goes around.  If the shortest path from the last
            to the first runs back along the others, the loop goes around nothing.
        crossing : Loops, optional
            At most six loops of level 0, such as ``hierarchy.loops("handle", level=0)[:1]``.  The
            result is the shortest closed path that crosses each of them an odd number
            of times, so it runs through their handles.  One picked point is then enough;
            without any it is the shortest of all.
        weights : (number of loops,) floats, optional
            As for :class:`Loops`.
        within : float, optional
            Points further from the surface are refused, in the unit of the positions; default a tenth of the
            diagonal of its box.
        """
        mesh = hierarchy.levels[0]
        graph = _Graph(mesh, _crossed(hierarchy, crossing))
        paths = []
        for given in picked:
            stops = _open(_nearest(mesh, given, within)).tolist()
            if not stops or (len(stops) < 3 and crossing is None):
                raise ValueError(f"pick at least three vertices for a loop, got {len(stops)}.")
            if max(stops) >= mesh.vertex_count:
                raise ValueError(f"vertex {max(stops)} does not exist; the mesh has {mesh.vertex_count}, from 0.")
            paths.append(graph.closed_path(stops))
        if not picked:
            if crossing is None:
                raise ValueError("pick vertices or points, or give the loops to cross.")
            paths.append(graph.shortest_closed_path())
        return cls([np.array(path, dtype=np.uint32) for path in paths], weights=weights)

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, weights: ArrayLike | None = None) -> Loops:
        """Loops of your mesh from a text file, as the tool reads and writes them (``hmf solve --loops``).

        One loop a line: vertices along edges, or ``t:`` and triangles that
        follow each other across edges; ``a:`` and vertices of an arc from
        boundary to boundary, or ``at:`` and its triangles.  What follows ``#`` is a comment, but
        for ``# --weights 1,2``, which gives weights where none are given here.
        """
        paths: list[list[int]] = []
        arcs: list[bool] = []
        sides: list[tuple[int, int]] = []
        kinds = set()
        for number, line in enumerate(Path(path).read_text(encoding="utf-8").splitlines(), 1):
            content, _, comment = line.partition("#")
            words = content.replace(",", " ").replace(":", ": ").split()
            try:
                if weights is None and comment.split()[:1] == ["--weights"]:
                    weights = [float(word) for word in comment.split(None, 1)[1].split(",")]
                if not words:
                    continue
                kind, arc, ends = _kind_of_line(words.pop(0) if words[0].endswith(":") else "v:")
                paths.append([int(word) for word in words])
                arcs.append(arc)
                sides.append(ends)
            except (ValueError, IndexError) as error:
                raise ValueError(f"{path}, line {number}: write numbers from 0, or t: and numbers.") from error
            kinds.add(kind)
        if len(kinds) > 1:
            raise ValueError(f"{path}: loops of vertices and loops of triangles; write all of them in one way.")
        if not paths or [] in paths:
            raise ValueError(f"{path}: no loops, or a line without numbers; write one loop a line.")
        if not any(arcs):
            return cls(paths, kind=kinds.pop(), weights=weights)
        return cls(paths, kind=kinds.pop(), weights=weights, arcs=arcs, arc_sides=sides)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes loops of your mesh, level 0, as :meth:`load` and the tool read them."""
        if self._level != 0:
            raise ValueError(f"loops of level {self._level} mean nothing to others: save those of level 0.")
        lines = ["# --weights " + ",".join(repr(weight) for weight in self.weights.tolist())]
        for loop, arc, sides in zip(self, self.arcs, self.arc_sides):
            lines.append(_line_of(self._kind, arc, sides) + " ".join(map(str, loop.tolist())))
        Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")

    def positions(self, hierarchy: Hierarchy) -> tuple[Floats, ...]:
        """Of each loop (n, 3) float64: its vertices, or the middles of the edges that its triangles cross.

        The last point joins the first, which is not repeated; those of an arc are its ends.
        """
        level = hierarchy.levels[self._level]
        if self._kind == "vertices":
            return tuple(level.positions[loop] for loop in self)
        uses = np.bincount(level.triangle_edges.reshape(-1), minlength=level.edge_count)
        result = []
        for loop, arc, sides in zip(self, self.arcs.tolist(), self.arc_sides.tolist()):
            edges = level.triangle_edges[loop]
            shared = (edges[:, :, None] == np.roll(edges, -1, axis=0)[:, None, :]).any(axis=2)
            shared = shared[:-1] if arc else shared
            if not shared.any(axis=1).all():
                raise ValueError("consecutive triangles of a loop share no edge: it is not of this hierarchy.")
            crossed = edges[np.arange(len(shared)), shared.argmax(axis=1)].tolist()
            if arc:
                ends = zip((edges[0], edges[-1]), sides)
                first, last = (own[side] if side >= 0 else own[np.argmin(uses[own])] for own, side in ends)
                crossed = [first, *crossed, last]
            result.append(level.positions[level.edges[crossed]].mean(axis=1))
        return tuple(result)

    @property
    def kind(self) -> LoopKind:
        """What the elements are."""
        return self._kind

    @property
    def level(self) -> int:
        """Level of the elements."""
        return self._level

    @property
    def weights(self) -> Floats:
        """(number of loops,) float64."""
        return np.ones(len(self)) if self._weights is None else self._weights

    @property
    def offsets(self) -> NDArray[np.uint64]:
        """(number of loops + 1,): loop i is ``elements[offsets[i]:offsets[i + 1]]``."""
        return self._offsets

    @property
    def elements(self) -> Indices:
        """All elements, one loop after the other."""
        return self._elements

    @property
    def arcs(self) -> NDArray[np.bool_]:
        """(number of loops,): which ones are arcs from boundary to boundary."""
        return np.zeros(len(self), dtype=bool) if self._arcs is None else self._arcs

    @property
    def arc_sides(self) -> NDArray[np.int32]:
        """(number of loops, 2): sides of triangles where arcs begin and end; -1: the first side on the boundary."""
        return np.full((len(self), 2), -1, dtype=np.int32) if self._arc_sides is None else self._arc_sides

    def with_weights(self, weights: ArrayLike | None) -> Loops:
        """The same loops with other weights; None means 1 each."""
        loops = type(self).__new__(type(self))
        return loops._set(
            self._offsets, self._elements, self._kind, self._level, weights, self._arcs, self._arc_sides
        )

    def __len__(self) -> int:
        return len(self._offsets) - 1

    @overload
    def __getitem__(self, which: int) -> Indices: ...
    @overload
    def __getitem__(self, which: slice) -> Loops: ...
    def __getitem__(self, which: int | slice) -> Indices | Loops:
        """One loop as (length,) uint32; of a slice, the set of those loops."""
        if isinstance(which, slice):
            chosen = range(len(self))[which]
            weights = None if self._weights is None else self._weights[which]
            return Loops(
                [self[i] for i in chosen],
                kind=self._kind,
                level=self._level,
                weights=weights,
                arcs=None if self._arcs is None else self._arcs[which],
                arc_sides=None if self._arc_sides is None else self._arc_sides[which],
            )
        number = range(len(self))[which]
        return self._elements[int(self._offsets[number]) : int(self._offsets[number + 1])]

    def __repr__(self) -> str:
        return f"<{len(self)} loops of {self._kind} on level {self._level}>"

    def _structure(self) -> Any:
        """hmf_loop_set; valid as long as these loops are."""
        return structure(
            "hmf_loop_set",
            element_kind=self._element_kind,
            level=self._level,
            count=len(self),
            offsets=pointer(self._offsets, "uint64_t *"),
            elements=pointer(self._elements, "uint32_t *"),
            weights=None if self._weights is None else pointer(self._weights, "double *"),
            arcs=None if self._arcs is None else pointer(self._arcs.view(np.uint8), "uint8_t *"),
            arc_sides=None if self._arc_sides is None else pointer(self._arc_sides.view(np.uint32), "uint32_t *"),
        )


def _kind_of_line(word: str) -> tuple[LoopKind, bool, tuple[int, int]]:
    """What the first word of a line of a file says: the kind of elements, whether it is an arc, and its sides."""
    if word in ("v:", "a:"):
        return "vertices", word == "a:", (-1, -1)
    if word in ("t:", "at:"):
        return "triangles", word == "at:", (-1, -1)
    if len(word) == 5 and word.startswith("at") and set(word[2:4]) <= set("012"):
        return "triangles", True, (int(word[2]), int(word[3]))
    raise ValueError(word)


def _line_of(kind: LoopKind, arc: bool, sides: NDArray[np.int32]) -> str:
    """The beginning of a line of a file."""
    if arc and kind == "triangles" and min(sides) >= 0:
        return f"at{sides[0]}{sides[1]}: "
    if arc:
        return "at: " if kind == "triangles" else "a: "
    return "t: " if kind == "triangles" else "v: "


def _rows(array: NDArray[Any], shape: tuple[int, ...], what: str) -> NDArray[Any]:
    if array.shape != shape:
        raise ValueError(f"{what} has the shape {array.shape}; give one entry for each of the {shape[0]} loops.")
    return array


def _open(path: Indices) -> Indices:
    """Without the first element at the end."""
    return path[:-1] if len(path) > 1 and path[0] == path[-1] else path


_NEAR = 0.1  # of the diagonal of the box: points further from the surface are of another one


def _distance(point: Floats, corners: Floats) -> float:
    """Of a point from triangles (m, 3, 3)."""
    a, sides = corners, np.roll(corners, -1, axis=1) - corners
    along = np.einsum("mik,mik->mi", point - a, sides) / np.maximum(np.einsum("mik,mik->mi", sides, sides), 1e-300)
    off = point - a - np.clip(along, 0, 1)[:, :, None] * sides
    least = np.einsum("mik,mik->mi", off, off).min(axis=1)
    normal = np.cross(sides[:, 0], sides[:, 1])
    size = np.einsum("mk,mk->m", normal, normal)
    turns = np.einsum("mik,mk->mi", np.cross(sides, point - a), normal)
    inside = (turns > 0).all(axis=1) & (size > 0)
    height = np.einsum("mk,mk->m", point - a[:, 0], normal) ** 2 / np.where(size > 0, size, 1)
    return float(np.sqrt(np.where(inside, height, least).min()))


def _nearest(mesh: Level, picked: ArrayLike, within: float | None) -> Indices:
    """Vertices as they are; of points (n, 3) the nearest vertices."""
    given = np.asarray(picked)
    if given.ndim != 2:
        return as_indices(picked, "picked vertices")
    points = as_positions(picked, "picked points")
    if not np.isfinite(points).all():
        raise ValueError("picked points must be finite.")
    positions = mesh.positions
    limit = _NEAR * float(np.linalg.norm(np.ptp(positions, axis=0))) if within is None else float(within)
    corners = positions[mesh.triangles]
    for number, point in enumerate(points):
        distance = _distance(point, corners)
        if not distance <= limit:
            raise ValueError(
                f"point {number}, {point.tolist()}, is {distance:.3g} from the surface, more than within={limit:.3g}. "
                "Check its unit and axes, or give a larger distance within."
            )
    nearest = [np.square(positions - point).sum(axis=1).argmin() for point in points]
    return np.array(nearest, dtype=np.uint32)


def _crossed(hierarchy: Hierarchy, crossing: Loops | None) -> list[NDArray[np.bool_]]:
    """For each loop the edges of level 0 that cross it an odd number of times."""
    if crossing is None:
        return []
    if crossing.level != 0 or not 0 < len(crossing) <= 6:
        raise ValueError("crossing takes one to six loops of level 0, such as hierarchy.loops(level=0)[:1].")
    single = (crossing[number : number + 1].with_weights(None) for number in range(len(crossing)))
    return [np.rint(hierarchy.initialize(loop).values) % 2 == 1 for loop in single]


class _Graph:
    """Vertices and edges of a level, with lengths, on 2 ** n sheets.

    Edges that cross loop i an odd number of times lead to another sheet, with the bit i changed: so the sheet
    where a path ends says which loops it has crossed.
    """

    def __init__(self, level: Level, crossed: list[NDArray[np.bool_]]) -> None:
        bits = sum((edges.astype(np.int64) << i for i, edges in enumerate(crossed)), np.zeros(level.edge_count, int))
        ends = np.concatenate([level.edges, level.edges[:, ::-1]])
        order = np.argsort(ends[:, 0], kind="stable")
        ends = ends[order]
        self._positions = level.positions
        self._first = np.searchsorted(ends[:, 0], np.arange(level.vertex_count + 1)).tolist()
        self._lengths = np.linalg.norm(level.positions[ends[:, 0]] - level.positions[ends[:, 1]], axis=1).tolist()
        self._targets = ends[:, 1].tolist()
        self._bits = np.concatenate([bits, bits])[order].tolist()
        self._sheets = 1 << len(crossed)
        # Every path that changes the first bit visits one of these.
        self._gates = np.unique(level.edges[crossed[0], 0]).tolist() if crossed else []

    def closed_path(self, stops: list[int]) -> list[int]:
        """Through the stops in their order; it ends on the last sheet."""
        best = {0: (0.0, list[int]())}  # for each sheet: the shortest path so far
        for start, goal in zip(stops, [*stops[1:], stops[0]]):
            # The last one leads to the last sheet; where there is one sheet only, so do all.
            legs = self._search(start, goal, range(self._sheets) if len(stops) > 1 else [self._sheets - 1])[0]
            longer: dict[int, tuple[float, list[int]]] = {}
            for sheet, (length, path) in best.items():
                for turn, (more, leg) in legs.items():
                    if length + more < longer.get(sheet ^ turn, (inf,))[0]:
                        longer[sheet ^ turn] = (length + more, path + leg)
            best = longer
        if self._sheets - 1 not in best:
            raise ValueError("no closed path through the picked vertices crosses these loops.")
        return best[self._sheets - 1][1]

    def shortest_closed_path(self) -> list[int]:
        """The shortest path from a vertex to itself on the last sheet.

        One through a vertex at distance d is at most 2 d longer than one through the other: so most need not be
        looked at.
        """
        least = dict.fromkeys(self._gates, 0.0)  # no path through here is shorter
        shortest, best = inf, list[int]()
        while least:
            start = min(least, key=lambda vertex: (least[vertex], vertex))
            if least.pop(start) >= shortest:
                break
            legs, distance = self._search(start, start, [self._sheets - 1])
            if not legs:
                continue
            length, path = legs[self._sheets - 1]
            if length < shortest:
                shortest, best = length, path
            for place, away in distance.items():
                vertex = place // self._sheets
                if vertex in least:
                    least[vertex] = max(least[vertex], length - 2 * away)
        if not best:
            raise ValueError("no closed path crosses these loops.")
        return best

    def _search(
        self, start: int, goal: int, sheets: Sequence[int]
    ) -> tuple[dict[int, tuple[float, list[int]]], dict[int, float]]:
        """The shortest paths to the goal on these sheets, without their ends, and the distances seen on the way.

        Dijkstra's, with the straight line to the goal as a bound.  A place is a vertex on a sheet.
        """
        bound = np.linalg.norm(self._positions - self._positions[goal], axis=1).tolist()
        first, lengths, targets, bits, count = self._first, self._lengths, self._targets, self._bits, self._sheets
        distance, previous = {start * count: 0.0}, {start * count: -1}
        heap = [(bound[start], start * count)]
        wanted = {goal * count + sheet for sheet in sheets}
        found: dict[int, tuple[float, list[int]]] = {}
        while heap and wanted:
            least, here = heappop(heap)
            vertex, sheet = divmod(here, count)
            if least > distance[here] + bound[vertex]:
                continue  # found shorter since
            if here in wanted:
                wanted.remove(here)
                path, back = [], previous[here]
                while back >= 0:
                    path.append(back // count)
                    back = previous[back]
                found[sheet] = (distance[here], path[::-1])
            for side in range(first[vertex], first[vertex + 1]):
                there = targets[side] * count + (sheet ^ bits[side])
                length = distance[here] + lengths[side]
                if length < distance.get(there, inf):
                    distance[there], previous[there] = length, here
                    heappush(heap, (length + bound[targets[side]], there))
        return found, distance


def as_loops(loops: Loops | Sequence[ArrayLike], weights: ArrayLike | None) -> Loops:
    """Loops as they are; other sequences are paths of vertices of level 0."""
    if not isinstance(loops, Loops):
        return Loops(loops, weights=weights)
    return loops if weights is None else loops.with_weights(weights)


def loop_structure(loops: Loops | Sequence[ArrayLike] | None, weights: ArrayLike | None) -> tuple[Any, Loops | None]:
    """hmf_loop_set, NULL of None, and the loops to keep as long as it is used."""
    chosen = None if loops is None else as_loops(loops, weights)
    return (ffi.NULL if chosen is None else chosen._structure()), chosen
