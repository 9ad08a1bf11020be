#!/usr/bin/env python3
"""The pictures of the guides, made by the tool from meshes that need no download.

    docs/pictures/make.py HMF      HMF is the tool, for example build/hmf; needs Pillow

Each picture is 480 x 360 pixels with at most 192 colors.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageChops, ImageDraw

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from example_meshes import plate, star

HERE = Path(__file__).resolve().parent
HANDLE = "2.08,0,0.1 1.6,0,0.6 1.15,0,0.1 1.6,0,-0.4"
WAIST = "0.45,1.3,0.1 0.4,0,0.6 0.45,-1.3,0.1 0.4,0,-0.4"
FRONT = ["--camera", "-0.15,0.2,1"]

# Picture: command, mesh, options.
PICTURES = {
    "cut": ("solve", "sample", ["--loops", "cut", *FRONT]),
    "tunnel": ("solve", "sample", ["--loops", "tunnel", *FRONT]),
    "pants": ("solve", "sample", ["--loops", "pants", *FRONT]),
    "even": ("solve", "sample", ["--loops", "even", *FRONT]),
    "weights": ("solve", "sample", ["--loops", "cut", "--weights", "1,2,4", *FRONT]),
    "handle_loop": ("solve", "sample", ["--through", HANDLE, *FRONT]),
    "waist_loop": ("solve", "sample", ["--through", WAIST, *FRONT]),
    "two_loops": ("solve", "sample", ["--through", f"{HANDLE}; {WAIST}", *FRONT]),
    "scale_cut": ("solve", "sample", ["--loops", "cut", "--pattern", "scale", *FRONT]),
    "scale_even": ("solve", "sample", ["--loops", "even", "--pattern", "scale", *FRONT]),
    "checkerboard": ("solve", "sample", ["--pattern", "checkerboard", *FRONT]),
    "quads": ("quads", "sample", ["--count", "3000", *FRONT]),
    "star": ("solve", "star", ["--loops", "even", "--camera", "0.2,-0.5,1"]),
    "star_quads": ("quads", "star", ["--count", "2500", "--camera", "0.2,-0.5,1"]),
    "plate": ("solve", "plate", ["--camera", "front"]),
    "plate_arc": ("solve", "plate", ["--loops", "arc.txt", "--camera", "front"]),
}


def few_colors(image: Image.Image) -> Image.Image:
    return image.quantize(192, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)


def on_white(image: Image.Image) -> Image.Image:
    """Without the background, which has one color in each row."""
    background = image.crop((0, 0, 1, image.height)).resize(image.size)
    far = ImageChops.difference(image, background).convert("L").point(lambda value: 255 if value > 1 else 0)
    return Image.composite(image, Image.new("RGB", image.size, "white"), far)


def draw_atlas(obj: Path, picture: Path) -> None:
    """The charts of an OBJ file with texture coordinates, one color each."""
    points, faces, parent = [], [], {}
    for line in obj.read_text().splitlines():
        if line.startswith("vt "):
            points.append(tuple(map(float, line.split()[1:3])))
        if line.startswith("f "):
            faces.append([int(corner.split("/")[1]) - 1 for corner in line.split()[1:]])

    def root(a: int) -> int:
        while parent.setdefault(a, a) != a:
            parent[a] = parent[parent[a]]
            a = parent[a]
        return a
    for a, b, c in faces:
        parent[root(a)] = root(c)
        parent[root(b)] = root(c)
    side, colors = 1080, {}
    image = Image.new("RGB", (side, side), "white")
    draw = ImageDraw.Draw(image)
    palette = ["#c8323c", "#3c78c8", "#3c9650", "#e6a03c", "#8c5ab4", "#50aab4", "#b4b43c", "#969696"]
    for face in faces:
        color = colors.setdefault(root(face[0]), palette[len(colors) % len(palette)])
        draw.polygon([(side * points[k][0], side * (1 - points[k][1])) for k in face], fill=color, outline=color)
    draw.rectangle((0, 0, side - 1, side - 1), outline="black", width=3)
    few_colors(image.resize((360, 360), Image.LANCZOS)).save(picture, optimize=True)


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    hmf = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        subprocess.run([hmf, "demo", "demo"], cwd=work, check=True)
        (work / "demo/sample.obj").rename(work / "sample.obj")
        star(work / "star.obj")
        (work / "arc.txt").write_text(" ".join(map(str, ["a:", *plate(work / "plate.obj")])) + "\n")
        for name, (command, mesh, options) in PICTURES.items():
            out = ["out.obj"] if command == "quads" else []
            subprocess.run([hmf, command, f"{mesh}.obj", *out, *options, "--image", f"{name}.png",
                            "--image-size", "960x720"], cwd=work, check=True)
            image = on_white(Image.open(work / f"{name}.png").convert("RGB")).resize((480, 360), Image.LANCZOS)
            few_colors(image).save(HERE / f"{name}.png", optimize=True)
        subprocess.run([hmf, "solve", "sample.obj", "--atlas", "atlas.obj"], cwd=work, check=True)
        draw_atlas(work / "atlas.obj", HERE / "atlas.png")


if __name__ == "__main__":
    main()
