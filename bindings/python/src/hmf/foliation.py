"""A foliation on a level, and what it is like."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import (
    Floats,
    Indices,
    ProgressCallback,
    ProgressOption,
    Watch,
    as_count,
    call,
    constant,
    frozen,
    pointer,
    progress_callback,
    structure_dtype,
)
from ._native import ffi, lib
from .cylinders import Cylinders, cylinders
from .errors import Cancelled, LimitWarning, Status
from .leaves import Leaves, LeavesKind, trace
from .loops import Loops
from .parameterization import Parameterization, parameterize
from .quads import QuadMesh, make_quads
from .report import Report, ReportBuffer

if TYPE_CHECKING:
    from .hierarchy import Hierarchy

Method = Literal["newton", "whitehead", "single_level"]
SingularityKind = Literal["vertex", "triangle", "cluster"]

_LIMITS = frozenset({Status.LIMIT_ITERATIONS, Status.LIMIT_TIME, Status.LIMIT_STALLED})
_SINGULARITY = structure_dtype("hmf_singularity")
_SINGULARITY_KINDS: dict[int, SingularityKind] = {
    lib.HMF_SINGULAR_VERTEX: "vertex",
    lib.HMF_SINGULAR_TRIANGLE: "triangle",
    lib.HMF_SINGULAR_CLUSTER: "cluster",
}


@dataclass(frozen=True)
class Singularity:
    """A zero or a pole."""

    kind: SingularityKind  #: where it is
    index: int  #: below 0 a zero of order -index, above 0 a pole
    element: int  #: the vertex or triangle; of a cluster its lowest vertex
    size: int  #: vertices of a cluster, otherwise 1


class Singularities(Sequence[Singularity]):
    """Zeros and poles of a foliation; their indices add up to 4 - 4 genus.

    Attributes
    ----------
    vertex_index : (vertex_count,) int32
        Index of each vertex; of a cluster, at its lowest vertex and 0 at the others.
    triangle_index : (triangle_count,) int32
        0 or -1.
    vertex_cluster : (vertex_count,) uint32
        Lowest vertex of the cluster of vertices joined by edges of value 0.
    """

    def __init__(
        self,
        entries: tuple[Singularity, ...],
        vertex_index: NDArray[np.int32],
        triangle_index: NDArray[np.int32],
        vertex_cluster: Indices,
    ) -> None:
        self._entries = entries
        self.vertex_index = vertex_index
        self.triangle_index = triangle_index
        self.vertex_cluster = vertex_cluster

    @property
    def zeros(self) -> tuple[Singularity, ...]:
        """Those of negative index."""
        return tuple(entry for entry in self if entry.index < 0)

    @property
    def poles(self) -> tuple[Singularity, ...]:
        """Those of positive index: none in a result of the library."""
        return tuple(entry for entry in self if entry.index > 0)

    @property
    def index_sum(self) -> int:
        """4 - 4 genus."""
        return sum(entry.index for entry in self)

    def __len__(self) -> int:
        return len(self._entries)

    @overload
    def __getitem__(self, which: int) -> Singularity: ...
    @overload
    def __getitem__(self, which: slice) -> tuple[Singularity, ...]: ...
    def __getitem__(self, which: int | slice) -> Singularity | tuple[Singularity, ...]:
        return self._entries[which]

    def __iter__(self) -> Iterator[Singularity]:
        return iter(self._entries)

    def __repr__(self) -> str:
        return f"<{len(self.zeros)} zeros, {len(self.poles)} poles>"


class Foliation:
    """One value for each edge of a level; made by :meth:`Hierarchy.solve` and others.

    Immutable.  ``numpy.asarray(foliation)`` is its values.
    """

    _hierarchy: Hierarchy
    _level: int
    _values: Floats
    _status: Status
    _report: Report | None
    _energy: float | None

    def __init__(self) -> None:
        raise TypeError("foliations are made by hmf.solve, or by solve, initialize and foliation of a Hierarchy")

    @classmethod
    def _of(
        cls, hierarchy: Hierarchy, level: int, values: Floats, status: Status = Status.OK, report: Report | None = None
    ) -> Foliation:
        foliation = cls.__new__(cls)
        foliation._hierarchy = hierarchy
        foliation._level = level
        foliation._values = frozen(values)
        foliation._status = status
        foliation._report = report
        foliation._energy = None
        return foliation

    def __reduce__(self) -> tuple[Any, ...]:
        return Foliation._of, (self._hierarchy, self._level, self._values, self._status, self._report)

    @property
    def hierarchy(self) -> Hierarchy:
        """The hierarchy it lies on."""
        return self._hierarchy

    @property
    def level(self) -> int:
        """Its level; 0 is your mesh."""
        return self._level

    @property
    def values(self) -> Floats:
        """(edge_count of the level,) float64, read-only, in the unit of the weights.

        The edges are those of ``hierarchy.levels[level].edges``.
        """
        return self._values

    @property
    def status(self) -> Status:
        """OK, or why the improvement stopped: LIMIT_... or CANCELLED (by ``Progress.FINISH``)."""
        return self._status

    @property
    def converged(self) -> bool:
        """Whether it was solved, and to the tolerance."""
        return self._report is not None and self._report.converged

    @property
    def report(self) -> Report | None:
        """Report of the solve that made it; None if none did."""
        return self._report

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if dtype is not None and np.dtype(dtype) != np.float64:
            if copy is False:
                raise ValueError("the values are float64; another dtype needs a copy")
            return self._values.astype(dtype)
        return self._values.copy() if copy else self._values

    def __len__(self) -> int:
        return len(self._values)

    def _given(self) -> list[Any]:
        return [self._hierarchy._pointer, self._level, pointer(self._values, "double *"), self._values.size]

    @property
    def energy(self) -> float:
        """Dirichlet energy; on level 0 that on the intrinsic Delaunay triangulation."""
        if self._energy is None:
            result = ffi.new("double *")
            call(lib.hmf_energy, *self._given(), result)
            self._energy = float(result[0])
        return self._energy

    def residuals(self) -> Floats:
        """(vertex_count,) float64: violation of the harmonic condition at each vertex, without unit.

        0 everywhere means that this is the unique minimum of the energy.
        """
        result = np.empty(self._hierarchy.levels[self._level].vertex_count, dtype=np.float64)
        call(lib.hmf_residuals, *self._given(), pointer(result, "double *"), result.size)
        return result

    def singularities(self) -> Singularities:
        """Zeros and poles."""
        level = self._hierarchy.levels[self._level]
        vertex_index = np.empty(level.vertex_count, dtype=np.int32)
        triangle_index = np.empty(level.triangle_count, dtype=np.int32)
        vertex_cluster = np.empty(level.vertex_count, dtype=np.uint32)
        count = ffi.new("size_t *")
        none = [ffi.NULL, 0]
        call(
            lib.hmf_singularities,
            *self._given(),
            *[pointer(vertex_index, "int32_t *"), vertex_index.size],
            *[pointer(triangle_index, "int32_t *"), triangle_index.size],
            *[pointer(vertex_cluster, "uint32_t *"), vertex_cluster.size],
            *none,
            count,
        )
        rows: NDArray[Any] = np.empty(count[0], dtype=_SINGULARITY)
        if rows.size:
            filled = [pointer(rows, "hmf_singularity *"), rows.size]
            call(lib.hmf_singularities, *self._given(), *none, *none, *none, *filled, count)
        entries = tuple(
            Singularity(_SINGULARITY_KINDS[kind], index, element, size)
            for kind, index, element, size in rows[["kind", "index", "element", "size"]].tolist()
        )
        return Singularities(entries, frozen(vertex_index), frozen(triangle_index), frozen(vertex_cluster))

    def interpolate(self, level: int) -> Foliation:
        """The same class on another level, finer or coarser; exact.

        Raises
        ------
        LevelError
            There is no such level.
        FoliationError
            The values are not closed, or have a pole.
        """
        number = as_count(level, "level")
        levels = self._hierarchy.levels
        result = np.empty(levels[number].edge_count if number < len(levels) else 0, dtype=np.float64)
        call(lib.hmf_interpolate, *self._given(), number, pointer(result, "double *"), result.size)
        return Foliation._of(self._hierarchy, number, result)

    def relax(
        self,
        *,
        method: Method | None = None,
        tolerance: float | None = None,
        time_limit: float | None = None,
        iteration_limit: int | None = None,
        progress: ProgressOption = None,
    ) -> Foliation:
        """These values improved on their level; parameters, result and errors as for :meth:`Hierarchy.solve`.

        Raises
        ------
        FoliationError
            The values are not closed, or have a pole.
        """
        with progress_callback(progress, "hmf relax") as callback:
            return optimise(
                self._hierarchy,
                self._level,
                self._values.copy(),
                lambda options, values, size, report, error: lib.hmf_relax(
                    self._hierarchy._pointer, self._level, options, values, size, report, error
                ),
                method=method,
                tolerance=tolerance,
                time_limit=time_limit,
                iteration_limit=iteration_limit,
                stop_level=0,
                initial=None,
                callback=callback,
                stacklevel=3,
            )

    def parameterize(
        self,
        *,
        tolerance: float | None = None,
        seam_edges: ArrayLike | None = None,
        progress: ProgressOption = None,
    ) -> Parameterization:
        """The global conformal parameterisation that has this foliation as |du|.

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
            The values are not closed, have a pole, or are too far from harmonic.
        UnsupportedError
            The mesh is so coarse that two zeros need the same vertex.
        """
        with progress_callback(progress, "hmf parameterize") as callback:
            return parameterize(self, tolerance, seam_edges, callback)

    def trace(
        self,
        *,
        leaves: LeavesKind = "foliation",
        spacing: float | None = None,
        critical: bool = False,
        length_limit: float | None = None,
        point_triangles: ArrayLike | None = None,
        point_barycentrics: ArrayLike | None = None,
    ) -> Leaves:
        """Leaves as polylines; without any argument the critical ones, which join zeros.

        No two leaves of the foliation cross, and each closes exactly; its
        values need not be harmonic.  Conjugate leaves do not close in general,
        and need harmonic values; their level sets go across each cylinder.

        Parameters
        ----------
        leaves : "foliation" or "conjugate"
            Those along which u is constant, or v; see :meth:`parameterize`.
        spacing : float, optional
            Leaves about so far apart, in the unit of the values, all over the surface.
        critical : bool
            All leaves out of zeros.
        length_limit : float, optional
            Where a leaf stops, in each direction, in the unit of the
            positions; default nowhere, for conjugate leaves after ten times
            the root of the area of the surface.
        point_triangles, point_barycentrics : (n,) ints and (n, 3) floats, optional
            The leaves through these points, given by triangle and barycentric
            coordinates: not negative, of sum 1.

        Raises
        ------
        FoliationError
            The values are not closed, have a pole, or belong to no loops that can be followed.
        OptionsError
            A number is out of range.
        """
        return trace(self, leaves, spacing, critical, length_limit, point_triangles, point_barycentrics)

    def cylinders(self, loops: Loops | Sequence[ArrayLike] | None = None, weights: ArrayLike | None = None) -> Cylinders:
        """The cylinders into which the critical leaves cut the surface: one for each loop, filled with closed leaves.

        Parameters
        ----------
        loops, weights : as for :meth:`Hierarchy.solve`, optional
            Those that the values belong to, to say which cylinder is whose.

        Raises
        ------
        FoliationError
            The values do not belong to the loops, are not closed, have a pole, or are too far from harmonic.
        LoopError
            The loops cannot be used.
        """
        return cylinders(self, loops, weights)

    def quads(self, *, edge_length: float | None = None) -> QuadMesh:
        """A closed quad mesh along the leaves: a grid on each cylinder, glued along the critical leaves.

        A zero of order m has 2 m + 4 edges, every other vertex has 4.  Zeros
        that only discretisation keeps apart can become one.

        Parameters
        ----------
        edge_length : float, optional
            Wished mean length of an edge, in the unit of the positions;
            default: about half as many quads as there are triangles.

        Raises
        ------
        UnsupportedError
            A zero goes round a part of the surface that no leaf crosses, or no grids match for edges so long.
        FoliationError
            The values cannot be used.
        """
        return make_quads(self, edge_length)

    def __repr__(self) -> str:
        return f"<Foliation on level {self._level}: {len(self._values)} edges, {self._status.name}>"


def optimise(
    hierarchy: Hierarchy,
    level: int,
    values: Floats,
    function: Callable[..., int],
    *,
    method: Method | None,
    tolerance: float | None,
    time_limit: float | None,
    iteration_limit: int | None,
    stop_level: int,
    initial: Foliation | None,
    callback: ProgressCallback | None,
    stacklevel: int,
) -> Foliation:
    """Runs hmf_solve or hmf_relax into ``values`` and makes a foliation of what comes back."""
    options = ffi.new("hmf_solve_options *")
    lib.hmf_solve_options_init(options)
    if method is not None:
        options.method = constant("METHOD", method, "method")
    if tolerance is not None:
        options.tolerance = tolerance
    if time_limit is not None:
        options.time_limit = time_limit
    if iteration_limit is not None:
        options.iteration_limit = as_count(iteration_limit, "iteration_limit")
    options.stop_level = stop_level
    if initial is not None:
        options.initial_values = pointer(initial.values, "double *")
        options.initial_count = initial.values.size
        options.initial_level = initial.level
    watch = Watch(callback)
    alive = watch.install(options)
    report = ReportBuffer()
    status, message = call(
        function,
        options,
        pointer(values, "double *"),
        values.size,
        report.structure,
        watch=watch,
        accept=_LIMITS | {Status.CANCELLED},
    )
    del alive
    written = bool(report.structure.values_written)
    foliation = Foliation._of(hierarchy, level, values, status, report.read()) if written else None
    if foliation is None or (status == Status.CANCELLED and not watch.finished):
        raise Cancelled(message, status, foliation=foliation)
    if status in _LIMITS:
        warnings.warn(message, LimitWarning, stacklevel=stacklevel)
    return foliation
