"""Meshes to try things with."""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

from ._boundary import Floats, Indices
from .export import Drawing, save

# Outward directions of the faces of a cube, and the corners of each face
# counter-clockwise from outside; the order is that of bindings/same_bits.
_DIRECTIONS = ((-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1))
_CORNERS = np.array(
    [
        [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]],
        [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],
        [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],
        [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]],
        [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
        [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
    ]
)


def plate(holes_x: int, holes_y: int, side: int, height: int) -> tuple[NDArray[np.int64], Indices]:
    """The boundary of a plate of unit cubes with holes_x * holes_y rectangular holes, its genus.

    Holes and the bars between them are ``side`` cubes wide, the plate is ``height`` thick.

    Returns
    -------
    points : (n, 3) int64
        Grid points, numbered by their first appearance in the triangles.
    triangles : (m, 3) uint32
        Two for each square, counter-clockwise from outside.
    """
    if min(holes_x, holes_y, side, height) < 1:
        raise ValueError("holes_x, holes_y, side and height must be at least 1.")
    odd_x = np.arange((2 * holes_x + 1) * side) // side % 2 == 1
    odd_y = np.arange((2 * holes_y + 1) * side) // side % 2 == 1
    solid = np.broadcast_to(~(odd_y[:, None] & odd_x), (height, odd_y.size, odd_x.size))
    padded = np.pad(solid, 1)
    exposed = np.empty((*solid.shape, 6), dtype=bool)
    for number, (x, y, z) in enumerate(_DIRECTIONS):
        neighbor = padded[1 + z :, 1 + y :, 1 + x :][: solid.shape[0], : solid.shape[1], : solid.shape[2]]
        exposed[..., number] = solid & ~neighbor
    # Rows in the order z, y, x, direction.
    faces = np.argwhere(exposed)
    corners = (faces[:, None, 2::-1] + _CORNERS[faces[:, 3]]).reshape(-1, 3)
    keys = np.ravel_multi_index(tuple(corners.T), tuple(corners.max(axis=0) + 1))
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    by_first = np.argsort(first)
    number_of = np.empty(first.size, dtype=np.uint32)
    number_of[by_first] = np.arange(first.size, dtype=np.uint32)
    quads = number_of[which.reshape(-1, 4)]
    return corners[first[by_first]].astype(np.int64), quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def pretzel(genus: int = 2, *, side: int = 6) -> tuple[Floats, Indices]:
    """A smooth bar with ``genus`` holes in a row.

    Parameters
    ----------
    genus : int
        At least 1.
    side : int
        Resolution: holes and bars are about ``side`` edges wide.  Genus 2 has
        1 798 vertices with side 6, and 51 198 with side 32.

    Returns
    -------
    positions : (n, 3) float64
    triangles : (m, 3) uint32
    """
    points, triangles = plate(genus, 1, side, side)
    positions = points.astype(np.float64)
    following = triangles[:, [1, 2, 0]]
    degree = np.bincount(triangles.ravel()).astype(np.float64)
    # Each vertex to the mean of its neighbors: rounds off edges of the cubes
    # in proportion to the size.
    for _ in range(side * side // 2):
        for axis in range(3):
            column = positions[:, axis]
            positions[:, axis] = np.bincount(triangles.ravel(), column[following].ravel()) / degree
    return np.ascontiguousarray(positions / side), triangles


def main() -> None:
    """python -m foliations.sample FILE.obj [GENUS]"""
    if not 2 <= len(sys.argv) <= 3:
        raise SystemExit(main.__doc__)
    positions, triangles = pretzel(int(sys.argv[2]) if len(sys.argv) == 3 else 2, side=12)
    save(sys.argv[1], Drawing(positions, triangles))


if __name__ == "__main__":
    main()
