"""Patterns on a surface: the texture, its period, and PNG files."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from ._boundary import Floats, Indices

if TYPE_CHECKING:
    from .foliation import Foliation
    from .parameterization import Parameterization

Pattern = Literal["stripes", "checkerboard"]
Bytes = NDArray[np.uint8]

_LIGHT = np.array([244, 239, 230])
_DARK = {"stripes": np.array([179, 32, 42]), "checkerboard": np.array([52, 84, 122])}
_SIZE = 256
STRIPES = 40  # about so many across the object


def png(pixels: Bytes) -> bytes:
    """An RGB picture, rows from the top, as a PNG file."""
    height, width, _ = pixels.shape
    rows = np.zeros((height, 1 + 3 * width), dtype=np.uint8)
    rows[:, 1:] = pixels.reshape(height, -1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = zlib.compress(rows.tobytes(), 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def share(pattern: str, uv: Floats) -> Floats:
    """Whether points (..., 2) of period 1 are dark, 0 or 1; the same at (u, v) and (-u, -v)."""
    if pattern == "stripes":
        return np.asarray(np.abs(uv[..., 0] - np.rint(uv[..., 0])) < 0.2, dtype=np.float64)
    if pattern == "checkerboard":
        return np.asarray(np.rint(2 * uv).sum(axis=-1) % 2)
    raise ValueError(f"pattern must be 'stripes' or 'checkerboard', got {pattern!r}.")


def texture(pattern: str) -> bytes:
    """One period of a pattern as a PNG file, to be repeated."""
    fine = (np.arange(4 * _SIZE) + 0.5) / (4 * _SIZE)
    dark = share(pattern, np.stack(np.broadcast_arrays(fine[None, :], fine[:, None]), axis=2))
    dark = dark.reshape(_SIZE, 4, _SIZE, 4).mean(axis=(1, 3))[:, :, None]
    return png(np.rint(_LIGHT + dark * (_DARK[pattern] - _LIGHT)).astype(np.uint8))


def default_spacing(foliation: Foliation, positions: Floats, triangles: Indices, stripes: int) -> float:
    """So that about ``stripes`` leaves would cross the object where the foliation is as steep as on average."""
    corners = positions[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    size = np.linalg.norm(positions.max(axis=0) - positions.min(axis=0))
    return float(np.sqrt(foliation.energy / area) * size / stripes)


def default_period(foliation: Foliation, parameterization: Parameterization) -> float:
    """About that of ``STRIPES``, and one that fits the jumps of u at the seams if any near it does."""
    level = foliation.hierarchy.levels[foliation.level]
    wanted = default_spacing(foliation, level.positions, level.triangles, STRIPES)
    jumps, counts = np.unique(np.abs(parameterization.transition[parameterization.seam, 1]), return_counts=True)
    counts, jumps = counts[jumps > 1e-9 * wanted], jumps[jumps > 1e-9 * wanted]
    periods = [wanted]
    for jump in jumps[np.argsort(-counts)[:8]]:
        numbers = np.arange(np.ceil(jump / (1.4 * wanted)), np.floor(jump / (0.7 * wanted)) + 1)
        periods += (jump / numbers[numbers > 0]).tolist()
    # Where most of the seams are not seen, and of those the nearest to the wish.  The
    # jumps between zeros that only discretization keeps apart fit nothing.
    turns = jumps[:, None] / np.array(periods)
    fits = counts @ (np.abs(turns - np.rint(turns)) < 1e-6 * np.maximum(turns, 1))
    best = np.array(periods)[fits == fits.max()]
    return float(best[np.abs(np.log(best / wanted)).argmin()])
