"""Callbacks, interrupts, bars, and the interpreter lock."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any

import foliations
import numpy as np
import pytest
from foliations import _boundary

from conftest import Mesh


@pytest.fixture(autouse=True)
def each_call(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_boundary, "PROGRESS_INTERVAL", 0.0)


def test_fractions_rise_to_one(pretzel: Mesh) -> None:
    seen: list[float] = []
    foliations.solve(*pretzel, coarsest=200, progress=seen.append)
    assert len(seen) > 10
    assert seen == sorted(seen) and seen[0] >= 0 and 0.9 < seen[-1] <= 1


def test_a_callback_does_not_change_the_result(hierarchy: foliations.Hierarchy) -> None:
    watched = hierarchy.solve(progress=lambda fraction: foliations.Progress.CONTINUE)
    assert np.array_equal(watched.values, hierarchy.solve().values)


def calls_of(hierarchy: foliations.Hierarchy) -> int:
    seen: list[float] = []
    hierarchy.solve(progress=seen.append)
    return len(seen)


def test_an_exception_in_each_call(hierarchy: foliations.Hierarchy) -> None:
    class Mine(Exception):
        pass

    expected = hierarchy.solve().values
    count = calls_of(hierarchy)
    for last in {*range(0, count, max(1, count // 60)), count - 1}:
        seen: list[float] = []

        def callback(fraction: float, seen: list[float] = seen, last: int = last) -> None:
            seen.append(fraction)
            if len(seen) > last:
                raise Mine(last)

        with pytest.raises(Mine) as caught:
            hierarchy.solve(progress=callback)
        assert caught.value.args == (last,)
        assert len(seen) == last + 1, "called again after an exception"
        assert caught.traceback[-1].name == "callback"
    assert np.array_equal(hierarchy.solve().values, expected)


def test_an_exception_in_each_call_of_the_build(pretzel: Mesh) -> None:
    seen: list[float] = []
    foliations.Hierarchy(*pretzel, progress=seen.append)
    for last in {*range(0, len(seen), max(1, len(seen) // 40)), len(seen) - 1}:
        left = [last]

        def callback(fraction: float, left: list[int] = left) -> None:
            left[0] -= 1
            if left[0] < 0:
                raise StopIteration

        with pytest.raises(StopIteration):
            foliations.Hierarchy(*pretzel, progress=callback)


@pytest.mark.parametrize("answer", ["yes", 3, -1, 0.5])
def test_other_answers_are_refused(hierarchy: foliations.Hierarchy, answer: object) -> None:
    with pytest.raises(TypeError, match="foliations.Progress"):
        hierarchy.solve(progress=lambda fraction: answer)  # type: ignore[arg-type, return-value]


def test_progress_is_a_function(hierarchy: foliations.Hierarchy) -> None:
    with pytest.raises(TypeError, match="progress must be"):
        hierarchy.solve(progress="bar")  # type: ignore[arg-type]


def test_cancel(hierarchy: foliations.Hierarchy, pretzel: Mesh) -> None:
    with pytest.raises(foliations.Cancelled) as caught:
        hierarchy.solve(progress=lambda fraction: foliations.Progress.CANCEL)
    assert caught.value.status is foliations.Status.CANCELLED and caught.value.foliation is None
    with pytest.raises(foliations.Cancelled):
        foliations.Hierarchy(*pretzel, progress=lambda fraction: foliations.Progress.CANCEL)


def test_finish_gives_a_foliation(hierarchy: foliations.Hierarchy) -> None:
    """Whenever it is said, what comes back is closed, without poles and in the class."""
    loops = hierarchy.loops(level=0)
    reports: list[float] = []
    hierarchy.solve(loops, progress=reports.append)
    count = len(reports)
    stopped = 0
    for last in range(0, count, max(1, count // 20)):
        seen: list[float] = []

        def callback(fraction: float, seen: list[float] = seen, last: int = last) -> foliations.Progress:
            seen.append(fraction)
            return foliations.Progress.FINISH if len(seen) > last else foliations.Progress.CONTINUE

        foliation = hierarchy.solve(loops, progress=callback)
        found = foliation.singularities()
        assert foliation.level == 0 and not found.poles and found.index_sum == -4
        if foliation.status is foliations.Status.CANCELLED:
            stopped += 1
            # Of the same class: relaxing it leads to the same minimum.
            if stopped in (1, 5):
                assert foliation.relax().energy == pytest.approx(hierarchy.solve(loops).energy, rel=1e-9)
    assert stopped > 5


def test_finish_during_the_build_cancels(pretzel: Mesh) -> None:
    with pytest.raises(foliations.Cancelled):
        foliations.Hierarchy(*pretzel, progress=lambda fraction: foliations.Progress.FINISH)


#: Every call that can be long, on a solved foliation; what it makes is compared by its text.
LONG_CALLS: dict[str, Callable[[foliations.Foliation, Any], object]] = {
    "loops": lambda f, progress: f.hierarchy.loops(level=0, progress=progress),
    "initialize": lambda f, progress: f.hierarchy.initialize(progress=progress),
    "foliation": lambda f, progress: f.hierarchy.foliation(f.values, progress=progress),
    "relax": lambda f, progress: f.relax(progress=progress),
    "interpolate": lambda f, progress: f.interpolate(2, progress=progress),
    "residuals": lambda f, progress: f.residuals(progress=progress),
    "singularities": lambda f, progress: f.singularities(progress=progress),
    "parameterize": lambda f, progress: f.parameterize(progress=progress),
    "trace": lambda f, progress: f.trace(spacing=0.1, progress=progress),
    "cylinders": lambda f, progress: f.cylinders(f.hierarchy.loops(), progress=progress),
    "quads": lambda f, progress: f.quads(progress=progress),
    "atlas": lambda f, progress: f.atlas(progress=progress),
}


@pytest.mark.parametrize("name", LONG_CALLS)
def test_each_long_call_reports_cancels_and_raises(hierarchy: foliations.Hierarchy, name: str) -> None:

    def function(progress: Any) -> object:
        # Each time on a new foliation, for these keep what they have made.
        return LONG_CALLS[name](hierarchy.solve(), progress)

    seen: list[float] = []
    expected = repr(function(seen.append))
    assert seen and seen == sorted(seen) and seen[0] >= 0 and seen[-1] == 1
    assert repr(function(None)) == expected
    with pytest.raises(foliations.Cancelled):
        function(lambda fraction: foliations.Progress.CANCEL)

    def boom(fraction: float) -> None:
        raise LookupError("in the callback")

    with pytest.raises(LookupError, match="in the callback"):
        function(boom)
    # Also where the call succeeds before it could react.
    left = [len(seen)]

    def late(fraction: float) -> None:
        left[0] -= 1
        if left[0] == 0:
            raise LookupError

    with pytest.raises(LookupError):
        function(late)


@pytest.mark.parametrize("name", LONG_CALLS)
def test_finish_cancels_what_cannot_be_stopped_early(hierarchy: foliations.Hierarchy, name: str) -> None:
    function, foliation = LONG_CALLS[name], hierarchy.solve()
    if name == "relax":
        assert isinstance(function(foliation, lambda fraction: foliations.Progress.FINISH), foliations.Foliation)
    else:
        with pytest.raises(foliations.Cancelled):
            function(foliation, lambda fraction: foliations.Progress.FINISH)


@pytest.mark.skipif(sys.platform == "win32", reason="no timer signals")
@pytest.mark.parametrize("action", ["build", "solve", "relax"])
def test_an_interrupt_stops_a_call_without_callback(
    large: Mesh, large_hierarchy: foliations.Hierarchy, action: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Early enough for the fastest call, 20 ms; it does not matter if the call has not begun.
    monkeypatch.setattr(_boundary, "PROGRESS_INTERVAL", 0)
    start = large_hierarchy.initialize(large_hierarchy.loops(level=0))
    previous = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_REAL, 0.002)
            if action == "build":
                foliations.Hierarchy(*large)
            elif action == "solve":
                large_hierarchy.solve()
            else:
                start.relax()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)


def test_the_lock_is_released(large_hierarchy: foliations.Hierarchy) -> None:
    """With a switch interval of an hour another thread runs only if the solving one lets go of the lock."""
    started, ended = threading.Event(), threading.Event()

    def work() -> None:
        started.set()
        large_hierarchy.solve()
        ended.set()

    interval = sys.getswitchinterval()
    thread = threading.Thread(target=work)
    sys.setswitchinterval(3600)
    try:
        thread.start()
        started.wait()
        assert not ended.is_set()
    finally:
        sys.setswitchinterval(interval)
        thread.join()


@pytest.mark.parametrize("installed", [True, False])
def test_bar(
    pretzel: Mesh, installed: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if installed:
        pytest.importorskip("tqdm")
    else:
        monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    foliations.solve(*pretzel, progress=True)
    captured = capsys.readouterr()
    assert captured.out == "" and "foliations:" in captured.err and "100%" in captured.err


def test_a_bar_says_what_is_done(hierarchy: foliations.Hierarchy, capsys: pytest.CaptureFixture[str]) -> None:
    hierarchy.solve(progress=True).quads(progress=True)
    captured = capsys.readouterr().err
    assert "foliations solve:" in captured and "foliations quads:" in captured


def test_silent_by_default(pretzel: Mesh, capfd: pytest.CaptureFixture[str]) -> None:
    foliations.solve(*pretzel)
    captured = capfd.readouterr()
    assert captured.out == "" and captured.err == ""


def test_a_bar_ends_with_an_exception(torus: Mesh, capsys: pytest.CaptureFixture[str]) -> None:
    turned = torus[1].copy()
    turned[0] = turned[0, ::-1]
    with pytest.raises(foliations.MeshError):
        foliations.solve(torus[0], turned, progress=True)
    assert "100%" not in capsys.readouterr().err


def test_an_interrupt_ends_the_process_as_usual(pretzel: Mesh) -> None:
    program = (
        "import foliations, os, signal\n"
        "from foliations import sample\n"
        "mesh = sample.pretzel(2)\n"
        "foliations.solve(*mesh, progress=lambda fraction: os.kill(os.getpid(), signal.SIGINT))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=600)
    assert "KeyboardInterrupt" in done.stderr and done.returncode != 0
    assert "From cffi callback" not in done.stderr
