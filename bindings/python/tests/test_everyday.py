"""What a first user meets: files, holes, names of choices, zero, sentences, summaries."""

from __future__ import annotations

import inspect
import json
import re
import warnings
from pathlib import Path
from typing import Any

import foliations
import numpy as np
import pytest
from conftest import Mesh
from foliations import solve_row
from foliations.errors import _WORDS, in_words
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[3]


def without(mesh: Mesh, *gone: int) -> Mesh:
    return mesh[0], np.delete(mesh[1], gone, axis=0)


def ball(n: int = 8) -> Mesh:
    """The surface of a cube of n^3 cubes as a round sphere."""
    points: dict[tuple[int, ...], int] = {}
    triangles = []
    for axis in range(3):
        for side in (0, n):
            for i in range(n):
                for j in range(n):
                    square = []
                    for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                        p = [0, 0, 0]
                        p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, a, b
                        square.append(points.setdefault(tuple(p), len(points)))
                    square = square if side else square[::-1]
                    triangles += [[square[0], square[1], square[2]], [square[0], square[2], square[3]]]
    x = np.array(list(points), float) - n / 2
    return x / np.linalg.norm(x, axis=1)[:, None], np.array(triangles, np.uint32)


# --- Choices by name ---------------------------------------------------------


@pytest.mark.parametrize("kind", ["cut", "handle", "tunnel", "pants", "even"])
def test_loops_by_name_everywhere(pretzel: Mesh, kind: str) -> None:
    foliation = foliations.solve(*pretzel, loops=kind)  # type: ignore[arg-type]
    hierarchy = foliation.hierarchy
    assert hierarchy.solve(kind).converged  # type: ignore[arg-type]
    assert foliations.solve_components(*pretzel, loops=kind)[0].status == foliations.Status.OK  # type: ignore[arg-type]
    row = solve_row({"mesh": pretzel, "loops": kind})
    assert row["ok"] and row["energy"] == pytest.approx(foliation.energy, rel=1e-6), row["message"]
    loops = foliation.loops
    assert loops is not None and loops.level == 0
    found = foliation.cylinders()
    assert sorted(c.loop for c in found) == list(range(len(loops)))
    assert [c.height for c in sorted(found, key=lambda c: c.loop or 0)] == loops.weights.tolist()
    again = hierarchy.solve(loops)
    assert again.energy == pytest.approx(foliation.energy, rel=1e-7)


def test_names_that_do_not_exist(pretzel: Mesh) -> None:
    for call in (
        lambda: foliations.solve(*pretzel, loops="trousers"),  # type: ignore[arg-type]
        lambda: foliations.solve_components(*pretzel, loops="trousers"),  # type: ignore[arg-type]
    ):
        with pytest.raises(ValueError, match="cut, handle, pants, tunnel; got 'trousers'"):
            call()
    assert "trousers" in solve_row({"mesh": pretzel, "loops": "trousers"})["message"]
    with pytest.raises(ValueError, match="suggest"):
        foliations.Hierarchy(*pretzel, marked_vertices="guess")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="no option wieghts; did you mean weights"):
        solve_row({"mesh": pretzel, "wieghts": [1, 2]})


def test_spheres_and_disks_by_default() -> None:
    sphere = ball()
    whole = without(sphere, *range(40))
    kept, numbers = np.unique(whole[1], return_inverse=True)
    disk = whole[0][kept], numbers.reshape(-1, 3).astype(np.uint32)
    for mesh in (sphere, disk):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            foliation = foliations.solve(*mesh)
        assert foliation.converged and len(foliation.hierarchy.marked_vertices) >= 2
        assert solve_row({"mesh": mesh})["energy"] == foliation.energy
        assert foliations.solve(*mesh, marked_vertices="suggest").energy == foliation.energy
        for kind in ("cut", "pants", "even"):
            assert foliation.hierarchy.solve(kind).converged  # type: ignore[arg-type]
        assert foliations.solve_components(*mesh)[0].foliation is not None
        with pytest.raises(foliations.MeshError, match="genus 0|marked"):
            foliations.solve(*mesh, marked_vertices=[])


# --- Holes -------------------------------------------------------------------


def test_a_hole_is_never_silent(pretzel: Mesh) -> None:
    closed = foliations.solve(*pretzel)
    assert "boundar" not in repr(closed) + repr(closed.hierarchy) + str(closed.report)
    with pytest.warns(
        foliations.MeshWarning, match="1 boundary looks like a hole by accident, the smallest with 3 edges"
    ):
        foliation = foliations.solve(*without(pretzel, 100))
    assert foliation.report is not None and foliation.report.boundaries == 1
    for text in (repr(foliation), repr(foliation.hierarchy), str(foliation.report)):
        assert "1 boundary" in text
    curve = foliation.hierarchy.boundaries
    assert [sorted(c.tolist()) for c in curve] == [sorted(pretzel[1][100].tolist())]
    with pytest.raises(foliations.MeshError, match="1 boundary, the first with 3 edges") as caught:
        foliations.solve(*without(pretzel, 100), closed=True)
    assert caught.value.status == foliations.Status.ERROR_MESH_BOUNDARY
    repaired = foliations.repair(*without(pretzel, 100), fill_holes=3)
    assert repaired.notes == ("filled 1 hole",) and repaired.faces[-1] == 2**32 - 1
    again = foliations.solve(repaired.positions, repaired.triangles, closed=True)
    assert again.energy == pytest.approx(closed.energy, rel=1e-9)
    assert foliations.solve(*pretzel, closed=True).energy == closed.energy


def test_counts_agree(pretzel: Mesh) -> None:
    """The zeros of a surface with boundary are those of the surface."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", foliations.MeshWarning)
        foliation = foliations.solve(*without(pretzel, 100))
    report, zeros = foliation.report, foliation.singularities()
    assert report is not None and report.zeros == -sum(zero.index for zero in zeros.zeros)
    assert report.index_sum == zeros.index_sum


# --- Files and repairs -------------------------------------------------------


def test_unused_vertices_are_dropped(pretzel: Mesh) -> None:
    points = np.vstack([[[9.0, 9, 9]], pretzel[0], [[8.0, 8, 8]]])
    with pytest.warns(foliations.MeshWarning, match="dropped 2 vertices"):
        foliation = foliations.solve(points, pretzel[1] + 1)
    assert foliation.energy == foliations.solve(*pretzel).energy
    assert foliation.hierarchy.kept_vertices is not None
    assert foliation.hierarchy.kept_vertices.tolist() == list(range(1, len(pretzel[0]) + 1))


def test_points_in_reach_are_joined(torus: Mesh) -> None:
    rng = np.random.default_rng(1)
    soup = torus[0][torus[1]].reshape(-1, 3)
    soup = soup + rng.uniform(-1e-7, 1e-7, soup.shape)
    triangles = np.arange(len(soup)).reshape(-1, 3)
    repaired = foliations.repair(soup, triangles, join_points=1e-6)
    assert len(repaired.positions) == len(torus[0]) and "joined" in repr(repaired)
    assert np.array_equal(repaired.triangles, torus[1]) or len(repaired.triangles) == len(torus[1])
    assert foliations.solve(repaired.positions, repaired.triangles, closed=True).hierarchy.genus == 1
    exact = torus[0][torus[1]].reshape(-1, 3)
    assert len(foliations.repair(exact, triangles, join_points=True).positions) == len(torus[0])
    assert len(foliations.repair(exact, triangles).positions) == len(exact)
    with pytest.raises(ValueError, match=r"join_points=-1 is not in \[0, inf\)"):
        foliations.repair(exact, triangles, join_points=-1)


def test_files_of_other_programs(tmp_path: Path) -> None:
    """Polygons as the tool reads them, and a note of what was skipped."""
    path = tmp_path / "a.obj"
    outline = [(4, 0), (4, 1), (1, 1), (1, 4), (0, 4), (0, 0)]
    rows = [f"v {x} {y} {z}" for z in (0, 2) for x, y in outline]
    rows += ["f 6 5 4 3 2 1", "f 7 8 9 10 11 12"] + [
        f"f {i + 1} {(i + 1) % 6 + 1} {(i + 1) % 6 + 7} {i + 7}" for i in range(6)
    ]
    path.write_text("\n".join(["$ by hand", *rows]))
    with pytest.warns(foliations.MeshWarning, match="skipped 1 line that is no statement of OBJ"):
        points, triangles = foliations.read_mesh(path)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == 46


# --- Zero is zero ------------------------------------------------------------


def test_zero_is_zero(pretzel: Mesh) -> None:
    hierarchy = foliations.Hierarchy(*pretzel)
    with pytest.warns(foliations.LimitWarning, match="time"):
        assert hierarchy.solve(time_limit=0).status == foliations.Status.LIMIT_TIME
    foliation = hierarchy.solve(time_limit=None, tolerance=None)
    refused = {
        hierarchy.solve: ("tolerance", "energy_tolerance", "iteration_limit", "step_limit"),
        foliation.quads: ("count", "edge_length"),
        foliation.trace: ("spacing", "length_limit"),
        foliation.relax: ("tolerance",),
        foliation.atlas: ("margin",),
        foliation.parameterize: ("tolerance",),
    }
    for function, names in refused.items():
        for name in names:
            with pytest.raises(
                foliations.OptionsError, match=f"^{name}=0 is not in .*None, or leaving it out, is the default"
            ):
                function(**{name: 0})
    for name in ("ratio", "coarsest", "memory_limit"):
        with pytest.raises(foliations.OptionsError, match=f"{name}=0 is not in"):
            foliations.Hierarchy(*pretzel, **{name: 0})  # type: ignore[arg-type]
    assert foliations.Hierarchy(*pretzel, mollify=0).genus == 2
    with pytest.raises(foliations.OptionsError, match=re.escape("ratio=2 is not in [0.05, 0.95]")):
        foliations.solve(*pretzel, ratio=2)
    with pytest.raises(foliations.OptionsError, match=re.escape("mollify=0.2 is not in [0, 0.1]")):
        foliations.solve(*pretzel, mollify=0.2)


# --- Sentences ---------------------------------------------------------------


def messages() -> set[str]:
    """What the library can say: the literals of each call that fails, whole, as sentences may hold a semicolon."""
    if not (ROOT / "src").exists():
        pytest.skip("the sources of the library are not here")
    found = set()
    for path in (ROOT / "src").rglob("*.[ch]pp"):
        calls = re.finditer(r"\bfail\((?:[^;\"]|\"(?:[^\"\\]|\\.)*\")*", path.read_text(encoding="utf-8"))
        found |= {"".join(re.findall(r"\"((?:[^\"\\]|\\.)*)\"", call[0])) for call in calls}
    return found - {""}


def test_every_error_is_in_words_of_python() -> None:
    found = messages()
    assert len(found) > 100
    for message in sorted(found):
        said = in_words(message, int(foliations.Status.ERROR_OPTIONS))
        assert len(said) > 15, (message, said)
        for word in ("hmf_", "HMF_", "NULL", "struct_size", "sizeof", "->", "build options", "position_stride", "optimis"):
            assert word not in said, (message, said)
    # A sentence that the library no longer says has no place in the table.
    assert [words for words, _ in _WORDS if not any(words in message for message in found)] == []


# --- Summaries ---------------------------------------------------------------


def test_results_print_a_summary(pretzel: Mesh) -> None:
    foliation = foliations.solve(*pretzel)
    results = [
        foliation, foliation.hierarchy, foliation.report, foliation.quads(), foliation.parameterize(),
        foliation.cylinders(),
        foliation.singularities(), foliation.trace(), foliation.atlas(), foliation.loops, foliations.repair(*pretzel),
        foliations.even_design(*pretzel), foliations.solve_components(*pretzel), foliations.Components(*pretzel),
    ]  # fmt: skip
    for result in results:
        assert len(repr(result)) < 200 and "array(" not in repr(result), type(result)
    mesh = foliation.quads()
    assert len(mesh) == len(mesh.quads) and f"{len(mesh)} quads" in repr(mesh)
    for result in results:
        assert inspect.getdoc(type(result)), type(result)


# --- Shells, repairs, places far away -----------------------------------------


def test_one_of_several_components(pretzel: Mesh, torus: Mesh) -> None:
    points = np.vstack([torus[0] + 100, pretzel[0], [[9.0, 9, 9]]])
    corners = np.vstack([torus[1], pretzel[1] + len(torus[0])])
    with pytest.raises(foliations.MeshError, match='Use solve_components, or Hierarchy.*component="largest"'):
        foliations.Hierarchy(points, corners)
    largest = foliations.solve(points, corners, component="largest")
    kept = largest.hierarchy.kept_vertices
    assert kept is not None and np.array_equal(points[kept], pretzel[0])
    assert np.array_equal(largest.values, foliations.solve(*pretzel).values)
    assert foliations.Hierarchy(points, corners, component=0).genus == 1
    assert foliations.Hierarchy(*pretzel, component="largest").kept_vertices is None
    for wrong in (2, "smallest"):
        with pytest.raises(ValueError, match="component is"):
            foliations.Hierarchy(points, corners, component=wrong)  # type: ignore[arg-type]


def test_repaired_meshes_are_meshes(torus: Mesh) -> None:
    turned = torus[1].copy()
    turned[5] = turned[5][::-1]
    with pytest.raises(foliations.MeshError, match=r"repair\(mesh\) turns patches to one sense"):
        foliations.Hierarchy(torus[0], turned)
    assert foliations.Hierarchy(foliations.repair(torus[0], turned)).genus == 1


def test_unused_vertices_are_dropped_from_designs_and_marks() -> None:
    points = np.array([[9.0, 9, 9], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 3], [0, 0, -3]])
    corners = np.array([[1, 3, 5], [3, 2, 5], [2, 4, 5], [4, 1, 5], [3, 1, 6], [2, 3, 6], [4, 2, 6], [1, 4, 6]])
    marks, used = foliations.suggest_marks(points, corners), foliations.suggest_marks(points[1:], corners - 1)
    assert np.array_equal(marks, used + 1)
    with pytest.warns(foliations.MeshWarning, match="dropped 1 vertex"):
        even = foliations.solve(points, corners, loops="even")
    assert np.array_equal(even.values, foliations.solve(points[1:], corners - 1, loops="even").values)


def test_glb_far_from_the_origin(torus: Mesh, tmp_path: Path) -> None:
    def read(path: Path) -> tuple[NDArray[Any], NDArray[Any]]:
        data = path.read_bytes()
        size = int.from_bytes(data[12:16], "little")
        document = json.loads(data[20 : 20 + size])
        accessor = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
        part = document["bufferViews"][accessor["bufferView"]]
        begin = 28 + size + part.get("byteOffset", 0)
        points = np.frombuffer(data, np.float32, 3 * accessor["count"], begin).reshape(-1, 3)
        return points.astype(float), np.array(document["nodes"][0].get("translation", [0, 0, 0]))

    far = torus[0] + [4e6, 0, -7e6]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        foliations.solve(far, torus[1]).export(tmp_path / "far.glb")
        foliations.solve(*torus).export(tmp_path / "near.glb")
    points, translation = read(tmp_path / "far.glb")
    distances = np.linalg.norm((points + translation)[:, None] - far[None], axis=2).min(axis=1)
    assert distances.max() < 1e-6 * np.ptp(torus[0])
    assert not read(tmp_path / "near.glb")[1].any()
    # Two vertices so near to each other that single precision has one place for them.
    close = torus[0].copy()
    a, b = torus[1][0][:2]
    close[b] = close[a] + 1e-12 * (close[b] - close[a])
    with pytest.warns(foliations.MeshWarning, match="1 edge is too short for the single precision of GLB"):
        foliations.solve(close, torus[1]).export(tmp_path / "close.glb")


# --- Picked points, previews ---------------------------------------------------


def test_points_far_from_the_surface_are_refused(pretzel: Mesh) -> None:
    hierarchy = foliations.Hierarchy(*pretzel)
    picked = pretzel[0][pretzel[1][[0, 1000, 2000]]].mean(axis=1)  # in the middle of triangles
    size = float(np.linalg.norm(np.ptp(pretzel[0], axis=0)))
    foliations.Loops.through(hierarchy, picked, within=1e-9 * size)
    raised = picked + [0, 0, 0.04 * size]
    foliations.Loops.through(hierarchy, raised)
    with pytest.raises(ValueError, match=r"point 0, .* from the surface, more than within=.*unit and axes"):
        foliations.Loops.through(hierarchy, 1000 * picked)
    with pytest.raises(ValueError, match="from the surface"):
        foliations.Loops.through(hierarchy, raised, within=1e-9 * size)


def test_a_preview_is_one_call(pretzel: Mesh) -> None:
    hierarchy = foliations.Hierarchy(*pretzel)
    preview = hierarchy.solve(stop_level=-1)
    assert preview.level == len(hierarchy.levels) - 1 > 0 and preview.converged
    assert np.array_equal(preview.values, hierarchy.solve(stop_level=preview.level).values)
    with pytest.raises((ValueError, foliations.LevelError)):
        hierarchy.solve(stop_level=-len(hierarchy.levels) - 1)


# --- Arcs ----------------------------------------------------------------------


def test_arcs_of_the_library_have_places_and_are_drawn() -> None:
    points, triangles = ball()
    cap = foliations.repair(points, triangles[points[triangles].mean(axis=1)[:, 2] > 0])
    hierarchy = foliations.Hierarchy(cap)
    loops = hierarchy.loops("cut")
    assert hierarchy.boundary_count == 1 and loops.arcs.any()
    rim = np.concatenate(hierarchy.boundaries)
    edges = [(rim[i - 1], rim[i]) for i in range(len(rim))]
    middles = np.array([hierarchy.levels[0].positions[list(edge)].mean(axis=0) for edge in edges])
    for curve, arc, loop in zip(loops.positions(hierarchy), loops.arcs, loops):
        assert len(curve) == len(loop) + bool(arc)
        for end in curve[[0, -1]] if arc else []:
            assert np.abs(middles - end).sum(axis=1).min() < 1e-12
    pytest.importorskip("matplotlib").use("Agg")
    assert foliations.plot(hierarchy.solve(loops), loops=loops).figure is not None
