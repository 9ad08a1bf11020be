"""Pictures: the shaded surface with leaves at equal distances, and its zeros.

The surface is drawn into a depth buffer in NumPy; the leaves are curves of
matplotlib over that picture, of which only the parts in front are drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._boundary import Floats, Indices
from ._texture import default_period, default_spacing, share
from .foliation import Foliation
from .leaves import Leaves
from .loops import Loops, as_loops
from .quads import QuadMesh

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PIXELS = 1100  # of the longer side of the picture
_MARGIN = 12  # pixels
_PAIRS = 1 << 21  # triangles x pixels at a time
_LIGHT = np.array([-0.4, 0.55, 0.75]) / np.linalg.norm([-0.4, 0.55, 0.75])


def _frame(positions: Floats, view: ArrayLike | None) -> Floats:
    """Rows: right, up, towards the viewer."""
    # The widest axis of the object lies to the right, its flattest looks at us.
    axes = np.linalg.svd(positions - positions.mean(axis=0), full_matrices=False)[2]
    axes *= np.where(axes[np.arange(3), np.abs(axes).argmax(axis=1)] < 0, -1, 1)[:, None]
    if view is None:
        towards = axes[2] * np.cos(0.7) - axes[1] * np.sin(0.7)
        widest = axes[0]
    else:
        towards = np.asarray(view, dtype=np.float64)
        if towards.shape != (3,) or not np.isfinite(towards).all() or not towards.any():
            raise ValueError(f"view must be a direction of three numbers, not all 0, got {view!r}.")
        towards = towards / np.linalg.norm(towards)
        widest = axes[0] if abs(axes[0] @ towards) < 0.9 else axes[1]
    right = widest - (widest @ towards) * towards
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(towards, right), towards])


def _normals(positions: Floats, triangles: Indices) -> Floats:
    """Of the vertices, weighted by area, outward."""
    corners = positions[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    if np.einsum("ij,ij->", corners[:, 0] - positions.mean(axis=0), normals) < 0:
        normals = -normals
    result = np.stack(
        [np.bincount(triangles.ravel(), np.repeat(normals[:, axis], 3), len(positions)) for axis in range(3)], axis=1
    )
    length = np.linalg.norm(result, axis=1, keepdims=True)
    return np.asarray(result / np.where(length > 0, length, 1))


class _Picture:
    """Depth and brightness of the surface on a grid of pixels."""

    def __init__(self, points: Floats, triangles: Indices) -> None:
        low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
        self.pixel = float((high - low).max()) / _PIXELS
        self.origin = low - _MARGIN * self.pixel
        self.width, self.height = (int(n) for n in np.ceil((high - self.origin) / self.pixel) + _MARGIN)
        self.depth = np.full(self.width * self.height, -np.inf)
        self.brightness = np.zeros(self.width * self.height)
        self.triangle = np.zeros(self.width * self.height, dtype=np.int64)
        self.weights = np.zeros((self.width * self.height, 3))
        self._draw(points, triangles, np.clip(_normals(points, triangles) @ _LIGHT, 0, 1))

    def _draw(self, points: Floats, triangles: Indices, light: Floats) -> None:
        places = (points[:, :2] - self.origin) / self.pixel
        corners = places[triangles]
        first = np.ceil(corners.min(axis=1)).astype(np.int64)
        count = np.floor(corners.max(axis=1)).astype(np.int64) - first + 1
        count = np.maximum(count, 0)
        ends = np.cumsum(count[:, 0] * count[:, 1])
        start = 0
        while start < len(triangles):
            done = int(ends[start - 1]) if start else 0
            stop = max(start + 1, int(np.searchsorted(ends, done + _PAIRS, side="right")))
            some = slice(start, stop)
            self._draw_some(points, triangles[some], corners[some], first[some], count[some], light, start)
            start = stop

    def _draw_some(
        self,
        points: Floats,
        triangles: Indices,
        corners: Floats,
        first: NDArray[np.int64],
        count: NDArray[np.int64],
        light: Floats,
        start: int,
    ) -> None:
        sizes = count[:, 0] * count[:, 1]
        which = np.repeat(np.arange(len(triangles)), sizes)
        number = np.arange(len(which)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        x = first[which, 0] + number % count[which, 0]
        y = first[which, 1] + number // count[which, 0]
        a, b, c = (corners[which, k] for k in range(3))
        double_area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        with np.errstate(divide="ignore", invalid="ignore"):
            at_b = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (y - a[:, 1]) * (c[:, 0] - a[:, 0])) / double_area
            at_c = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])) / double_area
        inside = np.flatnonzero((at_b >= 0) & (at_c >= 0) & (at_b + at_c <= 1))
        weights = np.stack([1 - at_b[inside] - at_c[inside], at_b[inside], at_c[inside]], axis=1)
        vertices = triangles[which[inside]]
        depth = np.einsum("ij,ij->i", weights, points[vertices, 2])
        pixel = y[inside] * self.width + x[inside]
        # Of several triangles the nearest comes last, and stays.
        nearer = np.flatnonzero(depth > self.depth[pixel])
        nearer = nearer[np.argsort(depth[nearer], kind="stable")]
        pixel = pixel[nearer]
        self.depth[pixel] = depth[nearer]
        self.brightness[pixel] = np.einsum("ij,ij->i", weights[nearer], light[vertices[nearer]])
        self.triangle[pixel] = start + which[inside][nearer]
        self.weights[pixel] = weights[nearer]

    def visible(self, points: Floats) -> NDArray[np.bool_]:
        """Whether points of the surface are in front: not behind all of the pixels around them."""
        x, y = np.rint((points[:, :2] - self.origin) / self.pixel).astype(np.int64).T
        nearest = np.full(len(points), np.inf)
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                here = np.clip(y + dy, 0, self.height - 1) * self.width + np.clip(x + dx, 0, self.width - 1)
                nearest = np.minimum(nearest, self.depth[here])
        return np.asarray(points[:, 2] >= nearest - 2 * self.pixel)

    def at_corners(self, values: Floats) -> Floats:
        """Values of corners (m, 3, k), interpolated at each pixel."""
        return np.asarray(np.einsum("pc,pck->pk", self.weights, values[self.triangle]))

    def colors(self, surface: Floats) -> Floats:
        """The shaded picture of a color, or of one for each pixel."""
        image = np.ones((self.height * self.width, 4))
        image[:, :3] = surface * (0.45 + 0.55 * self.brightness[:, None])
        image[:, 3] = np.isfinite(self.depth)
        return image.reshape(self.height, self.width, 4)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        low = self.origin - self.pixel / 2
        return (low[0], low[0] + self.width * self.pixel, low[1], low[1] + self.height * self.pixel)


Pattern = Literal["stripes", "checkerboard", "dilatation", "none"]


def _surface(picture: _Picture, foliation: Foliation, pattern: Pattern, period: float | None, colors: Any) -> Floats:
    """Colors of the surface, for all pixels or for each."""
    from matplotlib import colormaps
    from matplotlib.colors import to_rgb

    light, dark = (np.array(to_rgb(color)) for color in colors)
    if pattern not in ("checkerboard", "dilatation"):
        return light[None, :]
    parameterization = foliation.parameterize()
    if pattern == "dilatation":
        # 1 is conformal; flipped triangles are negative.
        scale = np.clip(np.abs(parameterization.dilatation) - 1, 0, 1)
        return np.asarray(colormaps["YlOrRd"](scale)[picture.triangle, :3])
    if period is None:
        period = 2 * default_period(foliation, parameterization)
    uv = picture.at_corners(parameterization.corner_uv / period)
    # Four points of each pixel.
    shape = (picture.height, picture.width, 2)
    gradient: Any = np.gradient(uv.reshape(shape), axis=(0, 1))
    by_y, by_x = (by.reshape(-1, 2) for by in gradient)
    by_x, by_y = (np.where(np.abs(by) < 0.25, by, 0) for by in (by_x, by_y))
    parts = [share("checkerboard", uv + a * by_x + b * by_y) for a in (-0.25, 0.25) for b in (-0.25, 0.25)]
    return np.asarray(light + np.mean(parts, axis=0)[:, None] * (dark - light))


def plot(
    foliation: Foliation,
    *,
    ax: Axes | None = None,
    view: ArrayLike | None = None,
    pattern: Pattern = "stripes",
    spacing: float | None = None,
    stripes: int = 60,
    zeros: bool = True,
    loops: Loops | Sequence[ArrayLike] | Literal[False] | None = None,
    quads: QuadMesh | None = None,
    leaves: Leaves | Sequence[Leaves] | None = None,
    color: Any = "#f4efe6",
    stripe_color: Any = "#b3202a",
    zero_color: Any = "#1f4fd8",
    loop_color: Any = "#1a8a3a",
) -> Axes:
    """Draws the surface with stripes along the leaves, and its zeros; needs matplotlib.

    Parameters
    ----------
    foliation : Foliation
        On any level.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; default a new figure.
    view : (3,) floats, optional
        Direction from the object to the viewer; by default the object is seen
        in its full width, from slightly above.
    pattern : "stripes", "checkerboard", "dilatation" or "none"
        Leaves at equal distances; squares of (u, v); the dilatation of the
        parameterization, light where it is nearly conformal; nothing.
    spacing : float, optional
        Distance of two stripes, or of two squares of one color, in the unit
        of the values; default of stripes from ``stripes``.
    stripes : int
        Approximate number of stripes across the object.
    zeros : bool
        Whether to mark the zeros; the area of a mark grows with the order.
    loops : as for :meth:`Hierarchy.solve`, optional
        Loops to draw; default those of the foliation, unless quads or leaves are drawn; False: none.
    quads : QuadMesh, optional
        Drawn instead of the surface, with its edges.
    leaves : Leaves, or sequence of Leaves, optional
        Drawn instead of stripes.  In a single set each cylinder has a color
        and critical leaves are black; of several sets each has a color.
    color, stripe_color, zero_color, loop_color
        Colors of matplotlib.

    Returns
    -------
    matplotlib.axes.Axes
        Its ``figure`` can be saved or shown.
    """
    try:
        from matplotlib.collections import LineCollection

        if ax is None:  # a backend is chosen only then
            import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("foliations.plot needs matplotlib: pip install 'foliations[plot]'") from error
    if pattern not in ("stripes", "checkerboard", "dilatation", "none"):
        raise ValueError(f"pattern must be 'stripes', 'checkerboard', 'dilatation' or 'none', got {pattern!r}.")

    level = foliation.hierarchy.levels[foliation.level]
    frame = _frame(level.positions, view)
    if quads is None:
        picture = _Picture(level.positions @ frame.T, level.triangles)
    else:
        pattern = "none"
        picture = _Picture(quads.positions @ frame.T, quads.quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
    if ax is None:
        ax = plt.figure(figsize=(9, 9 * picture.height / picture.width), layout="constrained").add_subplot()
    surface = _surface(picture, foliation, pattern, spacing, (color, stripe_color))
    ax.imshow(picture.colors(surface), extent=picture.extent, origin="lower", zorder=1)

    def draw(begin: Floats, end: Floats, color: Any, width: float, order: int) -> None:
        """What is in front of some segments."""
        shown = picture.visible((begin + end) / 2)
        segments = np.stack([begin[shown, :2], end[shown, :2]], axis=1)
        ax.add_collection(
            LineCollection(list(segments), colors=[color], linewidths=width, capstyle="round", zorder=order)
        )

    def draw_leaves(given: Leaves, which: NDArray[np.bool_], color: Any, width: float) -> None:
        path = given.points @ frame.T
        # Each point with the next one of its leaf.
        begin, following = np.arange(len(path)), np.arange(1, len(path) + 1)
        last = given.offsets[1:].astype(np.int64) - 1
        following[last] = given.offsets[:-1]
        counts: Any = np.diff(given.offsets.astype(np.int64))
        kept = np.repeat(which, counts)
        kept[last[given._rows["closed"] == 0]] = False
        draw(path[begin[kept]], path[following[kept]], color, width, 2)

    if leaves is not None:
        sets = [leaves] if isinstance(leaves, Leaves) else list(leaves)
        for number, given in enumerate(sets):
            cylinder = given._rows["cylinder"].astype(np.int32)
            if len(sets) > 1:
                draw_leaves(given, cylinder >= -1, f"C{(3 * number) % 10}", 1.1)
                continue
            for one in np.unique(cylinder):
                black = one < 0
                draw_leaves(given, cylinder == one, "black" if black else f"C{one % 10}", 2.2 if black else 1.1)
    elif pattern == "stripes":
        if spacing is None:
            spacing = default_spacing(foliation, level.positions, level.triangles, stripes)
        lines = foliation.trace(spacing=spacing)
        if len(lines):
            draw_leaves(lines, np.ones(len(lines), dtype=bool), stripe_color, 1.1)
    if quads is not None:
        sides = np.stack([quads.quads, np.roll(quads.quads, -1, axis=1)], axis=2).reshape(-1, 2)
        points = quads.positions @ frame.T
        begin, end = (points[column] for column in sides[sides[:, 0] < sides[:, 1]].T)
        # In pieces: one end of a side may be hidden.
        for part in np.arange(4) / 4:
            draw(begin + part * (end - begin), begin + (part + 0.25) * (end - begin), stripe_color, 0.8, 2)
    if loops is None and quads is None and leaves is None:
        loops = foliation.loops
    if loops is not None and loops is not False:
        shown_loops = as_loops(loops, None)
        for points, arc in zip(shown_loops.positions(foliation.hierarchy), shown_loops.arcs):
            path = points @ frame.T
            following = np.roll(path, -1, axis=0)
            count = len(path) - bool(arc)
            draw(path[:count], following[:count], loop_color, 3.0, 3)
    if zeros:
        marks = foliation.singularities().zeros
        places = np.array([zero.position for zero in marks]).reshape(-1, 3) @ frame.T
        shown = picture.visible(places)
        sizes = np.array([-40.0 * zero.index for zero in marks])
        ax.scatter(places[shown, 0], places[shown, 1], s=sizes[shown], color=zero_color, edgecolors="white", zorder=4)
    ax.set_aspect("equal")
    ax.set_axis_off()
    return ax
