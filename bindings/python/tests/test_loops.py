"""Loops that people give: picked, drawn, written to files."""

from __future__ import annotations

from pathlib import Path

import foliations
import numpy as np
import pytest

from conftest import Mesh


@pytest.fixture(scope="module")
def ring(pretzel: Mesh) -> list[int]:
    """Four vertices around the left arm of the pretzel: outside, on top, in the hole, below."""
    positions = pretzel[0]
    middle = np.abs(positions[:, 1] - np.median(positions[:, 1])) < 0.1
    left = np.flatnonzero(middle & (positions[:, 0] < positions[:, 0].min() + 1.2))
    sides = positions[left]
    x, z = sides[:, 0], sides[:, 2]
    return [int(left[place]) for place in (x.argmin(), z.argmax(), x.argmax(), z.argmin())]


def length(points: np.ndarray) -> float:
    return float(np.linalg.norm(points - np.roll(points, -1, axis=0), axis=1).sum())


def test_through_picked_vertices(hierarchy: foliations.Hierarchy, ring: list[int]) -> None:
    loops = foliations.Loops.through(hierarchy, ring, weights=[2.0])
    assert len(loops) == 1 and loops.kind == "vertices" and loops.level == 0 and loops.weights.tolist() == [2.0]
    path = loops[0].tolist()
    assert path[0] == ring[0] and set(ring) <= set(path)
    edges = {frozenset(edge) for edge in hierarchy.levels[0].edges.tolist()}
    assert all(frozenset(pair) in edges for pair in zip(path, path[1:] + path[:1]))
    foliation = hierarchy.solve(loops)
    assert foliation.converged and foliation.cylinders(loops)[0].height == 2.0


def test_through_picked_points(hierarchy: foliations.Hierarchy, ring: list[int]) -> None:
    """Near the vertices is enough."""
    points = hierarchy.levels[0].positions[ring] + [0.01, 0.01, -0.01]
    by_points, by_vertices = (foliations.Loops.through(hierarchy, picked) for picked in (points, ring))
    assert by_points[0].tolist() == by_vertices[0].tolist()
    assert foliations.Loops.through(hierarchy, points.tolist())[0].tolist() == by_vertices[0].tolist()
    with pytest.raises(ValueError, match="finite"):
        foliations.Loops.through(hierarchy, points * np.nan)
    with pytest.raises(ValueError, match="three"):
        foliations.Loops.through(hierarchy, points[:2])


def test_paths_are_shortest(hierarchy: foliations.Hierarchy, ring: list[int]) -> None:
    """Against distances by relaxing all edges until nothing changes."""
    mesh = hierarchy.levels[0]
    sizes = np.linalg.norm(mesh.positions[mesh.edges[:, 0]] - mesh.positions[mesh.edges[:, 1]], axis=1)
    total = 0.0
    for start, goal in zip(ring, ring[1:] + ring[:1]):
        distance = np.full(mesh.vertex_count, np.inf)
        distance[start] = 0
        for _ in range(mesh.vertex_count):
            before = distance.copy()
            for a, b in (mesh.edges.T, mesh.edges.T[::-1]):
                np.minimum.at(distance, b, before[a] + sizes)
            if np.array_equal(before, distance):
                break
        total += distance[goal]
    (points,) = foliations.Loops.through(hierarchy, ring).positions(hierarchy)
    assert length(points) == pytest.approx(total, rel=1e-12)


def test_picked_vertices_beside_the_way(hierarchy: foliations.Hierarchy, ring: list[int]) -> None:
    """A path there and back is pulled tight: the class is the same."""
    top = np.argmax(hierarchy.levels[0].positions[:, 1])
    aside = foliations.Loops.through(hierarchy, [ring[0], int(top), ring[0], *ring[1:]])
    difference = hierarchy.solve(aside).values - hierarchy.solve(foliations.Loops.through(hierarchy, ring)).values
    assert np.abs(difference).max() < 1e-6


def test_there_and_back_is_no_loop(hierarchy: foliations.Hierarchy, ring: list[int]) -> None:
    with pytest.raises(foliations.LoopError, match="goes back the way it came"):
        hierarchy.solve(foliations.Loops.through(hierarchy, ring[:3]))


@pytest.mark.parametrize("picked", [[], [3, 4], [3, 4, 3], [3, 4, 10**6], [3, 4, -1]])
def test_wrong_picks(hierarchy: foliations.Hierarchy, picked: list[int]) -> None:
    with pytest.raises(ValueError, match="pick|exist|index"):
        foliations.Loops.through(hierarchy, picked)


def relaxed(mesh: foliations.Level, odd: np.ndarray, start: int) -> float:
    """The shortest closed path from here that has crossed the edges `odd` an odd number of times: by relaxing all."""
    sizes = np.linalg.norm(mesh.positions[mesh.edges[:, 0]] - mesh.positions[mesh.edges[:, 1]], axis=1)
    distance = np.full((2, mesh.vertex_count), np.inf)
    distance[0, start] = 0
    while True:
        before = distance.copy()
        for a, b in (mesh.edges.T, mesh.edges.T[::-1]):
            for sheet in (0, 1):
                np.minimum.at(distance, (sheet ^ odd.astype(int), b), before[sheet, a] + sizes)
        if np.array_equal(before, distance):
            return float(distance[1, start])


def test_through_handles(hierarchy: foliations.Hierarchy) -> None:
    """The shortest closed path that crosses a loop, against every start; crossings are counted by the cylinders."""
    mesh = hierarchy.levels[0]
    handles = hierarchy.loops("handle", level=0)
    for number in range(2):
        crossing = handles[number : number + 1]
        loops = foliations.Loops.through(hierarchy, crossing=crossing)
        odd = np.zeros(mesh.edge_count, dtype=bool)
        around = mesh.triangle_edges[crossing[0]]
        for here, there in zip(around, np.roll(around, -1, axis=0)):
            odd[np.intersect1d(here, there)] ^= True
        path = loops[0].tolist()
        (points,) = loops.positions(hierarchy)
        index = {frozenset(edge): i for i, edge in enumerate(mesh.edges.tolist())}
        assert sum(odd[index[frozenset(pair)]] for pair in zip(path, path[1:] + path[:1])) % 2 == 1
        starts = np.unique(mesh.edges[odd, 0])[:: max(1, odd.sum() // 8)]
        lengths = [relaxed(mesh, odd, int(start)) for start in starts]
        assert length(points) <= min(lengths) * (1 + 1e-12)
        assert relaxed(mesh, odd, path[0]) == pytest.approx(length(points), rel=1e-12)
        for start, least in zip(starts[:3], lengths):
            (picked,) = foliations.Loops.through(hierarchy, [start], crossing=crossing).positions(hierarchy)
            assert length(picked) == pytest.approx(least, rel=1e-12)
        assert hierarchy.solve(loops).converged


def test_through_two_handles(hierarchy: foliations.Hierarchy, ring: list[int]) -> None:
    handles = hierarchy.loops("handle", level=0)
    (both,) = foliations.Loops.through(hierarchy, crossing=handles).positions(hierarchy)
    singles = [foliations.Loops.through(hierarchy, crossing=handles[i : i + 1]).positions(hierarchy)[0] for i in (0, 1)]
    assert length(both) >= max(map(length, singles))
    # Through two points and both handles: no longer than any other way to put it together.
    (picked,) = foliations.Loops.through(hierarchy, ring[:2], crossing=handles).positions(hierarchy)
    assert length(picked) >= length(both)
    with pytest.raises(ValueError, match="level 0"):
        foliations.Loops.through(hierarchy, crossing=hierarchy.loops("handle", level=1))
    with pytest.raises(ValueError, match="pick"):
        foliations.Loops.through(hierarchy)


def test_several_loops_at_once(hierarchy: foliations.Hierarchy, ring: list[int]) -> None:
    positions = hierarchy.levels[0].positions
    mirrored = positions[ring] * [-1, 1, 1] + [positions[:, 0].min() + positions[:, 0].max(), 0, 0]
    other = [int(np.linalg.norm(positions - place, axis=1).argmin()) for place in mirrored]
    loops = foliations.Loops.through(hierarchy, ring, other, weights=[1, 3])
    assert len(loops) == 2 and hierarchy.solve(loops).converged


@pytest.mark.parametrize("kind", ["vertices", "triangles"])
def test_the_first_element_may_be_repeated(hierarchy: foliations.Hierarchy, ring: list[int], kind: str) -> None:
    loops = foliations.Loops.through(hierarchy, ring) if kind == "vertices" else hierarchy.loops(level=0)
    path = loops[0].tolist()
    closed = foliations.Loops([[*path, path[0]]], kind=loops.kind)
    assert closed[0].tolist() == path
    assert np.array_equal(hierarchy.solve(closed).values, hierarchy.solve(loops[:1]).values)


@pytest.mark.parametrize("level", [0, 2])
def test_positions(hierarchy: foliations.Hierarchy, ring: list[int], level: int) -> None:
    by_vertices = foliations.Loops.through(hierarchy, ring)
    assert np.array_equal(by_vertices.positions(hierarchy)[0], hierarchy.levels[0].positions[by_vertices[0]])
    loops, mesh = hierarchy.loops(level=level), hierarchy.levels[level]
    for loop, points in zip(loops, loops.positions(hierarchy)):
        assert points.shape == (len(loop), 3)
        for triangle, point, before in zip(loop, points, np.roll(points, 1, axis=0)):
            corners = mesh.positions[mesh.triangles[triangle]]
            middles = (corners + np.roll(corners, -1, axis=0)) / 2
            # A point of a loop lies on the side to the next triangle, the one before on that to the last.
            for place in (point, before):
                assert np.abs(middles - place).sum(axis=1).min() < 1e-12
    with pytest.raises(ValueError, match="share no edge"):
        foliations.Loops([[0, 5, 99]], kind="triangles").positions(hierarchy)


def test_saved_and_loaded(hierarchy: foliations.Hierarchy, ring: list[int], tmp_path: Path) -> None:
    file = tmp_path / "loops.txt"
    for loops in (foliations.Loops.through(hierarchy, ring), hierarchy.loops(level=0).with_weights([1, 0.1])):
        loops.save(file)
        again = foliations.Loops.load(str(file))
        assert (again.kind, again.level) == (loops.kind, 0) and again.weights.tolist() == loops.weights.tolist()
        assert [loop.tolist() for loop in again] == [loop.tolist() for loop in loops]
    assert foliations.Loops.load(file, weights=[2, 3]).weights.tolist() == [2, 3]
    assert file.read_text().splitlines()[1].startswith("t: ")
    with pytest.raises(ValueError, match="level 0"):
        hierarchy.loops(level=1).save(file)


def test_files_as_people_write_them(tmp_path: Path) -> None:
    file = tmp_path / "loops.txt"
    file.write_text("# by hand\n\n 1, 2,3 1 # closed\r\nv:\t4 5 6\n")
    loops = foliations.Loops.load(file)
    assert loops.kind == "vertices" and [loop.tolist() for loop in loops] == [[1, 2, 3], [4, 5, 6]]
    assert loops.weights.tolist() == [1, 1]
    file.write_text("t:1 2 3\nt: 7 8 9")
    assert foliations.Loops.load(file).kind == "triangles"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3\nt: 1 2 3\n", "one way"),
        ("1 2 3\n1 2.5 3\n", "line 2"),
        ("one two\n", "line 1"),
        ("1 -2 3\n", "index"),
        ("# --weights 1,2\n1 2 3\n", "one for each loop"),
        ("# --weights heavy\n1 2 3\n", "line 1"),
        ("t:\n", "without numbers"),
        ("# nothing\n", "no loops"),
    ],
)
def test_files_that_cannot_be_read(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "loops.txt"
    file.write_text(text)
    with pytest.raises(ValueError, match=message):
        foliations.Loops.load(file)
