"""One hierarchy, many threads."""

from __future__ import annotations

import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import foliations
import numpy as np
import pytest
from foliations import _boundary, _threads, sample
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
    done = subprocess.run([sys.executable, str(example)], capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("->") == 24


def test_lent_threads_change_no_bit() -> None:
    positions, triangles = sample.pretzel(2, side=24)
    with foliations.threads(1):
        alone = foliations.solve(positions, triangles)
    for count in (2, 3):
        with foliations.threads(count) as given:
            assert given == count
            lent = foliations.solve(positions, triangles)
            assert np.array_equal(lent.values, alone.values)
            assert np.array_equal(lent.parameterize().corner_uv, alone.parameterize().corner_uv)
    assert np.array_equal(foliations.solve(positions, triangles).values, alone.values)


def test_the_innermost_threads_count() -> None:
    def workers() -> int:
        return int(_threads.lent_threads().get("workers", 0))

    seen: list[int] = []
    with foliations.threads(3):
        with foliations.threads(2):
            other = threading.Thread(target=lambda: seen.append(workers()))
            other.start()
            other.join()
            assert workers() == 2
        assert workers() == 3
    assert workers() == 0 and seen == [0]


def test_threads_refuse_a_number_that_cannot_be() -> None:
    for count in (-1, 257):
        with pytest.raises(ValueError, match="count is"), foliations.threads(count):
            pass


def test_threads_are_there_without_a_callback() -> None:
    """On another thread there is no callback; what is lent there arrives all the same."""

    def solve() -> np.ndarray:
        with foliations.threads(2):
            assert _boundary.Watch(None).control().workers == 2
            return foliations.solve(*sample.pretzel(1, side=6)).values

    with ThreadPoolExecutor(1) as pool:
        assert np.array_equal(pool.submit(solve).result(), foliations.solve(*sample.pretzel(1, side=6)).values)
