"""Mesh objects of other packages, and files."""

from __future__ import annotations

import gzip
import struct
import sys
import warnings
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import foliations
import numpy as np
import pytest
from conftest import Mesh
from foliations import as_mesh, read_mesh
from foliations.export import Drawing, save


def same(given: Mesh, expected: Mesh, tolerance: float = 0) -> None:
    assert given[0].dtype == np.float64 and given[1].dtype == np.uint32
    assert np.abs(given[0] - expected[0]).max() <= tolerance and np.array_equal(given[1], expected[1])


def counted(triangles: np.ndarray) -> np.ndarray:
    return np.insert(triangles.astype(int), 0, 3, axis=1).ravel()


class Vectors:
    """As open3d.utility.Vector3dVector: numpy can read it."""

    def __init__(self, array: np.ndarray) -> None:
        self._array = array

    def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
        return np.asarray(self._array, dtype=dtype)  # type: ignore[call-overload]


def test_objects_by_their_attributes(pretzel: Mesh) -> None:
    positions, triangles = pretzel
    tensor = SimpleNamespace(cpu=lambda: SimpleNamespace(numpy=lambda: positions))
    for mesh in (
        (positions, triangles),
        [positions, triangles.astype(np.int64)],
        SimpleNamespace(vertices=positions, faces=triangles),
        SimpleNamespace(vertices=Vectors(positions), triangles=Vectors(triangles.astype(np.int32))),
        SimpleNamespace(V=positions, F=triangles),
        SimpleNamespace(vertices=tensor, faces=triangles),
        SimpleNamespace(points=positions, faces=counted(triangles)),
        SimpleNamespace(
            points=positions, cells=[SimpleNamespace(type="triangle", data=triangles)], cells_dict={"triangle": 0}
        ),
    ):
        same(as_mesh(mesh), pretzel)  # type: ignore[arg-type]
    hierarchy = foliations.Hierarchy(SimpleNamespace(vertices=positions, faces=triangles))
    assert np.array_equal(hierarchy.levels[0].triangles, triangles)


def test_polygons_become_fans() -> None:
    points = np.zeros((6, 3))
    quads = SimpleNamespace(points=points, faces=np.array([4, 0, 1, 2, 3, 4, 2, 3, 4, 5]))
    assert as_mesh(quads)[1].tolist() == [[0, 1, 2], [0, 2, 3], [2, 3, 4], [2, 4, 5]]
    mixed = SimpleNamespace(points=points, faces=np.array([3, 0, 1, 2, 5, 0, 2, 3, 4, 5]))
    assert as_mesh(mixed)[1].tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]


def test_what_is_no_mesh(torus: Mesh) -> None:
    with pytest.raises(TypeError, match="no mesh"):
        foliations.solve(3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="no mesh"):
        foliations.solve(torus[0])
    cells = SimpleNamespace(points=torus[0], cells=[SimpleNamespace(type="tetra", data=[[0, 1, 2, 3]])], cells_dict={})
    with pytest.raises(ValueError, match="tetra"):
        as_mesh(cells)  # type: ignore[arg-type]


def test_trimesh(pretzel: Mesh) -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(*pretzel, process=False)
    same(as_mesh(mesh), pretzel)
    assert foliations.solve(mesh).converged
    with pytest.raises(ValueError, match="to_mesh"):
        as_mesh(trimesh.Scene([mesh]))


def test_meshio(pretzel: Mesh) -> None:
    meshio = pytest.importorskip("meshio")
    mesh = meshio.Mesh(pretzel[0], [("vertex", [[0]]), ("triangle", pretzel[1].astype(int))])
    same(as_mesh(mesh), pretzel)
    assert foliations.solve(mesh).converged


def test_pyvista(pretzel: Mesh) -> None:
    pyvista = pytest.importorskip("pyvista")
    mesh = pyvista.PolyData(np.array(pretzel[0]), counted(pretzel[1]))
    same(as_mesh(mesh), pretzel)
    assert foliations.solve(mesh).converged
    with pytest.raises(ValueError, match="extract_surface"):
        as_mesh(mesh.cast_to_unstructured_grid())
    same(as_mesh(mesh.cast_to_unstructured_grid().extract_surface(algorithm="dataset_surface")), pretzel)


def test_open3d(pretzel: Mesh) -> None:
    open3d = pytest.importorskip("open3d")
    vectors = open3d.utility
    mesh = open3d.geometry.TriangleMesh(vectors.Vector3dVector(pretzel[0]), vectors.Vector3iVector(pretzel[1]))
    same(as_mesh(mesh), pretzel)


def test_igl(pretzel: Mesh, tmp_path: Path) -> None:
    igl = pytest.importorskip("igl")
    igl.write_triangle_mesh(str(tmp_path / "a.off"), *pretzel)
    assert foliations.solve(*igl.read_triangle_mesh(str(tmp_path / "a.off"))).converged


# --- Files -------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply"])
def test_written_and_read_exactly(pretzel: Mesh, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"mesh{suffix}"
    save(path, Drawing(*pretzel))
    same(read_mesh(path), pretzel)
    assert foliations.solve(str(path)).converged


def stl(corners: np.ndarray) -> bytes:
    rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows["corners"] = corners
    return b"solid but binary".ljust(80) + struct.pack("<I", len(rows)) + rows.tobytes()


def test_stl(pretzel: Mesh, tmp_path: Path) -> None:
    corners = pretzel[0].astype(np.float32)[pretzel[1]]
    binary, text = tmp_path / "binary.stl", tmp_path / "text.STL"
    binary.write_bytes(stl(corners))
    facets = []
    for triangle in corners.astype(float).tolist():
        facets += ["facet normal 0 0 0\nouter loop"]
        facets += ["vertex {} {} {}".format(*corner) for corner in triangle]
        facets += ["end loop\nend facet"]
    text.write_text("solid a\n" + "\n".join(facets) + "\nendsolid a\n")
    for path in (binary, text):
        positions, triangles = read_mesh(path)
        assert len(positions) == len(pretzel[0]), "equal points are joined"
        assert np.array_equal(positions[triangles], corners)
        assert triangles[0].tolist() == [0, 1, 2], "numbered by first appearance"
    binary.write_bytes(stl(corners)[:-1])
    with pytest.raises(ValueError, match="bytes"):
        read_mesh(binary)


def test_obj_as_programs_write_it(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text("# x\no a\nv 0 0 0 1\r\n v 1 0 0\nv\t1 1 0\nv 0 1 .5e0\nvt 0 0\nf 1/1 2/1/1 -2//3 4 # quad\n")
    positions, triangles = read_mesh(path)
    assert positions[3].tolist() == [0, 1, 0.5] and triangles.tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize("corners", [[[0, 1, 2], [0, 2, 3]], [[0, 1, 2, 3], [0, 1, 2]]])
def test_binary_ply(tmp_path: Path, order: str, corners: list[list[int]]) -> None:
    mark = "<" if order == "little" else ">"
    header = f"ply\nformat binary_{order}_endian 1.0\ncomment a\nelement vertex 4\nproperty float x\nproperty float y\n"
    header += "property float z\nproperty uchar red\nelement face 2\nproperty int label\n"
    header += "property list uchar int vertex_index\nend_header\n"
    data = b"".join(struct.pack(mark + "fffB", i, i / 2, 0, 7) for i in range(4))
    for face in corners:
        data += struct.pack(f"{mark}iB{len(face)}i", 9, len(face), *face)
    path = tmp_path / "a.ply"
    path.write_bytes(header.encode() + data)
    positions, triangles = read_mesh(path)
    assert positions[:, 1].tolist() == [0, 0.5, 1, 1.5]
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3]] + ([] if len(corners[0]) == 3 else [[0, 1, 2]])
    path.write_bytes(header.encode() + data[:-1])
    with pytest.raises(ValueError, match="is cut"):
        read_mesh(path)


PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
PLY += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.obj", "v 0 0 0\nv 1 0\n", "line 2: a vertex needs three coordinates"),
        ("a.obj", "v 0 0 0\nv 1 0 zero\n", "line 2"),
        ("a.obj", "v 0 0 0\nf 1 2\n", "line 2: face 0 has fewer than three corners"),
        ("a.obj", "v 0 0 0\nf 1 1 2\n", "line 2: face 0 names vertex 2, which does not exist; the file has 1"),
        ("a.obj", "v 0 0 0\nf 1 1 0\n", "line 2: a face names vertex 0"),
        ("a.obj", "v 0 0 0\nf 1 1 a\n", "line 2"),
        ("a.obj", "v 0 0 0\n", "no faces"),
        ("a.off", "COFFEE\n", "line 1"),
        ("a.off", "OFF\n1\n", "line 3: the file ends before the number of faces"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n# c\n1 0 0\n0 1\n", "line 6: vertex 2 needs three"),
        ("a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "line 5: face 0 has 2 of 3 corners"),
        ("a.off", "OFF 3 1 0\n0 0 0\n1 0 0\n", "line 4: the file ends after 2 of 3 vertices"),
        ("a.ply", "plx\n", "line 1"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex many\nend_header\n", "line 3"),
        ("a.ply", PLY + "0 0 0\n1 0 0\n0 1\n3 0 1 2\n", "line 12: vertex 2 has fewer numbers"),
        ("a.ply", PLY + "0 0 0\n1 0 0\n0 1 0\n3 0 1 x\n", "line 13"),
        ("a.ply", PLY + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "line 13: face 0 names vertex 7"),
        ("a.ply", PLY + "0 0 0\n1 0 0\n0 1 0\n", "ends after 0 of 1 rows of .face"),
        ("a.stl", "solid\nvertex 0 0\n", "line 2: .vertex. where facet"),
        ("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "ends in facet 0; it is cut"),
        ("a.stl", "", "the file is empty"),
    ],
)
def test_files_that_cannot_be_read(tmp_path: Path, name: str, text: str, message: str) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(ValueError, match=message) as caught:
        read_mesh(path)
    assert str(path) in str(caught.value)


def test_broken_bytes_never_surprise(pretzel: Mesh, tmp_path: Path) -> None:
    """Whatever is in a file: a mesh or a ValueError."""
    generator = np.random.default_rng(0)
    for suffix in (".obj", ".off", ".ply", ".stl", ".glb"):
        path = tmp_path / f"a{suffix}"
        if suffix == ".stl":
            path.write_bytes(stl(pretzel[0][pretzel[1][:20]]))
        else:
            save(path, Drawing(pretzel[0][:20], np.arange(18).reshape(6, 3)))
        data = path.read_bytes()
        for _ in range(150):
            broken = np.frombuffer(data, np.uint8).copy()
            places = generator.integers(0, len(broken), 3)
            broken[places] = generator.integers(0, 256, 3)
            path.write_bytes(broken.tobytes()[: generator.integers(0, 2 * len(broken))])
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", foliations.MeshWarning)
                with suppress(ValueError):
                    read_mesh(path)


def test_other_formats(pretzel: Mesh, tmp_path: Path) -> None:
    """What other packages read, packed or not; without them the sentence of the library, and what to install."""
    trimesh, meshio = pytest.importorskip("trimesh"), pytest.importorskip("meshio")
    trimesh.Trimesh(*pretzel, process=False).export(tmp_path / "a.glb")
    other = meshio.Mesh(pretzel[0], [("triangle", pretzel[1].astype(int))])
    other.write(tmp_path / "a.vtk", binary=False)
    elsewhere = ["b.vtk", "b.msh", "b.vtu"]
    meshio.write(tmp_path / "b.vtk", other, file_format="vtk", binary=True)
    meshio.write(tmp_path / "b.msh", other, file_format="gmsh", binary=True)
    meshio.write(tmp_path / "b.vtu", other)
    with suppress(ImportError, ValueError):  # needs lxml and networkx
        trimesh.Trimesh(*pretzel, process=False).export(tmp_path / "b.3mf")
        elsewhere.append("b.3mf")
    for name in ("a.glb", "a.vtk", *elsewhere):
        packed = tmp_path / f"{name}.GZ"
        packed.write_bytes(gzip.compress((tmp_path / name).read_bytes(), 1))
        for path in (tmp_path / name, packed):
            same(read_mesh(path), pretzel, 1e-6)
    with pytest.MonkeyPatch.context() as patch:
        for package in ("trimesh", "meshio"):
            patch.setitem(sys.modules, package, None)
        for name in elsewhere:
            with pytest.raises(ValueError, match="is not installed.* pip install .*(meshio|trimesh)") as caught:
                read_mesh(tmp_path / name)
            assert ("Python package" in str(caught.value)) == (name in ("b.vtk", "b.msh"))
    (tmp_path / "b.vtu.gz").write_bytes(packed.read_bytes()[:100])
    with pytest.raises(ValueError, match="b.vtu.gz: gzip cannot unpack it"):
        read_mesh(tmp_path / "b.vtu.gz")
    (tmp_path / "a.xyz3").write_text("nothing")
    with pytest.raises(ValueError, match=r"none of .obj, .off, .ply, .stl"):
        read_mesh(tmp_path / "a.xyz3")


def test_vtp(torus: Mesh, tmp_path: Path) -> None:
    pytest.importorskip("pyvista", reason="meshio and trimesh read no VTP")

    def array(values: np.ndarray, kind: str, name: str, width: int = 1) -> str:
        text = " ".join(map(repr, values.ravel().tolist()))
        return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" format="ascii">{text}</DataArray>'

    points, triangles = torus
    counts = f'NumberOfPoints="{len(points)}" NumberOfPolys="{len(triangles)}"'
    ends = 3 * np.arange(1, len(triangles) + 1)
    polygons = array(triangles, "Int64", "connectivity") + array(ends, "Int64", "offsets")
    text = f"<Points>{array(points, 'Float64', 'Points', 3)}</Points><Polys>{polygons}</Polys>"
    text = f'<VTKFile type="PolyData" version="0.1"><PolyData><Piece {counts}>{text}</Piece></PolyData></VTKFile>'
    (tmp_path / "a.vtp").write_text(text)
    (tmp_path / "a.vtp.gz").write_bytes(gzip.compress(text.encode()))
    save(tmp_path / "own.vtp", Drawing(points, triangles))
    for name in ("a.vtp", "a.vtp.gz", "own.vtp"):
        same(read_mesh(tmp_path / name), torus)


def test_no_such_file() -> None:
    for name in ("no_such.obj", "no_such.vtk"):
        with pytest.raises(FileNotFoundError):
            foliations.solve(name)
