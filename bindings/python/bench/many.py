"""Throughput of solve_row over 1 000 meshes: one process against several.

    python many.py [meshes] [processes]

Seconds of the clock and of the processors, and meshes a second.  On a busy machine only the processor seconds say
something: they show what the processes and the copies cost beside the solves.
"""

import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor

import foliations
from foliations import sample


def mesh_rows(count: int) -> list[dict]:
    rows = []
    for n in range(count):
        positions, triangles = sample.pretzel(genus=1 + n % 4, side=4 + n // 4 % 6)
        # No two are the same.
        rows.append({"number": n, "positions": positions * (1 + n / count, 1, 1), "triangles": triangles})
    return rows


def processor_seconds() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    processes = int(sys.argv[2]) if len(sys.argv) > 2 else os.cpu_count() or 1
    rows = mesh_rows(count)
    print(f"{count} meshes, {sum(len(r['triangles']) for r in rows) // count} triangles each on average")
    energies = []
    for workers in (1, processes):
        clock, processor = time.perf_counter(), processor_seconds()
        if workers == 1:
            results = [foliations.solve_row(row) for row in rows]
        else:
            with ProcessPoolExecutor(workers) as pool:
                results = list(pool.map(foliations.solve_row, rows, chunksize=16))
        clock, processor = time.perf_counter() - clock, processor_seconds() - processor
        assert all(result["ok"] for result in results)
        energies.append([result["energy"] for result in results])
        print(f"{workers} processes: {clock:.2f} s, {processor:.2f} s of processors, {count / clock:.0f} meshes a second")
    assert energies[0] == energies[-1], "the same bits in each process"


if __name__ == "__main__":
    main()
