"""Global conformal parameterisation of a harmonic foliation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import Floats, ProgressCallback, Watch, as_indices, call, frozen, pointer
from ._native import ffi, lib

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
    flipped_triangles: int
    degenerate_triangles: int
    seam_edge_count: int
    seam_length: float  #: in the unit of the positions
    area: float  #: of the image: the energy, up to discretisation
    linear_iterations: int
    seconds: float

    def __repr__(self) -> str:
        return (
            f"<Parameterization: {len(self.corner_uv)} triangles, mean dilatation {self.dilatation_mean:.4g}, "
            f"{self.seam_edge_count} seam edges>"
        )


def parameterize(
    foliation: Foliation, tolerance: float | None, seam_edges: ArrayLike | None, callback: ProgressCallback | None
) -> Parameterization:
    """hmf_parameterize; the documentation is that of Foliation.parameterize."""
    level = foliation.hierarchy.levels[foliation.level]
    options = ffi.new("hmf_parameterize_options *")
    lib.hmf_parameterize_options_init(options)
    if tolerance is not None:
        options.tolerance = tolerance
    seams = np.empty(0, dtype=np.uint32) if seam_edges is None else as_indices(seam_edges, "seam_edges")
    if seams.size:
        options.seam_edges = pointer(seams, "uint32_t *")
        options.seam_edge_count = seams.size
    watch = Watch(callback)
    alive = watch.install(options)

    out = ffi.new("hmf_parameterization *")
    out.struct_size = ffi.sizeof("hmf_parameterization")
    out.vertex_capacity = level.vertex_count
    out.edge_capacity = level.edge_count
    out.triangle_capacity = level.triangle_count
    arrays: dict[str, NDArray[Any]] = {
        "corner_uv": np.empty((level.triangle_count, 3, 2), dtype=np.float64),
        "transition": np.empty((level.edge_count, 3), dtype=np.float64),
        "seam": np.empty(level.edge_count, dtype=np.uint8),
        "cone": np.empty(level.vertex_count, dtype=np.int32),
        "dilatation": np.empty(level.triangle_count, dtype=np.float64),
        "differential": np.empty((level.triangle_count, 2), dtype=np.float64),
    }
    for name, array in arrays.items():
        setattr(out, name, ffi.cast(ffi.typeof(getattr(out, name)), array.__array_interface__["data"][0]))
    call(lib.hmf_parameterize, *foliation._given(), options, out, watch=watch)
    del alive
    return Parameterization(
        corner_uv=frozen(arrays["corner_uv"]),
        transition=frozen(arrays["transition"]),
        seam=frozen(arrays["seam"].view(np.bool_)),
        cone=frozen(arrays["cone"]),
        dilatation=frozen(arrays["dilatation"]),
        differential=frozen(arrays["differential"].view(np.complex128)[:, 0]),
        dilatation_mean=out.dilatation_mean,
        dilatation_median=out.dilatation_median,
        dilatation_p99=out.dilatation_p99,
        flipped_triangles=out.flipped_triangles,
        degenerate_triangles=out.degenerate_triangles,
        seam_edge_count=out.seam_edge_count,
        seam_length=out.seam_length,
        area=out.area,
        linear_iterations=out.linear_iterations,
        seconds=out.seconds,
    )
