"""Results: laws that every harmonic foliation obeys, on meshes of several genera."""

from __future__ import annotations

import pickle
import warnings
from pathlib import Path
from typing import get_args

import foliations
import foliations.hierarchy
import numpy as np
import pytest
from foliations import sample
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from conftest import Mesh


def check_foliation(foliation: foliations.Foliation) -> None:
    """Closed and without poles."""
    level = foliation.hierarchy.levels[foliation.level]
    sides = np.sort(foliation.values[level.triangle_edges], axis=1)
    assert (sides[:, 0] + sides[:, 1] >= sides[:, 2]).all()
    found = foliation.singularities()
    assert not found.poles
    assert found.index_sum == 4 - 4 * foliation.hierarchy.genus


def check_harmonic(foliation: foliations.Foliation, tolerance: float = 1e-8) -> None:
    check_foliation(foliation)
    assert foliation.converged and foliation.status is foliations.Status.OK
    assert foliation.residuals().max() <= tolerance


@pytest.mark.parametrize("genus", [1, 2, 3, 5])
def test_one_line(genus: int) -> None:
    positions, triangles = sample.pretzel(genus, side=4)
    foliation = foliations.solve(positions, triangles)
    assert foliation.hierarchy.genus == genus
    assert foliation.values.shape == (3 * len(triangles) // 2,) and foliation.values.dtype == np.float64
    check_harmonic(foliation)


def test_torus_of_revolution_is_turned_evenly() -> None:
    """By symmetry each of the n steps around the axis has the same value, 1 / n."""
    around, along = 12, 40
    a, b = (grid.ravel() for grid in np.meshgrid(np.arange(around), np.arange(along), indexing="ij"))
    angle_a, angle_b = 2 * np.pi * a / around, 2 * np.pi * b / along
    radius = 3 + np.cos(angle_a)
    positions = np.stack([radius * np.cos(angle_b), radius * np.sin(angle_b), np.sin(angle_a)], axis=1)

    def vertex(i: np.ndarray, j: np.ndarray) -> np.ndarray:
        return i % around * along + j % along

    corners = [vertex(a, b), vertex(a, b + 1), vertex(a + 1, b + 1), vertex(a + 1, b)]
    triangles = np.concatenate([np.stack([corners[k] for k in t], axis=1) for t in ((0, 2, 1), (0, 3, 2))])
    hierarchy = foliations.Hierarchy(positions, triangles)
    meridian = vertex(np.arange(around), np.zeros(around, int))
    foliation = hierarchy.solve([meridian])
    check_harmonic(foliation)
    i, j = np.divmod(hierarchy.levels[0].edges.astype(np.int64), along)
    turns = i[:, 0] == i[:, 1]
    assert turns.sum() == around * along
    assert np.abs(along * foliation.values[turns] - 1).max() < 1e-7
    stays = j[:, 0] == j[:, 1]
    assert np.abs(along * foliation.values[stays]).max() < 0.5


def test_levels(hierarchy: foliations.Hierarchy, pretzel: Mesh) -> None:
    levels = hierarchy.levels
    assert len(levels) > 1 and [level.number for level in levels] == list(range(len(levels)))
    assert np.array_equal(levels[0].positions, pretzel[0])
    assert np.array_equal(levels[0].triangles, pretzel[1])
    for finer, coarser in zip(levels, levels[1:]):
        assert coarser.edge_count < finer.edge_count
    for level in levels:
        assert level.vertex_count - level.edge_count + level.triangle_count == 2 - 2 * hierarchy.genus
        assert level.edges.shape == (level.edge_count, 2)
        assert level.weights.shape == (level.edge_count,)
        ends = np.sort(level.edges[level.triangle_edges], axis=2)
        corners = np.sort(np.stack([level.triangles, level.triangles[:, [1, 2, 0]]], axis=2), axis=2)
        assert np.array_equal(ends, corners)


def test_edges_are_numbered_by_first_appearance(hierarchy: foliations.Hierarchy, pretzel: Mesh) -> None:
    sides = np.stack([pretzel[1], pretzel[1][:, [1, 2, 0]]], axis=2).reshape(-1, 2)
    _, first = np.unique(np.sort(sides, axis=1), axis=0, return_index=True)
    assert np.array_equal(np.sort(hierarchy.levels[0].edges, axis=1), np.sort(sides[np.sort(first)], axis=1))


def test_energy_is_the_sum_over_the_edges(hierarchy: foliations.Hierarchy) -> None:
    level = hierarchy.levels[1]
    foliation = hierarchy.solve(stop_level=1)
    assert foliation.level == 1
    assert foliation.energy == pytest.approx(float(level.weights @ foliation.values**2), rel=1e-12)
    assert foliation.report is not None and foliation.report.energy == pytest.approx(foliation.energy, rel=1e-12)


def test_the_minimum_is_below_the_start(hierarchy: foliations.Hierarchy) -> None:
    loops = hierarchy.loops(level=0)
    start, end = hierarchy.initialize(loops), hierarchy.solve(loops)
    check_foliation(start)
    assert set(np.unique(start.values)) <= {0.0, 1.0, 2.0}
    assert end.energy < start.energy
    relaxed = start.relax()
    check_harmonic(relaxed)
    assert relaxed.energy == pytest.approx(end.energy, rel=1e-10)
    assert np.abs(relaxed.values - end.values).max() < 1e-6


def test_interpolate_there_and_back(hierarchy: foliations.Hierarchy) -> None:
    coarse = hierarchy.solve(stop_level=2)
    fine = coarse.interpolate(0)
    check_foliation(fine)
    assert np.array_equal(fine.interpolate(2).values, coarse.values)


@pytest.mark.parametrize("method", ["newton", "whitehead", "single_level"])
def test_methods_agree(hierarchy: foliations.Hierarchy, method: foliations._options.Method) -> None:
    # Loops of the finest level: single_level takes no others by itself.
    loops = hierarchy.loops(level=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", foliations.LimitWarning)
        foliation = hierarchy.solve(loops, method=method)
    check_foliation(foliation)
    assert foliation.report is not None and foliation.report.method == method
    assert foliation.energy == pytest.approx(hierarchy.solve(loops).energy, rel=1e-3)


def test_weights_scale(hierarchy: foliations.Hierarchy) -> None:
    one, four = hierarchy.solve(), hierarchy.solve(weights=[4, 4])
    assert np.array_equal(4 * one.values, four.values)
    assert four.energy == pytest.approx(16 * one.energy)


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(exponents=st.tuples(st.floats(-6, 6), st.floats(-6, 6)))
def test_random_weights(hierarchy: foliations.Hierarchy, exponents: tuple[float, float]) -> None:
    """Each weight gives a harmonic foliation, and turning one weight to the other's place is the same class."""
    weights = 2.0 ** np.array(exponents)
    loops = hierarchy.loops()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        foliation = hierarchy.solve(loops, weights)
    check_harmonic(foliation)
    turned = foliations.Loops([loops[1], loops[0]], kind="triangles", level=loops.level, weights=weights[::-1])
    assert np.allclose(hierarchy.solve(turned).values, foliation.values, rtol=0, atol=1e-5 * weights.max())


def test_loops(hierarchy: foliations.Hierarchy) -> None:
    loops = hierarchy.loops("cut")
    assert len(loops) == hierarchy.genus and loops.level == 0 and loops.kind == "triangles"
    assert loops.offsets[-1] == len(loops.elements)
    assert [loop.tolist() for loop in loops] == [loops[0].tolist(), loops[-1].tolist()]
    assert loops.weights.tolist() == [1.0, 1.0]
    heavy = loops.with_weights([1, 3])
    assert heavy[1:].weights.tolist() == [3.0] and heavy[1:][0].tolist() == loops[1].tolist()
    assert np.array_equal(hierarchy.solve(heavy[1:]).values, hierarchy.solve([*loops][1:2] and heavy[1:]).values)
    with pytest.raises(IndexError):
        loops[2]
    with pytest.raises(ValueError, match="triangles, vertices"):
        foliations.Loops([[0, 1, 2]], kind="edges")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="must be one of"):
        hierarchy.loops("knot")  # type: ignore[arg-type]


def test_each_kind_of_loops(hierarchy: foliations.Hierarchy) -> None:
    for kind in get_args(foliations.hierarchy.LoopsKind):
        loops = hierarchy.loops(kind)
        assert len(loops) >= hierarchy.genus
        check_harmonic(hierarchy.solve(loops))


def test_paths_of_vertices(hierarchy: foliations.Hierarchy) -> None:
    """A loop of triangles is homotopic to the vertices on its left."""
    loops = hierarchy.loops(level=0)
    triangles = hierarchy.levels[0].triangles
    path: list[int] = []
    ring = loops[0]
    for here, there in zip(ring, np.roll(ring, -1)):
        first, second = (int(v) for v in triangles[here] if v in triangles[there])
        # Of the two ends of the edge that is crossed, the one on the left.
        place = triangles[here].tolist().index(first)
        left = first if triangles[here][(place + 1) % 3] == second else second
        if not path or path[-1] != left:
            path.append(left)
    by_triangles, by_vertices = hierarchy.solve(loops[:1]), hierarchy.solve([path])
    assert np.abs(by_triangles.values - by_vertices.values).max() < 1e-6


def test_report(hierarchy: foliations.Hierarchy) -> None:
    report = hierarchy.solve().report
    assert report is not None
    assert report.method == "newton" and report.converged and report.residual_max <= 1e-8
    assert [entry.vertex_count for entry in report.levels] == [level.vertex_count for level in hierarchy.levels]
    assert sum(entry.linear_solve_count for entry in report.levels) > 0
    assert report.history and {entry.kind for entry in report.history} <= {"interpolation", "sweep", "linear solve"}
    assert all(a.seconds <= b.seconds for a, b in zip(report.history, report.history[1:]))
    assert report.history[-1].energy == pytest.approx(report.energy)
    assert report.zeros == -sum(zero.index for zero in hierarchy.solve().singularities().zeros) == 4
    assert (report.poles, report.index_sum) == (0, -4)


def test_a_report_is_printed_on_several_lines(hierarchy: foliations.Hierarchy) -> None:
    report = hierarchy.solve().report
    lines = str(report).splitlines()
    assert len(lines) == 4 + len(hierarchy.levels) and max(map(len, lines)) < 80
    assert "newton: converged" in lines[0] and "4 zeros" in lines[1]
    for number, level in enumerate(hierarchy.levels):
        assert lines[4 + number].split()[:3] == [str(number), str(level.vertex_count), str(level.edge_count)]


def test_singularities_have_positions(hierarchy: foliations.Hierarchy) -> None:
    level = hierarchy.levels[0]
    found = hierarchy.solve().singularities()
    assert len(found) > 1 and found.positions.shape == (len(found), 3)
    for zero, place in zip(found, found.positions):
        assert zero.position == tuple(place)
        own = level.triangles[zero.element] if zero.kind == "triangle" else [zero.element]
        if zero.kind == "cluster":
            own = np.flatnonzero(found.vertex_cluster == zero.element)
            assert len(own) == zero.size > 1
        assert np.allclose(place, level.positions[own].mean(axis=0))


def test_values_are_multiples_of_the_unit(hierarchy: foliations.Hierarchy) -> None:
    foliation = hierarchy.solve(weights=[1, 3])
    assert np.frexp(foliation.unit)[0] == 0.5
    assert (foliation.values / foliation.unit % 1 == 0).all()


@pytest.mark.parametrize("level", [0, 2])
def test_saved_and_loaded(hierarchy: foliations.Hierarchy, pretzel: Mesh, tmp_path: Path, level: int) -> None:
    foliation, file = hierarchy.solve(stop_level=level), tmp_path / "foliation"
    foliation.save(file)
    again = foliations.Foliation.load(str(file), hierarchy)
    assert np.array_equal(again.values, foliation.values)
    assert (again.level, again.status, again.report) == (level, foliation.status, None)
    assert again.energy == pytest.approx(foliation.energy, rel=1e-12)
    with pytest.raises(ValueError, match="one for each edge|triangles"):
        foliations.Foliation.load(file, foliations.Hierarchy(*sample.pretzel(2, side=5), coarsest=200))
    # The same counts, but other numbers.
    turned = foliations.Hierarchy(pretzel[0], pretzel[1][::-1], coarsest=200)
    with pytest.raises(ValueError):
        foliations.Foliation.load(file, turned)


@pytest.mark.parametrize("content", ["nothing", "text", "array", "archive"])
def test_loading_what_was_not_saved(hierarchy: foliations.Hierarchy, tmp_path: Path, content: str) -> None:
    file = tmp_path / "foliation.npz"
    if content == "array":
        with file.open("wb") as opened:
            np.save(opened, np.ones(5))
    elif content == "archive":
        np.savez(file, values=np.ones(5))
    else:
        file.write_text("" if content == "nothing" else "hello")
    with pytest.raises(ValueError, match="no file that"):
        foliations.Foliation.load(file, hierarchy)
    with pytest.raises(FileNotFoundError):
        foliations.Foliation.load(tmp_path / "none", hierarchy)


def test_a_limit_warns_and_gives_the_result(hierarchy: foliations.Hierarchy) -> None:
    with pytest.warns(foliations.LimitWarning, match="iteration_limit") as caught:
        foliation = hierarchy.solve(method="whitehead", iteration_limit=1)
    assert caught[0].filename == __file__
    assert foliation.status is foliations.Status.LIMIT_ITERATIONS and not foliation.converged
    check_foliation(foliation)
    with pytest.warns(foliations.LimitWarning) as caught:
        foliations.solve(
            hierarchy.levels[0].positions, hierarchy.levels[0].triangles, method="whitehead", iteration_limit=1
        )
    assert caught[0].filename == __file__
    with pytest.warns(foliations.LimitWarning) as caught:
        hierarchy.initialize(hierarchy.loops(level=0)).relax(method="whitehead", iteration_limit=1)
    assert caught[0].filename == __file__


def test_time_limit(large_hierarchy: foliations.Hierarchy) -> None:
    with pytest.warns(foliations.LimitWarning, match="time_limit"):
        foliation = large_hierarchy.solve(time_limit=1e-6)
    assert foliation.status is foliations.Status.LIMIT_TIME
    check_foliation(foliation)


def test_the_same_after_pickling(hierarchy: foliations.Hierarchy) -> None:
    foliation = hierarchy.solve()
    again = pickle.loads(pickle.dumps(foliation))
    assert np.array_equal(again.values, foliation.values) and again.report == foliation.report
    assert np.array_equal(again.hierarchy.solve().values, foliation.values)
    assert len(again.hierarchy.levels) == len(hierarchy.levels)


def test_results_can_be_pickled(hierarchy: foliations.Hierarchy) -> None:
    foliation = hierarchy.solve()
    for result in (
        foliation.singularities(),
        foliation.trace(spacing=0.1),
        foliation.cylinders(),
        foliation.quads(),
        foliation.parameterize(),
        hierarchy.loops(),
    ):
        again = pickle.loads(pickle.dumps(result))
        assert type(again) is type(result) and repr(again) == repr(result)
        for name, array in getattr(result, "__dict__", {}).items():
            if isinstance(array, np.ndarray):
                assert np.array_equal(getattr(again, name), array, equal_nan=array.dtype.kind in "fc")


def test_memory(hierarchy: foliations.Hierarchy, pretzel: Mesh) -> None:
    assert hierarchy.memory > 100 * hierarchy.levels[0].edge_count
    estimate = foliations.memory_estimate(len(pretzel[0]), len(pretzel[1]), coarsest=200)
    assert estimate >= hierarchy.memory
    foliations.Hierarchy(*pretzel, coarsest=200, memory_limit=estimate)
    assert foliations.memory_estimate(0, 0) == 0


def test_build_options(pretzel: Mesh) -> None:
    few, many = (
        foliations.Hierarchy(*pretzel, ratio=0.1, coarsest=200),
        foliations.Hierarchy(*pretzel, ratio=0.8, coarsest=200),
    )
    assert len(few.levels) < len(many.levels)
    for collapse in ("midpoint", "endpoint", "qslim"):
        check_harmonic(foliations.solve(*pretzel, coarsest=200, collapse=collapse))


def test_plates_have_the_sizes_of_the_contract() -> None:
    sizes = (((1, 1, 4, 4), 512, 1024), ((2, 1, 8, 7), 3006, 6016), ((3, 2, 15, 10), 20240, 40500))
    for size, vertices, triangles in sizes:
        points, corners = sample.plate(*size)
        assert (len(points), len(corners)) == (vertices, triangles)


def test_initial_values(hierarchy: foliations.Hierarchy, pretzel: Mesh) -> None:
    """The class comes from the values, also from those of another frame."""
    first = hierarchy.solve(weights=[1, 3])
    again = hierarchy.solve(initial=first)
    check_harmonic(again)
    assert again.energy == pytest.approx(first.energy, rel=1e-10)
    stretched = foliations.Hierarchy(pretzel[0] * [1.0, 1.2, 1.0], pretzel[1], coarsest=200)
    moved = stretched.solve(initial=first)
    check_harmonic(moved)
    # The same class: its energy is that of the first values carried over and relaxed.
    assert moved.energy == pytest.approx(stretched.foliation(first.values).relax().energy, rel=1e-8)
    with pytest.raises(ValueError, match="no loops"):
        hierarchy.solve(hierarchy.loops(), initial=first)
    with pytest.raises(ValueError, match="no weights"):
        hierarchy.solve(weights=[1, 3], initial=first)
    with pytest.raises(foliations.FoliationError):
        hierarchy.solve(initial=hierarchy.foliation(np.arange(len(first), dtype=float)))


def test_mollify_accepts_a_triangle_without_area(pretzel: Mesh) -> None:
    positions, triangles = pretzel[0].copy(), pretzel[1]
    a, b, c = triangles[100]
    positions[a] = (positions[b] + positions[c]) / 2
    with pytest.raises(foliations.MeshError) as caught:
        foliations.solve(positions, triangles)
    assert caught.value.status is foliations.Status.ERROR_MESH_DEGENERATE
    foliation = foliations.solve(positions, triangles, mollify=1e-5)
    check_foliation(foliation)
    assert foliation.converged
