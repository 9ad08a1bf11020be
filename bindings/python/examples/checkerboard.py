"""The global conformal parameterization: squares of (u, v), and how far it is from conformal."""

import foliations
import matplotlib.pyplot as plt
from foliations import sample

foliation = foliations.solve(*sample.pretzel(genus=2, side=16))
print(foliation.parameterize())
figure, axes = plt.subplots(2, 1, figsize=(7, 8), layout="constrained")
foliations.plot(foliation, ax=axes[0], pattern="checkerboard", stripe_color="#34547a")
foliations.plot(foliation, ax=axes[1], pattern="dilatation")
axes[1].set_title("dilatation, 1 (light) to 2 (dark)")
figure.savefig("checkerboard.png")
foliation.export("checkerboard.glb", pattern="checkerboard")  # for Blender, a browser, ...
