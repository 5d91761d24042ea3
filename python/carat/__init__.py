"""Discrete differential operators on polygon and polyhedral meshes.

Gradients, divergences, Laplacians, stiffness and mass matrices on any polygonal surface mesh and
any polyhedral volume mesh, and what people need them for: Poisson's equation, geodesic distance,
mean curvature, eigenmodes.

>>> import carat
>>> V = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
>>> S, M = carat.stiffness(V, [[0, 1, 2, 3]])      # scipy.sparse, S positive semidefinite
>>> mesh = carat.generate("sphere-hexagons", level=3)  # or carat.read("gear.obj")
>>> d = carat.HeatGeodesics(mesh).distance(0)
>>> lam, U = carat.eigenmodes(mesh, k=5)

Values are those of the vertices. Stiffness and laplacian (= -stiffness) are integrated; their
pointwise form is a solve with the mass.
"""

import atexit as _atexit

from . import _core
from ._curvature import mean_curvature
from ._eigenmodes import Eigenmodes, eigenmodes
from ._errors import (
    DegenerateElement,
    Error,
    InvalidMesh,
    InvalidOption,
    InvalidType,
    IoError,
    SolverFailure,
)
from ._files import Family, FileFormat, View, families, formats, generate, read, show, write
from ._foreign import as_mesh
from ._geodesics import HeatGeodesics
from ._mesh import Mesh, PolygonMesh, PolyhedralMesh
from ._operators import (
    Discretization,
    Finding,
    OperatorInfo,
    discretize,
    operators,
    stiffness,
)
from ._poisson import Poisson, SolveReport

__version__: str = _core.version

# Work that Ctrl-C left to itself must not outlive the memory it uses.
_atexit.register(_core.wait_for_abandoned)

__all__ = [
    "DegenerateElement",
    "Discretization",
    "Eigenmodes",
    "Error",
    "Family",
    "FileFormat",
    "Finding",
    "HeatGeodesics",
    "InvalidMesh",
    "InvalidOption",
    "InvalidType",
    "IoError",
    "Mesh",
    "OperatorInfo",
    "Poisson",
    "PolygonMesh",
    "PolyhedralMesh",
    "SolveReport",
    "SolverFailure",
    "View",
    "__version__",
    "as_mesh",
    "discretize",
    "eigenmodes",
    "families",
    "formats",
    "generate",
    "mean_curvature",
    "operators",
    "read",
    "show",
    "stiffness",
    "write",
]

# Where things are found, as help(), tracebacks and pickles should say.
for _name in __all__:
    if getattr(globals()[_name], "__module__", "").startswith("carat._"):
        globals()[_name].__module__ = "carat"
