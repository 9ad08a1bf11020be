"""Leaves of a foliation as polylines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import (
    Floats,
    Indices,
    as_indices,
    as_positions,
    call,
    constant,
    frozen,
    optional_index,
    pointer,
    structure_dtype,
)
from ._native import ffi, lib

if TYPE_CHECKING:
    from .foliation import Foliation

LineKind = Literal["level", "critical", "point"]
End = Literal["closed", "zero", "limit", "nowhere", "critical"]
LeavesKind = Literal["foliation", "conjugate"]

_LINE = structure_dtype("hmf_line")
_KINDS: dict[int, LineKind] = {
    lib.HMF_LINE_LEVEL: "level",
    lib.HMF_LINE_CRITICAL: "critical",
    lib.HMF_LINE_POINT: "point",
}
_ENDS: dict[int, End] = {
    lib.HMF_END_CLOSED: "closed",
    lib.HMF_END_ZERO: "zero",
    lib.HMF_END_LIMIT: "limit",
    lib.HMF_END_NOWHERE: "nowhere",
    lib.HMF_END_CRITICAL: "critical",
}


@dataclass(frozen=True, eq=False)
class Leaf:
    """One leaf."""

    kind: LineKind  #: a level set of its cylinder, a leaf between zeros, or the leaf through a given point
    closed: bool  #: the last point joins the first, which is not repeated
    begin: End  #: what is at its begin; "critical" (of conjugate leaves): a critical leaf, where the cylinder ends
    end: End
    begin_zero: int | None  #: which zero, in Foliation.singularities
    end_zero: int | None
    cylinder: int | None  #: None for critical leaves
    source: int  #: number of the point, of the level in its cylinder, or of the critical leaf
    height: float  #: above the lower side of its cylinder, in the unit of the values
    length: float  #: in the unit of the positions
    points: Floats  #: (n, 3) float64; consecutive ones lie in one triangle
    edges: Indices  #: (n,) uint32: the edge each point lies on; 2^32 - 1 for the middle of a zero in a triangle


class Leaves(Sequence[Leaf]):
    """Leaves from :meth:`Foliation.trace`.

    Attributes
    ----------
    offsets : (number of leaves + 1,) uint64
        Leaf i has the points ``offsets[i]`` to ``offsets[i + 1] - 1``.
    points : (n, 3) float64
        Of all leaves, in the unit of the positions.
    edges : (n,) uint32
        The edge that each point lies on.
    """

    def __init__(self, lines: NDArray[Any], offsets: NDArray[np.uint64], points: Floats, edges: Indices) -> None:
        self._lines = lines
        self.offsets = frozen(offsets)
        self.points = frozen(points)
        self.edges = frozen(edges)

    def __len__(self) -> int:
        return len(self._lines)

    @overload
    def __getitem__(self, which: int) -> Leaf: ...
    @overload
    def __getitem__(self, which: slice) -> tuple[Leaf, ...]: ...
    def __getitem__(self, which: int | slice) -> Leaf | tuple[Leaf, ...]:
        if isinstance(which, slice):
            return tuple(self[i] for i in range(len(self))[which])
        if not -len(self) <= which < len(self):
            raise IndexError(f"there is no leaf {which}, only {len(self)}")
        which %= len(self)
        line = self._lines[which]
        own = slice(int(self.offsets[which]), int(self.offsets[which + 1]))
        return Leaf(
            kind=_KINDS[int(line["kind"])],
            closed=bool(line["closed"]),
            begin=_ENDS[int(line["begin"])],
            end=_ENDS[int(line["end"])],
            begin_zero=optional_index(line["begin_zero"]),
            end_zero=optional_index(line["end_zero"]),
            cylinder=optional_index(line["cylinder"]),
            source=int(line["source"]),
            height=float(line["height"]),
            length=float(line["length"]),
            points=self.points[own],
            edges=self.edges[own],
        )

    def __iter__(self) -> Iterator[Leaf]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<{len(self)} leaves, {len(self.points)} points>"


def trace(
    foliation: Foliation,
    leaves: LeavesKind,
    spacing: float | None,
    critical: bool,
    length_limit: float | None,
    point_triangles: ArrayLike | None,
    point_barycentrics: ArrayLike | None,
) -> Leaves:
    """hmf_trace; the documentation is that of Foliation.trace."""
    options = ffi.new("hmf_trace_options *")
    lib.hmf_trace_options_init(options)
    options.leaves = constant("LEAVES", leaves, "leaves")
    options.critical = bool(critical)
    if spacing is not None:
        options.spacing = spacing
    if length_limit is not None:
        options.length_limit = length_limit
    if (point_triangles is None) != (point_barycentrics is None):
        raise ValueError("point_triangles and point_barycentrics come together: give both or none.")
    if point_triangles is not None and point_barycentrics is not None:
        triangles = as_indices(point_triangles, "point_triangles")
        barycentrics = np.ascontiguousarray(as_positions(point_barycentrics, "point_barycentrics"))
        if len(triangles) != len(barycentrics):
            raise ValueError(f"{len(triangles)} point_triangles but {len(barycentrics)} rows of point_barycentrics.")
        options.point_count = len(triangles)
        options.point_triangles = pointer(triangles, "uint32_t *")
        options.point_barycentrics = pointer(barycentrics, "double *")

    counts = ffi.new("size_t[2]")
    none = [ffi.NULL, 0, ffi.NULL, 0, ffi.NULL, ffi.NULL, 0]
    call(lib.hmf_trace, *foliation._given(), options, *none, counts, counts + 1)
    line_count, point_count = counts
    lines: NDArray[Any] = np.empty(line_count, dtype=_LINE)
    offsets = np.zeros(line_count + 1, dtype=np.uint64)
    points = np.empty((point_count, 3), dtype=np.float64)
    edges = np.empty(point_count, dtype=np.uint32)
    if line_count:
        call(
            lib.hmf_trace,
            *foliation._given(),
            options,
            *[pointer(lines, "hmf_line *"), lines.size],
            *[pointer(offsets, "uint64_t *"), offsets.size],
            *[pointer(points, "double *"), pointer(edges, "uint32_t *"), edges.size],
            counts,
            counts + 1,
        )
    return Leaves(lines, offsets, points, edges)
