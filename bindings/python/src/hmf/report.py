"""What a solve tells about itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._boundary import pointer, structure_dtype
from ._native import ffi, lib

_LEVEL = structure_dtype("hmf_level_report")
_HISTORY = structure_dtype("hmf_history_entry")
_LEVEL_CAPACITY = 256
_HISTORY_CAPACITY = 1 << 16
_HISTORY_KINDS = ("interpolation", "sweep", "linear solve")


class LevelReport(NamedTuple):
    """Work on one level."""

    vertices: int
    edges: int
    nld: int  #: edges whose weight was raised to the floor
    iterations: int  #: sweeps of Whitehead moves
    linear_solves: int
    optimize_seconds: float
    interpolate_seconds: float  #: from the next coarser level to this one


class HistoryEntry(NamedTuple):
    """After each sweep or linear solve."""

    seconds: float  #: since the start of the call
    energy: float
    residual_max: float | None  #: None: not evaluated
    level: int
    kind: str  #: "interpolation", "sweep" or "linear solve"


@dataclass(frozen=True)
class Report:
    """Report of :meth:`Hierarchy.solve` and :meth:`Foliation.relax`."""

    method: str  #: "newton", "whitehead" or "single_level"
    converged: bool  #: to the tolerance
    energy: float  #: on the finest level solved, intrinsic Delaunay weights
    residual_max: float  #: relative coclosedness residual, see Foliation.residuals
    residual_mean: float
    poles: int  #: always 0
    zeros: int  #: counted with their orders: 4 genus - 4
    index_sum: int  #: 4 - 4 genus
    bad_flips: int  #: flips of case 4 of the paper that would have made a pole
    bad_flips_left: int  #: and did
    solve_seconds: float
    peak_memory_bytes: int  #: of the call, without the hierarchy
    levels: tuple[LevelReport, ...]  #: finest first
    history: tuple[HistoryEntry, ...]  #: in order of time, at most 65536


def _entry(row: Any) -> HistoryEntry:
    seconds, energy, residual, level, kind = row
    name = _HISTORY_KINDS[kind] if kind < len(_HISTORY_KINDS) else str(kind)
    return HistoryEntry(seconds, energy, None if residual < 0 else residual, level, name)


def _method_name(value: int) -> str:
    for name in dir(lib):
        if name.startswith("HMF_METHOD_") and name != "HMF_METHOD_DEFAULT" and getattr(lib, name) == value:
            return name[len("HMF_METHOD_") :].lower()
    return str(value)


class ReportBuffer:
    """hmf_report with room for levels and history."""

    def __init__(self) -> None:
        self._levels: NDArray[Any] = np.zeros(_LEVEL_CAPACITY, dtype=_LEVEL)
        self._history: NDArray[Any] = np.empty(_HISTORY_CAPACITY, dtype=_HISTORY)
        self.structure = ffi.new("hmf_report *")
        self.structure.struct_size = ffi.sizeof("hmf_report")
        self.structure.levels = pointer(self._levels, "hmf_level_report *")
        self.structure.level_capacity = _LEVEL_CAPACITY
        self.structure.history = pointer(self._history, "hmf_history_entry *")
        self.structure.history_capacity = _HISTORY_CAPACITY

    def read(self) -> Report:
        s = self.structure
        levels = self._levels[: min(s.level_count, _LEVEL_CAPACITY)][list(LevelReport._fields)]
        history = self._history[: min(s.history_count, _HISTORY_CAPACITY)][list(HistoryEntry._fields)]
        return Report(
            method=_method_name(s.method),
            converged=bool(s.converged),
            energy=s.energy,
            residual_max=s.residual_max,
            residual_mean=s.residual_mean,
            poles=s.poles,
            zeros=s.zeros,
            index_sum=s.index_sum,
            bad_flips=s.bad_flips,
            bad_flips_left=s.bad_flips_left,
            solve_seconds=s.solve_seconds,
            peak_memory_bytes=s.peak_memory_bytes,
            levels=tuple(LevelReport(*row) for row in levels.tolist()),
            history=tuple(_entry(row) for row in history.tolist()),
        )

