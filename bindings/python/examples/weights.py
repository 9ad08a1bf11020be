"""The same two loops with other weights: how the foliation changes."""

import foliations
import matplotlib.pyplot as plt
from foliations import sample

hierarchy = foliations.Hierarchy(*sample.pretzel(genus=2, side=10))
loops = hierarchy.loops("handle")
figure, axes = plt.subplots(3, 1, figsize=(6, 9), layout="constrained")
for ax, weights in zip(axes, ([1, 1], [1, 2], [1, 4])):
    foliation = hierarchy.solve(loops, weights)
    foliations.plot(foliation, ax=ax, stripes=50)
    ax.set_title(f"weights {weights}, energy {foliation.energy:.3f}")
figure.savefig("weights.png")
