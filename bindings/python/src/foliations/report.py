"""The report of a solve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from ._boundary import names, view
from ._native import ffi

#: What is known of the class of a result.
ClassState = Literal["unknown", "proven", "lost"]

_HISTORY_KINDS = ("interpolation", "sweep", "linear solve")


class LevelReport(NamedTuple):
    """Work on one level."""

    vertex_count: int
    edge_count: int
    raised_count: int  #: edges whose weight was raised to the floor
    sweep_count: int  #: sweeps of Whitehead moves
    linear_solve_count: int
    optimize_seconds: float
    interpolate_seconds: float  #: from the next coarser level to this one


class HistoryEntry(NamedTuple):
    """After each sweep or linear solve."""

    seconds: float  #: since the start of the call
    energy: float
    residual_max: float | None  #: None: not evaluated
    level: int
    kind: str  #: "interpolation", "sweep" or "linear solve"


@dataclass(frozen=True, repr=False)
class Report:
    """Report of :meth:`Hierarchy.solve` and :meth:`Foliation.relax`."""

    method: str  #: "newton", "whitehead", "single_level" or "paper"
    converged: bool  #: to the tolerance
    energy: float  #: on the finest level solved, intrinsic Delaunay weights
    residual_max: float  #: relative coclosedness residual, see Foliation.residuals
    residual_mean: float
    poles: int  #: always 0
    zeros: int  #: counted with their orders: 4 genus - 4 + marked vertices; with boundary those of the surface
    index_sum: int  #: 4 - 4 genus - marked vertices; with boundary the sum over the surface
    boundaries: int  #: closed curves that the boundary of the surface consists of
    bad_flips: int  #: flips of case 4 of the paper that would have made a pole
    bad_flips_left: int  #: and did
    solve_seconds: float
    peak_memory_bytes: int  #: of the call, without the hierarchy
    levels: tuple[LevelReport, ...]  #: finest first
    history: tuple[HistoryEntry, ...]  #: in order of time
    #: Do the values belong to the loops?  "proven": exactly, one cylinder for each loop, as high as its weight and
    #: freely homotopic to it; "lost": no, never with OK; "unknown": not checked, as after relax.
    class_state: ClassState
    class_repeats: int  #: levels that were solved once more, as the first result had left the class
    class_seconds: float  #: for the certificate, part of solve_seconds

    def __str__(self) -> str:
        """Several lines: the result, its cost, and the work on each level."""
        reached = "converged" if self.converged else "not converged"
        residual = f"residual {self.residual_max:.2g}" if self.residual_max >= 0 else "residual not evaluated"
        lines = [
            f"{self.method}: {reached}, {residual}",
            f"{boundary_words(self.boundaries)}energy {self.energy:.12g}, {_counted(self.zeros, 'zero')}, "
            f"{_counted(self.poles, 'pole')}, class {self.class_state}",
            f"{self.solve_seconds:.3g} s, {self.peak_memory_bytes / 1e6:.3g} MB, {len(self.history)} steps",
            "level  vertices     edges  sweeps  linear solves  seconds",
        ]
        for number, level in enumerate(self.levels):
            seconds = level.optimize_seconds + level.interpolate_seconds
            counts = f"{number:5}{level.vertex_count:10}{level.edge_count:10}{level.sweep_count:8}{level.linear_solve_count:15}"
            lines.append(f"{counts}{seconds:9.3f}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        reached = "converged" if self.converged else "not converged"
        return (
            f"<Report: {self.method}, {reached}, energy {self.energy:.6g}, class {self.class_state}; print it for more>"
        )


def _entry(row: Any) -> HistoryEntry:
    seconds, energy, residual, level, kind = row
    name = _HISTORY_KINDS[kind] if kind < len(_HISTORY_KINDS) else str(kind)
    return HistoryEntry(seconds, energy, None if residual < 0 else residual, level, name)


def _counted(number: int, noun: str, several: str | None = None) -> str:
    return f"{number} {noun if number == 1 else several or noun + 's'}"


def boundary_words(count: int) -> str:
    """In a summary; a closed surface needs no words."""
    return "" if count == 0 else _counted(count, "boundary", "boundaries") + ", "


def read_report(pointer: Any, boundary_count: int) -> Report | None:
    """The report of a foliation; None of NULL."""
    if pointer == ffi.NULL:
        return None
    # Read at once, so that nothing has to keep the memory.
    fields: dict[str, Any] = {
        name: getattr(pointer, name) for name in Report.__dataclass_fields__ if name != "boundaries"
    }
    fields["boundaries"] = boundary_count
    fields["method"] = names("METHOD").get(pointer.method, str(pointer.method))
    fields["class_state"] = names("CLASS").get(pointer.class_state, str(pointer.class_state))
    fields["converged"] = bool(pointer.converged)
    fields["levels"] = tuple(LevelReport(*row) for row in view(None, pointer.levels, pointer.level_count).tolist())
    fields["history"] = tuple(_entry(row) for row in view(None, pointer.history, pointer.history_count).tolist())
    return Report(**fields)
