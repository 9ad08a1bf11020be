"""Critical leaves, black, cut the surface into cylinders, which the other leaves fill."""

import foliations
from foliations import sample

foliation = foliations.solve(*sample.pretzel(genus=2, side=16), weights=[1, 2])
for number, cylinder in enumerate(foliation.cylinders()):
    print(f"cylinder {number}: height {cylinder.height:g}, circumference {cylinder.circumference:.3f}")
leaves = foliation.trace(spacing=0.06, critical=True)
leaves.export("leaves.vtp")  # for ParaView
foliations.plot(foliation, leaves=leaves).figure.savefig("leaves.png")
