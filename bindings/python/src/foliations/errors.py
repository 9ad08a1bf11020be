"""Statuses of the library as Python exceptions and warnings.

Every failure of the library is an :class:`Error` of the subclass of its kind,
which derives from the builtin exception that fits as well.  Arguments that do
not even have the right type or shape are refused before the library is
called, with a plain :class:`TypeError` or :class:`ValueError`.
"""

from __future__ import annotations

import re
import sys
import warnings
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._native import ffi, lib

if TYPE_CHECKING:
    from .foliation import Foliation


class Status(IntEnum):
    """Result of a call, ``HMF_*`` of the C header.  Values never change."""

    OK = 0
    LIMIT_ITERATIONS = 10
    LIMIT_TIME = 11
    LIMIT_STALLED = 12
    CANCELLED = 13
    LIMIT_CLASS = 14
    ERROR_NULL = 100
    ERROR_OPTIONS = 101
    ERROR_COUNT = 102
    ERROR_LEVEL = 103
    ERROR_UNSUPPORTED = 104
    ERROR_QUADS = 105
    ERROR_MEMORY = 200
    ERROR_MEMORY_LIMIT = 201
    ERROR_MESH_COUNTS = 300
    ERROR_MESH_INDEX = 301
    ERROR_MESH_NOT_FINITE = 302
    ERROR_MESH_REPEATED_VERTEX = 303
    ERROR_MESH_DEGENERATE = 304
    ERROR_MESH_BOUNDARY = 305
    ERROR_MESH_NON_MANIFOLD_EDGE = 306
    ERROR_MESH_ORIENTATION = 307
    ERROR_MESH_NON_MANIFOLD_VERTEX = 308
    ERROR_MESH_UNUSED_VERTEX = 309
    ERROR_MESH_COMPONENTS = 310
    ERROR_MESH_GENUS = 311
    ERROR_MESH_NOT_EMBEDDED = 312
    ERROR_MESH_NOT_DELAUNAY = 313
    ERROR_LOOP_COUNT = 400
    ERROR_LOOP_INDEX = 401
    ERROR_LOOP_NOT_CLOSED = 402
    ERROR_LOOP_NOT_SIMPLE = 403
    ERROR_LOOP_CROSSING = 404
    ERROR_LOOP_TRIVIAL = 405
    ERROR_LOOP_PARALLEL = 406
    ERROR_LOOP_WEIGHT = 407
    ERROR_VALUE_NOT_FINITE = 500
    ERROR_VALUE_NOT_CLOSED = 501
    ERROR_VALUE_POLE = 502
    ERROR_VALUE_NOT_HARMONIC = 503
    ERROR_VALUE_CLASS = 504
    ERROR_INTERNAL = 900

    @classmethod
    def _missing_(cls, value: object) -> Status | None:
        # Of a newer library: statuses are added, never changed.
        if not isinstance(value, int):
            return None
        status = int.__new__(cls, value)
        status._name_ = f"STATUS_{value}"
        status._value_ = value
        return status

    @property
    def text(self) -> str:
        """A short English text, from ``hmf_status_string``."""
        return str(ffi.string(lib.hmf_status_string(int(self))).decode())


class Element(IntEnum):
    """What an error is about, ``HMF_ELEMENT_*`` of the C header."""

    NONE = 0
    VERTEX = 1
    EDGE = 2
    TRIANGLE = 3
    LOOP = 4
    LEVEL = 5
    OPTION = 6


class Error(Exception):
    """Base class of all failures of the library.

    Attributes
    ----------
    status : Status
        The status of the failure.
    element : Element
        Kind of the element concerned; ``Element.NONE`` if there is none.
    index : int or None
        Number of that element; None if ``element`` is ``Element.NONE``.
    message : str
        What is wrong and what to do.
    """

    def __init__(self, message: str, status: int, element: int = 0, index: int = 0) -> None:
        super().__init__(message)
        self.message = message
        self.status = Status(status)
        self.element = Element(element)
        self.index: int | None = index if self.element is not Element.NONE else None

    @property
    def advice(self) -> str:
        """What to do: the message without its first sentence, or the whole of it."""
        _, found, rest = self.message.partition(". ")
        return rest if found else self.message

    def __str__(self) -> str:
        place = "" if self.index is None else f", {self.element.name.lower()} {self.index}"
        return f"{self.message} [{self.status.name}{place}]"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.message, int(self.status), int(self.element), self.index or 0), self.__dict__


class OptionsError(Error, ValueError):
    """An option is out of range."""


class LevelError(Error, IndexError):
    """The hierarchy has no such level."""


class UnsupportedError(Error, NotImplementedError):
    """Not available in this version of the library."""


class OutOfMemoryError(Error, MemoryError):
    """Memory ran out, or the ``memory_limit`` of the hierarchy was reached."""


class MeshError(Error, ValueError):
    """The mesh is not connected, oriented and manifold, or a sphere or disk with too few marked vertices."""


class LoopError(Error, ValueError):
    """A loop or a weight cannot be used."""


class FoliationError(Error, ValueError):
    """Values cannot be used: not finite, not closed, with a pole, or not harmonic."""


class InternalError(Error, RuntimeError):
    """A defect of the library itself; please report it."""


class Cancelled(Error):
    """A progress callback said :attr:`Progress.CANCEL`.

    ``foliation`` is the result if it existed already, otherwise None.
    """

    def __init__(
        self, message: str, status: int, element: int = 0, index: int = 0, foliation: Foliation | None = None
    ) -> None:
        super().__init__(message, status, element, index)
        self.foliation = foliation


class LimitWarning(UserWarning):
    """The result is closed and without poles, but not harmonic to the tolerance.

    With LIMIT_CLASS it may not belong to the loops either: ``class_state`` of the report.
    """


class MeshWarning(UserWarning):
    """A mesh was read or built, but something about it looks wrong: statements that were skipped, small holes."""


_HERE = Path(__file__).parent


def warn(sentence: str, category: type[Warning]) -> None:
    """A warning at the line that called the package."""
    depth = 1
    while Path(sys._getframe(depth).f_code.co_filename).parent == _HERE:
        depth += 1
    warnings.warn(sentence, category, stacklevel=depth + 1)


# What sentences of the C library call otherwise than this package.  Other sentences with its words are left out.
_WORDS: tuple[tuple[str, str], ...] = (
    ("set mollify in the build options", "give mollify=1e-5"),
    ("HMF_METHOD_WHITEHEAD has none", 'method="whitehead" has none'),
    ("Use HMF_LOOPS_CUT or HMF_LOOPS_PANTS", 'Use the loops "cut" or "pants"'),
    ("use HMF_LOOPS_CUT or HMF_LOOPS_PANTS", 'use the loops "cut" or "pants"'),
    ("report->class_state", "report.class_state"),
    ("Build each component of hmf_components on its own", 'Use solve_components, or Hierarchy(mesh, component="largest")'),
    ("Use hmf_loops, or another mesh", "Use other loops, or another mesh"),
    ("; hmf_singularities lists them", "; Foliation.singularities() lists them"),
    (
        "Start from hmf_foliation_from_loops or a result of hmf_solve",
        "Start from Hierarchy.initialize or a result of a solve",
    ),
    ("; hmf_hierarchy_memory_estimate gives a sufficient value", "; memory_estimate gives a sufficient value"),
    ("with hmf_interpolate", "with Foliation.interpolate"),
    ("with hmf_relax", "with Foliation.relax"),
    ("start lies on", "initial lies on"),
    ("start belongs to", "initial belongs to"),
    ("Give one of them, the other NULL", "Give one of them"),
)
# What repair() does about a mesh that is refused.
_REPAIRS: dict[int, str] = {
    Status.ERROR_MESH_REPEATED_VERTEX: "repair(mesh) drops such triangles.",
    Status.ERROR_MESH_ORIENTATION: "repair(mesh) turns patches to one sense.",
    Status.ERROR_MESH_NON_MANIFOLD_EDGE: "repair(mesh) drops duplicate triangles and takes sheets apart that touch there.",
    Status.ERROR_MESH_NON_MANIFOLD_VERTEX: "repair(mesh) takes sheets apart that touch there.",
}
_FOREIGN = re.compile(r"hmf_|HMF_|NULL|struct_size|sizeof|->|position_stride|element_kind|_count\b")


def in_words(message: str, status: int) -> str:
    """A sentence of the C library in the words of this package."""
    for library, package in _WORDS:
        message = message.replace(library, package)
    kept = [part for part in re.split(r"(?<=\.)\s+", message) if part and not _FOREIGN.search(part)]
    if status in _REPAIRS:
        kept.append(_REPAIRS[status])
    return " ".join(kept) or Status(status).text.capitalize() + "."


_CLASSES: dict[int, type[Error]] = {
    Status.CANCELLED: Cancelled,
    Status.ERROR_LEVEL: LevelError,
    Status.ERROR_UNSUPPORTED: UnsupportedError,
    Status.ERROR_QUADS: UnsupportedError,
    Status.ERROR_NULL: InternalError,
}
_HUNDREDS: dict[int, type[Error]] = {
    1: OptionsError,
    2: OutOfMemoryError,
    3: MeshError,
    4: LoopError,
    5: FoliationError,
}


def error_class(status: int) -> type[Error]:
    """The subclass of :class:`Error` for a status."""
    return _CLASSES.get(status) or _HUNDREDS.get(status // 100, InternalError)
