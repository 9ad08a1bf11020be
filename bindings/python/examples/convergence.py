"""Three methods on one mesh: the energy above its minimum, over time."""

import foliations
import matplotlib.pyplot as plt
from foliations import sample

hierarchy = foliations.Hierarchy(*sample.pretzel(genus=2, side=10))
loops = hierarchy.loops(level=0)
minimum = hierarchy.solve(loops, tolerance=1e-11).energy
figure, ax = plt.subplots(figsize=(7, 4.5), layout="constrained")
for method in ("newton", "whitehead", "single_level"):
    steps = hierarchy.solve(loops, method=method).report.history
    finest = [step for step in steps if step.level == 0 and step.energy > 0]
    ax.loglog(
        [step.seconds for step in finest],
        [max(step.energy / minimum - 1, 1e-13) for step in finest],
        ".-",
        label=method,
    )
ax.set(xlabel="seconds", ylabel="energy / minimum - 1")
ax.legend()
figure.savefig("convergence.png")
