"""The picture: what is in front is drawn, what is behind is not."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import foliations
import numpy as np
import pytest
from conftest import Mesh
from foliations import sample

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")
pyplot = pytest.importorskip("matplotlib.pyplot")


@pytest.fixture(autouse=True)
def close_figures() -> Iterator[None]:
    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def foliation() -> foliations.Foliation:
    return foliations.solve(*sample.pretzel(2, side=10))


def pixels(ax: object) -> np.ndarray:
    figure = ax.figure  # type: ignore[attr-defined]
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[:, :, :3].astype(int)


def share(image: np.ndarray, channel: int) -> float:
    """Share of the pixels where one channel is far above both others."""
    others = np.delete(image, channel, axis=2).max(axis=2)
    return float((image[:, :, channel] - others > 70).mean())


def test_picture(foliation: foliations.Foliation, tmp_path: Path) -> None:
    ax = foliations.plot(foliation)
    image = pixels(ax)
    assert share(image, 0) > 0.03, "red stripes"
    assert 0 < share(image, 2) < 0.02, "blue zeros"
    assert (image.min(axis=2) == 255).mean() > 0.02, "white around, and in the holes"
    ax.figure.savefig(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_without_zeros_and_with_fewer_stripes(foliation: foliations.Foliation) -> None:
    many, few = pixels(foliations.plot(foliation)), pixels(foliations.plot(foliation, stripes=15, zeros=False))
    assert share(few, 0) < 0.5 * share(many, 0)
    assert share(few, 2) == 0


def test_the_axes_given_are_used(foliation: foliations.Foliation) -> None:
    figure = matplotlib.figure.Figure()
    ax = figure.add_subplot()
    assert foliations.plot(foliation, ax=ax, view=[0, 0, 1]) is ax
    assert foliation.loops is not None
    assert len(ax.images) == 1 and len(ax.collections) == 2 + len(foliation.loops)
    plain = foliations.plot(foliation, ax=figure.add_subplot(), view=[0, 0, 1], loops=False)
    assert len(plain.collections) == 2


def test_what_is_behind_is_hidden(foliation: foliations.Foliation) -> None:
    """From both sides together about each piece of a leaf is seen once."""
    leaves = foliation.trace(spacing=0.1)
    counts = []
    for sign in (1, -1):
        ax = foliations.plot(foliation, view=[0, 0, sign], spacing=0.1, zeros=False)
        counts.append(len(ax.collections[0].get_segments()))
    assert 0.7 < sum(counts) / len(leaves.points) < 1.3
    assert min(counts) > 0.25 * len(leaves.points)


def test_coarse_level_and_clockwise_mesh(torus: Mesh) -> None:
    coarse = foliations.solve(*sample.pretzel(2, side=10), stop_level=1, coarsest=200)
    assert share(pixels(foliations.plot(coarse)), 0) > 0.03
    positions, triangles = sample.pretzel(1, side=6)
    a, b = (
        pixels(foliations.plot(foliations.solve(positions, t), zeros=False)) for t in (triangles, triangles[:, ::-1])
    )
    assert np.abs(a.mean() - b.mean()) < 5, "lit from outside whatever the orientation"
    foliations.plot(foliations.solve(*torus))


def test_bad_view(foliation: foliations.Foliation) -> None:
    for view in ([0, 0, 0], [1, 2], [np.nan, 0, 0]):
        with pytest.raises(ValueError, match="view"):
            foliations.plot(foliation, view=view)


def test_without_matplotlib(foliation: foliations.Foliation, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    with pytest.raises(ImportError, match="pip install"):
        foliations.plot(foliation)


def lines(ax: object) -> int:
    """Segments that are drawn."""
    collections = ax.collections  # type: ignore[attr-defined]
    return sum(len(each.get_segments()) for each in collections if hasattr(each, "get_segments"))


def test_loops(foliation: foliations.Foliation) -> None:
    loops = foliation.hierarchy.loops(level=0)
    ax = foliations.plot(foliation, pattern="none", zeros=False, loops=loops)
    assert len(ax.collections) == len(loops) and share(pixels(ax), 1) > 0.001, "green"
    path = loops.positions(foliation.hierarchy)[0]
    seen = [foliations.plot(foliation, pattern="none", zeros=False, loops=loops[:1], view=[0, 0, z]) for z in (1, -1)]
    assert 0.5 < sum(map(lines, seen)) / len(path) < 1.6, "from both sides each piece is seen once"


def test_checkerboard(foliation: foliations.Foliation) -> None:
    image = pixels(foliations.plot(foliation, pattern="checkerboard", zeros=False))
    red = image[:, :, 0] - image[:, :, 1] > 60
    surface = image.min(axis=2) < 250
    assert 0.4 < red.sum() / surface.sum() < 0.6, "half of the squares"
    coarse = pixels(foliations.plot(foliation, pattern="checkerboard", zeros=False, spacing=1.0))
    changes = [np.count_nonzero(np.diff(one[:, :, 1] < 120, axis=1)) for one in (coarse, image)]
    assert changes[0] < changes[1]


def test_dilatation_and_quads(foliation: foliations.Foliation) -> None:
    light = pixels(foliations.plot(foliation, pattern="dilatation", zeros=False))
    assert light.mean() > 120, "near to conformal"
    mesh = foliation.quads()
    ax = foliations.plot(foliation, quads=mesh)
    assert 0.25 * 8 * len(mesh.quads) < lines(ax) < 0.9 * 8 * len(mesh.quads), "about those in front, in four pieces"


def test_leaves(foliation: foliations.Foliation) -> None:
    leaves = foliation.trace(spacing=0.1, critical=True)
    ax = foliations.plot(foliation, leaves=leaves, zeros=False)
    colors = {tuple(collection.get_colors()[0]) for collection in ax.collections}
    assert len(colors) == 3, "two cylinders, and black"
    conjugate = foliation.trace(leaves="conjugate", spacing=0.1, length_limit=2.0)
    ax = foliations.plot(foliation, leaves=[leaves, conjugate], zeros=False)
    assert len(ax.collections) == 2


def test_unknown_pattern(foliation: foliations.Foliation) -> None:
    with pytest.raises(ValueError, match="pattern"):
        foliations.plot(foliation, pattern="dots")  # type: ignore[arg-type]
