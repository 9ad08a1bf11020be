"""Charts without overlap in the unit square."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ._boundary import Floats, Indices, ProgressOption, call, structure, view
from ._native import lib
from .export import export_atlas

if TYPE_CHECKING:
    from .foliation import Foliation


@dataclass(frozen=True, eq=False)
class Atlas:
    """Coordinates in the unit square for each triangle corner.

    Made by :meth:`Foliation.atlas`.  Arrays are read-only.
    """

    corner_uv: Floats  #: (triangle_count, 3, 2) float64
    triangle_chart: Indices  #: (triangle_count,) uint32
    chart_count: int
    used_area: float  #: part of the square that the triangles cover
    seam_length: float  #: in the unit of the positions, each side between two triangles once
    seam_edge_count: int  #: edges whose two triangles do not meet in the square
    collapsed_count: int  #: without a positive area there, where the foliation is nearly 0
    unevenness: float  #: standard deviation over the surface of the logarithm of the scale
    speck_count: int  #: triangles without area or below a millionth of the square, which the check of overlaps leaves out
    compared_count: int  #: edges of charts that the check compared
    _foliation: Foliation

    def export(self, path: str | os.PathLike[str]) -> None:
        """Writes the mesh with these texture coordinates: ``.obj``, ``.glb``, ``.ply`` or ``.vtp``."""
        export_atlas(self, path)

    def __repr__(self) -> str:
        return (
            f"<Atlas: {len(self.corner_uv)} triangles in {self.chart_count} charts, "
            f"{100 * self.used_area:.0f} % of the square used>"
        )


def atlas(foliation: Foliation, *, margin: float | None = None, progress: ProgressOption = None) -> Atlas:
    """Charts without overlap in the unit square, for painting and baking.

    Each cylinder of the foliation is a rectangle; charts are rectangles that
    are cut open, joined and packed.  They are as conformal as (u, v), and their
    areas are proportional to areas on the surface.  Even designs give fewer and
    larger charts (:func:`even_design`).

    Parameters
    ----------
    margin : float, optional
        Least distance of two charts, as a part of the side of the square, at most 1/16; default 1/512.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Raises
    ------
    FoliationError
        The values have a pole, or are too far from harmonic.
    UnsupportedError
        The surface has a boundary, or the margin is too large for so many charts.
    """
    options = structure("hmf_atlas_options", margin=margin)
    made = call(lib.hmf_atlas, foliation._pointer, options, progress=progress)
    fields: dict[str, Any] = {
        name: getattr(made, name) for name in Atlas.__dataclass_fields__ if name != "_foliation"
    }
    fields["corner_uv"] = view(made, made.corner_uv, made.triangle_count, 3, 2)
    fields["triangle_chart"] = view(made, made.triangle_chart, made.triangle_count)
    return Atlas(**fields, _foliation=foliation)
