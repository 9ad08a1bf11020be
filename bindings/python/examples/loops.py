"""Loops made by the library, and the foliations that belong to them."""

import foliations
import matplotlib.pyplot as plt
from foliations import sample

hierarchy = foliations.Hierarchy(*sample.pretzel(genus=2, side=10))
figure, axes = plt.subplots(2, 2, figsize=(11, 7), layout="constrained")
for ax, kind in zip(axes.flat, ("cut", "handle", "tunnel", "pants")):
    loops = hierarchy.loops(kind, level=0)
    foliations.plot(hierarchy.solve(loops), ax=ax, loops=loops, view=(0.2, -0.5, 1), stripes=50)
    ax.set_title(f'loops("{kind}")')
figure.savefig("loops.png")
