"""Harmonic measured foliations on triangle meshes.

    >>> foliation = foliations.solve("mesh.obj")    # or positions and triangles, or a mesh object
    >>> foliation.values             # one number for each edge
    >>> foliation.singularities()    # its zeros
    >>> foliations.plot(foliation)          # stripes along the leaves

:class:`Hierarchy` is the mesh with its coarser levels; solve on it as often as
you like.  :class:`Loops` are the closed curves that determine the class, and
:class:`Foliation` is the result.  Every failure is an :class:`Error`.
"""

from ._boundary import Progress, ProgressCallback, ProgressOption
from ._native import lib as _lib
from ._plot import plot
from ._threads import threads
from .atlas import Atlas
from .components import Component, ComponentFoliations, ComponentRow, Components, solve_components
from .cylinders import Cylinder, Cylinders
from .errors import (
    Cancelled,
    Element,
    Error,
    FoliationError,
    InternalError,
    LevelError,
    LimitWarning,
    LoopError,
    MeshError,
    MeshWarning,
    OptionsError,
    OutOfMemoryError,
    Status,
    UnsupportedError,
)
from .foliation import Foliation, Singularities, Singularity
from .forms import HarmonicForms
from .hierarchy import Design, Hierarchy, Level, even_design, memory_estimate, solve, suggest_marks
from .leaves import Leaf, Leaves
from .loops import Loops
from .meshes import MeshLike, RepairedMesh, as_mesh, read_mesh, repair
from .parameterization import Parameterization
from .quads import QuadMesh
from .report import ClassState, HistoryEntry, LevelReport, Report
from .rows import solve_row


def _version() -> str:
    number = _lib.hmf_version()
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


__version__ = _version()

__all__ = [
    "Atlas",
    "Cancelled",
    "ClassState",
    "Component",
    "ComponentFoliations",
    "ComponentRow",
    "Components",
    "Cylinder",
    "Cylinders",
    "Design",
    "Element",
    "Error",
    "Foliation",
    "FoliationError",
    "HarmonicForms",
    "Hierarchy",
    "HistoryEntry",
    "InternalError",
    "Leaf",
    "Leaves",
    "Level",
    "LevelError",
    "LevelReport",
    "LimitWarning",
    "LoopError",
    "Loops",
    "MeshError",
    "MeshLike",
    "MeshWarning",
    "OptionsError",
    "OutOfMemoryError",
    "Parameterization",
    "Progress",
    "ProgressCallback",
    "ProgressOption",
    "QuadMesh",
    "RepairedMesh",
    "Report",
    "Singularities",
    "Singularity",
    "Status",
    "UnsupportedError",
    "__version__",
    "as_mesh",
    "even_design",
    "memory_estimate",
    "plot",
    "read_mesh",
    "repair",
    "solve",
    "solve_components",
    "solve_row",
    "suggest_marks",
    "threads",
]
