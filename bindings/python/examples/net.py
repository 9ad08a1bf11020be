"""Leaves and conjugate leaves: two families that cross at right angles."""

import foliations
from foliations import sample

foliation = foliations.solve(*sample.pretzel(genus=3, side=12))
net = [foliation.trace(leaves=family, spacing=0.05) for family in ("foliation", "conjugate")]
foliations.plot(foliation, leaves=net).figure.savefig("net.png")
