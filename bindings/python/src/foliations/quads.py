"""Quad meshes along the leaves of a foliation."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from ._boundary import Floats, Indices, ProgressOption, call, structure, view
from ._native import lib
from .export import export_quads

if TYPE_CHECKING:
    from .foliation import Foliation


class QuadMesh(NamedTuple):
    """A closed quad mesh from :meth:`Foliation.quads`; arrays are read-only."""

    #: (n, 3) float64: points of the surface.  The first ones are the zeros, in
    #: the order of Foliation.singularities.
    positions: Floats
    #: (m, 4) uint32, oriented as the triangles; in quad (a, b, c, d) the sides
    #: a-d and b-c lie on leaves.
    quads: Indices

    def export(self, path: str | os.PathLike[str]) -> None:
        """Writes ``.obj``, ``.off``, ``.ply``, ``.vtp``, or ``.glb``, where each quad becomes two triangles."""
        export_quads(self, path)


def quads(foliation: Foliation, *, edge_length: float | None = None, progress: ProgressOption = None) -> QuadMesh:
    """A closed quad mesh along the leaves: a grid on each cylinder, glued along the critical leaves.

    A zero of order m has 2 m + 4 edges, every other vertex has 4.  Zeros that
    only discretisation keeps apart can become one.

    Parameters
    ----------
    edge_length : float, optional
        Wished mean length of an edge, in the unit of the positions; default:
        about half as many quads as there are triangles.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Raises
    ------
    UnsupportedError
        A zero goes round a part of the surface that no leaf crosses, or no grids match for edges so long.
    FoliationError
        The values cannot be used.
    """
    options = structure("hmf_quad_options", edge_length=edge_length)
    made = call(lib.hmf_quads, foliation._pointer, options, progress=progress)
    return QuadMesh(view(made, made.positions, made.vertex_count, 3), view(made, made.quads, made.quad_count, 4))
