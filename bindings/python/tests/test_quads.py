"""The quad mesh: closed, oriented, irregular only at the zeros."""

from __future__ import annotations

import foliations
import numpy as np
import pytest


@pytest.fixture(scope="module")
def foliation(hierarchy: foliations.Hierarchy) -> foliations.Foliation:
    return hierarchy.solve()


def test_closed_and_regular_but_at_the_zeros(foliation: foliations.Foliation) -> None:
    mesh = foliation.quads()
    zeros = foliation.singularities().zeros
    # Each directed side meets its opposite once.
    sides = np.stack([mesh.quads, np.roll(mesh.quads, -1, axis=1)], axis=2).reshape(-1, 2).astype(np.int64)
    size = len(mesh.positions)
    keys, opposite = sides[:, 0] * size + sides[:, 1], sides[:, 1] * size + sides[:, 0]
    assert len(np.unique(keys)) == len(keys) and np.array_equal(np.sort(keys), np.sort(opposite))
    assert size - len(keys) // 2 + len(mesh.quads) == 2 - 2 * foliation.hierarchy.genus
    degree = np.bincount(sides[:, 0], minlength=size)
    assert degree[: len(zeros)].tolist() == [4 - 2 * zero.index for zero in zeros]
    assert (degree[len(zeros) :] == 4).all()


def test_the_zeros_come_first(foliation: foliations.Foliation) -> None:
    level = foliation.hierarchy.levels[0]
    mesh = foliation.quads()
    for place, zero in zip(mesh.positions, foliation.singularities().zeros):
        if zero.kind == "vertex":
            assert np.allclose(place, level.positions[zero.element])


def test_edge_length(foliation: foliations.Foliation) -> None:
    coarse, fine = foliation.quads(edge_length=0.3), foliation.quads(edge_length=0.1)
    assert 4 < len(fine.quads) / len(coarse.quads) < 16
    with pytest.raises(ValueError):
        foliation.quads(edge_length=-1.0)
    with pytest.raises(ValueError, match="read-only"):
        coarse.quads[0] = 0
