"""A mesh of trimesh, and the foliation as colors on it."""

import foliations
import numpy as np
import trimesh
from foliations import sample

mesh = trimesh.Trimesh(*sample.pretzel(genus=1, side=10), process=False)
mesh.apply_transform(trimesh.transformations.rotation_matrix(0.5, [1, 0, 0]))
foliation = foliations.solve(mesh)  # meshes of meshio, pyvista and Open3D as well, or a file name
# How steep the foliation is at each vertex: the mean of its values over the lengths of the edges.
edges = foliation.hierarchy.levels[0].edges
slope = foliation.values / np.linalg.norm(mesh.vertices[edges[:, 0]] - mesh.vertices[edges[:, 1]], axis=1)
mean = np.bincount(edges.ravel(), np.repeat(slope, 2)) / np.bincount(edges.ravel())
mesh.visual.vertex_colors = trimesh.visual.interpolate(mean, "viridis")
mesh.export("objects.ply")
foliations.plot(foliation, zeros=False).figure.savefig("objects.png")
