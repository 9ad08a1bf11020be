"""mypy --strict on the package as users see it, and on a program of theirs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """\
import numpy as np
import foliations
from numpy.typing import NDArray

def f(positions: NDArray[np.float64], triangles: NDArray[np.int64]) -> float:
    hierarchy = foliations.Hierarchy(positions, triangles, ratio=0.4, collapse="qslim", progress=True)
    loops = hierarchy.loops("cut").with_weights([1.0, 2.0])
    foliation = hierarchy.solve(loops, method="newton", progress=lambda fraction: None)
    reveal_type(foliation.values)
    reveal_type(foliation.singularities()[0])
    reveal_type(loops[0])
    hierarchy.solve(method="simplex")
    return foliation.energy
"""


def test_strict(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    (tmp_path / "program.py").write_text(PROGRAM)
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache")]
    done = subprocess.run([*command, "-p", "foliations"], capture_output=True, text=True, cwd=tmp_path, timeout=1200)
    assert done.returncode == 0, done.stdout + done.stderr
    done = subprocess.run([*command, "program.py"], capture_output=True, text=True, cwd=tmp_path, timeout=1200)
    output = done.stdout
    assert output.count("error:") == 1, output
    assert 'program.py:12: error: Argument "method"' in output
    assert "Singularity" in output and "float64" in output
    assert "uint32" in output or "unsignedinteger" in output
