"""Files, families of test meshes, and views."""

from __future__ import annotations

import html
import os
import tempfile
import webbrowser
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats
from ._errors import InvalidOption, InvalidType
from ._foreign import as_mesh
from ._mesh import Mesh, PolygonMesh, PolyhedralMesh
from ._operators import _number, _whole

PathLike = Union[str, "os.PathLike[str]"]


def _path(path: PathLike) -> str:
    try:
        given = os.fspath(path)
    except TypeError:
        raise InvalidType(f"path: {type(path).__name__}; expected a string or a path") from None
    if isinstance(given, bytes):
        return os.fsdecode(given)
    return given


def read(path: PathLike) -> Mesh:
    """Reads a surface or volume mesh with its fields.

    Parameters
    ----------
    path : str or path
        OBJ, OFF, PLY, STL, VTK, VTP; VTU, OVM, Medit, Gmsh or an OpenFOAM case (its folder).
        What a file is is found from its content.

    Returns
    -------
    PolygonMesh or PolyhedralMesh
        A volume if the file has three-dimensional cells. Fields are in `vertex_data` and
        `face_data` or `cell_data`, named parts of the boundary in `patches`. Vertices and faces
        keep the file's order.

    Raises
    ------
    IoError
        Missing, damaged or of no known format; names the path and line.
    InvalidMesh
        What it holds is no mesh.
    """
    core, vertex, element, patches = _core.read(_path(path))
    if isinstance(core, _core.PolygonMesh):
        return PolygonMesh._of(core, vertex, element)
    return PolyhedralMesh._of(
        core,
        vertex,
        element,
        {name: faces for name, (_, faces) in patches.items()},
        {name: kind for name, (kind, _) in patches.items()},
    )


def write(
    path: PathLike,
    mesh: Any,
    *,
    vertex: Optional[Mapping[str, Any]] = None,
    face: Optional[Mapping[str, Any]] = None,
    cell: Optional[Mapping[str, Any]] = None,
) -> None:
    """Writes a mesh with fields. The file appears when it is complete.

    Parameters
    ----------
    path : str or path
        The extension says the format: see :func:`formats`.
    mesh : PolygonMesh, PolyhedralMesh, or a mesh of another package
        The mesh.
    vertex, face, cell : dict, optional
        Named values, (n,) or (n, k), to be written; default: the mesh's own.

    Raises
    ------
    IoError
        No known format, or the file cannot be written.
    InvalidOption
        A field that does not fit, or fields in a format without any.
    """
    mesh = as_mesh(mesh)
    at = _path(path)
    fields = _fields_of(mesh, vertex, face, cell)
    if vertex or face or cell:
        extension = os.path.splitext(at)[1].lower()
        for known in formats():
            if extension in known.extensions and not known.fields:
                raise InvalidOption(
                    f"{at}: {known.title} files hold no fields; write .vtp, .vtu or .ply, or leave"
                    " the fields out"
                )
    _core.write(at, mesh._core, *fields, _patches_of(mesh))


Named = list[tuple[str, Floats]]


def _fields_of(
    mesh: Mesh,
    vertex: Optional[Mapping[str, Any]],
    face: Optional[Mapping[str, Any]],
    cell: Optional[Mapping[str, Any]],
) -> tuple[Named, Named]:
    def named(given: Optional[Mapping[str, Any]], own: Any, what: str, n: int, of: str) -> Named:
        chosen = own if given is None else given
        if not isinstance(chosen, Mapping):
            raise InvalidType(
                f'{what}: {type(chosen).__name__}; expected named arrays, e.g. {{"u": u}}'
            )
        return [
            (str(name), _arrays.field(values, n, f'{what} "{name}"', of))
            for name, values in chosen.items()
        ]

    at_vertices = named(vertex, mesh.vertex_data, "vertex", mesh.n_vertices, "vertices")
    if isinstance(mesh, PolygonMesh):
        if cell is not None:
            raise InvalidOption("cell: a surface has no cells; give its faces' values as face=")
        return at_vertices, named(face, mesh.face_data, "face", mesh.n_faces, "faces")
    if face is not None:
        raise InvalidOption("face: volumes carry fields of vertices and cells; give cell=")
    return at_vertices, named(cell, mesh.cell_data, "cell", mesh.n_cells, "cells")


def _patches_of(mesh: Mesh) -> list[tuple[str, str, npt.NDArray[np.int32]]]:
    if isinstance(mesh, PolygonMesh):
        return []
    return [
        (name, mesh.patch_types.get(name, ""), faces) for name, faces in mesh.patches.items()
    ]


@dataclass(frozen=True)
class FileFormat:
    """A file format and what it can hold."""

    name: str
    title: str
    extensions: tuple[str, ...]
    reads_surfaces: bool
    writes_surfaces: bool
    reads_volumes: bool
    writes_volumes: bool
    fields: bool  #: named values at vertices and elements


def formats() -> list[FileFormat]:
    """The file formats that :func:`read` and :func:`write` know."""
    return [
        FileFormat(name, title, tuple(extensions), *abilities)
        for name, title, extensions, *abilities in _core.formats()
    ]


@dataclass(frozen=True)
class Family:
    """A family of test meshes."""

    name: str
    kind: str  #: "surface" or "volume"
    title: str
    domain: str  #: e.g. "unit sphere"


def families(kind: Optional[str] = None) -> list[Family]:
    """The families of test meshes that :func:`generate` makes.

    Parameters
    ----------
    kind : {"surface", "volume"}, optional
        Only those of one kind.
    """
    if kind not in (None, "surface", "volume"):
        raise InvalidOption(f'kind={kind!r}: choose one of "surface", "volume"')
    return [family for family in map(lambda e: Family(*e), _core.families())
            if kind in (None, family.kind)]


def generate(
    family: str, *, level: int = 0, jitter: float = 0.0, anisotropy: float = 1.0, seed: int = 1
) -> Mesh:
    """A mesh of known geometry, the same in every run.

    Parameters
    ----------
    family : str
        E.g. ``"sphere-hexagons"``, ``"cube-voronoi"``; see :func:`families`.
    level : int
        Every level halves the edge length.
    jitter : float
        Random displacement of vertices, 0 to 0.5 of the shortest edge at each.
    anisotropy : float
        1 to 1000: how much elements are drawn out.
    seed : int
        Of all that is random.

    Returns
    -------
    PolygonMesh or PolyhedralMesh
    """
    if not isinstance(family, str):
        raise InvalidType(f"family: {family!r}; expected a name, see carat.families()")
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or not 0 <= seed < 2**64:
        raise InvalidOption(f"seed: {seed!r}; expected a whole number of at least 0")
    core = _core.generate(
        family,
        _whole(level, "level", 0),
        _number(jitter, "jitter") or 0.0,
        _number(anisotropy, "anisotropy") or 0.0,
        int(seed),
    )
    if isinstance(core, _core.PolygonMesh):
        return PolygonMesh._of(core)
    return PolyhedralMesh._of(core)


class View:
    """An interactive page of a mesh and its fields: shown by Jupyter, saved as one HTML file."""

    def __init__(self, page: str, title: str, height: int) -> None:
        #: The whole page.
        self.html = page
        self._title = title
        self._height = height

    def save(self, path: PathLike) -> Path:
        """Writes the page; it needs no network and no server."""
        target = Path(_path(path))
        temporary = target.with_name(f"{target.name}.{os.getpid()}.part")
        try:
            temporary.write_text(self.html, encoding="utf-8")
            os.replace(temporary, target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise
        return target

    def open(self) -> Path:
        """Writes the page to a temporary file and opens it in a browser."""
        path = Path(tempfile.mkdtemp(prefix="carat-")) / "view.html"
        self.save(path)
        webbrowser.open(path.as_uri())
        return path

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="{self._height}"'
            f' style="border:0" title="{html.escape(self._title)}"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<carat.View: {self._title}, {len(self.html) / 1e6:.1f} MB>"


def show(
    mesh: Any,
    u: Optional[Any] = None,
    *,
    vertex: Optional[Mapping[str, Any]] = None,
    face: Optional[Mapping[str, Any]] = None,
    cell: Optional[Mapping[str, Any]] = None,
    path: Optional[PathLike] = None,
    title: str = "carat",
    height: int = 600,
) -> View:
    """An interactive view of a mesh: inline in Jupyter, and as a file.

    Parameters
    ----------
    mesh : PolygonMesh, PolyhedralMesh, or a mesh of another package
        The mesh.
    u : (n_vertices,) or (n_vertices, k) array_like, optional
        Values to show, called ``u``. Infinite ones are shown as such.
    vertex, face, cell : dict, optional
        More named values; default: the mesh's own.
    path : str or path, optional
        An HTML file to write as well.
    title : str
        The page's heading.
    height : int
        Of the view in a notebook [pixels].

    Returns
    -------
    View
        The last line of a notebook's cell shows it; elsewhere call its ``open()`` or ``save()``.
    """
    mesh = as_mesh(mesh)
    if u is not None:
        vertex = {"u": u, **(vertex or {})}
    fields = _fields_of(mesh, vertex, face, cell)
    with tempfile.TemporaryDirectory(prefix="carat-") as folder:
        page = os.path.join(folder, "view.html")
        _core.write_view(page, mesh._core, *fields, str(title))
        text = Path(page).read_text(encoding="utf-8")
    view = View(text, str(title), _whole(height, "height", 1))
    if path is not None:
        view.save(path)
    return view
