"""What arrays are accepted, what is copied, and what is refused with which advice."""

from __future__ import annotations

import gc

import foliations
import numpy as np
import pytest
from foliations import sample
from foliations._boundary import as_floats, as_indices, as_positions

from conftest import Mesh


def same(a: foliations.Foliation, b: foliations.Foliation) -> bool:
    return np.array_equal(a.values, b.values)


def shares(a: np.ndarray, b: np.ndarray) -> bool:
    return a.__array_interface__["data"][0] == b.__array_interface__["data"][0]


# --- Read in place -----------------------------------------------------------


def test_packed_positions_are_not_copied(pretzel: Mesh) -> None:
    assert shares(as_positions(pretzel[0]), pretzel[0])


def test_positions_with_a_stride_are_not_copied(pretzel: Mesh) -> None:
    wide = np.full((len(pretzel[0]), 8), np.nan)
    wide[:, 2:5] = pretzel[0]
    part = wide[:, 2:5]
    assert shares(as_positions(part), part) and as_positions(part).strides == (64, 8)
    assert same(foliations.solve(part, pretzel[1]), foliations.solve(*pretzel))


@pytest.mark.parametrize("dtype", [np.uint32, np.int32])
def test_32_bit_triangles_are_not_copied(pretzel: Mesh, dtype: type) -> None:
    triangles = pretzel[1].astype(dtype)
    assert shares(as_indices(triangles, "triangles", 3), triangles)


def test_values_leave_without_a_copy(hierarchy: foliations.Hierarchy) -> None:
    foliation = hierarchy.solve()
    assert np.asarray(foliation) is foliation.values
    assert hierarchy.levels[0].weights is hierarchy.levels[0].weights


# --- Copied ------------------------------------------------------------------


@pytest.mark.parametrize(
    "change",
    [
        lambda v: v.tolist(),
        np.asfortranarray,
        lambda v: v[::-1][::-1],
        lambda v: np.repeat(v, 2, axis=1)[:, ::2],
        lambda v: v.astype(">f8"),
        lambda v: v.astype(object).astype(np.float64),
        lambda v: np.frombuffer(b"x" + v.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(-1, 3),
    ],
    ids=["list", "fortran", "reversed twice", "columns", "big endian", "object", "unaligned"],
)
def test_positions_of_any_layout(pretzel: Mesh, change: object) -> None:
    assert same(foliations.solve(change(pretzel[0]), pretzel[1]), foliations.solve(*pretzel))  # type: ignore[operator]


def test_unaligned_arrays_are_copied(pretzel: Mesh) -> None:
    def unaligned(array: np.ndarray) -> np.ndarray:
        moved = np.frombuffer(b"x" + array.tobytes(), dtype=np.uint8)[1:].view(array.dtype).reshape(array.shape)
        assert not moved.flags.aligned
        return moved

    positions, triangles = (unaligned(array) for array in pretzel)
    assert as_positions(positions).flags.aligned and as_indices(triangles, "triangles", 3).flags.aligned
    assert as_floats(positions[:, 0], len(positions), "values", "vertex").flags.aligned
    assert same(foliations.solve(positions, triangles), foliations.solve(*pretzel))


def test_positions_with_rows_backwards(pretzel: Mesh) -> None:
    backwards = np.ascontiguousarray(pretzel[0][::-1])[::-1]
    assert backwards.strides[0] < 0
    assert same(foliations.solve(backwards, pretzel[1]), foliations.solve(*pretzel))


def test_float32_positions(pretzel: Mesh) -> None:
    low = pretzel[0].astype(np.float32)
    assert same(foliations.solve(low, pretzel[1]), foliations.solve(low.astype(np.float64), pretzel[1]))


@pytest.mark.parametrize("dtype", [np.int64, np.uint64, np.int32, np.uint16, ">i4"])
def test_triangles_of_any_integers(pretzel: Mesh, dtype: str) -> None:
    assert same(foliations.solve(pretzel[0], pretzel[1].astype(dtype)), foliations.solve(*pretzel))
    assert same(foliations.solve(pretzel[0], np.asfortranarray(pretzel[1].astype(dtype))), foliations.solve(*pretzel))


def test_values_and_weights_with_strides(hierarchy: foliations.Hierarchy) -> None:
    values = hierarchy.solve().values
    again = hierarchy.foliation(np.repeat(values, 2)[::2])
    assert again.energy == hierarchy.solve().energy
    weights = np.array([1.0, 9.0, 2.0, 9.0])[::2]
    assert same(hierarchy.solve(weights=weights), hierarchy.solve(weights=[1, 2]))


def test_inputs_are_not_kept(pretzel: Mesh) -> None:
    positions, triangles = pretzel[0].copy(), pretzel[1].copy()
    hierarchy = foliations.Hierarchy(positions, triangles)
    expected = hierarchy.solve()
    positions[:] = np.nan
    triangles[:] = 0
    assert same(hierarchy.solve(), expected)
    values = expected.values.copy()
    foliation = hierarchy.foliation(values)
    values[:] = 0
    assert same(foliation, expected)


def test_results_are_memory_of_the_library(hierarchy: foliations.Hierarchy) -> None:
    """Not copies, and kept by the arrays alone."""
    foliation = foliations.solve(*sample.pretzel(2, side=5))
    found, leaves, cylinders = foliation.singularities(), foliation.trace(spacing=0.1), foliation.cylinders()
    mesh, uv, loops = foliation.quads(), foliation.parameterize(), foliation.hierarchy.loops()
    arrays = [foliation.values, found.positions, found.vertex_index, leaves.points, leaves.offsets, mesh.positions]
    arrays += [uv.corner_uv, uv.seam, uv.differential, loops.elements, cylinders.leaves.elements, loops[-1]]
    copies = [array.copy() for array in arrays]
    for array in arrays:
        base = array
        while isinstance(base, np.ndarray):
            base = base.base
        assert type(base).__module__ == "foliations._boundary"
        with pytest.raises(ValueError, match="cannot set WRITEABLE"):
            array.setflags(write=True)
    del foliation, found, leaves, cylinders, mesh, uv, loops
    gc.collect()
    # What was freed too early would be written over.
    foliations.solve(*sample.pretzel(3, side=5)).parameterize()
    for array, copy in zip(arrays, copies):
        assert np.array_equal(array, copy, equal_nan=True)


def test_results_are_read_only(hierarchy: foliations.Hierarchy) -> None:
    foliation, level = hierarchy.solve(), hierarchy.levels[0]
    found = foliation.singularities()
    arrays = [foliation.values, level.positions, level.edges, level.triangles, level.triangle_edges, level.weights]
    arrays += [found.vertex_index, found.triangle_index, found.vertex_cluster, hierarchy.loops().elements]
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


# --- Refused -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("positions", "advice"),
    [
        (np.zeros(9), r"shape \(n, 3\)"),
        (np.zeros((4, 2)), "three coordinates"),
        (np.zeros((3, 50)), "transpose"),
        (np.zeros((2, 2, 3)), "three coordinates"),
    ],
)
def test_shape_of_positions(torus: Mesh, positions: np.ndarray, advice: str) -> None:
    with pytest.raises(ValueError, match=advice):
        foliations.solve(positions, torus[1])


@pytest.mark.parametrize(
    ("triangles", "advice"),
    [
        (np.zeros(9, int), r"shape \(n, 3\)"),
        (np.zeros((5, 4), int), "two triangles"),
        (np.zeros((3, 50), int), "transpose"),
    ],
)
def test_shape_of_triangles(torus: Mesh, triangles: np.ndarray, advice: str) -> None:
    with pytest.raises(ValueError, match=advice):
        foliations.solve(torus[0], triangles)


@pytest.mark.parametrize("dtype", [complex, str, object, bool, "M8[s]"])
def test_dtype_of_positions(torus: Mesh, dtype: str) -> None:
    with pytest.raises(TypeError, match="real numbers"):
        foliations.solve(np.zeros((7, 3)).astype(dtype), torus[1])


@pytest.mark.parametrize("dtype", [float, np.float32, complex, bool, object])
def test_dtype_of_triangles(torus: Mesh, dtype: type) -> None:
    with pytest.raises(TypeError, match="integers"):
        foliations.solve(torus[0], torus[1].astype(dtype))


@pytest.mark.parametrize("dtype", [np.int64, np.int32, np.int8])
def test_negative_index(torus: Mesh, dtype: type) -> None:
    triangles = torus[1].astype(dtype)
    triangles[5, 1] = -1
    with pytest.raises(foliations.MeshError, match="vertex -1") as caught:
        foliations.solve(torus[0], triangles)
    assert (caught.value.status, caught.value.element, caught.value.index) == (
        foliations.Status.ERROR_MESH_INDEX,
        foliations.Element.TRIANGLE,
        5,
    )


def test_index_above_32_bits(torus: Mesh) -> None:
    triangles = torus[1].astype(np.int64)
    triangles[3, 0] += 2**32
    with pytest.raises(foliations.MeshError, match="does not exist"):
        foliations.solve(torus[0], triangles)


def test_values_and_weights_of_the_wrong_shape(hierarchy: foliations.Hierarchy) -> None:
    with pytest.raises(ValueError, match="one for each edge"):
        hierarchy.foliation(np.ones(5))
    with pytest.raises(ValueError, match="one for each loop"):
        hierarchy.solve(weights=[1, 2, 3])
    with pytest.raises(TypeError, match="real numbers"):
        hierarchy.solve(weights=["1", "2"])


@pytest.mark.parametrize(
    "options",
    [
        {"method": "simplex"},
        {"method": 3},
        {"stop_level": -99},
        {"stop_level": 0.5},
        {"iteration_limit": -3},
        {"iteration_limit": 2**64},
        {"tolerance": 2.0},
        {"time_limit": -1.0},
        {"ratio": 2.0},
        {"coarsest": -1},
        {"collapse": "random"},
        {"memory_limit": -1},
    ],
    ids=str,
)
def test_options_out_of_range(torus: Mesh, options: dict[str, object]) -> None:
    with pytest.raises(ValueError):
        foliations.solve(*torus, **options)  # type: ignore[arg-type]


def test_a_choice_names_the_others(torus: Mesh) -> None:
    with pytest.raises(ValueError, match="newton, paper, single_level, whitehead"):
        foliations.solve(*torus, method="simplex")  # type: ignore[arg-type]
