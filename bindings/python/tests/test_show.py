"""Windows and notebooks.  Where there is no screen, scenes are made and nothing waits."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import foliations
import numpy as np
import pytest
from conftest import Mesh


@pytest.fixture(scope="module")
def foliation(pretzel: Mesh) -> foliations.Foliation:
    return foliations.solve(*pretzel)


def test_png_of_notebooks(foliation: foliations.Foliation, monkeypatch: pytest.MonkeyPatch) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.close("all")
    picture = foliation._repr_png_()
    assert picture is not None and picture[:8] == b"\x89PNG\r\n\x1a\n" and len(picture) > 10_000
    assert not pyplot.get_fignums(), "none that a notebook would show a second time"
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert foliation._repr_png_() is None, "without matplotlib the text is shown"


# In a process of its own: a window system may not be torn down cleanly.
PROGRAM = """
import sys
import foliations
from foliations import sample

hierarchy = foliations.Hierarchy(*sample.pretzel(2, side=6))
loops = hierarchy.loops(level=0)
foliation = hierarchy.solve(loops)
"""
POLYSCOPE = """
import polyscope
polyscope.init("openGL_mock")
polyscope.init = lambda: None
mesh = foliation.show("polyscope", loops=loops, wait=False)
assert mesh.n_faces() == hierarchy.levels[0].triangle_count
assert polyscope.get_curve_network("leaves").n_nodes() > 1000
assert polyscope.get_point_cloud("zeros").n_points() == len(foliation.singularities().zeros)
assert polyscope.get_curve_network("loop 1").n_nodes() == len(loops[1])
"""
PYVISTA = """
import pyvista
pyvista.OFF_SCREEN = True
plotter = foliation.show("pyvista", loops=loops, wait=False)
assert {"mesh", "leaves", "loop 0", "loop 1"} <= set(plotter.actors)
plotter.screenshot(sys.argv[1])
"""


def run(program: str, *arguments: str) -> None:
    command = [sys.executable, "-c", PROGRAM + program, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stderr


def test_polyscope() -> None:
    pytest.importorskip("polyscope")
    run(POLYSCOPE)


def test_pyvista(tmp_path: Path) -> None:
    pytest.importorskip("pyvista")
    path = tmp_path / "a.png"
    run(PYVISTA, str(path))
    image = pytest.importorskip("matplotlib.pyplot").imread(path)[:, :, :3]
    red = image[:, :, 0] - image[:, :, 1:].max(axis=2) > 0.1
    surface = (image != image[0, 0]).any(axis=2)
    assert 0.15 < red.sum() / surface.sum() < 0.6, "leaves, which do not sink into the surface"


def test_without_any_viewer(foliation: foliations.Foliation, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("polyscope", "pyvista"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ImportError, match="pip install polyscope"):
        foliation.show()
    with pytest.raises(ValueError, match="viewer"):
        foliation.show("paraview")  # type: ignore[arg-type]
