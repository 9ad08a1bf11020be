"""Quad meshes along the leaves of a foliation."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ._boundary import Floats, Indices, ProgressOption, call, structure, view
from ._native import lib
from .export import export_quads

if TYPE_CHECKING:
    from .foliation import Foliation


@dataclass(frozen=True, repr=False)
class QuadMesh:
    """A quad mesh from :meth:`Foliation.quads`; arrays are read-only.  ``len`` is the number of quads."""

    #: (n, 3) float64: points of the surface.  The first ones are the zeros, in
    #: the order of Foliation.singularities.
    positions: Floats
    #: (m, 4) uint32, oriented as the triangles; in quad (a, b, c, d) the sides
    #: a-d and b-c lie on leaves.
    quads: Indices
    #: Vertices with another number of edges than 4.
    irregular_count: int = 0
    #: Quads with a corner of 0, or of 180 degrees or more, seen from outside the surface where they lie.
    inverted_count: int = 0
    #: Root of the area of the surface / number of quads.
    edge_length: float = 0.0
    #: Area of the quads / area of the surface.
    area_ratio: float = 0.0
    #: Greatest distance of a vertex of the surface from the quads near it.
    distance: float = 0.0

    def __len__(self) -> int:
        return len(self.quads)

    def __iter__(self) -> Iterator[Any]:
        """``positions, quads, ... = mesh``."""
        return iter(getattr(self, name) for name in self.__dataclass_fields__)

    def __repr__(self) -> str:
        return (
            f"<QuadMesh: {len(self.quads)} quads, {len(self.positions)} vertices, {self.irregular_count} irregular, "
            f"{self.inverted_count} inverted>"
        )

    def export(self, path: str | os.PathLike[str]) -> None:
        """Writes ``.obj``, ``.off``, ``.ply``, ``.vtp``, or ``.glb``, where each quad becomes two triangles."""
        export_quads(self, path)


def quads(
    foliation: Foliation,
    *,
    edge_length: float | None = None,
    count: int | None = None,
    merge: bool = False,
    keep_poles: bool = False,
    relax: int | None = None,
    progress: ProgressOption = None,
) -> QuadMesh:
    """A closed quad mesh along the leaves: a grid on each cylinder, glued along the critical leaves.

    A zero of order m has 2 m + 4 edges, every other vertex has 4.  Zeros that
    only discretization keeps apart can become one.  One quad lies over each
    pole, between two vertices with 3 edges.  ``hmf quads`` of the command line
    is ``quads(count=5000, merge=True, relax=40)``.

    Parameters
    ----------
    edge_length : float, optional
        Target for the mean edge length, in the unit of the positions; by default there are
        about half as many quads as triangles.
    count : int, optional
        Target number of quads instead; met as closely as the grids allow.
    merge : bool
        A critical leaf shorter than half an edge gets no quad, and its zeros become one vertex.
    keep_poles : bool
        A pole stays a vertex with two edges.
    relax : int, optional
        Rounds that move vertices on the surface to improve angles and sides; by default vertices stay on their leaves.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Raises
    ------
    UnsupportedError
        A zero surrounds a part of the surface that no leaf crosses, no grids match for edges so long, or too many
        relaxed quads would be folded.
    FoliationError
        The values cannot be used.
    """
    options = structure(
        "hmf_quad_options",
        edge_length=edge_length,
        count=count,
        merge=bool(merge),
        keep_poles=bool(keep_poles),
        relax=relax,
    )
    made = call(lib.hmf_quads, foliation._pointer, options, progress=progress)
    return QuadMesh(
        view(made, made.positions, made.vertex_count, 3),
        view(made, made.quads, made.quad_count, 4),
        made.irregular_count,
        made.inverted_count,
        made.edge_length,
        made.area_ratio,
        made.distance,
    )
