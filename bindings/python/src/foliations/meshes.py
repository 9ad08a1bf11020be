"""Meshes of other packages and from files, as arrays of positions and triangles.

No other package is imported unless a file needs it: mesh objects are known by
the attributes they have.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import Floats, Indices, as_indices, as_positions


class _VerticesFaces(Protocol):
    """trimesh.Trimesh and many others."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...


class _VerticesTriangles(Protocol):
    """open3d.geometry.TriangleMesh."""

    @property
    def vertices(self) -> Any: ...
    @property
    def triangles(self) -> Any: ...


class _PointsCells(Protocol):
    """meshio.Mesh."""

    @property
    def points(self) -> Any: ...
    @property
    def cells_dict(self) -> Any: ...


class _PointsFaces(Protocol):
    """pyvista.PolyData."""

    @property
    def points(self) -> Any: ...
    @property
    def faces(self) -> Any: ...


#: A file name, the mesh object of another package, or a pair (positions, triangles).
MeshLike = Union[
    str,
    "os.PathLike[str]",
    _VerticesFaces,
    _VerticesTriangles,
    _PointsCells,
    _PointsFaces,
    "tuple[ArrayLike, ArrayLike]",
]


def as_mesh(mesh: MeshLike) -> tuple[Floats, Indices]:
    """Positions (n, 3) and triangles (m, 3) of a file or of a mesh object.

    Parameters
    ----------
    mesh : file name, mesh object, or pair (positions, triangles)
        Files: see :func:`read_mesh`.  Objects: those of trimesh, meshio,
        pyvista and Open3D, and whatever has ``vertices`` and ``faces`` as they
        have.  Polygons become fans of triangles.

    Raises
    ------
    TypeError
        It is none of these.
    ValueError
        It has no triangles, or other cells as well.
    """
    if isinstance(mesh, (str, os.PathLike)):
        return read_mesh(mesh)
    positions, triangles = _arrays(mesh)
    return as_positions(positions), as_indices(triangles, "triangles", 3)


def _arrays(mesh: Any) -> tuple[Any, Any]:
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return mesh[0], mesh[1]
    kind = f"{type(mesh).__module__.partition('.')[0]}.{type(mesh).__name__}"
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict") and hasattr(mesh, "cells"):
        if not hasattr(mesh, "celltypes"):  # not an unstructured grid of pyvista
            return _points(mesh.points), _cells(mesh, kind)
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):
        return mesh.points, _counted(np.asarray(mesh.faces), kind)
    if hasattr(mesh, "points") and hasattr(mesh, "extract_surface"):
        raise ValueError(f"{kind} is no surface: give mesh.extract_surface().clean().")
    for vertices, faces in (("vertices", "faces"), ("vertices", "triangles"), ("V", "F"), ("v", "f")):
        if hasattr(mesh, vertices) and hasattr(mesh, faces):
            return _numpy(getattr(mesh, vertices)), _fans(_numpy(getattr(mesh, faces)))
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):  # open3d.t.geometry.TriangleMesh
        return _numpy(mesh.vertex.positions), _numpy(mesh.triangle.indices)
    if hasattr(mesh, "geometry") and hasattr(mesh, "to_mesh"):
        raise ValueError(f"{kind} may hold several meshes: give scene.to_mesh().")
    raise TypeError(
        f"{kind} is no mesh: give positions and triangles, a file name, "
        "or a mesh of trimesh, meshio, pyvista or Open3D."
    )


def _numpy(array: Any) -> NDArray[Any]:
    """Also of tensors, which may lie on another device."""
    for step in ("detach", "cpu", "numpy"):
        if not isinstance(array, np.ndarray) and hasattr(array, step):
            array = getattr(array, step)()
    return np.asarray(array)


def _points(points: Any) -> NDArray[Any]:
    result = np.asarray(points)
    if result.ndim == 2 and result.shape[1] == 2:
        result = np.column_stack([result, np.zeros(len(result))])
    return result


def _fans(faces: NDArray[Any]) -> NDArray[Any]:
    """Polygons with equally many corners as triangles, fans from their first corner."""
    if faces.ndim != 2 or faces.shape[1] <= 3:
        return faces
    count = faces.shape[1]
    return np.stack([faces[:, [0, i, i + 1]] for i in range(1, count - 1)], axis=1).reshape(-1, 3)


def _cells(mesh: Any, kind: str) -> NDArray[Any]:
    """Triangles of the cells of meshio."""
    parts = []
    for block in mesh.cells:
        if block.type in ("triangle", "quad", "polygon") and len(block.data):
            parts.append(_fans(np.asarray(block.data)))
        elif block.type not in ("vertex", "line"):
            raise ValueError(f"{kind} has cells of type {block.type!r}: give its surface, of triangles.")
    if not parts:
        raise ValueError(f"{kind} has no triangles.")
    return np.concatenate(parts)


def _counted(faces: NDArray[Any], kind: str) -> NDArray[Any]:
    """Triangles of [count, corner, corner, ..., count, ...], as pyvista has them."""
    if faces.ndim == 2:
        return _fans(faces)
    if len(faces) == 0:
        raise ValueError(f"{kind} has no triangles.")
    step = int(faces[0]) + 1
    if len(faces) % step == 0 and (faces[::step] == faces[0]).all():
        return _fans(faces.reshape(-1, step)[:, 1:])
    parts, at = [], 0
    while at < len(faces):
        parts.append(_fans(faces[None, at + 1 : at + 1 + int(faces[at])]))
        at += 1 + int(faces[at])
    return np.concatenate(parts)


# --- Files -------------------------------------------------------------------


def read_mesh(path: str | os.PathLike[str]) -> tuple[Floats, Indices]:
    """Positions (n, 3) and triangles (m, 3) from a file.

    OBJ, OFF, PLY (ASCII and binary) and STL are read here, with all digits;
    polygons become fans of triangles, and equal points of an STL are joined.
    Other formats are left to trimesh or meshio where they are installed.

    Raises
    ------
    ValueError
        The file is no such mesh; the message names the line.
    OSError
        It cannot be opened.
    """
    name = os.fspath(path)
    suffix = Path(name).suffix.lower()
    if suffix not in _READERS:
        return _read_elsewhere(name, suffix)
    builder = _READERS[suffix](name, Path(name).read_bytes())
    return builder.mesh()


class _Builder:
    """A mesh while it is read; knows where each face comes from."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.points: list[list[float]] = []
        self.polygons: list[list[int]] = []
        self.places: list[int] = []  # lines of the polygons
        self.positions: NDArray[Any] | None = None
        self.triangles: NDArray[Any] | None = None

    def fail(self, line: int, what: str) -> NoReturn:
        raise ValueError(f"{self.name}, line {line}: {what}" if line else f"{self.name}: {what}")

    def point(self, line: int, words: Sequence[str]) -> None:
        try:
            x, y, z = words[:3]
            self.points.append([float(x), float(y), float(z)])
        except ValueError:
            self.fail(line, f"a vertex needs three numbers, got {' '.join(words)!r}.")

    def face(self, line: int, corners: list[int]) -> None:
        if len(corners) < 3:
            self.fail(line, f"a face needs at least three corners, got {len(corners)}.")
        self.polygons.append(corners)
        self.places.append(line)

    def _faces(self) -> NDArray[np.int64]:
        if all(len(polygon) == 3 for polygon in self.polygons):
            return np.array(self.polygons, dtype=np.int64).reshape(-1, 3)
        fans = [[p[0], p[i], p[i + 1]] for p in self.polygons for i in range(1, len(p) - 1)]
        return np.array(fans, dtype=np.int64).reshape(-1, 3)

    def mesh(self) -> tuple[Floats, Indices]:
        points: NDArray[Any] = np.array(self.points, dtype=np.float64).reshape(-1, 3)
        if self.positions is not None:
            points = np.ascontiguousarray(self.positions, dtype=np.float64)
        triangles = self._faces() if self.triangles is None else self.triangles
        if len(triangles) == 0:
            self.fail(0, "no faces in it.")
        wrong = (triangles < 0) | (triangles >= len(points))
        if wrong.any():
            self._wrong_index(len(points), wrong, triangles)
        return points, triangles.astype(np.uint32)

    def _wrong_index(self, count: int, wrong: NDArray[Any], triangles: NDArray[Any]) -> NoReturn:
        for line, polygon in zip(self.places, self.polygons):
            for corner in polygon:
                if not 0 <= corner < count:
                    self.fail(line, f"the face names vertex {corner}, counted from 0, of {count}.")
        row, column = np.argwhere(wrong)[0]
        self.fail(0, f"triangle {row} names vertex {triangles[row, column]}, counted from 0, of {count}.")


def _lines(data: bytes) -> list[str]:
    return data.decode("utf-8", "replace").splitlines()


def _read_obj(name: str, data: bytes) -> _Builder:
    builder = _Builder(name)
    for line, text in enumerate(_lines(data), 1):
        words = text.split()
        if not words:
            continue
        if words[0] == "v":
            builder.point(line, words[1:])
        elif words[0] == "f":
            corners = []
            for word in words[1:]:
                if word.startswith("#"):
                    break
                try:
                    number = int(word.partition("/")[0])
                except ValueError:
                    builder.fail(line, f"{word!r} is no corner of a face: write 1, 1/2, 1//3 or 1/2/3.")
                if number == 0:
                    builder.fail(line, "a face names vertex 0; vertices of OBJ count from 1.")
                corners.append(number - 1 if number > 0 else len(builder.points) + number)
            builder.face(line, corners)
    return builder


def _words(data: bytes) -> Iterator[tuple[int, list[str]]]:
    """Lines with something in them, without comments."""
    for line, text in enumerate(_lines(data), 1):
        words = text.partition("#")[0].split()
        if words:
            yield line, words


def _read_off(name: str, data: bytes) -> _Builder:
    builder = _Builder(name)
    lines = _words(data)
    line, words = next(lines, (1, []))
    if not words or not words[0].upper().endswith("OFF"):
        builder.fail(line, "an OFF file begins with the word OFF.")
    words = words[1:]
    try:
        if not words:
            line, words = next(lines)
        vertices, faces = int(words[0]), int(words[1])
    except (StopIteration, ValueError, IndexError):
        builder.fail(line, "the numbers of vertices and faces are missing.")
    try:
        for _ in range(vertices):
            line, words = next(lines)
            builder.point(line, words)
        for _ in range(faces):
            line, words = next(lines)
            builder.face(line, _corners(builder, line, words))
    except StopIteration:
        builder.fail(line, f"the file ends after {len(builder.points)} vertices and {len(builder.polygons)} faces.")
    return builder


def _corners(builder: _Builder, line: int, words: list[str]) -> list[int]:
    """A number of corners, and these."""
    try:
        count = int(words[0])
        corners = [int(word) for word in words[1 : 1 + count]]
    except (ValueError, IndexError):
        builder.fail(line, f"{' '.join(words)!r} is no face: write the number of its corners, and these.")
    if len(corners) != count:
        builder.fail(line, f"a face of {count} corners, but {len(corners)} numbers.")
    return corners


# A property of PLY: its name, the type of a count if it is a list, and the type.
_Property = tuple[str, Union[str, None], str]
_PLY_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8",
}  # fmt: skip


def _ply_header(builder: _Builder, data: bytes) -> tuple[str, list[tuple[str, int, list[_Property]]], int, int]:
    """Format, elements with their properties, and where the header ends: byte and line."""
    at = line = 0
    form = ""
    elements: list[tuple[str, int, list[_Property]]] = []
    while True:
        end = data.find(b"\n", at)
        line += 1
        if end < 0:
            builder.fail(line, "the header has no end_header.")
        words = data[at:end].decode("latin-1").split()
        at = end + 1
        if line == 1 and words != ["ply"]:
            builder.fail(1, "a PLY file begins with the word ply.")
        try:
            if words[:1] == ["format"]:
                form = words[1]
            elif words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:2] == ["property", "list"]:
                elements[-1][2].append((words[4], _PLY_TYPES[words[2]], _PLY_TYPES[words[3]]))
            elif words[:1] == ["property"]:
                elements[-1][2].append((words[2], None, _PLY_TYPES[words[1]]))
        except (IndexError, KeyError, ValueError):
            builder.fail(line, f"{' '.join(words)!r} is no line of a PLY header.")
        if words == ["end_header"]:
            return form, elements, at, line


def _read_ply(name: str, data: bytes) -> _Builder:
    builder = _Builder(name)
    form, elements, at, line = _ply_header(builder, data)
    if form == "ascii":
        text = _lines(data[at:])
        numbered = ((line + 1 + i, words) for i, words in enumerate(map(str.split, text)) if words)
        for element, count, properties in elements:
            for done in range(count):
                try:
                    row, words = next(numbered)
                except StopIteration:
                    builder.fail(line + len(text), f"the file ends after {done} of {count} rows of {element}.")
                _ply_row(builder, row, element, properties, words)
        return builder
    if form not in ("binary_little_endian", "binary_big_endian"):
        builder.fail(line, f"format {form!r} is none of ascii, binary_little_endian, binary_big_endian.")
    order = "<" if form == "binary_little_endian" else ">"
    for element, count, properties in elements:
        columns, at = _ply_binary(builder, data, at, order, element, count, properties)
        if element == "vertex":
            try:
                builder.positions = np.stack([columns[axis] for axis in "xyz"], axis=1)
            except KeyError:
                builder.fail(0, "its vertices have no properties x, y, z.")
        elif element == "face" and count:
            key = next((key for key in ("vertex_indices", "vertex_index") if key in columns), None)
            if key is None:
                builder.fail(0, "its faces have no property vertex_indices.")
            rows = columns[key]
            if isinstance(rows, np.ndarray):
                builder.triangles = _fans(rows.astype(np.int64))
                if builder.triangles.shape[1] != 3:
                    builder.fail(0, "face 0 has fewer than three corners.")
            else:
                for number, row in enumerate(rows):
                    if len(row) < 3:
                        builder.fail(0, f"face {number} has {len(row)} corners.")
                    builder.polygons.append([int(corner) for corner in row])
    return builder


def _ply_row(builder: _Builder, line: int, element: str, properties: list[_Property], words: list[str]) -> None:
    at = 0
    values: dict[str, list[str]] = {}
    for name, counted, _ in properties:
        if counted is None:
            size = 1
        else:
            try:
                size = int(words[at])
            except (ValueError, IndexError):
                builder.fail(line, f"the number of {name} is missing.")
            at += 1
        values[name] = words[at : at + size]
        if len(values[name]) != size:
            builder.fail(line, f"the row ends within {name}.")
        at += size
    if element == "vertex":
        builder.point(line, [values[axis][0] for axis in "xyz" if axis in values])
    elif element == "face":
        corners = values.get("vertex_indices", values.get("vertex_index", []))
        builder.face(line, _corners(builder, line, [str(len(corners)), *corners]))


def _ply_binary(
    builder: _Builder, data: bytes, at: int, order: str, element: str, count: int, properties: list[_Property]
) -> tuple[dict[str, Any], int]:
    """The columns of an element, and where it ends.  Lists that are all of one length are an array."""
    if count == 0:
        return {}, at

    def take(kind: str, number: int, place: int) -> NDArray[Any]:
        dtype = np.dtype(order + kind)
        if number < 0 or place + number * dtype.itemsize > len(data):
            builder.fail(0, f"the file ends within element {element}.")
        return np.frombuffer(data, dtype, number, place)

    # As long as in the first row.
    fields: list[tuple[Any, ...]] = []
    place = at
    for number, (_, counted, kind) in enumerate(properties):
        size = 1
        if counted is not None:
            size = int(take(counted, 1, place)[0])
            fields.append((f"count{number}", order + counted))
            place += np.dtype(counted).itemsize
        take(kind, size, place)
        fields.append((f"value{number}", order + kind, (size,) if counted else ()))
        place += size * np.dtype(kind).itemsize
    dtype = np.dtype(fields)
    if at + count * dtype.itemsize <= len(data):
        rows = np.frombuffer(data, dtype, count, at)
        lists = [f"count{number}" for number, (_, counted, _) in enumerate(properties) if counted]
        if all((rows[name] == rows[name][0]).all() for name in lists):
            columns = {name: rows[f"value{number}"] for number, (name, _, _) in enumerate(properties)}
            return columns, at + count * dtype.itemsize
    slow: dict[str, list[Any]] = {name: [] for name, _, _ in properties}
    for _ in range(count):
        for name, counted, kind in properties:
            size = 1
            if counted is not None:
                size = int(take(counted, 1, at)[0])
                at += np.dtype(counted).itemsize
            values = take(kind, size, at)
            slow[name].append(values if counted else values[0])
            at += size * np.dtype(kind).itemsize
    return dict(slow), at


def _read_stl(name: str, data: bytes) -> _Builder:
    builder = _Builder(name)
    count = int.from_bytes(data[80:84], "little")
    if len(data) >= 84 and len(data) == 84 + 50 * count:
        dtype = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        corners = np.frombuffer(data, dtype, count, 84)["corners"].astype(np.float64).reshape(-1, 3)
    elif data.lstrip()[:5].lower() == b"solid" and b"vertex" in data.lower():
        for line, text in enumerate(_lines(data), 1):
            words = text.split()
            if words and words[0].lower() == "vertex":
                builder.point(line, words[1:])
        corners = np.array(builder.points, dtype=np.float64).reshape(-1, 3)
        if len(corners) % 3:
            builder.fail(line, f"{len(corners)} vertices, which is no multiple of three: the file is cut off.")
    else:
        builder.fail(0, f"a binary STL of {count} triangles has {84 + 50 * count} bytes, this file has {len(data)}.")
    points, first, which = np.unique(corners + 0.0, axis=0, return_index=True, return_inverse=True)
    by_first = np.argsort(first)
    number_of = np.empty(len(first), dtype=np.int64)
    number_of[by_first] = np.arange(len(first))
    builder.positions = points[by_first]
    builder.triangles = number_of[which.reshape(-1)].reshape(-1, 3)
    return builder


_READERS: dict[str, Callable[[str, bytes], _Builder]] = {
    ".obj": _read_obj,
    ".off": _read_off,
    ".ply": _read_ply,
    ".stl": _read_stl,
}


# Formats for drawing, which trimesh knows better; meshio has those of simulations.
_SCENES = (".glb", ".gltf", ".3mf", ".dae", ".zae", ".ctm")


def _read_elsewhere(name: str, suffix: str) -> tuple[Floats, Indices]:
    with open(name, "rb"):
        pass  # an OSError of ours, not of them
    reasons = []
    for package in ("trimesh", "meshio") if suffix in _SCENES else ("meshio", "trimesh"):
        try:
            module = sys.modules.get(package) or import_module(package)
        except ImportError:
            reasons.append(f"{package} is not installed")
            continue
        try:
            if package == "trimesh":
                mesh = module.load(name, force="mesh", process=False)
                # Formats for drawing have a point twice where its texture or normal jumps.
                mesh.merge_vertices(merge_tex=True, merge_norm=True)
            else:
                mesh = module.read(name)
            return as_mesh(mesh)
        except (Exception, SystemExit) as error:  # meshio exits on formats it does not know
            reasons.append(f"{package}: {str(error) or type(error).__name__}")
    raise ValueError(
        f"{name}: {suffix or 'a name without ending'} is none of .obj, .off, .ply, .stl ({'; '.join(reasons)})."
    )
