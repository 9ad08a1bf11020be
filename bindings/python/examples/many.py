"""Many meshes, one process for each core; a mesh that cannot be solved is a row as well."""

from concurrent.futures import ProcessPoolExecutor
from functools import partial

import foliations
import matplotlib.pyplot as plt
from foliations import sample


def main() -> None:
    rows = []
    for genus in (1, 2, 3, 4):
        for side in (4, 5, 6, 7):
            positions, triangles = sample.pretzel(genus, side=side)
            rows.append({"side": side, "positions": positions, "triangles": triangles})
    rows.append({"side": 0, "positions": positions, "triangles": triangles[1:]})  # with a hole
    with ProcessPoolExecutor() as pool:
        results = list(pool.map(partial(foliations.solve_row, loops="handle"), rows))
    for result in results:
        print(result["genus"], result["side"], f"{result['energy']:.4f}", result["error"], result["message"])
    solved = [result for result in results if result["ok"]]
    figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
    dots = ax.scatter(
        [result["vertices"] for result in solved],
        [result["energy"] for result in solved],
        c=[result["genus"] for result in solved],
    )
    ax.set(xlabel="vertices", ylabel="energy")
    figure.colorbar(dots, label="genus", ticks=[1, 2, 3, 4])
    figure.savefig("many.png")


if __name__ == "__main__":
    main()
