"""Each example runs as it is, and leaves its picture."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1]
EXAMPLES = sorted((PACKAGE / "examples").glob("*.py"))


def run(folder: Path, *command: str) -> str:
    done = subprocess.run(
        [sys.executable, *command],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=1200,
        env={**os.environ, "MPLBACKEND": "Agg"},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("example", EXAMPLES, ids=[example.stem for example in EXAMPLES])
def test_example(example: Path, tmp_path: Path) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    for name in re.findall(r"^import (\w+)", example.read_text(), re.M):
        pytest.importorskip(name)
    if example.stem == "first":
        run(tmp_path, "-m", "foliations.sample", "pretzel.obj")
    run(tmp_path, str(example))
    image = pyplot.imread(tmp_path / f"{example.stem}.png")[:, :, :3]
    assert min(image.shape[:2]) >= 300 and image.std() > 0.05, "something is drawn"


def test_there_are_ten() -> None:
    assert len(EXAMPLES) >= 10
    readme = (PACKAGE / "README.md").read_text()
    for example in EXAMPLES:
        assert f"examples/{example.name}" in readme, f"{example.name} is not in the gallery"


def test_the_first_hour_of_the_readme(tmp_path: Path) -> None:
    """Load, draw a loop, solve, look, save: verbatim, in at most ten lines with the installation."""
    readme = (PACKAGE / "README.md").read_text()
    program = re.search(r"```python\n(.*?)```", readme, re.S)
    assert program is not None and program[1] == (PACKAGE / "examples" / "first.py").read_text()
    assert len(program[1].strip().splitlines()) <= 10
    (tmp_path / "program.py").write_text(program[1])
    run(tmp_path, "-m", "foliations.sample", "pretzel.obj")
    output = run(tmp_path, "program.py")
    assert "converged" in output
    files = {file.name for file in tmp_path.iterdir()}
    assert {"first.png", "first.glb", "first.npz"} <= files


def test_the_programs_of_the_guides(tmp_path: Path) -> None:
    script = PACKAGE.parents[1] / "docs" / "run_examples.py"
    tool = shutil.which("hmf", path=str(Path(sys.executable).parent))
    if tool is None or not script.is_file():
        pytest.skip("no tool in this environment, or no guides beside the package")
    pytest.importorskip("matplotlib")
    assert ", 0 not ok" in run(tmp_path, str(script), tool, "python")
