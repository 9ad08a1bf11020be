"""Prints the lines of bindings/same_bits/README.md."""

from __future__ import annotations

import foliations
import numpy as np
from foliations import sample

PLATES = {"genus1": (1, 1, 4, 4), "genus2": (2, 1, 8, 7), "genus6": (3, 2, 15, 10)}


def fnv1a64(data: bytes) -> int:
    value = 14695981039346656037
    for byte in data:
        value = (value ^ byte) * 1099511628211 % 2**64
    return value


def shifted(points: np.ndarray) -> np.ndarray:
    i, j, k = points.T
    return np.stack(
        [
            16 * i + (3 * i + 5 * j + 6 * k + i * j) % 7 - 3,
            16 * j + (5 * i + 2 * j + 3 * k + j * k) % 7 - 3,
            16 * k + (2 * i + 3 * j + 5 * k + k * i) % 7 - 3,
        ],
        axis=1,
    ).astype(np.float64)


def main() -> None:
    for name, size in PLATES.items():
        points, triangles = sample.plate(*size)
        values = foliations.solve(shifted(points), triangles).values
        print(name, len(points), len(triangles), f"{fnv1a64(values.astype('<f8').tobytes()):016x}")


if __name__ == "__main__":
    main()
