import foliations
from foliations import sample

# Any closed triangle mesh will do: (n, 3) floats and (m, 3) integers.
positions, triangles = sample.pretzel(genus=2, side=16)

foliation = foliations.solve(positions, triangles)
print(foliation.values)  # one number for each edge
print(foliation.hierarchy.levels[0].edges)  # the vertices of each edge
print("largest residual:", foliation.residuals().max())
for zero in foliation.singularities():
    print(f"zero of order {-zero.index} at {zero.kind} {zero.element}")

picture = foliations.plot(foliation)
picture.figure.savefig("stripes.png")
print("The picture is in stripes.png.")
