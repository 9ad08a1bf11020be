"""The cylinders of a harmonic foliation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import call, optional_index, pointer, structure_dtype
from ._native import ffi, lib
from .loops import Loops, as_loops

if TYPE_CHECKING:
    from .foliation import Foliation

_CYLINDER = structure_dtype("hmf_cylinder")


@dataclass(frozen=True)
class Cylinder:
    """One cylinder; lengths are those of the flat metric du^2 + dv^2, in the unit of the values."""

    loop: int | None  #: which of the given loops; None if none were given
    height: float  #: the weight of the loop, exactly
    circumference: float
    modulus: float  #: height / circumference
    area: float  #: areas add up to the energy


class Cylinders(Sequence[Cylinder]):
    """Cylinders from :meth:`Foliation.cylinders`, in the order of :attr:`Leaf.cylinder`.

    Attributes
    ----------
    leaves : Loops
        The leaf in the middle of each cylinder as a loop of triangles of the
        level, with the heights as weights: loops of the class of the foliation.
    """

    def __init__(self, entries: tuple[Cylinder, ...], leaves: Loops) -> None:
        self._entries = entries
        self.leaves = leaves

    def __len__(self) -> int:
        return len(self._entries)

    @overload
    def __getitem__(self, which: int) -> Cylinder: ...
    @overload
    def __getitem__(self, which: slice) -> tuple[Cylinder, ...]: ...
    def __getitem__(self, which: int | slice) -> Cylinder | tuple[Cylinder, ...]:
        return self._entries[which]

    def __iter__(self) -> Iterator[Cylinder]:
        return iter(self._entries)

    def __repr__(self) -> str:
        return f"<{len(self)} cylinders>"


def cylinders(foliation: Foliation, loops: Loops | Sequence[ArrayLike] | None, weights: ArrayLike | None) -> Cylinders:
    """hmf_cylinders; the documentation is that of Foliation.cylinders."""
    chosen = None if loops is None else as_loops(loops, weights)
    given = [*foliation._given(), ffi.NULL if chosen is None else chosen._structure()]
    counts = ffi.new("size_t[2]")
    # The counts do not depend on the loops, and are found faster without them.
    call(lib.hmf_cylinders, *foliation._given(), ffi.NULL, *[ffi.NULL, 0] * 3, counts, counts + 1)
    rows: NDArray[Any] = np.empty(counts[0], dtype=_CYLINDER)
    offsets = np.zeros(counts[0] + 1, dtype=np.uint64)
    triangles = np.empty(counts[1], dtype=np.uint32)
    call(
        lib.hmf_cylinders,
        *given,
        *[pointer(rows, "hmf_cylinder *"), rows.size],
        *[pointer(offsets, "uint64_t *"), offsets.size],
        *[pointer(triangles, "uint32_t *"), triangles.size],
        counts,
        counts + 1,
    )
    entries = tuple(
        Cylinder(optional_index(loop), height, circumference, modulus, area)
        for loop, height, circumference, modulus, area in rows[list(Cylinder.__dataclass_fields__)].tolist()
    )
    leaves = Loops._of_arrays(offsets, triangles, "triangles", foliation.level, [entry.height for entry in entries])
    return Cylinders(entries, leaves)
