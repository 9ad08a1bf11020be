"""A walk through the errors of the library: each that Python can reach is raised, and says nothing in words of C."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from typing import Any

import foliations
import numpy as np
import pytest
from conftest import Mesh
from foliations import Loops, Status, _boundary, sample

from test_errors import MESH_DEFECTS, changed, sphere
from test_everyday import without

C_WORDS = re.compile(
    r"\b(hmf|HMF)_|\bNULL\b|struct_size|sizeof|->|build options|stride|element_kind|_count\b|offsets\[|%[a-z]|optimis"
)
# No call of the package raises these.
UNREACHABLE = {
    "ERROR_NULL": "no pointer is NULL",
    "ERROR_MEMORY": "the allocator has to fail",
    "ERROR_MESH_UNUSED_VERTEX": "such vertices are dropped",
    "ERROR_MESH_NOT_DELAUNAY": "no mesh is known",
    "ERROR_INTERNAL": "a defect of the library",
    "LIMIT_CLASS": "no small mesh is known",
}
EARLY = ("time", "steps", "sweeps", "stalled")  # results, with a warning


def wound_torus() -> Mesh:
    """A torus that goes around twice, through itself."""
    n = 12
    i, j = (k.ravel() for k in np.mgrid[:n, :n])
    a, b = 2 * np.pi * i / n, 2 * np.pi * (j + 0.3) / n
    r = 3 + 0.5 * np.cos(a) + 0.6 * np.cos(b)
    points = np.stack([r * np.cos(2 * a), r * np.sin(2 * a), 0.6 * np.sin(b) + 0.15 * np.sin(a)], axis=1)
    at = lambda i, j: n * (i % n) + j % n  # noqa: E731
    square = np.stack([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], axis=1)
    return points, np.concatenate([square[:, [0, 1, 2]], square[:, [0, 2, 3]]])


def fan(triangles: np.ndarray, vertex: int) -> list[int]:
    """The triangles around a vertex, in their order."""
    following = {}
    for number, corners in enumerate(triangles.tolist()):
        if vertex in corners:
            k = corners.index(vertex)
            following[corners[(k + 1) % 3]] = (corners[(k + 2) % 3], number)
    first = at = next(iter(following))
    found = []
    while not found or at != first:
        at, number = following[at]
        found.append(number)
    return found


def calls(torus: Mesh, pretzel: Mesh) -> Iterator[tuple[str, Callable[[], Any]]]:
    build = foliations.Hierarchy
    for defect in MESH_DEFECTS:
        yield defect, lambda defect=defect: build(*changed(torus, defect), marked_vertices=[])
    flat = torus[0].copy()
    flat[1] = flat[0]
    yield "no area", lambda: build(flat, torus[1])
    yield "no extent", lambda: build(0 * flat, torus[1], mollify=1e-5)
    yield "no vertices", lambda: build(np.empty((0, 3)), np.empty((0, 3), int))
    for marks in ([0, 1, 2], [0, 1, 2, 4, 2], [0, 1, 2, 6]):
        yield f"marks {marks}", lambda marks=marks: build(*sphere(), marked_vertices=marks)
    half = sphere()[0], sphere()[1][:4]
    yield "disk", lambda: build(*half, marked_vertices=[])
    yield "closed", lambda: build(*without(pretzel, 100), closed=True)
    yield "memory", lambda: build(*pretzel, memory_limit=10_000)
    yield "components", lambda: foliations.Components(torus[0], torus[1] + 3)
    yield "no handles", lambda: build(*sphere()).loops("handle")
    yield "not embedded", lambda: build(*wound_torus()).loops("handle")

    hierarchy = build(*pretzel, coarsest=200)
    foliation = hierarchy.solve()
    triangles, edges = pretzel[1], hierarchy.levels[0].edges
    wrong_options: list[dict[str, Any]] = [
        {name: value}
        for name, values in {
            "tolerance": (0, 1, -1.0, np.nan), "energy_tolerance": (0, 2), "iteration_limit": (0,), "step_limit": (0,),
            "time_limit": (-1.0, np.inf), "stop_level": (99,),
        }.items()
        for value in values
    ]  # fmt: skip
    for options in [*wrong_options, {"method": "single_level", "stop_level": 1}]:
        yield f"solve {options}", lambda options=options: hierarchy.solve(**options)
    for options in ({"ratio": 2}, {"ratio": np.nan}, {"mollify": -1}, {"coarsest": 0}, {"memory_limit": 0}):
        yield f"build {options}", lambda options=options: build(*pretzel, **options)

    # Loops.
    ring = triangles[0].tolist()
    cut = hierarchy.loops()
    both = [cut[0], cut[0]]
    strips: Callable[..., Loops] = lambda paths, **more: Loops(paths, kind="triangles", **more)  # noqa: E731
    for name, loops in {
        "none": Loops([]), "no elements": Loops([[]]), "index": Loops([[0, 1, 99999]]),
        "no edge": Loops([[0, 900, 1700]]),
        "disk": Loops([ring]), "back": Loops([[int(edges[0, 0]), int(edges[0, 1])]]), "twice": strips(both),
        "arc": strips([cut[0]], arcs=[True]), "weight": cut.with_weights([1, -1]),
        "weights": cut.with_weights([1, 1e9]),
        "level": Loops([ring], level=99), "crosses itself": strips([np.concatenate(both)]),
        "cross": strips([cut[0], *(hierarchy.loops(kind)[0] for kind in ("tunnel", "handle"))]),
    }.items():  # fmt: skip
        yield f"loops: {name}", lambda loops=loops: hierarchy.solve(loops)
        yield f"initial loops: {name}", lambda loops=loops: hierarchy.initialize(loops)
    marked = build(*torus, marked_vertices=[0, 1])
    yield "marked vertex", lambda: marked.solve([[0, 1, 3]])
    yield "single marked vertex", lambda: marked.solve(Loops([fan(torus[1], 0)], kind="triangles"))

    # Values.
    values = foliation.values
    other: Callable[[int, float], Any] = lambda e, x: np.where(np.arange(len(values)) == e, x, values)  # noqa: E731
    pole = np.where((edges == 0).any(axis=1), 1.0, 0.0)
    for name, given in {
        "negative": other(5, -1), "infinite": other(5, np.inf), "zero": 0 * values, "tiny": 1e-280 * values,
        "not closed": other(5, 2 * values.sum()), "no unit": values * np.pi,
    }.items():  # fmt: skip
        yield f"values: {name}", lambda given=given: hierarchy.foliation(given)
    with_pole = hierarchy.foliation(pole)
    yield "pole: relax", with_pole.relax
    yield "pole: start", lambda: hierarchy.solve(initial=with_pole)
    yield "pole: cylinders", lambda: with_pole.cylinders(cut)
    start = hierarchy.initialize()
    yield "not harmonic", start.parameterize
    yield "not minimal", lambda: hierarchy.initialize("pants").interpolate(0).cylinders()
    yield "other loops", lambda: foliation.cylinders(hierarchy.loops("pants"))
    finer = build(*sample.pretzel(2, side=4), coarsest=100)
    yield "other mesh", lambda: hierarchy.solve(initial=finer.solve())
    yield "other level", lambda: finer.solve(initial=foliation.interpolate(1))
    for level in (99, 2**40):
        yield f"level {level}", lambda level=level: foliation.interpolate(level)
        yield f"loops of level {level}", lambda level=level: hierarchy.loops(level=level)
        yield f"values of level {level}", lambda level=level: hierarchy.foliation([], level=level)

    # Applications.
    for name, work in {
        "seams": lambda: foliation.parameterize(seam_edges=[10**6]),
        "tolerance": lambda: foliation.parameterize(tolerance=-1),
        "both sizes": lambda: foliation.quads(count=500, edge_length=0.1),
        "count": lambda: foliation.quads(count=10**12),
        "no leaf": lambda: start.quads(), "small": lambda: foliation.quads(edge_length=1e-9),
        "tiny": lambda: foliation.quads(edge_length=1e-300), "huge": lambda: foliation.quads(edge_length=1e300),
        "relax": lambda: foliation.quads(relax=10**6), "not a size": lambda: foliation.quads(edge_length=np.nan),
        "margin": lambda: foliation.atlas(margin=0.5),
        "spacing": lambda: foliation.trace(spacing=1e-12),
        "conjugate": lambda: foliation.trace(leaves="conjugate", spacing=1e-12),
        "not a spacing": lambda: foliation.trace(spacing=np.inf), "length": lambda: foliation.trace(length_limit=-1),
        "triangle": lambda: foliation.trace(point_triangles=[10**6], point_barycentrics=[[1, 0, 0]]),
        "sum": lambda: foliation.trace(point_triangles=[0], point_barycentrics=[[1, 1, 0]]),
        "design": lambda: foliations.even_design(*pretzel, solve_limit=0),
    }.items():  # fmt: skip
        yield f"applications: {name}", work

    # With boundary.
    open_mesh = build(*without(pretzel, 100), coarsest=200)
    solved = open_mesh.solve()
    upper = solved.interpolate(1)
    yield "boundary: handles", lambda: open_mesh.loops("handle")
    yield "boundary: forms", open_mesh.harmonic_forms
    yield "boundary: loops of a level", lambda: open_mesh.loops(level=1)
    yield "boundary: level of loops", lambda: open_mesh.solve(Loops([[0, 1, 2]], level=1))
    for name, work in {
        "quads": upper.quads, "atlas": upper.atlas, "parameterize": upper.parameterize,
        "cylinders": lambda: upper.cylinders(), "of values": lambda: open_mesh.foliation(solved.values).cylinders(),
    }.items():  # fmt: skip
        yield f"boundary: {name}", work
    for name, path in {"one vertex": [50], "inside": list(edges[len(edges) // 2])}.items():
        yield f"arc: {name}", lambda path=path: open_mesh.solve(Loops([path], arcs=[True]))

    # Ended early.
    yield "canceled", lambda: hierarchy.solve(progress=lambda fraction: foliations.Progress.CANCEL)
    yield "canceled build", lambda: build(*pretzel, progress=lambda fraction: foliations.Progress.CANCEL)
    yield "finished", lambda: hierarchy.solve(progress=lambda fraction: foliations.Progress.FINISH)
    yield "time", lambda: hierarchy.solve(time_limit=0)
    yield "steps", lambda: hierarchy.solve(step_limit=1, tolerance=1e-12)
    yield "sweeps", lambda: hierarchy.solve(method="whitehead", iteration_limit=1, tolerance=1e-12)
    yield "stalled", lambda: hierarchy.solve(tolerance=1e-300)


def test_every_error(torus: Mesh, pretzel: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    said: set[str] = set()

    def in_words(message: str, status: int, translate: Any = _boundary.in_words) -> str:
        said.add(message)
        return str(translate(message, status))

    monkeypatch.setattr(_boundary, "in_words", in_words)
    found = {Status.OK}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", foliations.MeshWarning)
        for name, work in calls(torus, pretzel):
            try:
                with pytest.warns(foliations.LimitWarning) if name in EARLY else nullcontext() as caught:
                    status = work().status
                text = str(caught[0].message) if caught else status.text
            except foliations.Error as error:
                status, text = error.status, str(error)
                assert not isinstance(error, foliations.InternalError), (name, text)
            assert status != Status.OK and len(text) > 20, (name, text)
            assert not C_WORDS.search(text), (name, text)
            found.add(status)
    assert {status.name for status in Status} - {status.name for status in found} == set(UNREACHABLE)
    assert len(said) > 60, len(said)
