"""Many meshes: a row in, a row out, in other processes as well."""

from __future__ import annotations

import pickle
import warnings
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import foliations
import numpy as np
import pytest
from conftest import Mesh
from foliations import sample, solve_row
from foliations.export import Drawing, save

# Columns that differ from run to run.
TIMES = ("build_seconds", "solve_seconds")


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    """Five meshes, of which the last is a file that does not exist, and the one before has a triangle twice."""
    folder = tmp_path_factory.mktemp("meshes")
    meshes = [sample.pretzel(genus, side=4) for genus in (1, 2, 3)]
    meshes.append((meshes[0][0], np.vstack([meshes[0][1], meshes[0][1][:1]])))
    result = []
    for number, mesh in enumerate(meshes):
        save(folder / f"{number}.off", Drawing(*mesh))
        result.append({"id": number, "mesh": str(folder / f"{number}.off")})
    return [*result, {"id": 4, "mesh": "no_such.off"}]


def check(results: list[dict[str, Any]], rows: list[dict[str, Any]]) -> None:
    results = sorted(results, key=lambda result: int(result["id"]))
    for result, row in zip(results, rows):
        for name, value in solve_row(row).items():
            if name not in TIMES:
                assert result[name] == value or (value != value and result[name] != result[name]), name
    assert len(results) == len(rows)


def test_columns(rows: list[dict[str, Any]]) -> None:
    results = [solve_row(row) for row in rows]
    assert [result["ok"] for result in results] == [True, True, True, False, False]
    assert [result["genus"] for result in results] == [1, 2, 3, -1, -1]
    assert [result["zeros"] for result in results] == [0, 4, 8, -1, -1]
    assert [result["error"] for result in results] == ["", "", "", "MeshError", "FileNotFoundError"]
    assert [result["status"] for result in results] == ["OK", "OK", "OK", "ERROR_MESH_NON_MANIFOLD_EDGE", ""]
    assert "no_such.off" in results[4]["message"]
    expected = foliations.solve(rows[1]["mesh"])
    assert results[1]["energy"] == expected.energy and results[1]["converged"]
    for result in results:
        assert list(result) == list(results[0])
        assert [type(value) for value in result.values()] == [type(value) for value in results[0].values()]


def test_the_row_is_left_alone_and_carried_on(pretzel: Mesh) -> None:
    row = {"name": "x", "positions": pretzel[0], "triangles": pretzel[1], "weights": [1, 2]}
    before = dict(row)
    result = solve_row(row)
    assert row == before and result["name"] == "x" and "positions" not in result and "weights" not in result
    assert result["energy"] == foliations.solve(*pretzel, weights=[1, 2]).energy
    pickle.dumps(result)


def test_options(pretzel: Mesh, tmp_path: Path) -> None:
    row = {"mesh": pretzel, "loops": "pants", "coarsest": 200.0, "method": None, "time_limit": float("nan")}
    result = solve_row(row, tolerance=1e-4, with_values=True, save=tmp_path / "a.npz", export=tmp_path / "a.glb")
    hierarchy = foliations.Hierarchy(*pretzel, coarsest=200)
    expected = hierarchy.solve(hierarchy.loops("pants"), tolerance=1e-4)
    assert np.array_equal(result["values"], expected.values)
    assert np.array_equal(foliations.Foliation.load(tmp_path / "a.npz", hierarchy), expected)
    assert (tmp_path / "a.glb").stat().st_size > 10_000
    as_lists = {"positions": pretzel[0].tolist(), "triangles": pretzel[1].tolist(), "loops": [[0, 1, 2]]}
    assert solve_row(as_lists)["error"] == "LoopError"
    nested = np.empty(len(pretzel[0]), dtype=object)
    nested[:] = list(pretzel[0])
    assert solve_row({"positions": nested, "triangles": pretzel[1]})["ok"]
    assert solve_row({"mesh": pretzel}, weights=[1, -1])["error"] == "LoopError"
    assert "no mesh" in solve_row({})["message"]
    with pytest.raises(TypeError, match="tolerence"):
        solve_row({"mesh": pretzel}, tolerence=1)


def test_several_components_are_named(pretzel: Mesh) -> None:
    two = np.vstack([pretzel[0], pretzel[0] + 10]), np.vstack([pretzel[1], pretzel[1] + len(pretzel[0])])
    result = solve_row({"mesh": two})
    assert not result["ok"] and result["status"] == "ERROR_MESH_COMPONENTS" and result["class"] == ""
    assert "solve_components" in result["message"]
    rows = [row.row for row in foliations.solve_components(*two)]
    assert [row["ok"] for row in rows] == [True, True]
    assert set(rows[0]) - set(result) == {"component", "boundaries"}


def test_a_limit_is_a_column_and_no_warning(large: Mesh) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = solve_row({"mesh": large}, method="whitehead", iteration_limit=1)
    assert result["ok"] and not result["converged"] and result["status"] == "LIMIT_ITERATIONS" and result["message"]
    with pytest.warns(foliations.LimitWarning):
        foliations.solve(*large, method="whitehead", iteration_limit=1)


def test_control_c_comes_through(pretzel: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("foliations.rows.as_mesh", interrupt)
    with pytest.raises(KeyboardInterrupt):
        solve_row({"mesh": pretzel})


def test_concurrent_futures(rows: list[dict[str, Any]]) -> None:
    with ThreadPoolExecutor(2) as pool:
        check(list(pool.map(solve_row, rows)), rows)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        check(list(processes.map(partial(solve_row, method="newton"), rows)), rows)


def test_dask(rows: list[dict[str, Any]]) -> None:
    bag = pytest.importorskip("dask.bag")
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster):
            check(bag.from_sequence(rows, npartitions=2).map(solve_row).compute(), rows)


def test_ray_data(rows: list[dict[str, Any]]) -> None:
    ray = pytest.importorskip("ray")
    data = pytest.importorskip("ray.data")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, ignore_reinit_error=True)
    try:
        check(data.from_items(rows).map(solve_row).take_all(), rows)
    finally:
        ray.shutdown()
