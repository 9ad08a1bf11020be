"""One hierarchy, many threads."""

from __future__ import annotations

import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import foliations
import numpy as np
from foliations import _boundary, sample
from pytest import MonkeyPatch


def test_solves_of_one_hierarchy_overlap(hierarchy: foliations.Hierarchy, monkeypatch: MonkeyPatch) -> None:
    """Each of four solves waits, in its first callback, for the three others to be there."""
    monkeypatch.setattr(_boundary, "PROGRESS_INTERVAL", 0.0)
    together = threading.Barrier(4)

    def solve(weight: float) -> np.ndarray:
        met: list[int] = []

        def meet(fraction: float) -> None:
            if not met:
                met.append(together.wait(timeout=60))

        return hierarchy.solve(weights=[1, weight], progress=meet).values

    weights = [1.0, 2.0, 3.0, 4.0]
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(solve, weights))
    for weight, values in zip(weights, results):
        assert np.array_equal(values, hierarchy.solve(weights=[1, weight]).values)


def test_many_meshes() -> None:
    meshes = [sample.pretzel(genus, side=4) for genus in (1, 2, 3, 4)]
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda mesh: foliations.solve(*mesh), meshes))
    for mesh, foliation in zip(meshes, results):
        assert foliation.converged
        assert np.array_equal(foliation.values, foliations.solve(*mesh).values)


def test_all_queries_from_threads(hierarchy: foliations.Hierarchy) -> None:
    def everything(_: int) -> tuple[float, float, int, int]:
        foliation = hierarchy.solve()
        coarse = foliation.interpolate(1)
        return foliation.energy, coarse.residuals().max(), len(foliation.singularities()), len(hierarchy.loops()[0])

    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(everything, range(24)))) == 1


def test_the_hierarchy_outlives_its_name() -> None:
    foliation = foliations.solve(*sample.pretzel(1, side=4))
    level = foliations.Hierarchy(*sample.pretzel(1, side=4)).levels[0]
    assert foliation.residuals().max() < 1e-8
    assert level.weights.size == level.edge_count


def test_the_example() -> None:
    example = Path(__file__).resolve().parents[1] / "examples" / "batch.py"
    done = subprocess.run([sys.executable, str(example)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("->") == 24
