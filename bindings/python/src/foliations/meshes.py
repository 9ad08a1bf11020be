"""Meshes of other packages and from files, as arrays of positions and triangles.

No other package is imported unless a file needs it: mesh objects are known by
the attributes they have.
"""

from __future__ import annotations

import gzip
import os
import shutil
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import Floats, Indices, as_count, as_indices, as_positions, pointer, view
from ._native import ffi, lib
from .errors import MeshWarning, warn


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


class _PositionsTriangles(Protocol):
    """RepairedMesh, Component and Level of this package."""

    @property
    def positions(self) -> Any: ...
    @property
    def triangles(self) -> Any: ...


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
    _PositionsTriangles,
    "tuple[ArrayLike, ArrayLike]",
]


def as_mesh(mesh: MeshLike) -> tuple[Floats, Indices]:
    """Positions (n, 3) and triangles (m, 3) of a file or of a mesh object.

    Parameters
    ----------
    mesh : file name, mesh object, or pair (positions, triangles)
        Files: see :func:`read_mesh`.  Objects: those of trimesh, meshio,
        pyvista and Open3D, whatever has ``vertices`` and ``faces`` as they
        have, and the result of :func:`repair`.  Polygons become fans of triangles.

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
    if hasattr(mesh, "positions") and hasattr(mesh, "triangles"):  # of this package
        return mesh.positions, mesh.triangles
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

    OBJ, OFF, PLY, STL, glTF (``.gltf``, ``.glb``), and as text Medit
    (``.mesh``), Gmsh (``.msh``) and legacy VTK (``.vtk``) are read here, with all digits,
    also with ``.gz``.  Polygons are cut along diagonals inside them, equal points of STL and
    glTF are joined, vertices without a face are dropped.  What was skipped or dropped is a
    :class:`foliations.MeshWarning`.  Other formats are left to other packages where they are
    installed, also with ``.gz``: 3MF to trimesh, VTP to pyvista, binary Gmsh and legacy VTK and
    those of simulations to meshio.

    Raises
    ------
    ValueError
        The file is no such mesh; the message names the line.
    OSError
        It cannot be opened.
    """
    name = os.fspath(path)
    suffixes = [suffix.lower() for suffix in Path(name).suffixes]
    if suffixes[-1:] == [".gz"]:
        suffixes.pop()
    suffix = suffixes[-1] if suffixes else ""
    if suffix and suffix not in _SUFFIXES:
        return _read_elsewhere(name, suffix, [])
    data = Path(name).read_bytes()
    folder = os.fspath(Path(name).parent).encode()
    file = lib.hmf_mesh_file_read(ffi.from_buffer(data), len(data), suffix.encode(), folder)
    try:
        mesh = _mesh_of(file)
    except _FileError as error:
        if suffix in _PERHAPS:  # binary ones, say
            return _read_elsewhere(name, suffix, [str(error)])
        raise ValueError(f"{name}, line {error.line}: {error}." if error.line else f"{name}: {error}.") from None
    for note in mesh.notes:
        warn(f"{name}: {note}", MeshWarning)
    return mesh.positions, mesh.triangles


class _FileError(Exception):
    def __init__(self, sentence: str, line: int) -> None:
        super().__init__(sentence)
        self.line = line


@dataclass(frozen=True)
class RepairedMesh:
    """A mesh and what was done to it; made by :func:`repair`."""

    positions: Floats  #: (n, 3)
    triangles: Indices  #: (m, 3)
    vertices: Indices  #: (n,): number of each vertex before; 2^32 - 1: it is new
    faces: Indices  #: (m,): likewise of each triangle
    notes: tuple[str, ...]  #: a sentence for each kind of repair

    def __repr__(self) -> str:
        done = "; ".join(self.notes) or "nothing to repair"
        return f"<RepairedMesh: {len(self.positions)} vertices, {len(self.triangles)} triangles; {done}>"


def _mesh_of(file: Any) -> RepairedMesh:
    """What an hmf_mesh_file holds; raises _FileError."""
    if file == ffi.NULL:
        raise MemoryError("no memory for the mesh")
    owner = ffi.gc(file, lib.hmf_mesh_file_free)
    sentence = ffi.string(file.error).decode("utf-8", "replace")
    if sentence:
        raise _FileError(sentence, file.line)
    return RepairedMesh(
        view(owner, file.positions, file.vertex_count, 3),
        view(owner, file.triangles, file.triangle_count, 3),
        view(owner, file.vertices, file.vertex_count),
        view(owner, file.faces, file.triangle_count),
        tuple(ffi.string(file.notes).decode().splitlines()),
    )


def repair(
    positions: ArrayLike | MeshLike,
    triangles: ArrayLike | None = None,
    *,
    join_points: bool | float = False,
    fill_holes: int = 0,
) -> RepairedMesh:
    """Lossless repairs, as with ``hmf --repair``.

    Drops triangles with a repeated vertex, duplicate triangles and unused vertices; separates sheets that touch in a
    vertex or an edge; orients patches consistently.

    Parameters
    ----------
    positions, triangles
        As for :class:`Hierarchy`.
    join_points : bool or float
        Merges vertices before the repair: True: those at the same point; a distance: those within it.
    fill_holes : int
        Closes every boundary of at most this many edges.
    """
    given: Any = positions
    mesh = as_mesh(given) if triangles is None else (as_positions(given), as_indices(triangles, "triangles", 3))
    points = np.ascontiguousarray(mesh[0])
    distance = -1.0 if join_points is False else 0.0 if join_points is True else float(join_points)
    if distance < 0 and join_points is not False:
        raise ValueError(f"join_points={join_points} is not in [0, inf).")
    file = lib.hmf_mesh_file_repair(
        pointer(points, "double *"),
        len(points),
        pointer(mesh[1], "uint32_t *"),
        len(mesh[1]),
        1,
        distance,
        as_count(fill_holes, "fill_holes"),
    )
    try:
        return _mesh_of(file)
    except _FileError as error:
        raise ValueError(f"{error}.") from None


_SUFFIXES = (".obj", ".off", ".ply", ".stl", ".gltf", ".glb", ".mesh", ".msh", ".vtk")
# Formats with variants that others read.
_PERHAPS = (".gltf", ".glb", ".mesh", ".msh", ".vtk")

# Who reads a format: trimesh knows those for drawing better, meshio has those of simulations, VTP is VTK's own.
_PACKAGES_OF = {suffix: ("trimesh", "meshio") for suffix in (".glb", ".gltf", ".3mf", ".dae", ".zae", ".ctm")}
_PACKAGES_OF[".vtp"] = ("pyvista", "meshio")


@contextmanager
def _unpacked(name: str, suffix: str) -> Iterator[str]:
    """The name of a file that ends in its suffix and is not packed by gzip: itself, or a copy while it is needed."""
    with open(name, "rb") as file:  # an OSError of ours, not of them
        packed = file.read(2) == b"\x1f\x8b"
        if not packed and name.lower().endswith(suffix):
            yield name
            return
        with TemporaryDirectory() as folder:
            plain = os.path.join(folder, "mesh" + suffix)
            file.seek(0)
            try:
                with open(plain, "wb") as copy:
                    shutil.copyfileobj(gzip.GzipFile(fileobj=file) if packed else file, copy)
            except (gzip.BadGzipFile, EOFError, zlib.error) as error:
                raise ValueError(f"{name}: gzip cannot unpack it: {error}.") from None
            yield plain


def _read_elsewhere(name: str, suffix: str, reasons: list[str]) -> tuple[Floats, Indices]:
    packages = _PACKAGES_OF.get(suffix, ("meshio", "trimesh"))
    with _unpacked(name, suffix) as plain:
        for package in packages:
            try:
                module = sys.modules.get(package) or import_module(package)
            except ImportError:
                reasons.append(f"{package} is not installed")
                continue
            try:
                if package == "trimesh":
                    mesh = module.load(plain, force="mesh", process=False)
                    # Formats for drawing have a point twice where its texture or normal jumps.
                    mesh.merge_vertices(merge_tex=True, merge_norm=True)
                else:
                    mesh = module.read(plain)
                if package == "pyvista":
                    mesh = mesh.triangulate()  # strips as well
                return as_mesh(mesh)
            except (Exception, SystemExit) as error:  # meshio exits on formats it does not know
                reasons.append(f"{package}: {str(error).replace(plain, name) or type(error).__name__}")
    other = "" if suffix in _SUFFIXES else f"{suffix} is none of {', '.join(_SUFFIXES)}; "
    raise ValueError(f"{name}: {other}{'; '.join(reasons)}. pip install {' '.join(packages)} reads more formats.")
