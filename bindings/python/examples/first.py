import foliations

hierarchy = foliations.Hierarchy("pretzel.obj")
# Around the left arm: any points near the surface, or numbers of vertices.
loops = foliations.Loops.through(hierarchy, [(0, 1.5, 0.5), (0.5, 1.5, 1), (1, 1.5, 0.5), (0.5, 1.5, 0)])
foliation = hierarchy.solve(loops)
print(foliation.report)
foliations.plot(foliation, loops=loops).figure.savefig("first.png")
foliation.export("first.glb")
foliation.save("first.npz")
