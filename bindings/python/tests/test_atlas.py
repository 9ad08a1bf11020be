"""Charts in the unit square: all triangles, the area that is told, files."""

from __future__ import annotations

from pathlib import Path

import foliations
import numpy as np
import pytest


@pytest.fixture(scope="module")
def foliation(hierarchy: foliations.Hierarchy) -> foliations.Foliation:
    return hierarchy.solve()


def test_in_the_square(foliation: foliations.Foliation) -> None:
    atlas = foliation.atlas(margin=0.01)
    uv = atlas.corner_uv
    assert uv.shape == (len(foliation.hierarchy.levels[0].triangles), 3, 2)
    assert uv.min() >= 0 and uv.max() <= 1
    assert set(atlas.triangle_chart) == set(range(atlas.chart_count))
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    area = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    assert (area > 0).sum() == len(area) - atlas.collapsed_count
    assert area.sum() == pytest.approx(atlas.used_area)
    assert "charts" in repr(atlas)


@pytest.mark.parametrize("suffix", [".obj", ".glb", ".ply"])
def test_export(foliation: foliations.Foliation, tmp_path: Path, suffix: str) -> None:
    foliation.atlas().export(tmp_path / f"atlas{suffix}")
    assert (tmp_path / f"atlas{suffix}").stat().st_size > 1000


def test_refused(foliation: foliations.Foliation) -> None:
    with pytest.raises(foliations.Error, match="margin"):
        foliation.atlas(margin=1)
    assert np.isfinite(foliation.atlas().unevenness)
