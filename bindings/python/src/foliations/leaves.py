"""Leaves of a foliation as polylines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import (
    Floats,
    Indices,
    ProgressOption,
    Rows,
    as_indices,
    as_positions,
    call,
    constant,
    names,
    optional_index,
    pointer,
    structure,
    view,
)
from ._native import lib
from .export import export_leaves

if TYPE_CHECKING:
    from .foliation import Foliation

LineKind = Literal["level", "critical", "point"]
End = Literal["closed", "zero", "limit", "nowhere", "critical"]
LeavesKind = Literal["foliation", "conjugate"]

_KINDS: dict[int, LineKind] = names("LINE")
_ENDS: dict[int, End] = names("END")


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


class Leaves(Rows[Leaf]):
    """Leaves from :meth:`Foliation.trace`.

    Attributes
    ----------
    offsets : (number of leaves + 1,) uint64
        Leaf i has the points ``offsets[i]`` to ``offsets[i + 1] - 1``.
    points : (n, 3) float64
        Of all leaves, in the unit of the positions.
    edges : (n,) uint32
        The edge that each point lies on.
    compared_count : int
        Pairs of points that were checked: whether both lie on one leaf.
    deviation : float
        Largest difference of the values at both points of a pair.
    """

    def __init__(
        self,
        lines: NDArray[Any],
        offsets: NDArray[np.uint64],
        points: Floats,
        edges: Indices,
        compared_count: int,
        deviation: float,
    ) -> None:
        super().__init__(lines)
        self.offsets = offsets
        self.points = points
        self.edges = edges
        self.compared_count = compared_count
        self.deviation = deviation

    def _entry(self, number: int, row: dict[str, Any]) -> Leaf:
        own = slice(int(self.offsets[number]), int(self.offsets[number + 1]))
        row.update(kind=_KINDS[row["kind"]], begin=_ENDS[row["begin"]], end=_ENDS[row["end"]])
        row.update(closed=bool(row["closed"]))
        row.update({name: optional_index(row[name]) for name in ("begin_zero", "end_zero", "cylinder")})
        return Leaf(**row, points=self.points[own], edges=self.edges[own])

    export = export_leaves

    def __repr__(self) -> str:
        return f"<{len(self)} leaves, {len(self.points)} points>"


def trace(
    foliation: Foliation,
    *,
    leaves: LeavesKind = "foliation",
    spacing: float | None = None,
    critical: bool = False,
    length_limit: float | None = None,
    point_triangles: ArrayLike | None = None,
    point_barycentrics: ArrayLike | None = None,
    progress: ProgressOption = None,
) -> Leaves:
    """Leaves as polylines; without arguments the critical leaves, which join zeros.

    No two leaves of the foliation cross, and each closes exactly; its values
    need not be harmonic.  Conjugate leaves do not close in general, and need
    harmonic values; their level sets go across each cylinder.

    Parameters
    ----------
    leaves : "foliation" or "conjugate"
        Leaves on which u is constant, or v; see :meth:`Foliation.parameterize`.
    spacing : float, optional
        Approximate distance of leaves over the whole surface, in the unit of the values.
    critical : bool
        All leaves out of zeros.
    length_limit : float, optional
        Length at which a leaf stops, in each direction, in the unit of the positions;
        default none, for conjugate leaves ten times the square root of the area.
    point_triangles, point_barycentrics : (n,) ints and (n, 3) floats, optional
        The leaves through these points, given by triangle and barycentric
        coordinates: not negative, of sum 1.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Raises
    ------
    FoliationError
        The values have a pole, or belong to no loops that can be followed.
    OptionsError
        A number is out of range.
    """
    if (point_triangles is None) != (point_barycentrics is None):
        raise ValueError("point_triangles and point_barycentrics come together: give both or none.")
    none = np.empty((0, 3))
    triangles = as_indices([] if point_triangles is None else point_triangles, "point_triangles")
    barycentrics = as_positions(none if point_barycentrics is None else point_barycentrics, "point_barycentrics")
    barycentrics = np.ascontiguousarray(barycentrics)
    if len(triangles) != len(barycentrics):
        raise ValueError(f"{len(triangles)} point_triangles but {len(barycentrics)} rows of point_barycentrics.")
    options = structure(
        "hmf_trace_options",
        leaves=constant("LEAVES", leaves, "leaves"),
        critical=bool(critical),
        spacing=spacing,
        length_limit=length_limit,
        point_count=len(triangles),
        point_triangles=pointer(triangles, "uint32_t *"),
        point_barycentrics=pointer(barycentrics, "double *"),
    )
    made = call(lib.hmf_trace, foliation._pointer, options, progress=progress)
    return Leaves(
        view(made, made.lines, made.line_count),
        view(made, made.offsets, made.line_count + 1),
        view(made, made.points, made.point_count, 3),
        view(made, made.point_edges, made.point_count),
        made.compared_count,
        made.deviation,
    )
