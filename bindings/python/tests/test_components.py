"""Meshes of several components."""

from __future__ import annotations

import foliations
import numpy as np
import pytest
from foliations import Status, sample

from conftest import Mesh

OCTAHEDRON = (
    np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float),
    np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]),
)


@pytest.fixture(scope="module")
def parts() -> list[Mesh]:
    return [sample.pretzel(2), (OCTAHEDRON[0], OCTAHEDRON[1].astype(np.uint32)), sample.pretzel(1)]


@pytest.fixture(scope="module")
def whole(parts: list[Mesh]) -> Mesh:
    first = np.cumsum([0] + [len(positions) for positions, _ in parts])
    triangles = np.concatenate([corners + begin for (_, corners), begin in zip(parts, first)])
    return np.vstack([positions for positions, _ in parts]), triangles.astype(np.uint32)


def test_components(parts: list[Mesh], whole: Mesh) -> None:
    components = foliations.Components(*whole)
    assert [c.status for c in components] == [Status.OK, Status.ERROR_MESH_GENUS, Status.OK]
    assert [c.genus for c in components] == [2, 0, 1]
    for (positions, triangles), c in zip(parts, components):
        assert np.array_equal(c.positions, positions) and np.array_equal(c.triangles, triangles)
        assert np.array_equal(whole[0][c.whole_vertices], positions)
        assert np.array_equal(whole[1][c.whole_triangles], c.whole_vertices[c.triangles])
    assert np.array_equal(np.unique(np.concatenate([c.whole_edges for c in components])), range(components.edge_count))
    assert len(components[1:]) == 2 and "3" in repr(components)
    assert components[1].status.text in repr(components[1])


def test_a_defect_is_the_status_of_its_component(whole: Mesh) -> None:
    triangles = whole[1].copy()
    triangles[-1] = triangles[-1, ::-1]
    last = foliations.Components(whole[0], triangles)[-1]
    assert last.status == Status.ERROR_MESH_ORIENTATION and last.index is not None
    assert last.index in last.whole_triangles
    with pytest.raises(foliations.MeshError, match="Indices start at 0"):
        foliations.Components(whole[0][:-1], triangles)


def test_all_are_solved_in_one_call(parts: list[Mesh], whole: Mesh) -> None:
    fractions: list[float] = []
    solved = foliations.solve_components(*whole, marked_vertices=[], progress=fractions.append)
    assert fractions == sorted(fractions) and fractions[-1] > 0.99
    assert [row.status for row in solved] == [Status.OK, Status.ERROR_MESH_GENUS, Status.OK]
    assert solved[1].foliation is None and solved[1].message and solved[1].row["class"] == "none"
    for k in (0, 2):
        alone = foliations.solve(*parts[k])
        assert np.array_equal(solved.values[solved[k].component.whole_edges], alone.values)
        assert (
            solved[k].row["ok"] and solved[k].row["energy"] == alone.energy and solved[k].row["genus"] == (2, 0, 1)[k]
        )
    assert not solved.values[solved[1].component.whole_edges].any()
    assert solved.energy == pytest.approx(sum(row.row["energy"] for row in (solved[0], solved[2])))
    assert "2 of 3" in repr(solved)


def test_marks_are_suggested(whole: Mesh) -> None:
    marks = foliations.suggest_marks(whole)
    assert len(marks) == 4 and set(marks.tolist()) <= set(foliations.Components(*whole)[1].whole_vertices.tolist())
    for chosen in ("suggest", None):
        solved = foliations.solve_components(whole, marked_vertices=chosen)  # type: ignore[arg-type]
        assert all(row.status == Status.OK for row in solved)
    with pytest.raises(ValueError, match="suggest"):
        foliations.solve_components(whole, marked_vertices="guess")  # type: ignore[arg-type]


def test_own_loops(parts: list[Mesh], whole: Mesh) -> None:
    loops = foliations.Hierarchy(*parts[2]).loops(level=0)
    components = foliations.Components(*whole)
    shifted = foliations.Loops([components[2].whole_triangles[path] for path in loops], kind="triangles", weights=[3])
    assert [len(own) for own in components.split(shifted)] == [0, 0, 1]
    solved = components.solve(shifted)
    assert solved[0].status == Status.ERROR_LOOP_COUNT and not solved.values[components[0].whole_edges].any()
    alone = foliations.solve(*parts[2], loops, [3])
    assert np.array_equal(solved.values[components[2].whole_edges], alone.values)
    with pytest.raises(ValueError, match="one component"):
        components.split([[0, len(parts[0][0])]])
    with pytest.raises(ValueError, match="does not have"):
        components.split([[len(whole[0])]])


def test_kinds_of_loops(whole: Mesh) -> None:
    solved = foliations.solve_components(whole, loops="pants", method="newton", coarsest=500)
    assert solved[0].foliation is not None and solved[0].foliation.report is not None
    assert solved[0].row["class"] == "proven"
    with pytest.raises(ValueError, match="stop_level"):
        foliations.solve_components(whole, stop_level=1)
    with pytest.raises(foliations.OptionsError):
        foliations.solve_components(whole, ratio=3.0)
