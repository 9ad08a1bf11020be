"""Global conformal parameterization of a harmonic foliation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import Floats, ProgressOption, as_indices, call, pointer, structure, view
from ._native import lib

if TYPE_CHECKING:
    from .foliation import Foliation


@dataclass(frozen=True, eq=False)
class Parameterization:
    """(u, v) for each corner of each triangle; made by :meth:`Foliation.parameterize`.

    |du| is the foliation and v its harmonic conjugate.  The surface is cut
    along short seams through the zeros.  Of a point of an edge, (u, v) in the
    second of its triangles (the one with the higher number) is exactly
    ``sign * (u, v) + (du, dv)`` of the first.  Arrays are read-only.
    """

    corner_uv: Floats  #: (triangle_count, 3, 2) float64, in the unit of the values
    transition: Floats  #: (edge_count, 3) float64: sign (+1 or -1), du, dv; off the seams 1, 0, 0
    seam: NDArray[np.bool_]  #: (edge_count,): where the layout is cut
    cone: NDArray[np.int32]  #: (vertex_count,): cone angle as a multiple of pi, 2 = regular
    #: (triangle_count,) float64: ratio of the singular values of the map, at
    #: least 1, negative where the image is flipped, infinite where degenerate.
    dilatation: Floats
    #: (triangle_count,) complex128: quadratic differential in the frame of
    #: each triangle, x along its side 0, y to the left of it.
    differential: NDArray[np.complex128]
    dilatation_mean: float  #: of the absolute value, weighted by area, without degenerate triangles
    dilatation_median: float  #: by area
    dilatation_p99: float  #: by area
    flipped_count: int
    degenerate_count: int
    seam_edge_count: int
    seam_length: float  #: in the unit of the positions
    area: float  #: of the image: the energy, up to discretization
    linear_iterations: int
    seconds: float
    energy_ratio: float  #: energy of du / energy of the foliation; not 1 where zeros move to vertices
    area_error: float  #: relative difference of the area of the image and the energy of du
    circumference_least: float  #: circumference of a cylinder by du / by the foliation, the smallest of all
    circumference_most: float  #: and the largest

    def __repr__(self) -> str:
        return (
            f"<Parameterization: {len(self.corner_uv)} triangles, mean dilatation {self.dilatation_mean:.4g}, "
            f"{self.seam_edge_count} seam edges>"
        )


def parameterize(
    foliation: Foliation,
    *,
    tolerance: float | None = None,
    seam_edges: ArrayLike | None = None,
    progress: ProgressOption = None,
) -> Parameterization:
    """The global conformal parameterization that has this foliation as |du|.

    Parameters
    ----------
    tolerance : float, optional
        Largest residual of the values; default 1e-2.
    seam_edges : (n,) ints, optional
        Edges where seams cost nothing, so that they run there if they can.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Raises
    ------
    FoliationError
        The values have a pole, or are too far from harmonic.
    UnsupportedError
        The mesh is so coarse that it has no vertex for each zero.
    """
    seams = as_indices([] if seam_edges is None else seam_edges, "seam_edges")
    options = structure(
        "hmf_parameterize_options",
        tolerance=tolerance,
        seam_edges=pointer(seams, "uint32_t *") if seams.size else None,
        seam_edge_count=seams.size,
    )
    made = call(lib.hmf_parameterize, foliation._pointer, options, progress=progress)
    vertices, edges, triangles = made.vertex_count, made.edge_count, made.triangle_count
    fields: dict[str, Any] = {name: getattr(made, name) for name in Parameterization.__dataclass_fields__}
    fields["corner_uv"] = view(made, made.corner_uv, triangles, 3, 2)
    fields["transition"] = view(made, made.transition, edges, 3)
    fields["seam"] = view(made, made.seam, edges).view(np.bool_)
    fields["cone"] = view(made, made.cone, vertices)
    fields["dilatation"] = view(made, made.dilatation, triangles)
    fields["differential"] = view(made, made.differential, triangles, 2).view(np.complex128)[:, 0]
    return Parameterization(**fields)
