"""Time of a solve in Python, and the share of it that is not the library's.

    python overhead.py [side of the pretzel, default 45: 103 400 vertices]

Each run is compared with the seconds that the library itself reports for the
same call (`Report.solve_seconds`), and a build with a call of hmf_hierarchy_create on
arrays that are already right, both in processor time.  Best of seven.
"""

import sys
import time

import foliations
from foliations import sample
from foliations._native import ffi, lib


def best(function, inner=lambda result: None, clock=time.perf_counter, rounds=7):
    """Least time of some rounds, with what ``inner`` makes of its result; that is freed outside the time."""
    results = []
    for _ in range(rounds):
        start = clock()
        result = function()
        results.append((clock() - start, inner(result)))
        del result
    return min(results, key=lambda pair: pair[0])


def build_directly(positions, triangles):
    out = ffi.new("hmf_hierarchy **")
    p = ffi.cast("double *", positions.ctypes.data)
    t = ffi.cast("uint32_t *", triangles.ctypes.data)
    start = time.process_time()
    status = lib.hmf_hierarchy_create(p, len(positions), t, len(triangles), ffi.NULL, ffi.NULL, out, ffi.NULL)
    seconds = time.process_time() - start
    assert status == 0
    lib.hmf_hierarchy_destroy(out[0])
    return seconds


def main():
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 45
    positions, triangles = sample.pretzel(2, side=side)
    print(f"{len(positions)} vertices, {3 * len(triangles) // 2} edges")

    direct = min(build_directly(positions, triangles) for _ in range(7))
    build, _ = best(lambda: foliations.Hierarchy(positions, triangles), clock=time.process_time)
    print(f"build      {build:.4f} s, hmf_hierarchy_create alone {direct:.4f} s: overhead {100 * (build / direct - 1):+.2f} %")

    hierarchy = foliations.Hierarchy(positions, triangles)
    for name, progress in (("solve", None), ("solve with a callback", lambda fraction: None)):
        total, inner = best(
            lambda progress=progress: hierarchy.solve(progress=progress),
            lambda foliation: foliation.report.solve_seconds,
        )
        print(f"{name:10} {total:.4f} s, library {inner:.4f} s: overhead {100 * (total / inner - 1):+.2f} %")

    foliation = hierarchy.solve()
    for name in ("residuals", "singularities", "parameterize"):
        total, _ = best(getattr(foliation, name))
        print(f"{name:13} {total:.4f} s")


if __name__ == "__main__":
    main()
