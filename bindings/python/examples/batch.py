"""Many foliations at once: one thread for each core, all on one hierarchy.

The library releases the interpreter lock, so that threads run in parallel;
a hierarchy is immutable, so that they can share it.  Control-C stops them all.
"""

import threading
from concurrent.futures import ThreadPoolExecutor

import hmf
import numpy as np
from hmf import sample

hierarchy = hmf.Hierarchy(*sample.pretzel(genus=3, side=12))
loops = hierarchy.loops("cut")
stop = threading.Event()


def watch(fraction: float) -> hmf.Progress:
    # Signals reach the main thread only; this brings them to the others.
    return hmf.Progress.CANCEL if stop.is_set() else hmf.Progress.CONTINUE


def energy(weights: np.ndarray) -> float:
    return hierarchy.solve(loops, weights, progress=watch).energy


def main() -> None:
    weights = np.random.default_rng(0).uniform(1, 4, size=(24, len(loops)))
    with ThreadPoolExecutor() as pool:
        try:
            for row, result in zip(weights, pool.map(energy, weights)):
                print(row.round(3), "->", round(result, 6))
        except KeyboardInterrupt:
            stop.set()
            raise


if __name__ == "__main__":
    main()
