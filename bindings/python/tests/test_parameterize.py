"""The parameterization against the foliation it comes from."""

from __future__ import annotations

import foliations
import numpy as np
import pytest


@pytest.fixture(scope="module")
def foliation(hierarchy: foliations.Hierarchy) -> foliations.Foliation:
    return hierarchy.solve()


@pytest.fixture(scope="module")
def uv(foliation: foliations.Foliation) -> foliations.Parameterization:
    return foliation.parameterize()


def test_shapes(foliation: foliations.Foliation, uv: foliations.Parameterization) -> None:
    level = foliation.hierarchy.levels[0]
    assert uv.corner_uv.shape == (level.triangle_count, 3, 2)
    assert uv.transition.shape == (level.edge_count, 3)
    assert uv.seam.shape == (level.edge_count,) and uv.seam.dtype == np.bool_
    assert uv.cone.shape == (level.vertex_count,) and uv.cone.dtype == np.int32
    assert uv.dilatation.shape == (level.triangle_count,)
    assert uv.differential.shape == (level.triangle_count,) and uv.differential.dtype == np.complex128
    with pytest.raises(ValueError, match="read-only"):
        uv.corner_uv[0] = 0


def test_du_is_the_foliation_almost_everywhere(
    foliation: foliations.Foliation, uv: foliations.Parameterization
) -> None:
    """But near zeros in triangles, which move to a corner."""
    level = foliation.hierarchy.levels[0]
    u = uv.corner_uv[:, :, 0]
    differences = np.abs(u[:, [1, 2, 0]] - u)
    deviation = np.abs(differences - foliation.values[level.triangle_edges]) / foliation.values.mean()
    assert np.median(deviation) < 0.02


def test_transitions_join_the_triangles(foliation: foliations.Foliation, uv: foliations.Parameterization) -> None:
    level = foliation.hierarchy.levels[0]
    order = np.argsort(level.triangle_edges.ravel(), kind="stable").reshape(-1, 2)
    (first, side_1), (second, side_2) = (np.divmod(order[:, k], 3) for k in (0, 1))
    assert (first < second).all()
    sign, shift = uv.transition[:, :1], uv.transition[:, 1:]
    # The second triangle runs through the edge in the other sense.
    for corner_1, corner_2 in ((side_1, (side_2 + 1) % 3), ((side_1 + 1) % 3, side_2)):
        moved = sign * uv.corner_uv[first, corner_1] + shift
        assert np.array_equal(moved, uv.corner_uv[second, corner_2])
    off = ~uv.seam
    assert (uv.transition[off] == [1, 0, 0]).all()
    assert uv.seam.sum() == uv.seam_edge_count > 0
    ends = level.positions[level.edges[uv.seam]]
    assert np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).sum() == pytest.approx(uv.seam_length)


def test_numbers(foliation: foliations.Foliation, uv: foliations.Parameterization) -> None:
    assert (2 - uv.cone).sum() == 4 - 4 * foliation.hierarchy.genus
    assert uv.area == pytest.approx(foliation.energy, rel=0.05)
    assert 1 <= uv.dilatation_median <= uv.dilatation_p99
    assert uv.flipped_count == (uv.dilatation < 0).sum()


def test_given_seams_are_preferred(foliation: foliations.Foliation, uv: foliations.Parameterization) -> None:
    other = foliation.hierarchy.solve(weights=[1, 3]).parameterize().seam
    again = foliation.parameterize(seam_edges=np.flatnonzero(other))
    assert other[again.seam].mean() > 0.8 > other[uv.seam].mean()


def test_errors(foliation: foliations.Foliation) -> None:
    hierarchy = foliation.hierarchy
    with pytest.raises(foliations.FoliationError) as caught:
        hierarchy.initialize(hierarchy.loops(level=0)).parameterize()
    assert caught.value.status is foliations.Status.ERROR_VALUE_NOT_HARMONIC
    with pytest.raises(ValueError):
        foliation.parameterize(seam_edges=[-1])
    with pytest.raises(foliations.Error):
        foliation.parameterize(seam_edges=[10**6])
    with pytest.raises(foliations.OptionsError):
        foliation.parameterize(tolerance=-1.0)
    with pytest.raises(foliations.Cancelled):
        foliation.parameterize(progress=lambda fraction: foliations.Progress.CANCEL)
