"""Marked vertices, and the class of a result."""

from __future__ import annotations

import pickle
from pathlib import Path

import foliations
import numpy as np
import pytest
from foliations import sample, solve_row

from conftest import Mesh


@pytest.fixture(scope="module")
def sphere() -> Mesh:
    """Genus 0, 302 vertices: rings of vertices between two poles, flattened."""
    rings, around = 15, 20
    angle, height = np.meshgrid(2 * np.pi * np.arange(around) / around, np.pi * np.arange(1, rings + 1) / (rings + 1))
    points = np.stack([np.sin(height) * np.cos(angle), 0.6 * np.sin(height) * np.sin(angle), np.cos(height)], axis=2)
    positions = np.vstack([points.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    here = np.arange(rings * around).reshape(rings, around)
    beside = np.roll(here, -1, axis=1)
    sides = [(here[:-1], here[1:], beside[1:]), (here[:-1], beside[1:], beside[:-1])]
    triangles = [np.stack(corners, axis=2).reshape(-1, 3) for corners in sides]
    top, bottom = np.full(around, len(positions) - 2), np.full(around, len(positions) - 1)
    triangles += [np.stack([top, here[0], beside[0]], axis=1), np.stack([bottom, beside[-1], here[-1]], axis=1)]
    return positions, np.concatenate(triangles).astype(np.uint32)


def test_a_sphere_with_suggested_marks(sphere: Mesh, tmp_path: Path) -> None:
    marks = foliations.suggest_marks(*sphere)
    assert marks.dtype == np.uint32 and 4 <= len(marks) <= 24 and len(set(marks.tolist())) == len(marks)
    assert np.array_equal(marks, foliations.suggest_marks(sphere, mollify=0.0))
    foliation = foliations.solve(*sphere, marked_vertices=marks)
    report = foliation.report
    assert report is not None and foliation.converged and foliation.hierarchy.genus == 0
    assert report.class_state == "proven" and 0 <= report.class_seconds <= report.solve_seconds
    assert "class proven" in str(report)
    found = foliation.singularities()
    assert found.index_sum == report.index_sum == 4 - len(marks) and not found.poles
    assert len(found.zeros) + len(found.marks) == len(found)
    assert {mark.element for mark in found.marks} <= set(marks.tolist())
    for suffix in ("obj", "ply", "vtp", "glb"):
        found.export(tmp_path / f"marks.{suffix}")
    assert np.array_equal(pickle.loads(pickle.dumps(foliation)), foliation)


def test_marks_are_any_sequence(sphere: Mesh) -> None:
    marks = foliations.suggest_marks(*sphere)
    expected = foliations.solve(*sphere, marked_vertices=marks).values
    for given in (marks.tolist(), tuple(marks.tolist()), marks.astype(np.int64)):
        assert np.array_equal(foliations.solve(*sphere, marked_vertices=given).values, expected)
    for wrong in ((), marks[:3]):
        with pytest.raises(foliations.MeshError) as caught:
            foliations.Hierarchy(*sphere, marked_vertices=wrong)
        assert caught.value.status is foliations.Status.ERROR_MESH_GENUS
    with pytest.raises(TypeError, match="marked_vertices"):
        foliations.Hierarchy(*sphere, marked_vertices=[0.5])  # type: ignore[list-item]
    with pytest.raises(foliations.Error):
        foliations.Hierarchy(*sphere, marked_vertices=[0, 1, 2, 10**6])


def test_a_torus_is_proven() -> None:
    torus = sample.pretzel(1, side=4)
    assert len(foliations.suggest_marks(*torus)) == 0
    foliation = foliations.solve(*torus)
    assert foliation.report is not None and foliation.report.class_state == "proven"
    assert not foliation.singularities().marks
    assert foliation.relax().report.class_state == "proven"  # type: ignore[union-attr]


def test_rows(sphere: Mesh) -> None:
    row = {"mesh": sphere, "marked_vertices": foliations.suggest_marks(*sphere).tolist()}
    result = solve_row(row)
    assert result["ok"] and result["class"] == "proven" and result["genus"] == 0 and "marked_vertices" not in result
    assert solve_row({"mesh": sphere})["energy"] == result["energy"]
    failed = solve_row({"mesh": sphere, "marked_vertices": []})
    assert failed["error"] == "MeshError" and failed["class"] == ""


def test_the_limit_of_the_class_is_no_error() -> None:
    from foliations.foliation import STOPPED

    assert foliations.Status.LIMIT_CLASS in STOPPED and foliations.Status.LIMIT_CLASS.text


def test_even_design(sphere: Mesh) -> None:
    design = foliations.even_design(*sphere)
    assert len(design.marked_vertices) >= 4 and design.unevenness > 0 and design.solves > 0
    even = foliations.solve(*sphere, loops="even")
    assert abs(even.unevenness - design.unevenness) < 0.25 * design.unevenness
    own = foliations.Hierarchy(*sphere, marked_vertices=design.marked_vertices).solve(design.loops)
    assert np.array_equal(own.values, even.values)
    assert even.conformal_scale().shape == (len(sphere[1]),)
    kept = foliations.even_design(*sphere, marked_vertices=[3], solve_limit=10)
    assert 3 in kept.marked_vertices
    with pytest.raises(ValueError, match="even"):
        foliations.solve(*sphere, loops="trousers")  # type: ignore[arg-type]
