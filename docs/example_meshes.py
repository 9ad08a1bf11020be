"""Meshes for the pictures and the examples of the documentation, made by formula."""

import math
from pathlib import Path


def write_obj(path: Path, vertices: list, triangles: list) -> None:
    path.write_text("".join(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices)
                    + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles))


def star(path: Path, rows: int = 60, columns: int = 120) -> None:
    """A sphere with five arms."""
    vertices = [(0, 0, 0.55), (0, 0, -0.55)]
    for i in range(1, rows):
        for j in range(columns):
            t, p = math.pi * i / rows, 2 * math.pi * j / columns
            r = 0.55 + 0.75 * math.sin(t) ** 8 * (0.5 + 0.5 * math.cos(5 * p)) ** 2
            vertices.append((r * math.sin(t) * math.cos(p), r * math.sin(t) * math.sin(p), r * math.cos(t)))

    def at(i: int, j: int) -> int:
        return 0 if i == 0 else 1 if i == rows else 2 + (i - 1) * columns + j % columns
    triangles = []
    for i in range(rows):
        for j in range(columns):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3]
    write_obj(path, vertices, triangles)


def plate(path: Path, rows: int = 24, columns: int = 160) -> list:
    """A square with a round hole; returns a line of vertices from the hole to the square."""
    vertices, triangles = [], []
    for i in range(rows + 1):
        for j in range(columns):
            p = 2 * math.pi * j / columns
            c, s = math.cos(p), math.sin(p)
            square = 1 / max(abs(c), abs(s))
            r = 0.4 + (square - 0.4) * (i / rows)
            vertices.append((r * c, r * s, 0))
    for i in range(rows):
        for j in range(columns):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            triangles += [(a, a + columns, b + columns), (a, b + columns, b)]
    write_obj(path, vertices, triangles)
    return [i * columns for i in range(rows + 1)]
