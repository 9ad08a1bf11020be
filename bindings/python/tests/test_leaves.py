"""Leaves cross each edge where the values say so."""

from __future__ import annotations

import foliations
import numpy as np
import pytest


@pytest.fixture(scope="module")
def foliation(hierarchy: foliations.Hierarchy) -> foliations.Foliation:
    return hierarchy.solve()


def test_levels_are_closed_and_cross_edges_as_often_as_the_values_say(foliation: foliations.Foliation) -> None:
    """In a unit of one spacing the crossings of an edge are its value, to one at either end."""
    spacing = 0.01
    leaves = foliation.trace(spacing=spacing)
    assert len(leaves) > 50 and all(leaf.kind == "level" and leaf.closed for leaf in leaves)
    assert all(leaf.begin == leaf.end == "closed" and leaf.cylinder is not None for leaf in leaves)
    crossings = np.bincount(leaves.edges, minlength=len(foliation))
    # round(height / spacing) level sets fill a cylinder: the spacing is right to 5 %.
    assert np.abs(crossings - foliation.values / spacing).max() < 2 + 0.05 * (foliation.values / spacing).max()


def test_points_lie_on_their_edges(foliation: foliations.Foliation) -> None:
    leaves = foliation.trace(spacing=0.1)
    level = foliation.hierarchy.levels[0]
    ends = level.positions[level.edges[leaves.edges]]
    along = [np.linalg.norm(leaves.points - ends[:, k], axis=1) for k in (0, 1)]
    assert np.allclose(along[0] + along[1], np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), rtol=1e-9)


def test_critical_leaves_join_zeros(foliation: foliations.Foliation) -> None:
    zeros = foliation.singularities()
    leaves = foliation.trace()
    ends = []
    for leaf in leaves:
        assert leaf.kind == "critical" and leaf.cylinder is None and leaf.begin == leaf.end == "zero"
        assert leaf.begin_zero is not None and leaf.end_zero is not None
        ends += [leaf.begin_zero, leaf.end_zero]
    # At a zero of order k, k + 2 leaves begin or end.
    assert np.bincount(ends).tolist() == [2 - zero.index for zero in zeros]
    assert [leaf.source for leaf in foliation.trace(critical=True)] == [leaf.source for leaf in leaves]


def test_leaves_through_points(foliation: foliations.Foliation) -> None:
    level = foliation.hierarchy.levels[0]
    triangles, barycentrics = [0, 7, 99], np.full((3, 3), 1 / 3)
    leaves = foliation.trace(point_triangles=triangles, point_barycentrics=barycentrics)
    assert [(leaf.kind, leaf.source) for leaf in leaves] == [("point", 0), ("point", 1), ("point", 2)]
    sizes = np.linalg.norm(np.ptp(level.positions[level.triangles[triangles]], axis=1), axis=1)
    for leaf, triangle, size in zip(leaves, triangles, sizes):
        if leaf.begin == "nowhere":
            continue
        center = level.positions[level.triangles[triangle]].mean(axis=0)
        assert np.linalg.norm(leaf.points - center, axis=1).min() < size
        assert leaf.length > 0


def test_conjugate_leaves_cross_the_cylinders(foliation: foliations.Foliation) -> None:
    spacing = 0.05
    leaves = foliation.trace(leaves="conjugate", spacing=spacing)
    for number, cylinder in enumerate(foliation.cylinders()):
        own = [leaf for leaf in leaves if leaf.cylinder == number]
        assert abs(len(own) - cylinder.circumference / spacing) <= 1
        assert all(leaf.begin == leaf.end == "critical" and not leaf.closed for leaf in own)
    with pytest.raises(ValueError, match="conjugate, default, foliation"):
        foliation.trace(leaves="both")  # type: ignore[arg-type]


def test_sequence(foliation: foliations.Foliation) -> None:
    leaves = foliation.trace(spacing=0.2)
    assert len(list(leaves)) == len(leaves) and len(leaves[1:]) == len(leaves) - 1
    assert np.array_equal(np.concatenate([leaf.points for leaf in leaves]), leaves.points)
    assert np.array_equal(leaves[-1].edges, leaves[len(leaves) - 1].edges)
    with pytest.raises(IndexError):
        leaves[len(leaves)]
    with pytest.raises(ValueError, match="read-only"):
        leaves.points[0] = 0


def test_a_leaf_of_a_torus_is_closed(torus: tuple[np.ndarray, np.ndarray]) -> None:
    foliation = foliations.solve(*torus)
    assert len(foliation.trace()) == 0
    assert all(leaf.closed for leaf in foliation.trace(spacing=0.1))


@pytest.mark.parametrize(
    "options",
    [
        {"spacing": -1.0},
        {"spacing": float("nan")},
        {"length_limit": -1.0},
        {"point_triangles": [0]},
        {"point_triangles": [0], "point_barycentrics": [[1, 0, 0], [0, 1, 0]]},
        {"point_triangles": [10**9], "point_barycentrics": [[1, 0, 0]]},
        {"point_triangles": [0], "point_barycentrics": [[2, -1, 0]]},
        {"point_triangles": [0], "point_barycentrics": [[1, 0]]},
    ],
    ids=str,
)
def test_errors(foliation: foliations.Foliation, options: dict[str, object]) -> None:
    with pytest.raises(ValueError):
        foliation.trace(**options)  # type: ignore[arg-type]
