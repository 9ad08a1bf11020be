"""Cylinders: one for each loop, of its weight in height."""

from __future__ import annotations

import foliations
import numpy as np
import pytest


def test_heights_areas_and_loops(hierarchy: foliations.Hierarchy) -> None:
    loops = hierarchy.loops().with_weights([1.0, 2.5])
    foliation = hierarchy.solve(loops)
    found = foliation.cylinders(loops)
    assert len(found) == len(list(found)) == 2
    for cylinder in found:
        assert cylinder.loop is not None
        assert cylinder.height == loops.weights[cylinder.loop]
        assert cylinder.modulus == pytest.approx(cylinder.height / cylinder.circumference)
        assert cylinder.area == pytest.approx(cylinder.height * cylinder.circumference)
    assert sorted(cylinder.loop or 0 for cylinder in found) == [0, 1]
    assert sum(cylinder.area for cylinder in found) == pytest.approx(foliation.energy, rel=1e-6)
    assert found.twists.shape == (2,) and found.corner_offsets.shape == (5,)
    assert len(found.corner_vertices) == len(found.corner_places) == found.corner_offsets[-1]
    assert (found.corner_places[found.corner_offsets[[0, 2]]] == 0).all()
    assert (found.corner_places[found.corner_offsets[[1, 3]]] == found.twists).all()


def test_middle_leaves_give_the_class(hierarchy: foliations.Hierarchy) -> None:
    foliation = hierarchy.solve(weights=[1.0, 2.5])
    found = foliation.cylinders()
    assert [(c.loop, c.height) for c in sorted(found, key=lambda c: c.height)] == [(0, 1.0), (1, 2.5)]
    again = hierarchy.foliation(foliation.values)
    assert again.loops is None and [c.loop for c in again.cylinders()] == [None, None]
    assert found.leaves.level == 0 and len(found.leaves) == 2
    again = hierarchy.solve(found.leaves)
    assert np.abs(again.values - foliation.values).max() < 1e-5


def test_errors(hierarchy: foliations.Hierarchy) -> None:
    foliation = hierarchy.solve()
    with pytest.raises(foliations.FoliationError) as caught:
        foliation.cylinders(hierarchy.loops().with_weights([1, 3]))
    assert caught.value.status is foliations.Status.ERROR_VALUE_CLASS
    with pytest.raises(foliations.FoliationError) as caught:
        hierarchy.initialize(hierarchy.loops(level=0)).cylinders()
    assert caught.value.status is foliations.Status.ERROR_VALUE_NOT_HARMONIC
