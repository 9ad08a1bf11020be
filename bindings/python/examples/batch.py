"""Many foliations at once: one thread for each core, all on one hierarchy.

The library releases the interpreter lock, so that threads run in parallel;
a hierarchy is immutable, so that they can share it.  Control-C stops them all.
"""

import threading
from concurrent.futures import ThreadPoolExecutor

import foliations
import matplotlib.pyplot as plt
import numpy as np
from foliations import sample

hierarchy = foliations.Hierarchy(*sample.pretzel(genus=3, side=12))
loops = hierarchy.loops("cut")
stop = threading.Event()


def watch(fraction: float) -> foliations.Progress:
    # Signals reach the main thread only; this brings them to the others.
    return foliations.Progress.CANCEL if stop.is_set() else foliations.Progress.CONTINUE


def energy(weights: np.ndarray) -> float:
    return hierarchy.solve(loops, weights, progress=watch).energy


def main() -> None:
    weights = np.random.default_rng(0).uniform(1, 4, size=(24, len(loops)))
    with ThreadPoolExecutor() as pool:
        try:
            energies = list(pool.map(energy, weights))
        except KeyboardInterrupt:
            stop.set()
            raise
    for row, result in zip(weights, energies):
        print(row.round(3), "->", round(result, 6))
    figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
    ax.plot(np.square(weights).sum(axis=1), energies, "o")
    ax.set(xlabel="sum of the squared weights", ylabel="energy")
    figure.savefig("batch.png")


if __name__ == "__main__":
    main()
