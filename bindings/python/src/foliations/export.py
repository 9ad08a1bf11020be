"""Files for other programs: OBJ, GLB, PLY, VTP, OFF.

Each writer takes a ``Drawing``: points with triangles, quads, polylines or
single points, and whatever there is on them.
"""

from __future__ import annotations

import base64
import json
import os
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from ._boundary import Floats, ProgressOption
from ._texture import Pattern, default_period, texture
from .errors import MeshWarning, warn

if TYPE_CHECKING:
    from .foliation import Foliation, Singularities
    from .leaves import Leaves
    from .atlas import Atlas
    from .quads import QuadMesh


@dataclass
class Drawing:
    """What a file shows."""

    points: Floats
    faces: NDArray[Any] | None = None  #: (m, 3) or (m, 4)
    lines: list[NDArray[Any]] = field(default_factory=list)  #: of points, the first one repeated where closed
    dots: bool = False  #: the points themselves
    corner_uv: Floats | None = None  #: (m, 3, 2), of period 1
    texture: bytes = b""
    point_data: dict[str, NDArray[Any]] = field(default_factory=dict)
    cell_data: dict[str, NDArray[Any]] = field(default_factory=dict)

    def split(self) -> tuple[NDArray[Any], Floats, NDArray[Any]]:
        """Points that have one (u, v) each: which point each is, its (u, v), and the faces with them."""
        assert self.faces is not None and self.corner_uv is not None
        uv = self.corner_uv.reshape(-1, 2)
        rows = np.column_stack([self.faces.reshape(-1), uv])
        _, first, which = np.unique(rows, axis=0, return_index=True, return_inverse=True)
        return self.faces.reshape(-1)[first], uv[first], which.reshape(self.faces.shape)


def save(path: str | os.PathLike[str], drawing: Drawing) -> None:
    """Writes the format of the file name's ending."""
    target = Path(path)
    suffix = target.suffix.lower()
    if suffix not in _WRITERS or (suffix == ".off" and drawing.faces is None):
        known = [name for name in _WRITERS if name != ".off" or drawing.faces is not None]
        raise ValueError(f"{os.fspath(path)}: the name must end in one of {', '.join(known)}.")
    _WRITERS[suffix](target, drawing)


def _texture_file(target: Path, drawing: Drawing) -> str:
    """Beside the file; not NAME.png, which may be a picture of it."""
    texture_path = target.with_name(f"{target.stem}_texture.png")
    texture_path.write_bytes(drawing.texture)
    return texture_path.name


def _segments(drawing: Drawing) -> NDArray[np.uint32]:
    parts = [np.stack([line[:-1], line[1:]], axis=1) for line in drawing.lines]
    return np.concatenate(parts).astype(np.uint32) if parts else np.empty((0, 2), np.uint32)


def _write_obj(target: Path, drawing: Drawing) -> None:
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in drawing.points.tolist()]
    if drawing.faces is not None and drawing.corner_uv is not None:
        material = target.with_suffix(".mtl")
        picture = _texture_file(target, drawing)
        material.write_text(f"newmtl foliation\nKd 1 1 1\nmap_Kd {picture}\n", encoding="utf-8")
        uv, which = np.unique(drawing.corner_uv.reshape(-1, 2), axis=0, return_inverse=True)
        rows.insert(0, f"mtllib {material.name}")
        rows += [f"vt {u!r} {v!r}" for u, v in uv.tolist()]
        rows.append("usemtl foliation")
        corners = np.stack([drawing.faces, which.reshape(drawing.faces.shape)], axis=2) + 1
        rows += [f"f {a}/{s} {b}/{t} {c}/{u}" for (a, s), (b, t), (c, u) in corners.tolist()]
    elif drawing.faces is not None:
        rows += ["f " + " ".join(map(str, face)) for face in (drawing.faces.astype(np.int64) + 1).tolist()]
    rows += ["l " + " ".join(map(str, (line.astype(np.int64) + 1).tolist())) for line in drawing.lines]
    if drawing.dots:
        rows += [f"p {number + 1}" for number in range(len(drawing.points))]
    target.write_text("\n".join(rows) + "\n", encoding="utf-8")


def _write_off(target: Path, drawing: Drawing) -> None:
    assert drawing.faces is not None
    rows = ["OFF", f"{len(drawing.points)} {len(drawing.faces)} 0"]
    rows += [f"{x!r} {y!r} {z!r}" for x, y, z in drawing.points.tolist()]
    rows += [f"{len(face)} " + " ".join(map(str, face)) for face in drawing.faces.tolist()]
    target.write_text("\n".join(rows) + "\n", encoding="utf-8")


_PLY_NAMES = {"f8": "double", "f4": "float", "i4": "int", "u4": "uint"}


def _narrow(values: NDArray[Any]) -> NDArray[Any]:
    """float64, or int32 of other numbers."""
    return np.asarray(values, dtype="<f8" if values.dtype.kind == "f" else "<i4")


def _write_ply(target: Path, drawing: Drawing) -> None:
    header = ["ply", "format binary_little_endian 1.0"]
    if drawing.corner_uv is not None:
        header.append(f"comment TextureFile {_texture_file(target, drawing)}")
    extra = {name: _narrow(values) for name, values in drawing.point_data.items() if values.ndim == 1}
    fields = [(axis, "<f8") for axis in "xyz"] + [(name, values.dtype.str) for name, values in extra.items()]
    vertices = np.empty(len(drawing.points), dtype=fields)
    for column, axis in enumerate("xyz"):
        vertices[axis] = drawing.points[:, column]
    for name, values in extra.items():
        vertices[name] = values
    header.append(f"element vertex {len(vertices)}")
    header += [f"property {_PLY_NAMES[kind[1:]]} {name}" for name, kind in fields]
    blocks = [vertices.tobytes()]
    if drawing.faces is not None:
        corners = drawing.faces.shape[1]
        columns: list[tuple[Any, ...]] = [("n", "u1"), ("corners", "<u4", (corners,))]
        header += [f"element face {len(drawing.faces)}", "property list uchar uint vertex_indices"]
        if drawing.corner_uv is not None:
            columns += [("m", "u1"), ("uv", "<f4", (2 * corners,))]
            header.append("property list uchar float texcoord")
        faces = np.empty(len(drawing.faces), dtype=columns)
        faces["n"], faces["corners"] = corners, drawing.faces
        if drawing.corner_uv is not None:
            faces["m"], faces["uv"] = 2 * corners, drawing.corner_uv.reshape(len(faces), -1)
        blocks.append(faces.tobytes())
    if drawing.lines:
        segments = _segments(drawing)
        header += [f"element edge {len(segments)}", "property uint vertex1", "property uint vertex2"]
        blocks.append(segments.astype("<u4").tobytes())
    target.write_bytes("\n".join([*header, "end_header", ""]).encode() + b"".join(blocks))


# --- VTP ---------------------------------------------------------------------

_VTK_TYPES = {"f8": "Float64", "f4": "Float32", "i4": "Int32", "i8": "Int64"}


def _data_array(name: str, values: NDArray[Any]) -> str:
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    data = values.tobytes()
    text = base64.b64encode(struct.pack("<Q", len(data)) + data).decode()
    kind = _VTK_TYPES[values.dtype.str[1:]]
    return f'<DataArray type="{kind}" Name="{escape(name)}"{components} format="binary">{text}</DataArray>'


def _cells(name: str, connectivity: NDArray[Any], offsets: NDArray[Any]) -> Iterator[str]:
    yield f"<{name}>"
    yield _data_array("connectivity", connectivity.astype("<i8"))
    yield _data_array("offsets", offsets.astype("<i8"))
    yield f"</{name}>"


def _write_vtp(target: Path, drawing: Drawing) -> None:
    points, faces, uv = drawing.points, drawing.faces, None
    point_data = drawing.point_data
    if drawing.corner_uv is not None:
        source, uv, faces = drawing.split()
        points = points[source]
        point_data = {name: values[source] for name, values in point_data.items()} | {"vertex": source}
    polygons = 0 if faces is None else len(faces)
    dots = len(points) if drawing.dots else 0
    rows = [
        '<?xml version="1.0"?>',
        '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        "<PolyData>",
        f'<Piece NumberOfPoints="{len(points)}" NumberOfVerts="{dots}" NumberOfLines="{len(drawing.lines)}" '
        f'NumberOfStrips="0" NumberOfPolys="{polygons}">',
        "<Points>",
        _data_array("Points", np.asarray(points, "<f8")),
        "</Points>",
    ]
    if dots:
        rows += _cells("Verts", np.arange(dots), np.arange(1, dots + 1))
    if drawing.lines:
        rows += _cells("Lines", np.concatenate(drawing.lines), np.cumsum([len(line) for line in drawing.lines]))
    if faces is not None:
        rows += _cells("Polys", faces.reshape(-1), np.arange(1, len(faces) + 1) * faces.shape[1])
    rows.append("<PointData>" if uv is None else '<PointData TCoords="uv">')
    rows += [_data_array(name, _narrow(values)) for name, values in point_data.items()]
    if uv is not None:
        rows.append(_data_array("uv", np.asarray(uv, "<f8")))
    rows += ["</PointData>", "<CellData>"]
    rows += [_data_array(name, _narrow(values)) for name, values in drawing.cell_data.items()]
    rows += ["</CellData>", "</Piece>", "</PolyData>", "</VTKFile>", ""]
    if uv is not None:
        _texture_file(target, drawing)
    target.write_text("\n".join(rows), encoding="utf-8")


# --- GLB ---------------------------------------------------------------------

_GL_TYPES = {"<f4": 5126, "<u4": 5125}
_POINTS, _LINES, _TRIANGLES = 0, 1, 4


class _Binary:
    """The binary part of a GLB, with its views and accessors."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def view(self, data: bytes, target: int | None = None) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        if target is not None:
            self.views[-1]["target"] = target
        self.data += data
        return len(self.views) - 1

    def accessor(self, array: NDArray[Any], *, indices: bool = False, bounds: bool = False) -> int:
        values = np.ascontiguousarray(array, dtype="<u4" if indices else "<f4")
        entry: dict[str, Any] = {
            "bufferView": self.view(values.tobytes(), 34963 if indices else 34962),
            "componentType": _GL_TYPES[values.dtype.str],
            "count": len(values),
            "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3"}[1 if values.ndim == 1 else values.shape[1]],
        }
        if bounds:
            entry.update(min=values.min(axis=0).tolist(), max=values.max(axis=0).tolist())
        self.accessors.append(entry)
        return len(self.accessors) - 1


def _normals(points: Floats, triangles: NDArray[Any]) -> Floats:
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    result = np.stack(
        [np.bincount(triangles.reshape(-1), np.repeat(normals[:, axis], 3), len(points)) for axis in range(3)], axis=1
    )
    length = np.linalg.norm(result, axis=1, keepdims=True)
    return np.asarray(np.where(length > 0, result / np.where(length > 0, length, 1), [0.0, 0.0, 1.0]))


_FAR = 16  # sizes of the box: four of the 24 bits of single precision


def _origin(points: NDArray[Any]) -> NDArray[Any]:
    """What the points of a GLB are relative to: 0, or the middle of a box that is far from there."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle = low / 2 + high / 2
    far = float(np.abs(middle).max()) / 2 > _FAR * float((high / 2 - low / 2).max())
    return middle if far else np.zeros(3)


def _warn_of_lost_edges(target: Path, points: NDArray[Any], ends: NDArray[Any]) -> None:
    """Points that single precision cannot tell apart."""
    single = points.astype(np.float32)
    a, b = ends[:, 0], ends[:, 1]
    lost = (single[a] == single[b]).all(axis=1) & (points[a] != points[b]).any(axis=1)
    count = len(np.unique(np.sort(ends[lost], axis=1), axis=0))
    if count:
        edges = "1 edge is" if count == 1 else f"{count} edges are"
        warn(
            f"{target}: {edges} too short for the single precision of GLB, which loses the shape there; "
            ".ply, .obj and .vtp have double precision.",
            MeshWarning,
        )


def _sides(triangles: NDArray[Any]) -> NDArray[Any]:
    return np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)


def _write_glb(target: Path, drawing: Drawing) -> None:
    binary = _Binary()
    points, faces = drawing.points, drawing.faces
    if len(points) == 0:
        raise ValueError(f"{target}: nothing to write.")
    origin = _origin(points)
    points = points - origin
    material: dict[str, Any] = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.7}}
    material["doubleSided"] = True
    document: dict[str, Any] = {"asset": {"version": "2.0", "generator": "foliations"}, "materials": [material]}
    attributes: dict[str, int] = {}
    if faces is not None:
        triangles = faces if faces.shape[1] == 3 else faces[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
        _warn_of_lost_edges(target, points, _sides(triangles))
        normals = _normals(points, triangles)
        if drawing.corner_uv is not None:
            source, uv, triangles = drawing.split()
            points, normals = points[source], normals[source]
            attributes["TEXCOORD_0"] = binary.accessor(uv)
            picture = binary.view(drawing.texture)
            document["images"] = [{"bufferView": picture, "mimeType": "image/png"}]
            # Repeated, linear between pixels and between sizes.
            document["samplers"] = [{"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}]
            document["textures"] = [{"sampler": 0, "source": 0}]
            material["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        attributes["NORMAL"] = binary.accessor(normals)
        mode, indices = _TRIANGLES, triangles.reshape(-1)
    elif drawing.lines:
        segments = _segments(drawing)
        _warn_of_lost_edges(target, points, segments)
        mode, indices = _LINES, segments.reshape(-1)
    else:
        mode, indices = _POINTS, np.arange(len(points))
    attributes["POSITION"] = binary.accessor(points, bounds=True)
    primitive = {"attributes": attributes, "indices": binary.accessor(indices, indices=True)}
    document["meshes"] = [{"primitives": [primitive | {"mode": mode, "material": 0}]}]
    node: dict[str, Any] = {"mesh": 0} | ({"translation": origin.tolist()} if origin.any() else {})
    document.update(nodes=[node], scenes=[{"nodes": [0]}], scene=0)
    document.update(accessors=binary.accessors, bufferViews=binary.views, buffers=[{"byteLength": len(binary.data)}])
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data = bytes(binary.data) + b"\0" * (-len(binary.data) % 4)
    header = struct.pack("<III", 0x46546C67, 2, 12 + 8 + len(text) + 8 + len(data))
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    target.write_bytes(header + chunks)


_WRITERS: dict[str, Callable[[Path, Drawing], None]] = {
    ".obj": _write_obj,
    ".glb": _write_glb,
    ".ply": _write_ply,
    ".vtp": _write_vtp,
    ".off": _write_off,
}


# --- What there is to export -------------------------------------------------


def export_foliation(
    foliation: Foliation,
    path: str | os.PathLike[str],
    *,
    pattern: Pattern = "stripes",
    period: float | None = None,
    progress: ProgressOption = None,
) -> None:
    """Writes the mesh of its level with (u, v) as texture coordinates, and a texture that shows the leaves.

    Parameters
    ----------
    path : file name
        ``.obj`` (with NAME.mtl and NAME_texture.png), ``.glb`` (one file with
        the texture in it), ``.ply`` or ``.vtp`` (with NAME_texture.png),
        ``.off`` (the mesh alone).  GLB has single precision, relative to its node; the others double.
    pattern : "stripes" or "checkerboard"
        Of the texture: a stripe along leaves, or squares.
    period : float, optional
        Distance of two stripes in the unit of the values; texture coordinates
        are (u, v) / period.  Default: one that fits at the seams if there is one.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Raises
    ------
    FoliationError
        The values have a pole, or are too far from harmonic.
    ValueError
        There is no such format.
    """
    level = foliation.hierarchy.levels[foliation.level]
    drawing = Drawing(level.positions, level.triangles)
    if Path(path).suffix.lower() in (".obj", ".glb", ".ply", ".vtp"):
        drawing.texture = texture(pattern)
        if period is not None and not 0 < period < np.inf:
            raise ValueError(f"period must be above 0, got {period}.")
        parameterization = foliation.parameterize(progress=progress)
        if period is None:
            period = default_period(foliation, parameterization)
        drawing.corner_uv = parameterization.corner_uv / period
        drawing.cell_data["dilatation"] = parameterization.dilatation
    save(path, drawing)


def export_atlas(atlas: Atlas, path: str | os.PathLike[str]) -> None:
    """Writes the mesh with the charts as texture coordinates, and a checkerboard as texture."""
    level = atlas._foliation.hierarchy.levels[atlas._foliation.level]
    drawing = Drawing(level.positions, level.triangles)
    if Path(path).suffix.lower() in (".obj", ".glb", ".ply", ".vtp"):
        drawing.texture = texture("checkerboard")
        drawing.corner_uv = atlas.corner_uv
        drawing.cell_data["chart"] = atlas.triangle_chart.astype(np.int32)
    save(path, drawing)


def export_leaves(leaves: Leaves, path: str | os.PathLike[str]) -> None:
    """Writes the polylines: ``.obj``, ``.glb``, ``.ply`` or ``.vtp`` (with kind, cylinder and length of each)."""
    lines = []
    offsets = leaves.offsets.astype(np.int64)
    rows = leaves._rows
    for begin, end, closed in zip(offsets[:-1], offsets[1:], rows["closed"]):
        line = np.arange(begin, end)
        lines.append(np.append(line, begin) if closed else line)
    # Without a cylinder -1.
    data = {name: rows[name].astype(np.int32) for name in ("kind", "cylinder")}
    data |= {name: np.array(rows[name]) for name in ("height", "length")}
    owner = np.repeat(np.arange(len(leaves)), np.diff(offsets))
    save(path, Drawing(leaves.points, lines=lines, cell_data=data, point_data={"leaf": owner}))


def export_quads(mesh: QuadMesh, path: str | os.PathLike[str]) -> None:
    """Writes the quad mesh: ``.obj``, ``.off``, ``.ply``, ``.vtp``, or ``.glb`` (two triangles for each)."""
    save(path, Drawing(mesh.positions, mesh.quads))


def export_singularities(zeros: Singularities, path: str | os.PathLike[str]) -> None:
    """Writes the points: ``.obj``, ``.glb``, ``.ply`` or ``.vtp``; the last two with the index of each (0: a mark)."""
    data = {name: np.array(zeros._rows[name]) for name in ("index", "kind")}
    save(path, Drawing(np.array(zeros.positions), dots=True, point_data=data))
