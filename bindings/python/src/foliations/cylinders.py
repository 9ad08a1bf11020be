"""The cylinders of a harmonic foliation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import ProgressOption, Rows, call, optional_index, view
from ._native import lib
from .loops import Loops, loop_structure

if TYPE_CHECKING:
    from .foliation import Foliation


@dataclass(frozen=True)
class Cylinder:
    """One cylinder; lengths are those of the flat metric du^2 + dv^2, in the unit of the values."""

    loop: int | None  #: which of the loops; None if there are none
    height: float  #: the weight of the loop, rounded to a multiple of the unit
    circumference: float
    modulus: float  #: height / circumference
    area: float  #: areas add up to the energy


class Cylinders(Rows[Cylinder]):
    """Cylinders from :meth:`Foliation.cylinders`, in the order of :attr:`Leaf.cylinder`.

    Attributes
    ----------
    leaves : Loops
        The leaf in the middle of each cylinder as a loop of triangles of the
        level, with the heights as weights: loops of the class of the foliation.
    area_error : float
        Relative difference of the sum of height * circumference and the energy.
    twists : (n,) array
        From the point opposite to the base of the first side to the base of the second side, along the leaves, with
        the second side on the right; in [0, circumference). NaN where there is none.
    corner_offsets : (2 n + 1,) array
        Corners of side s (0 or 1) of cylinder k: ``corner_offsets[2 * k + s]`` up to ``corner_offsets[2 * k + s + 1]``,
        the base first.
    corner_vertices : array
        For each corner the vertex of its zero, or the vertex of the triangle with the zero that lies ahead of the zero
        inside the cylinder. The base is the corner with the lowest one.
    corner_places : array
        For each corner its distance from the base of the first side, in [0, circumference). For other bases subtract
        their places.
    """

    def __init__(self, made: Any) -> None:
        super().__init__(view(made, made.list, made.count))
        self.leaves = Loops._of(made.leaves, made)
        self.area_error: float = made.area_error
        self.twists: NDArray[np.float64] = view(made, made.twists, made.count)
        self.corner_offsets: NDArray[np.uint64] = view(made, made.corner_offsets, 2 * made.count + 1)
        corners = int(self.corner_offsets[-1])
        self.corner_vertices: NDArray[np.uint32] = view(made, made.corner_vertices, corners)
        self.corner_places: NDArray[np.float64] = view(made, made.corner_places, corners)

    def _entry(self, number: int, row: dict[str, Any]) -> Cylinder:
        row["loop"] = optional_index(row["loop"])
        return Cylinder(**row)

    def __repr__(self) -> str:
        return f"<{len(self)} cylinders>"


def cylinders(
    foliation: Foliation,
    loops: Loops | Sequence[ArrayLike] | None = None,
    weights: ArrayLike | None = None,
    *,
    progress: ProgressOption = None,
) -> Cylinders:
    """The cylinders into which the critical leaves cut the surface: one for each loop, filled with closed leaves.

    Parameters
    ----------
    loops, weights : as for :meth:`Hierarchy.solve`, optional
        Loops of the foliation, to match cylinders to loops; default those of :attr:`Foliation.loops`.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Raises
    ------
    FoliationError
        The values do not belong to the loops, have a pole, or are too far from harmonic.
    LoopError
        The loops cannot be used.
    """
    given, alive = loop_structure(foliation.loops if loops is None else loops, weights)
    made = call(lib.hmf_cylinders, foliation._pointer, given, progress=progress)
    del alive
    return Cylinders(made)
