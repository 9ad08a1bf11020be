"""Sets of closed curves on a level of a hierarchy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import (
    Floats,
    Indices,
    as_count,
    as_floats,
    as_indices,
    constant,
    frozen,
    names,
    pointer,
    structure,
    view,
)
from ._native import ffi

LoopKind = Literal["vertices", "triangles"]


class Loops(Sequence[Indices]):
    """Disjoint closed curves with weights: they give the class of a foliation.

    Parameters
    ----------
    paths : sequence of sequences of int
        One path for each loop.  Consecutive elements are neighbours, and so
        are the last and the first.
    kind : "vertices" or "triangles"
        Vertices that follow each other along edges, or triangles that follow
        each other across edges.
    level : int
        Of the hierarchy; 0 is your mesh.
    weights : (number of loops,) floats, optional
        Positive; None means 1 each.  They set the unit of the values.

    Whether the loops are closed, simple, disjoint, essential and not parallel
    is checked by the call that uses them (:class:`hmf.LoopError`).
    """

    def __init__(
        self,
        paths: Sequence[ArrayLike],
        *,
        kind: LoopKind = "vertices",
        level: int = 0,
        weights: ArrayLike | None = None,
    ) -> None:
        arrays = [as_indices(path, f"loop {number}") for number, path in enumerate(paths)]
        offsets = np.zeros(len(arrays) + 1, dtype=np.uint64)
        np.cumsum([len(array) for array in arrays], out=offsets[1:])
        elements = np.concatenate(arrays) if arrays else np.empty(0, dtype=np.uint32)
        self._set(offsets, elements, kind, level, weights)

    def _set(
        self,
        offsets: NDArray[np.uint64],
        elements: Indices,
        kind: LoopKind,
        level: int,
        weights: ArrayLike | None,
    ) -> Loops:
        self._element_kind = constant("LOOP", kind, "kind of a loop")
        self._kind: LoopKind = kind
        self._offsets = frozen(offsets)
        self._elements = frozen(elements)
        self._level = as_count(level, "level")
        self._weights: Floats | None = None
        if weights is not None:
            self._weights = frozen(as_floats(weights, len(offsets) - 1, "weights", "loop").copy())
        return self

    @classmethod
    def _of(cls, given: Any, owner: Any) -> Loops:
        """The loops of an hmf_loop_set, which lies in memory that ``owner`` keeps alive."""
        offsets = view(owner, given.offsets, given.count + 1)
        elements = view(owner, given.elements, int(offsets[-1]))
        weights = None if given.weights == ffi.NULL else view(owner, given.weights, given.count)
        return cls.__new__(cls)._set(offsets, elements, names("LOOP")[given.element_kind], given.level, weights)

    @property
    def kind(self) -> LoopKind:
        """What the elements are."""
        return self._kind

    @property
    def level(self) -> int:
        """Level of the elements."""
        return self._level

    @property
    def weights(self) -> Floats:
        """(number of loops,) float64."""
        return np.ones(len(self)) if self._weights is None else self._weights

    @property
    def offsets(self) -> NDArray[np.uint64]:
        """(number of loops + 1,): loop i is ``elements[offsets[i]:offsets[i + 1]]``."""
        return self._offsets

    @property
    def elements(self) -> Indices:
        """All elements, one loop after the other."""
        return self._elements

    def with_weights(self, weights: ArrayLike | None) -> Loops:
        """The same loops with other weights; None means 1 each."""
        loops = type(self).__new__(type(self))
        return loops._set(self._offsets, self._elements, self._kind, self._level, weights)

    def __len__(self) -> int:
        return len(self._offsets) - 1

    @overload
    def __getitem__(self, which: int) -> Indices: ...
    @overload
    def __getitem__(self, which: slice) -> Loops: ...
    def __getitem__(self, which: int | slice) -> Indices | Loops:
        """One loop as (length,) uint32; of a slice, the set of those loops."""
        if isinstance(which, slice):
            chosen = range(len(self))[which]
            weights = None if self._weights is None else self._weights[which]
            return Loops([self[i] for i in chosen], kind=self._kind, level=self._level, weights=weights)
        number = range(len(self))[which]
        return self._elements[int(self._offsets[number]) : int(self._offsets[number + 1])]

    def __repr__(self) -> str:
        return f"<{len(self)} loops of {self._kind} on level {self._level}>"

    def _structure(self) -> Any:
        """hmf_loop_set; valid as long as these loops are."""
        return structure(
            "hmf_loop_set",
            element_kind=self._element_kind,
            level=self._level,
            count=len(self),
            offsets=pointer(self._offsets, "uint64_t *"),
            elements=pointer(self._elements, "uint32_t *"),
            weights=None if self._weights is None else pointer(self._weights, "double *"),
        )


def as_loops(loops: Loops | Sequence[ArrayLike], weights: ArrayLike | None) -> Loops:
    """Loops as they are; other sequences are paths of vertices of level 0."""
    if not isinstance(loops, Loops):
        return Loops(loops, weights=weights)
    return loops if weights is None else loops.with_weights(weights)


def loop_structure(loops: Loops | Sequence[ArrayLike] | None, weights: ArrayLike | None) -> tuple[Any, Loops | None]:
    """hmf_loop_set, NULL of None, and the loops to keep as long as it is used."""
    chosen = None if loops is None else as_loops(loops, weights)
    return (ffi.NULL if chosen is None else chosen._structure()), chosen
