#!/usr/bin/env python3
"""The pictures beside the Python examples, drawn by the installed package, reduced to few colors.

    docs/pictures/gallery.py      needs the package foliations[plot], the tool for first.py, and Pillow
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

EXAMPLES = Path(__file__).resolve().parents[2] / "bindings/python/examples"
NAMES = ("first", "stripes", "checkerboard", "leaves", "loops", "net", "quads", "objects", "weights")
WIDTH, COLORS = 720, 56
# Few pixels have the colors of zeros and loops: a strip of each, so that the palette has them.
MARKS = ((31, 79, 216), (179, 32, 42), (26, 138, 58), (255, 255, 255))


def reduced(picture: Image.Image) -> Image.Image:
    height = round(picture.height * WIDTH / picture.width)
    small = picture.convert("RGB").resize((WIDTH, height), Image.LANCZOS)
    strips = Image.new("RGB", (WIDTH, height + 6 * len(MARKS)))
    strips.paste(small, (0, 0))
    for i, color in enumerate(MARKS):
        strips.paste(color, (0, height + 6 * i, WIDTH, height + 6 * i + 6))
    palette = strips.quantize(COLORS, method=Image.Quantize.MEDIANCUT)
    return small.quantize(palette=palette, dither=Image.Dither.NONE)


with tempfile.TemporaryDirectory() as folder:
    subprocess.run([sys.executable, "-m", "foliations.sample", "pretzel.obj"], cwd=folder, check=True)
    for name in NAMES:
        environment = {**os.environ, "MPLBACKEND": "Agg"}
        subprocess.run([sys.executable, EXAMPLES / f"{name}.py"], cwd=folder, env=environment, check=True)
        reduced(Image.open(Path(folder) / f"{name}.png")).save(EXAMPLES / f"{name}.png", optimize=True)
