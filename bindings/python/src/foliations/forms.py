"""Harmonic 1-forms of a closed surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ._boundary import Floats, ProgressOption, as_count, call, view
from ._native import lib

if TYPE_CHECKING:
    from .hierarchy import Hierarchy


@dataclass(frozen=True, repr=False)
class HarmonicForms:
    """A basis of the harmonic 1-forms, from :meth:`Hierarchy.harmonic_forms`: n = 2 genus forms.

    Forms ``0 .. genus - 1`` are a[0], a[1], ..., forms ``genus .. n - 1`` are b[0], b[1], ...
    """

    values: Floats  #: (n, edge_count) float64: integral of each form along each edge, from its first vertex to its second
    intersections: NDArray[np.int32]  #: (n, n): integral of form i ^ form j: 1 at (a[k], b[k]), -1 at (b[k], a[k]), else 0
    inner_products: Floats  #: (n, n): of the forms, symmetric and positive definite
    conjugation: Floats  #: (n, n): the conjugate of form j is the sum of entry (i, j) times form i, up to discretization
    period_matrix: NDArray[np.complex128]  #: (genus, genus) p: symmetric; a[k] + the sum of p[k, j] b[j] is holomorphic
    residual: float  #: largest divergence at the vertices, relative to the fluxes; at most 1e-8
    conjugation_error: float  #: largest absolute entry of conjugation^2 + identity

    @property
    def genus(self) -> int:
        """Half the number of forms."""
        return len(self.values) // 2

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        return f"<{len(self)} harmonic forms on {self.values.shape[1]} edges>"


def harmonic_forms(hierarchy: Hierarchy, level: int = 0, *, progress: ProgressOption = None) -> HarmonicForms:
    """A basis of the harmonic 1-forms of a closed surface, and its period matrix.

    A form is one number per edge.  In each triangle the three numbers add up to exactly 0, along a closed path of edges
    they add up to an integer, and among all such forms with the same integers each has the least energy.

    Parameters
    ----------
    level : int
        Of the hierarchy; 0 is your mesh.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Raises
    ------
    MeshError
        The surface has a boundary.
    UnsupportedError
        The linear systems could not be solved accurately enough.
    LevelError
        There is no such level.
    """
    made = call(lib.hmf_harmonic_forms, hierarchy._pointer, as_count(level, "level"), progress=progress)
    n, genus, edges = made.form_count, made.genus, made.edge_count
    real = view(made, made.period_real, genus, genus)
    return HarmonicForms(
        view(made, made.values, n, edges),
        view(made, made.intersections, n, n),
        view(made, made.inner_products, n, n),
        view(made, made.conjugation, n, n),
        real + 1j * view(made, made.period_imaginary, genus, genus),
        made.residual,
        made.conjugation_error,
    )
