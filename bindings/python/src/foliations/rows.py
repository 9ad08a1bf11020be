"""One mesh of many: a row in, a row out."""

from __future__ import annotations

import inspect
import os
import time
from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

import numpy as np

from ._options import SolveOptions
from .errors import Error, Status
from .foliation import quiet
from .hierarchy import Hierarchy, even_design
from .loops import Loops
from .meshes import as_mesh

_BUILD = tuple(name for name in inspect.getfullargspec(Hierarchy.__init__).kwonlyargs if name != "progress")
_SOLVE = tuple(SolveOptions.__annotations__)
_INPUT = ("mesh", "positions", "triangles", "loops", "weights", *_BUILD, *_SOLVE, "save", "export", "with_values")
# Not carried on: the mesh may be large, and these are lists, or lists of lists.
_DROPPED = ("positions", "triangles", "loops", "weights", "marked_vertices")

_COMPONENTS = " For each component solve_components has a row (ComponentRow.row)."


def _given(value: Any) -> bool:
    """Whether a column has a value: tables have None or NaN where it has none."""
    return value is not None and not (isinstance(value, float) and value != value)


def _plain(name: str, value: Any) -> Any:
    """Numbers of tables: whole ones may have become floats."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and value.is_integer() and (name == "coarsest" or name.endswith(("_limit", "_level"))):
        return int(value)
    return value


def solve_row(row: Mapping[str, Any], **defaults: Any) -> dict[str, Any]:
    """Solves one mesh of a table; never raises for a mesh that cannot be solved.

    A pure function of its arguments, so other processes can run it: for
    ``concurrent.futures``, Ray Data (``dataset.map``) and Dask (``bag.map``).

    Parameters
    ----------
    row : dict
        ``mesh`` (a file name or a mesh object), or ``positions`` and
        ``triangles``.  Optional: ``loops`` (of vertices, :class:`Loops`, or one
        of "cut", "handle", "tunnel", "pants", "even"), ``weights``, the options of
        :func:`solve`, ``save`` (a file for :meth:`Foliation.save`), ``export``
        (a file for :meth:`Foliation.export`), ``with_values`` (True: a column
        ``values`` with one number for each edge).
        Other columns are carried on; one that is nearly the name of an option is a TypeError.
    defaults
        The same, for rows that do not have them.

    Returns
    -------
    dict
        The row without its arrays, and ``ok`` (bool), ``error`` (name of the
        exception, "" without), ``message`` (of the error or of the limit),
        ``status`` ("OK", a limit, or the status of the error), ``converged``,
        ``vertices``, ``edges``, ``triangles_count``, ``genus``, ``zeros``,
        ``energy``, ``residual_max``, ``class`` (:attr:`Report.class_state`),
        ``build_seconds``, ``solve_seconds``.
        Each column has one type: where there is no result, numbers are -1 or
        NaN and texts are empty.  A mesh of several components has no result:
        :func:`solve_components` has a row for each.
    """
    unknown = set(defaults) - set(_INPUT)
    if unknown:
        raise TypeError(f"solve_row has no option {', '.join(sorted(unknown))}; there are {', '.join(_INPUT)}.")
    given = {name: value for name, value in {**defaults, **row}.items() if name in _INPUT and _given(value)}
    for name in set(defaults) - set(given):
        if _given(defaults[name]):
            given[name] = defaults[name]
    for name in set(row) - set(_INPUT):
        if near := get_close_matches(str(name), _INPUT, 1, 0.8):
            raise TypeError(f"solve_row has no option {name}; did you mean {near[0]}?")
    result: dict[str, Any] = {name: value for name, value in row.items() if name not in _DROPPED}
    mesh = result.get("mesh")
    if isinstance(mesh, os.PathLike):
        result["mesh"] = os.fspath(mesh)
    elif mesh is not None and not isinstance(mesh, str):
        del result["mesh"]
    result.update(
        ok=False,
        error="",
        message="",
        status="",
        converged=False,
        vertices=-1,
        edges=-1,
        triangles_count=-1,
        genus=-1,
        zeros=-1,
        energy=float("nan"),
        residual_max=float("nan"),
        **{"class": ""},
        build_seconds=float("nan"),
        solve_seconds=float("nan"),
    )
    if given.get("with_values"):
        result["values"] = np.empty(0)
    token = quiet.set(True)
    try:
        _solve(given, result)
    except Exception as error:
        result.update(ok=False, error=type(error).__name__, message=str(error))
        if isinstance(error, Error):
            result.update(message=error.message, status=error.status.name)
            if error.status == Status.ERROR_MESH_COMPONENTS:
                result["message"] += _COMPONENTS
    finally:
        quiet.reset(token)
    return result


def _solve(given: dict[str, Any], result: dict[str, Any]) -> None:
    options = {name: _plain(name, value) for name, value in given.items() if name in _BUILD + _SOLVE}
    if "positions" in given and "triangles" in given:
        # Tables hold an array as a list of rows.
        mesh = as_mesh((_stacked(given["positions"]), _stacked(given["triangles"])))
    elif "mesh" in given:
        mesh = as_mesh(given["mesh"])
    else:
        raise ValueError("the row has no mesh: give mesh (a file name), or positions and triangles.")
    started = time.perf_counter()
    if isinstance(given.get("loops"), str) and given["loops"] == "even":
        marks = options.get("marked_vertices")
        design = even_design(*mesh, marked_vertices=None if isinstance(marks, str) else marks)
        options["marked_vertices"], given["loops"] = design.marked_vertices, design.loops
    hierarchy = Hierarchy(*mesh, **{name: options[name] for name in _BUILD if name in options})
    level = hierarchy.levels[0]
    result.update(
        build_seconds=time.perf_counter() - started,
        vertices=level.vertex_count,
        edges=level.edge_count,
        triangles_count=level.triangle_count,
        genus=hierarchy.genus,
    )
    loops = given.get("loops")
    if loops is not None and not isinstance(loops, (Loops, str)):
        loops = [np.asarray(loop) for loop in loops]
    foliation = hierarchy.solve(
        loops, given.get("weights"), **{name: options[name] for name in _SOLVE if name in options}
    )
    report = foliation.report
    assert report is not None
    result.update(
        ok=True,
        status=foliation.status.name,
        message="" if foliation.status == Status.OK else foliation.status.text,
        converged=report.converged,
        zeros=report.zeros,
        energy=report.energy,
        residual_max=report.residual_max if report.residual_max >= 0 else float("nan"),
        **{"class": report.class_state},
        solve_seconds=report.solve_seconds,
    )
    if given.get("with_values"):
        result["values"] = np.array(foliation.values)
    if "save" in given:
        foliation.save(given["save"])
    if "export" in given:
        foliation.export(given["export"])


def _stacked(array: Any) -> Any:
    if isinstance(array, np.ndarray) and array.dtype == object:
        return np.stack(list(array))
    return array
