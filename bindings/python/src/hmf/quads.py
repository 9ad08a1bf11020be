"""Quad meshes along the leaves of a foliation."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ._boundary import Floats, Indices, call, frozen, pointer
from ._native import ffi, lib

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


def make_quads(foliation: Foliation, edge_length: float | None) -> QuadMesh:
    """hmf_quads; the documentation is that of Foliation.quads."""
    options = ffi.new("hmf_quad_options *")
    lib.hmf_quad_options_init(options)
    if edge_length is not None:
        options.edge_length = edge_length
    counts = ffi.new("size_t[2]")
    given = [*foliation._given(), options]
    call(lib.hmf_quads, *given, ffi.NULL, 0, ffi.NULL, 0, counts, counts + 1)
    positions = np.empty((counts[0], 3), dtype=np.float64)
    quads = np.empty((counts[1], 4), dtype=np.uint32)
    call(
        lib.hmf_quads,
        *given,
        *[pointer(positions, "double *"), len(positions)],
        *[pointer(quads, "uint32_t *"), len(quads)],
        counts,
        counts + 1,
    )
    return QuadMesh(frozen(positions), frozen(quads))
