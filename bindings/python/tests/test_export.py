"""Files for other programs: read back, by ourselves and by other packages."""

from __future__ import annotations

import base64
import json
import struct
import zlib
from pathlib import Path
from xml.etree import ElementTree

import foliations
import numpy as np
import pytest
from foliations import read_mesh

MESH = (".obj", ".glb", ".ply", ".vtp")


@pytest.fixture(scope="module")
def foliation(hierarchy: foliations.Hierarchy) -> foliations.Foliation:
    return hierarchy.solve()


def pixels(png: bytes) -> np.ndarray:
    """Of the RGB pictures that are written here: no row is filtered."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n" and png[-8:-4] == b"IEND"
    width, height = struct.unpack(">II", png[16:24])
    size = struct.unpack(">I", png[33:37])[0]
    assert (
        png[37:41] == b"IDAT" and zlib.crc32(png[37 : 41 + size]) == struct.unpack(">I", png[41 + size : 45 + size])[0]
    )
    rows = np.frombuffer(zlib.decompress(png[41 : 41 + size]), np.uint8).reshape(height, 1 + 3 * width)
    assert not rows[:, 0].any()
    return rows[:, 1:].reshape(height, width, 3).astype(int)


def glb(path: Path) -> tuple[dict, list[np.ndarray], bytes]:
    """The document, its accessors, its binary part."""
    data = path.read_bytes()
    magic, version, length = struct.unpack("<4sII", data[:12])
    assert (magic, version, length) == (b"glTF", 2, len(data)) and length % 4 == 0
    size = struct.unpack("<I", data[12:16])[0]
    assert data[16:20] == b"JSON" and size % 4 == 0
    document = json.loads(data[20 : 20 + size])
    binary = data[28 + size :]
    arrays = []
    for accessor in document["accessors"]:
        view = document["bufferViews"][accessor["bufferView"]]
        dtype = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        assert view["byteOffset"] % 4 == 0 and view["byteLength"] == 4 * width * accessor["count"]
        array = np.frombuffer(binary, dtype, width * accessor["count"], view["byteOffset"])
        arrays.append(array.reshape(-1, width))
    return document, arrays, binary


def vtp(path: Path) -> dict[str, np.ndarray]:
    arrays = {}
    for element in ElementTree.parse(path).iter("DataArray"):
        raw = base64.b64decode(element.text or "")
        assert struct.unpack("<Q", raw[:8])[0] == len(raw) - 8
        dtype = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8"}[element.attrib["type"]]
        array = np.frombuffer(raw[8:], dtype)
        width = int(element.attrib.get("NumberOfComponents", 1))
        arrays[element.attrib["Name"]] = array.reshape(-1, width) if width > 1 else array
    return arrays


def textured(foliation: foliations.Foliation, uv: np.ndarray) -> None:
    """Texture coordinates of each corner belong to the parameterization."""
    corner_uv = foliation.parameterize().corner_uv
    period = np.abs(corner_uv).max() / np.abs(uv).max()
    assert np.abs(uv * period - corner_uv).max() < 1e-5 * np.abs(corner_uv).max()


def test_textured_obj(foliation: foliations.Foliation, tmp_path: Path) -> None:
    foliation.export(tmp_path / "a.obj")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.mtl", "a.obj", "a_texture.png"]
    assert "map_Kd a_texture.png" in (tmp_path / "a.mtl").read_text()
    lines = (tmp_path / "a.obj").read_text().splitlines()
    assert lines[0] == "mtllib a.mtl" and "usemtl foliation" in lines
    level = foliation.hierarchy.levels[0]
    positions, triangles = read_mesh(tmp_path / "a.obj")
    assert np.array_equal(positions, level.positions) and np.array_equal(triangles, level.triangles)
    table = np.array([line.split()[1:] for line in lines if line.startswith("vt ")], dtype=float)
    corners = [[int(word.split("/")[1]) - 1 for word in line.split()[1:]] for line in lines if line.startswith("f ")]
    textured(foliation, table[np.array(corners)])


def test_glb(foliation: foliations.Foliation, tmp_path: Path) -> None:
    foliation.export(str(tmp_path / "a.glb"), pattern="checkerboard")
    document, arrays, binary = glb(tmp_path / "a.glb")
    primitive = document["meshes"][0]["primitives"][0]
    points, normals, uv = (arrays[primitive["attributes"][name]] for name in ("POSITION", "NORMAL", "TEXCOORD_0"))
    triangles = arrays[primitive["indices"]].reshape(-1, 3)
    level = foliation.hierarchy.levels[0]
    assert np.abs(points[triangles] - level.positions[level.triangles]).max() < 1e-5
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
    textured(foliation, uv[triangles])
    accessor = document["accessors"][primitive["attributes"]["POSITION"]]
    assert accessor["min"] == points.min(axis=0).tolist() and accessor["max"] == points.max(axis=0).tolist()
    view = document["bufferViews"][document["images"][0]["bufferView"]]
    image = pixels(binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]])
    dark = image[:, :, 0] < 150
    assert 0.45 < dark.mean() < 0.55, "half of the squares"


def test_glb_as_others_read_it(foliation: foliations.Foliation, tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    foliation.export(tmp_path / "a.glb")
    mesh = trimesh.load(tmp_path / "a.glb", force="mesh")
    assert len(mesh.faces) == foliation.hierarchy.levels[0].triangle_count
    assert mesh.visual.uv.shape == (len(mesh.vertices), 2)
    foliation.export(tmp_path / "a.obj")
    mesh = trimesh.load(tmp_path / "a.obj", force="mesh")
    assert mesh.visual.uv is not None and mesh.visual.material.image is not None


def test_ply_of_the_mesh(foliation: foliations.Foliation, tmp_path: Path) -> None:
    foliation.export(tmp_path / "a.ply")
    level = foliation.hierarchy.levels[0]
    positions, triangles = read_mesh(tmp_path / "a.ply")
    assert np.array_equal(positions, level.positions) and np.array_equal(triangles, level.triangles)
    head, _, data = (tmp_path / "a.ply").read_bytes().partition(b"end_header\n")
    assert b"comment TextureFile a_texture.png" in head and (tmp_path / "a_texture.png").exists()
    rows = np.frombuffer(data[24 * len(positions) :], [("a", "u1"), ("b", "<u4", 3), ("c", "u1"), ("uv", "<f4", 6)])
    textured(foliation, rows["uv"].reshape(-1, 3, 2))


def test_vtp_of_the_mesh(foliation: foliations.Foliation, tmp_path: Path) -> None:
    foliation.export(tmp_path / "a.vtp")
    arrays = vtp(tmp_path / "a.vtp")
    level = foliation.hierarchy.levels[0]
    triangles = arrays["connectivity"].reshape(-1, 3)
    assert np.array_equal(arrays["vertex"][triangles], level.triangles)
    assert np.array_equal(arrays["Points"], level.positions[arrays["vertex"]])
    assert np.array_equal(arrays["dilatation"], foliation.parameterize().dilatation)
    textured(foliation, arrays["uv"][triangles])


def test_vtp_as_others_read_it(foliation: foliations.Foliation, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    foliation.export(tmp_path / "mesh.vtp")
    foliation.trace(spacing=0.1).export(tmp_path / "leaves.vtp")
    foliation.quads().export(tmp_path / "quads.vtp")
    foliation.singularities().export(tmp_path / "zeros.vtp")
    mesh, leaves, quads, zeros = (
        pyvista.read(tmp_path / f"{name}.vtp") for name in ("mesh", "leaves", "quads", "zeros")
    )
    assert mesh.n_cells == foliation.hierarchy.levels[0].triangle_count and "dilatation" in mesh.cell_data
    assert mesh.active_texture_coordinates is not None
    assert leaves.n_lines == len(foliation.trace(spacing=0.1)) and "length" in leaves.cell_data
    assert quads.n_cells == len(foliation.quads().quads)
    assert zeros["index"].sum() == 4 - 4 * foliation.hierarchy.genus


@pytest.mark.parametrize("suffix", MESH)
def test_leaves(foliation: foliations.Foliation, tmp_path: Path, suffix: str) -> None:
    leaves = foliation.trace(spacing=0.2, critical=True)
    path = tmp_path / f"leaves{suffix}"
    leaves.export(path)
    count = sum(len(leaf.points) - 1 + leaf.closed for leaf in leaves)
    if suffix == ".obj":
        lines = [line.split()[1:] for line in path.read_text().splitlines() if line.startswith("l ")]
        assert sum(len(line) - 1 for line in lines) == count
        for line, leaf in zip(lines, leaves):
            assert (line[0] == line[-1]) == leaf.closed
    elif suffix == ".glb":
        document, arrays, _ = glb(path)
        primitive = document["meshes"][0]["primitives"][0]
        assert primitive["mode"] == 1 and len(arrays[primitive["indices"]]) == 2 * count
    elif suffix == ".ply":
        assert f"element edge {count}\n".encode() in path.read_bytes()
    else:
        arrays = vtp(path)
        assert len(arrays["connectivity"]) == arrays["offsets"][-1] == count + len(leaves)
        assert arrays["length"].tolist() == [leaf.length for leaf in leaves]
        assert arrays["cylinder"].tolist() == [-1 if leaf.cylinder is None else leaf.cylinder for leaf in leaves]


@pytest.mark.parametrize("suffix", [*MESH, ".off"])
def test_quads(foliation: foliations.Foliation, tmp_path: Path, suffix: str) -> None:
    mesh = foliation.quads()
    path = tmp_path / f"quads{suffix}"
    mesh.export(path)
    if suffix == ".glb":
        document, arrays, _ = glb(path)
        triangles = arrays[document["meshes"][0]["primitives"][0]["indices"]].reshape(-1, 3)
    elif suffix == ".vtp":
        assert np.array_equal(vtp(path)["connectivity"].reshape(-1, 4), mesh.quads)
        return
    else:
        positions, triangles = read_mesh(path)
        assert np.array_equal(positions, mesh.positions)
    assert np.array_equal(triangles, mesh.quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))


@pytest.mark.parametrize("suffix", MESH)
def test_zeros(foliation: foliations.Foliation, tmp_path: Path, suffix: str) -> None:
    zeros = foliation.singularities()
    path = tmp_path / f"zeros{suffix}"
    zeros.export(path)
    if suffix == ".obj":
        assert path.read_text().count("\np ") == len(zeros)
    elif suffix == ".glb":
        assert glb(path)[0]["meshes"][0]["primitives"][0]["mode"] == 0
    elif suffix == ".ply":
        data = path.read_bytes().partition(b"end_header\n")[2]
        rows = np.frombuffer(data, [("xyz", "<f8", 3), ("index", "<i4"), ("kind", "<i4")])
        assert np.array_equal(rows["xyz"], zeros.positions) and rows["index"].sum() == zeros.index_sum
    else:
        assert vtp(path)["index"].tolist() == [zero.index for zero in zeros]


@pytest.mark.parametrize("weights", [[1, 1], [1, 2], [0.5, 0.75]])
def test_the_default_period_fits_at_the_seams(hierarchy: foliations.Hierarchy, weights: list[float]) -> None:
    from foliations._texture import default_period

    foliation = hierarchy.solve(weights=weights)
    parameterization = foliation.parameterize()
    jumps = parameterization.transition[parameterization.seam, 1] / default_period(foliation, parameterization)
    fits = np.abs(jumps - np.rint(jumps)) < 1e-4
    # But near zeros that only discretization keeps apart.
    assert fits.mean() > 0.95


def test_wrong_names_and_options(foliation: foliations.Foliation, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"end in one of \.obj, \.glb, \.ply, \.vtp"):
        foliation.trace(spacing=0.5).export(tmp_path / "a.off")
    with pytest.raises(ValueError, match="end in one of"):
        foliation.export(tmp_path / "a.fbx")
    with pytest.raises(ValueError, match="pattern"):
        foliation.export(tmp_path / "a.glb", pattern="dots")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="period"):
        foliation.export(tmp_path / "a.glb", period=-1)
    assert not list(tmp_path.iterdir())
    foliation.export(tmp_path / "a.off")
    assert np.array_equal(read_mesh(tmp_path / "a.off")[1], foliation.hierarchy.levels[0].triangles)
