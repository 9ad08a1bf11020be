"""The boundary to the C library: arrays, options, progress and calls.

Everything that touches pointers goes through here.  cffi releases the
interpreter lock for the time of each call.
"""

from __future__ import annotations

import sys
import threading
import weakref
from abc import abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from enum import IntEnum
from functools import lru_cache
from importlib import import_module
from types import TracebackType
from typing import Any, NamedTuple, TypeVar, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import ffi, lib
from ._threads import lent_threads
from .errors import Element, MeshError, OptionsError, Status, error_class, in_words

Floats = NDArray[np.float64]
Indices = NDArray[np.uint32]

# --- Arrays in ---------------------------------------------------------------


def pointer(array: NDArray[Any], ctype: str) -> Any:
    """Pointer to the first element; the caller keeps the array alive."""
    return ffi.cast(ctype, array.__array_interface__["data"][0])


def _real(array: ArrayLike, what: str) -> NDArray[Any]:
    given = np.asarray(array)
    if given.dtype.kind not in "fiu" and given.size:
        raise TypeError(f"{what} must be real numbers, got dtype {given.dtype}. Convert with .astype(numpy.float64).")
    return given


def as_positions(array: ArrayLike, what: str = "positions") -> Floats:
    """(n, 3) float64 with contiguous rows; the given array itself where that holds."""
    given = _real(array, what)
    if given.ndim != 2 or given.shape[1] != 3:
        remedy = "transpose it" if given.ndim == 2 and given.shape[0] == 3 else "give three coordinates in each row"
        raise ValueError(f"{what} must have shape (n, 3), got {given.shape}: {remedy}.")
    result = np.asarray(given, dtype=np.float64)
    row, column = result.strides
    rows_are_fine = len(result) <= 1 or (row >= 24 and row % 8 == 0)
    if not (rows_are_fine and column == 8 and result.flags.aligned):
        result = np.array(result, order="C")
    return result


def as_indices(array: ArrayLike, what: str, columns: int | None = None) -> Indices:
    """uint32 and C-contiguous, (n,) or (n, columns); the given memory itself where that holds."""
    given = np.asarray(array)
    if given.size == 0 and given.dtype.kind == "f":
        given = given.astype(np.uint32)  # an empty list
    if given.dtype.kind not in "iu":
        raise TypeError(f"{what} must be integers, got dtype {given.dtype}. Convert with .astype(numpy.uint32).")
    if columns is None and given.ndim != 1:
        raise ValueError(f"{what} must have shape (n,), got {given.shape}.")
    if columns is not None and (given.ndim != 2 or given.shape[1] != columns):
        remedy = f"give {columns} indices in each row"
        if given.ndim == 2 and given.shape[0] == columns:
            remedy = "transpose it"
        elif given.ndim == 2 and given.shape[1] == 4:
            remedy = "cut each quadrilateral into two triangles"
        raise ValueError(f"{what} must have shape (n, {columns}), got {given.shape}: {remedy}.")
    if given.dtype != np.uint32 and given.size:
        for wrong in (int(given.min()), int(given.max())):
            if not 0 <= wrong < 2**32:
                place = int(np.argmax(given == wrong)) // (columns or 1)
                raise _index_error(what, place, wrong)
        given = given.view(np.uint32) if given.dtype == np.int32 else given.astype(np.uint32)
    return np.require(given, dtype=np.uint32, requirements=["C", "A"])


def _index_error(what: str, place: int, wrong: int) -> Exception:
    if what == "triangles":
        return MeshError(
            f"Triangle {place} names vertex {wrong}, which does not exist. Indices count from 0.",
            Status.ERROR_MESH_INDEX,
            Element.TRIANGLE,
            place,
        )
    return ValueError(f"{what} holds {wrong} at {place}, which is no index. Indices count from 0.")


def as_floats(array: ArrayLike, count: int, what: str, per: str) -> Floats:
    """(count,) float64 and contiguous; the given array itself where that holds."""
    given = _real(array, what)
    if given.shape != (count,):
        raise ValueError(f"{what} must have shape ({count},), one for each {per}, got {given.shape}.")
    return np.require(given, dtype=np.float64, requirements=["C", "A"])


def as_count(number: int, what: str) -> int:
    """A number that fits the unsigned integers of the library."""
    result = int(number)
    if result != number or not 0 <= result < 2**63:
        raise ValueError(f"{what} must be an integer from 0 to 2^63 - 1, got {number}.")
    return result


# --- Choices and options -----------------------------------------------------

_CONSTANTS: dict[str, int] = {
    name: getattr(lib, name) for name in dir(lib) if name.startswith("HMF_") and isinstance(getattr(lib, name), int)
}


def names(prefix: str) -> dict[int, Any]:
    """The names of the values HMF_<prefix>_<NAME>."""
    start = f"HMF_{prefix}_"
    return {value: name[len(start) :].lower() for name, value in _CONSTANTS.items() if name.startswith(start)}


def constant(prefix: str, name: str | None, what: str) -> int | None:
    """The value of HMF_<prefix>_<NAME>, None of None; ValueError with the names that exist."""
    if name is None:
        return None
    values = {known: value for value, known in names(prefix).items()}
    key = str(name).lower().replace("-", "_")
    if key not in values:
        raise ValueError(f"{what} must be one of {', '.join(sorted(values))}; got {name!r}.")
    return values[key]


# Ranges of options; the library takes 0 for "the default", which is None here.
_RANGES: dict[str, str] = {
    "ratio": "[0.05, 0.95]",
    "coarsest": "[1, inf)",
    "memory_limit": "[1, inf)",
    "mollify": "[0, 0.1]",
    "tolerance": "(0, 1)",
    "energy_tolerance": "(0, 1)",
    "time_limit": "[0, inf)",
    "iteration_limit": "[1, inf)",
    "step_limit": "[1, inf)",
    "solve_limit": "[1, inf)",
    "edge_length": "(0, inf)",
    "count": "[1, inf)",
    "spacing": "(0, inf)",
    "length_limit": "(0, inf)",
    "margin": "(0, 0.0625]",
}
_SHORTEST = 1e-9  # seconds; the library takes a limit of 0 for none


def check_range(name: str, value: Any) -> None:
    """Raises OptionsError where an option is out of its range."""
    limits = _RANGES.get(name)
    if limits is None:
        return
    low, high = (float(word) for word in limits[1:-1].split(","))
    above = value > low if limits[0] == "(" else value >= low
    below = value < high if limits[-1] == ")" else value <= high
    if not (above and below):
        default = "" if name == "mollify" else "; None, or leaving it out, is the default"
        raise OptionsError(f"{name}={value} is not in {limits}{default}.", Status.ERROR_OPTIONS, Element.OPTION, 0)


def structure(ctype: str, **values: Any) -> Any:
    """A structure that begins with its size; None in a field is its default, and counts are checked to fit."""
    fields = dict(ffi.typeof(ctype).fields)
    result = ffi.new(f"{ctype} *")
    if ctype.endswith(("_options", "_control")):
        getattr(lib, f"{ctype}_init")(result, ffi.sizeof(ctype))
    else:
        result.struct_size = ffi.sizeof(ctype)
    for name, value in values.items():
        if value is not None:
            if ctype.endswith("_options"):
                check_range(name, value)
            if name == "time_limit":
                value = max(float(value), _SHORTEST)
            setattr(result, name, as_count(value, name) if fields[name].type.cname == "uint64_t" else value)
    return result


# --- Arrays out --------------------------------------------------------------


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Makes results read-only, because objects share them."""
    array.setflags(write=False)
    return array


class _Memory:
    """What numpy needs to make a read-only array, whose base this object then is."""

    def __init__(self, owner: Any, address: int, size: int) -> None:
        self._owner = owner
        self.__array_interface__ = {"version": 3, "typestr": "|u1", "shape": (size,), "data": (address, True)}


_FORMATS = {"double": "f8", "int32_t": "i4", "uint32_t": "u4", "int64_t": "i8", "uint64_t": "u8", "uint8_t": "u1"}


@lru_cache(maxsize=None)
def _dtype(ctype: Any) -> np.dtype[Any]:
    """The dtype of an element: a number, an array of them, or a structure of both."""
    if ctype.kind == "array":
        return np.dtype((_dtype(ctype.item), (ctype.length,)))
    if ctype.kind != "struct":
        return np.dtype(_FORMATS[ctype.cname])
    fields = [(name, field) for name, field in ctype.fields if name != "reserved"]
    return np.dtype(
        {
            "names": [name for name, _ in fields],
            "formats": [_dtype(field.type) for _, field in fields],
            "offsets": [field.offset for _, field in fields],
            "itemsize": ffi.sizeof(ctype),
        }
    )


def view(owner: Any, elements: Any, *shape: int) -> NDArray[Any]:
    """The array that ``elements`` points to: not a copy, but memory of the library that ``owner`` keeps alive."""
    dtype = _dtype(ffi.typeof(elements).item)
    count = int(np.prod(shape))
    if count == 0:
        return frozen(np.empty(shape, dtype))
    address = int(ffi.cast("uintptr_t", elements))
    return np.asarray(_Memory(owner, address, count * dtype.itemsize)).view(dtype).reshape(shape)


def optional_index(number: int) -> int | None:
    """An index of the library; None for HMF_NONE."""
    return None if number == lib.HMF_NONE else number


_Entry = TypeVar("_Entry")


class Rows(Sequence[_Entry]):
    """A list of structures of the library; each becomes an object on access."""

    def __init__(self, rows: NDArray[Any]) -> None:
        self._rows = rows

    @abstractmethod
    def _entry(self, number: int, row: dict[str, Any]) -> _Entry:
        """The object of one structure."""

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, which: int) -> _Entry: ...
    @overload
    def __getitem__(self, which: slice) -> tuple[_Entry, ...]: ...
    def __getitem__(self, which: int | slice) -> _Entry | tuple[_Entry, ...]:
        chosen = range(len(self))[which]
        if isinstance(chosen, range):
            return tuple(self[number] for number in chosen)
        return self._entry(chosen, dict(zip(self._rows.dtype.names or (), self._rows[chosen].item())))


# --- Progress ----------------------------------------------------------------


class Progress(IntEnum):
    """Answers of a progress callback; None means CONTINUE."""

    CONTINUE = 0
    #: Return at once; :class:`foliations.Cancelled` is raised.
    CANCEL = 1
    #: solve and relax: stop improving and return the foliation so far; elsewhere as CANCEL.
    FINISH = 2


ProgressCallback = Callable[[float], Union[Progress, int, None]]
ProgressOption = Union[bool, ProgressCallback, None]

# Seconds between two calls into Python.  An interrupt waits for the next one,
# and at most 50 ms for the library to react.
PROGRESS_INTERVAL = 0.01


class Watch:
    """Receives the progress of a running call: calls the user's callback and handles pending signals."""

    def __init__(self, callback: ProgressCallback | None) -> None:
        self._callback = callback
        self._exception: BaseException | None = None
        #: The callback said FINISH, and not CANCEL later.
        self.finished = False

    def control(self) -> Any:
        """hmf_control for a call; valid as long as this object is."""
        lent = lent_threads()
        if self._callback is None and threading.current_thread() is not threading.main_thread():
            # Signals arrive on the main thread only: nobody needs to be called.
            self._control = structure("hmf_control", **lent) if lent else ffi.NULL
            return self._control
        self._handle = ffi.new_handle(weakref.proxy(self))
        self._throttle = ffi.new(
            "hmf_python_throttle *", {"interval": PROGRESS_INTERVAL, "last": -1e9, "watch": self._handle}
        )
        throttled = ffi.addressof(lib, "hmf_python_throttled")
        self._control = structure("hmf_control", progress=throttled, progress_user=self._throttle, **lent)
        return self._control

    def tick(self, fraction: float) -> int:
        # To be in Python code is enough for signals to be handled.
        if self._callback is None:
            return Progress.CONTINUE
        answer = self._callback(fraction)
        if answer is None:
            return Progress.CONTINUE
        if isinstance(answer, int) and 0 <= answer <= 2:
            if answer != Progress.CONTINUE:
                self.finished = answer == Progress.FINISH
            return int(answer)
        raise TypeError(f"a progress callback returns None or a member of foliations.Progress, got {answer!r}")

    def fail(self, exception: BaseException) -> None:
        if self._exception is None:
            self._exception = exception

    def reraise(self) -> None:
        """Raises the exception of the callback, if any."""
        exception, self._exception = self._exception, None
        if exception is not None:
            try:
                raise exception
            finally:
                del exception  # no cycle with the traceback


def _store(kind: type[BaseException], exception: BaseException, traceback: TracebackType | None) -> None:
    """Stores an exception until the call has ended, because it must not pass through C."""
    if traceback is not None:
        ffi.from_handle(traceback.tb_frame.f_locals["watch"]).fail(exception.with_traceback(traceback))


@ffi.def_extern(  # type: ignore[untyped-decorator]
    name="hmf_python_progress", error=int(Progress.CANCEL), onerror=_store
)
def _progress(watch: Any, fraction: float) -> int:
    return int(ffi.from_handle(watch).tick(fraction))


class _Bar:
    """A progress bar on standard error: of tqdm, or a line with the percentage."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._shown = -1
        self._bar: Any = None
        try:
            tqdm = import_module("tqdm.auto")
        except ImportError:
            return
        form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"
        self._bar = tqdm.tqdm(total=100, desc=title, bar_format=form)

    def update(self, fraction: float) -> None:
        percent = int(100 * fraction)
        if percent <= self._shown:
            return
        if self._bar is not None:
            self._bar.update(percent - max(self._shown, 0))
        else:
            sys.stderr.write(f"\r{self._title}: {percent:3d}%")
            sys.stderr.flush()
        self._shown = percent

    def close(self, finished: bool) -> None:
        if finished:
            self.update(1.0)
        if self._bar is not None:
            self._bar.close()
        else:
            sys.stderr.write("\n")


@contextmanager
def progress_callback(progress: ProgressOption, title: str) -> Iterator[ProgressCallback | None]:
    """The callback for a progress option; True shows a bar during the block."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        bar = _Bar(title)
        finished = False
        try:
            yield bar.update
            finished = True
        finally:
            bar.close(finished)
    elif callable(progress):
        yield progress
    else:
        raise TypeError(f"progress must be True, False, None or a function of one number, got {progress!r}")


def part(callback: ProgressCallback | None, low: float, high: float) -> ProgressCallback | None:
    """A callback for one of several calls that together report 0 to 1."""
    if callback is None:
        return None
    whole = callback
    return lambda fraction: whole(low + (high - low) * fraction)


# --- Calls -------------------------------------------------------------------


class Outcome(NamedTuple):
    """Result of a call."""

    status: Status
    message: str
    #: What the library made, given back with the last reference to it; None if nothing.
    result: Any
    #: The progress callback said FINISH.
    finished: bool


_CONTROL = ffi.typeof("hmf_control *")
_FREE = {
    ffi.typeof("hmf_hierarchy *"): lib.hmf_hierarchy_destroy,
    ffi.typeof("hmf_foliation *"): lib.hmf_foliation_destroy,
}


def _title(name: str) -> str:
    """Of a progress bar: what is done, not which function of the library does it."""
    return name.replace("hmf_", "foliations ").replace("_cut_system", "").replace("_", " ")


def run(
    function: Any, *arguments: Any, progress: ProgressOption = None, accept: frozenset[int] = frozenset()
) -> Outcome:
    """Calls a fallible function; raises unless the status is OK or in ``accept``.

    ``arguments`` are those but hmf_control, the address of an object that the
    library makes, and hmf_error, which stand where the header declares them.
    """
    types = ffi.typeof(function).args
    error = ffi.new("hmf_error *")
    made = types[-2].item if types[-2].kind == "pointer" else types[-2]
    out = ffi.new(types[-2]) if made.kind == "pointer" else None
    passed = [*arguments, error] if out is None else [*arguments, out, error]
    with progress_callback(progress, _title(function.__name__)) as callback:
        watch = Watch(callback)
        if _CONTROL in types:
            passed.insert(types.index(_CONTROL), watch.control())
        status = function(*passed)
        result = None
        if out is not None and out[0] != ffi.NULL:
            result = ffi.gc(out[0], _FREE.get(made, lib.hmf_free))
        watch.reraise()
        message = ffi.string(error.message).decode("utf-8", "replace")
        message = in_words(message, status) if message else message
        if status != Status.OK and status not in accept:
            raise error_class(status)(message, status, error.element, error.index)
    return Outcome(Status(status), message, result, watch.finished)


def call(function: Any, *arguments: Any, progress: ProgressOption = None) -> Any:
    """What a function of the library makes, see :func:`run`."""
    return run(function, *arguments, progress=progress).result
