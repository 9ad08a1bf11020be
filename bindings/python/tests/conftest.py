from __future__ import annotations

import foliations
import numpy as np
import pytest
from foliations import sample

Mesh = tuple[np.ndarray, np.ndarray]


def read_only(mesh: Mesh) -> Mesh:
    for array in mesh:
        array.setflags(write=False)
    return mesh


@pytest.fixture(scope="session")
def torus() -> Mesh:
    """Genus 1, 7 vertices."""
    positions = [3, -3, 0, -3, 3, 0, -3, -3, 1, 3, 3, 1, -1, -2, 3, 1, 2, 3, 0, 0, 15]
    triangles = [0, 1, 3, 0, 3, 2, 1, 2, 4, 1, 4, 3, 2, 3, 5, 2, 5, 4, 3, 4, 6]
    triangles += [3, 6, 5, 4, 5, 0, 4, 0, 6, 5, 6, 1, 5, 1, 0, 6, 0, 2, 6, 2, 1]
    return read_only((np.array(positions, float).reshape(-1, 3), np.array(triangles, np.uint32).reshape(-1, 3)))


@pytest.fixture(scope="session")
def pretzel() -> Mesh:
    """Genus 2, 1 798 vertices."""
    return read_only(sample.pretzel(2, side=6))


@pytest.fixture(scope="session")
def large() -> Mesh:
    """Genus 3, 37 500 vertices: a solve takes some tenths of a second."""
    return read_only(sample.pretzel(3, side=24))


@pytest.fixture(scope="session")
def hierarchy(pretzel: Mesh) -> foliations.Hierarchy:
    return foliations.Hierarchy(*pretzel, coarsest=200)


@pytest.fixture(scope="session")
def large_hierarchy(large: Mesh) -> foliations.Hierarchy:
    return foliations.Hierarchy(*large)
