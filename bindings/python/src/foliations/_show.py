"""Windows of Polyscope and PyVista, and the picture in notebooks."""

from __future__ import annotations

from importlib import import_module
from io import BytesIO
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ._boundary import ProgressOption
from ._texture import STRIPES, default_period, default_spacing
from .loops import Loops, as_loops

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from .foliation import Foliation

Viewer = Literal["polyscope", "pyvista"]
_BLUE, _GREEN, _RED, _CREAM = (0.12, 0.31, 0.85), (0.1, 0.55, 0.2), (0.7, 0.13, 0.16), (0.96, 0.94, 0.9)


def show(
    foliation: Foliation,
    viewer: Viewer | None = None,
    *,
    loops: Loops | Sequence[ArrayLike] | None = None,
    spacing: float | None = None,
    wait: bool = True,
    progress: ProgressOption = None,
) -> Any:
    """Opens a window with the surface, its leaves and zeros.

    Parameters
    ----------
    viewer : "polyscope" or "pyvista", optional
        Default: the first of them that is installed.
    loops : as for :meth:`Hierarchy.solve`, optional
        Drawn as well, in green.
    spacing : float, optional
        Distance of two leaves in the unit of the values.
    wait : bool
        Wait until the window is closed; False only creates the scene.
    progress : bool or function, optional
        As for :class:`Hierarchy`.

    Returns
    -------
    The surface mesh of Polyscope, or the plotter of PyVista, to add to.

    Raises
    ------
    ImportError
        None of the two is installed.
    """
    names = ("polyscope", "pyvista") if viewer is None else (viewer,)
    for name in names:
        if name not in ("polyscope", "pyvista"):
            raise ValueError(f"viewer must be 'polyscope' or 'pyvista', got {name!r}.")
        try:
            module = import_module(name)
        except ImportError:
            continue
        level = foliation.hierarchy.levels[foliation.level]
        if spacing is None:
            spacing = default_spacing(foliation, level.positions, level.triangles, STRIPES)
        leaves = foliation.trace(spacing=spacing, progress=progress)
        # Each point with the next one of its leaf; leaves of level sets are closed.
        following = np.arange(1, len(leaves.points) + 1)
        following[leaves.offsets[1:].astype(np.int64) - 1] = leaves.offsets[:-1]
        segments = np.stack([np.arange(len(following)), following], axis=1)
        zeros = np.array([zero.position for zero in foliation.singularities().zeros]).reshape(-1, 3)
        shown = None if loops is None else as_loops(loops, None)
        curves = [] if shown is None else list(shown.positions(foliation.hierarchy))
        for number, arc in enumerate([] if shown is None else shown.arcs):
            if arc:  # there and back, as the curves are closed
                curves[number] = np.vstack([curves[number], curves[number][-2:0:-1]])
        draw = _polyscope if name == "polyscope" else _pyvista
        return draw(module, foliation, (np.array(leaves.points), segments), zeros, curves, wait)
    raise ImportError("show needs Polyscope or PyVista: pip install polyscope, or pip install pyvista.")


def _polyscope(module: Any, foliation: Foliation, leaves: Any, zeros: Any, curves: Any, wait: bool) -> Any:
    module.init()
    level = foliation.hierarchy.levels[foliation.level]
    mesh = module.register_surface_mesh("mesh", level.positions, level.triangles, smooth_shade=True, color=_CREAM)
    parameterization = foliation.parameterize()
    mesh.add_parameterization_quantity(
        "uv",
        parameterization.corner_uv.reshape(-1, 2) / default_period(foliation, parameterization),
        defined_on="corners",
    )
    mesh.add_scalar_quantity("dilatation", parameterization.dilatation, defined_on="faces")
    module.register_curve_network("leaves", *leaves, radius=0.0008, color=_RED)
    if len(zeros):
        module.register_point_cloud("zeros", zeros, radius=0.008, color=_BLUE)
    for number, points in enumerate(curves):
        module.register_curve_network(f"loop {number}", points, "loop", radius=0.003, color=_GREEN)
    if wait:
        module.show()
    return mesh


def _pyvista(module: Any, foliation: Foliation, leaves: Any, zeros: Any, curves: Any, wait: bool) -> Any:
    level = foliation.hierarchy.levels[foliation.level]

    def counted(cells: Any) -> Any:
        return np.insert(cells, 0, cells.shape[1], axis=1).astype(np.int64).reshape(-1)

    plotter = module.Plotter()
    surface = module.PolyData(np.array(level.positions), counted(level.triangles))
    mapper = plotter.add_mesh(surface, color=_CREAM, smooth_shading=True, name="mesh").mapper
    # Somewhat behind the lines that lie on it.
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(2, 40)
    points, segments = leaves
    plotter.add_mesh(module.PolyData(points, lines=counted(segments)), color=_RED, line_width=2, name="leaves")
    if len(zeros):
        plotter.add_points(zeros, color=_BLUE, point_size=14, render_points_as_spheres=True, name="zeros")
    for number, curve in enumerate(curves):
        line = np.append(np.arange(len(curve)), 0)[None, :]
        plotter.add_mesh(
            module.PolyData(np.array(curve), lines=counted(line)), color=_GREEN, line_width=6, name=f"loop {number}"
        )
    if wait:
        plotter.show()
    return plotter


def repr_png(foliation: Foliation) -> bytes | None:
    """The picture of :func:`plot` for notebooks; None without matplotlib."""
    try:
        figures = import_module("matplotlib.figure")
        agg = import_module("matplotlib.backends.backend_agg")
    except ImportError:
        return None
    from ._plot import plot

    # Not one of pyplot, which would be shown a second time.
    figure = figures.Figure(figsize=(6, 5), layout="constrained")
    agg.FigureCanvasAgg(figure)
    plot(foliation, ax=figure.add_subplot())
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=100, bbox_inches="tight")
    return buffer.getvalue()
