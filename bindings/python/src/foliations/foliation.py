"""A foliation on a level, and what it is like."""

from __future__ import annotations

import os
import zlib
from contextvars import ContextVar
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from ._boundary import (
    Floats,
    Indices,
    Outcome,
    ProgressOption,
    Rows,
    as_count,
    call,
    names,
    pointer,
    run,
    view,
)
from ._native import ffi, lib
from ._options import RelaxOptions, solve_options, takes
from ._show import repr_png, show
from .atlas import atlas
from .cylinders import cylinders
from .errors import Cancelled, LimitWarning, Status, warn
from .export import export_foliation, export_singularities
from .leaves import trace
from .loops import Loops, as_loops
from .parameterization import parameterize
from .quads import quads
from .report import Report, boundary_words, read_report

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .hierarchy import Hierarchy

SingularityKind = Literal["vertex", "triangle", "cluster"]

#: Whether no LimitWarning is wanted: the caller says it in another way.
quiet: ContextVar[bool] = ContextVar("quiet", default=False)

#: Statuses with which hmf_solve and hmf_relax may give a foliation.
STOPPED = frozenset(status for status in Status if status.name.startswith("LIMIT_")) | {Status.CANCELLED}
_SINGULARITY_KINDS: dict[int, SingularityKind] = names("SINGULAR")


@dataclass(frozen=True)
class Singularity:
    """A zero, a pole, or a marked vertex that is neither."""

    kind: SingularityKind  #: where it is
    index: int  #: below 0 a zero of order -index, above 0 a pole, 0 a marked vertex that is no zero
    element: int  #: the vertex or triangle; of a cluster its lowest vertex
    size: int  #: vertices of a cluster, otherwise 1
    #: Of the vertex, the middle of the triangle, the mean of the cluster; with boundary its vertex nearest to that.
    position: tuple[float, float, float]


class Singularities(Rows[Singularity]):
    """Zeros and poles of a foliation, followed by the marked vertices that are in no zero.

    Indices add up to 4 - 4 genus - marked vertices.

    Attributes
    ----------
    positions : (n, 3) float64
        Of all of them, in the unit of the positions.
    vertex_index : (vertex_count,) int32
        Index of each vertex; of a cluster, at its lowest vertex and 0 at the others.
    triangle_index : (triangle_count,) int32
        0 or -1.
    vertex_cluster : (vertex_count,) uint32
        Lowest vertex of the cluster of vertices joined by edges of value 0.
    """

    def __init__(
        self,
        rows: NDArray[Any],
        vertex_index: NDArray[np.int32],
        triangle_index: NDArray[np.int32],
        vertex_cluster: Indices,
    ) -> None:
        super().__init__(rows)
        self.positions: Floats = rows["position"]
        self.vertex_index = vertex_index
        self.triangle_index = triangle_index
        self.vertex_cluster = vertex_cluster

    def _entry(self, number: int, row: dict[str, Any]) -> Singularity:
        row.update(kind=_SINGULARITY_KINDS[row["kind"]], position=tuple(row["position"].tolist()))
        return Singularity(**row)

    @property
    def zeros(self) -> tuple[Singularity, ...]:
        """Those of negative index."""
        return tuple(entry for entry in self if entry.index < 0)

    @property
    def poles(self) -> tuple[Singularity, ...]:
        """Those of positive index: none in a result of the library."""
        return tuple(entry for entry in self if entry.index > 0)

    @property
    def marks(self) -> tuple[Singularity, ...]:
        """Those of index 0: marked vertices that are in no zero."""
        return tuple(entry for entry in self if entry.index == 0)

    @property
    def index_sum(self) -> int:
        """4 - 4 genus - marked vertices."""
        return int(self._rows["index"].sum())

    export = export_singularities

    def __repr__(self) -> str:
        marks = f", {len(self.marks)} marks" if self.marks else ""
        return f"<{len(self.zeros)} zeros, {len(self.poles)} poles{marks}>"


class Foliation:
    """One value for each edge of a level; made by :meth:`Hierarchy.solve` and others.

    Immutable.  ``numpy.asarray(foliation)`` is its values.
    """

    _hierarchy: Hierarchy
    _pointer: Any
    _values: Floats
    _status: Status
    _report: Report | None
    _energy: float | None
    _loops: Loops | str | None
    _weights: Floats | None

    def __init__(self) -> None:
        raise TypeError("foliations are made by foliations.solve, or by solve, initialize and foliation of a Hierarchy")

    @classmethod
    def _of(cls, hierarchy: Hierarchy, pointer: Any, status: Status = Status.OK) -> Foliation:
        foliation = cls.__new__(cls)
        count = ffi.new("size_t *")
        values = lib.hmf_foliation_values(pointer, count)
        foliation._hierarchy = hierarchy
        foliation._pointer = pointer
        foliation._values = view(pointer, values, count[0])
        foliation._status = status
        foliation._report = None
        foliation._energy = None
        foliation._loops = foliation._weights = None
        return foliation

    def _belongs_to(self, loops: Loops | str | None, weights: Floats | None) -> Foliation:
        """Loops, or a kind of loops of the library, with weights; they give its class."""
        self._loops, self._weights = loops, weights
        return self

    @staticmethod
    def _again(hierarchy: Hierarchy, level: int, values: Floats, status: Status, report: Report | None) -> Foliation:
        foliation = hierarchy.foliation(values, level=level)
        foliation._status = status
        foliation._report = report
        return foliation

    def __reduce__(self) -> tuple[Any, ...]:
        return Foliation._again, (self._hierarchy, self.level, self._values, self._status, self.report)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes level and values exactly to a NumPy archive (npz), without mesh and report."""
        level, mesh = self.level, _checksum(self._hierarchy, self.level)
        with open(path, "wb") as file:
            np.savez_compressed(file, values=self._values, level=level, status=int(self._status), mesh=mesh)

    @staticmethod
    def load(path: str | os.PathLike[str], hierarchy: Hierarchy, *, progress: ProgressOption = None) -> Foliation:
        """Reads a file of :meth:`save`, on a hierarchy of the same mesh.

        For level 0 the same triangles are enough; coarser levels take the
        same positions and options as well.
        """
        try:
            with np.load(path, allow_pickle=False) as stored:
                values, level, status, mesh = (stored[name] for name in ("values", "level", "status", "mesh"))
        except (KeyError, TypeError, ValueError, EOFError, BadZipFile) as error:
            raise ValueError(f"{os.fspath(path)} is no file that Foliation.save has written.") from error
        foliation = hierarchy.foliation(values, level=int(level), progress=progress)
        if mesh != _checksum(hierarchy, foliation.level):
            raise ValueError(f"{os.fspath(path)} belongs to other triangles: give the hierarchy it was saved from.")
        foliation._status = Status(int(status))
        return foliation

    @property
    def hierarchy(self) -> Hierarchy:
        """The hierarchy of the foliation."""
        return self._hierarchy

    @property
    def loops(self) -> Loops | None:
        """The loops of the solve, with their weights; None if the values came without loops.

        Those of the library lie on your mesh, level 0.
        """
        if isinstance(self._loops, str):
            self._loops = as_loops(self._hierarchy.loops(self._loops), self._weights)  # type: ignore[arg-type]
        return self._loops

    @property
    def level(self) -> int:
        """Level of the foliation; 0 is your mesh."""
        return int(lib.hmf_foliation_level(self._pointer))

    @property
    def unit(self) -> float:
        """The power of two that all values are multiples of."""
        return float(lib.hmf_foliation_unit(self._pointer))

    @property
    def memory(self) -> int:
        """Bytes held by the foliation, without its hierarchy.

        Grows once, at the first :meth:`parameterize`, :meth:`quads` or :meth:`trace`.
        """
        return int(lib.hmf_foliation_memory(self._pointer))

    @property
    def values(self) -> Floats:
        """(edge_count of the level,) float64, read-only, in the unit of the weights.

        The edges are those of ``hierarchy.levels[level].edges``.
        """
        return self._values

    @property
    def status(self) -> Status:
        """OK, or why the solve stopped early: LIMIT_... or CANCELLED (by ``Progress.FINISH``)."""
        return self._status

    @property
    def converged(self) -> bool:
        """Whether it was solved to the tolerance."""
        return self.report is not None and self.report.converged

    @property
    def report(self) -> Report | None:
        """Report of the solve that made it; None if none did."""
        if self._report is None:
            self._report = read_report(lib.hmf_foliation_report(self._pointer), self._hierarchy.boundary_count)
            if self._report is not None and self._report.boundaries:
                # The library counts on the closed double.
                found = self.singularities()._rows["index"]
                zeros, poles = -int(found[found < 0].sum()), int(found[found > 0].sum())
                self._report = replace(self._report, zeros=zeros, poles=poles, index_sum=int(found.sum()))
        return self._report

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if dtype is not None and np.dtype(dtype) != np.float64:
            if copy is False:
                raise ValueError("the values are float64; another dtype needs a copy")
            return self._values.astype(dtype)
        return self._values.copy() if copy else self._values

    def __len__(self) -> int:
        return len(self._values)

    @property
    def energy(self) -> float:
        """Dirichlet energy; on level 0 that on the intrinsic Delaunay triangulation."""
        if self._energy is None:
            result = ffi.new("double *")
            call(lib.hmf_energy, self._pointer, result)
            self._energy = float(result[0])
        return self._energy

    def residuals(self, *, progress: ProgressOption = None) -> Floats:
        """(vertex_count,) float64: violation of the harmonic condition at each vertex, without unit.

        0 everywhere means that this is the unique minimum of the energy.
        """
        made = call(lib.hmf_residuals, self._pointer, progress=progress)
        return view(made, made.values, made.vertex_count)

    def conformal_scale(self, *, progress: ProgressOption = None) -> Floats:
        """(triangle_count,) float64: natural logarithm of the length of the gradient on each triangle.

        The local scale of a conformal (u, v), in the unit of the values / the unit of the positions.
        """
        made = call(lib.hmf_conformal_scale, self._pointer, progress=progress)
        return view(made, made.log_scale, made.triangle_count)

    @property
    def unevenness(self) -> float:
        """Standard deviation of :meth:`conformal_scale` over the surface; 0: the same scale everywhere."""
        return float(call(lib.hmf_conformal_scale, self._pointer).unevenness)

    def singularities(self, *, progress: ProgressOption = None) -> Singularities:
        """Zeros and poles, and the marked vertices that are neither."""
        made = call(lib.hmf_singularities, self._pointer, progress=progress)
        return Singularities(
            view(made, made.list, made.count),
            view(made, made.vertex_index, made.vertex_count),
            view(made, made.triangle_index, made.triangle_count),
            view(made, made.vertex_cluster, made.vertex_count),
        )

    def interpolate(self, level: int, *, progress: ProgressOption = None) -> Foliation:
        """The foliation on another level, finer or coarser: exactly in the same class, but not harmonic there.

        For a quick preview of a mesh solve with ``stop_level`` instead.

        Raises
        ------
        LevelError
            There is no such level.
        FoliationError
            The values have a pole.
        """
        made = call(lib.hmf_interpolate, self._pointer, as_count(level, "level"), progress=progress)
        return Foliation._of(self._hierarchy, made)._belongs_to(self._loops, self._weights)

    @takes(RelaxOptions)
    def relax(self, *, progress: ProgressOption = None, **options: Unpack[RelaxOptions]) -> Foliation:
        """Solves on the level of this foliation, starting from it.

        After a mesh was deformed, ``hierarchy.foliation(previous.values).relax()`` takes 0.4 to 0.8 of the time of a
        solve from loops, and ``hierarchy.solve(initial=previous)`` 0.8 to 1.1 (kitten, botijo and fertility,
        24 000 to 42 000 edges, moved by 0.1 % and 2 % of their size).

        Parameters, result and errors as for :meth:`Hierarchy.solve`.

        Raises
        ------
        FoliationError
            The values have a pole.
        """
        outcome = run(lib.hmf_relax, self._pointer, solve_options(options), progress=progress, accept=STOPPED)
        return solved(self._hierarchy, outcome, self._loops, self._weights)

    # Applications (include/hmf/applications.h), a module for each.
    parameterize = parameterize
    trace = trace
    cylinders = cylinders
    quads = quads
    atlas = atlas
    export = export_foliation
    show = show
    _repr_png_ = repr_png

    def __repr__(self) -> str:
        mesh = self._hierarchy
        energy = "" if self.report is None else f", energy {self.report.energy:.6g}"
        return (
            f"<Foliation on level {self.level}: genus {mesh.genus}, {boundary_words(mesh.boundary_count)}"
            f"{len(self._values)} edges{energy}, {self._status.name}>"
        )


def _checksum(hierarchy: Hierarchy, level: int) -> int:
    return zlib.crc32(hierarchy.levels[level].triangles.tobytes())


def solved(
    hierarchy: Hierarchy, outcome: Outcome, loops: Loops | str | None = None, weights: Floats | None = None
) -> Foliation:
    """The foliation that hmf_solve or hmf_relax gave, with a warning if a limit stopped it."""
    status = outcome.status
    foliation = None
    if outcome.result is not None:
        foliation = Foliation._of(hierarchy, outcome.result, status)._belongs_to(loops, weights)
    if foliation is None or (status == Status.CANCELLED and not outcome.finished):
        raise Cancelled(outcome.message, status, foliation=foliation)
    if status not in (Status.OK, Status.CANCELLED) and not quiet.get():
        warn(outcome.message, LimitWarning)
    return foliation
