"""A quad mesh along the leaves, irregular only at the zeros."""

import foliations
from foliations import sample

foliation = foliations.solve(*sample.pretzel(genus=2, side=12))
quads = foliation.quads(edge_length=0.12)
print(len(quads.quads), "quads,", len(quads.positions), "vertices")
quads.export("quads.obj")
foliations.plot(foliation, quads=quads).figure.savefig("quads.png")
