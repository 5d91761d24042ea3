"""What callers pass as points, faces, cells and values, as arrays of one exact type and shape."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._errors import InvalidMesh, InvalidOption, InvalidType

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
#: Anything that NumPy makes an array of.
ArrayLike = Union[npt.ArrayLike, "npt.NDArray[Any]"]


def shape_of(array: npt.NDArray[Any]) -> str:
    """A shape as it is written: ``(3, 100)``."""
    return str(array.shape)


def _array(values: Any, what: str) -> npt.NDArray[Any]:
    try:
        array = np.asarray(values)
    except ValueError:
        raise InvalidOption(
            f"{what}: no array of numbers: rows of different length, or nested unevenly"
        ) from None
    if array.dtype == object:
        raise InvalidOption(
            f"{what}: no array of numbers, but of Python objects"
            " (rows of different length, or something that is no number)"
        )
    return array


def floats(values: Any, what: str) -> Floats:
    """Real numbers as a C-ordered float64 array; not copied if they are one."""
    array = _array(values, what)
    if array.dtype.kind not in "fiub":
        raise InvalidType(f"{what}: dtype {array.dtype}; expected real numbers")
    return np.ascontiguousarray(array, dtype=np.float64).reshape(array.shape)


def integers(values: Any, what: str) -> npt.NDArray[Any]:
    """Whole numbers as a C-ordered int32 or int64 array; int32 and int64 are not converted."""
    array = _array(values, what)
    if array.size == 0 and array.dtype.kind == "f":
        array = array.astype(np.int32)  # np.asarray([]) has no reason to be of floats
    if array.dtype.kind not in "iu":
        hint = ""
        if array.dtype.kind == "f":
            hint = "; convert them with .astype(int) if they are whole numbers"
        elif array.dtype.kind == "b":
            hint = "; for a mask give np.flatnonzero(mask)"
        raise InvalidType(f"{what}: dtype {array.dtype}; expected integers{hint}")
    if array.dtype == np.uint64 and array.size and array.max() > np.iinfo(np.int64).max:
        raise InvalidMesh(f"{what}: entry {array.max()} is out of range")
    if array.dtype not in (np.dtype(np.int32), np.dtype(np.int64)):
        array = array.astype(np.int64)
    return np.ascontiguousarray(array).reshape(array.shape)


def points(values: Any) -> Floats:
    """Positions as (n, 3); (n, 2) lie in the plane z = 0."""
    array = floats(values, "points")
    if array.ndim == 2 and array.shape[1] == 3:
        return array
    if array.ndim == 2 and array.shape[1] == 2:
        return np.ascontiguousarray(np.pad(array, ((0, 0), (0, 1))))
    if array.size == 0:
        return np.zeros((0, 3))
    hint = "; transpose it" if array.ndim == 2 and array.shape[0] in (2, 3) else ""
    raise InvalidMesh(f"points: shape {shape_of(array)}; expected (n, 3) or (n, 2){hint}")


def _is_row_array(values: Any) -> bool:
    return isinstance(values, np.ndarray) and values.ndim == 1 and values.dtype.kind in "iu"


def offsets_of(lengths: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """Where rows of these lengths begin, and where the last one ends."""
    offsets = np.zeros(len(lengths) + 1, dtype=np.int64)
    np.cumsum(lengths, out=offsets[1:])
    return offsets


def _ragged(rows: Sequence[Any], what: str) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """(indices, offsets) of rows of any length."""
    lengths = np.empty(len(rows), dtype=np.int64)
    for i, row in enumerate(rows):
        if isinstance(row, str) or not (hasattr(row, "__len__") and hasattr(row, "__iter__")):
            raise InvalidType(
                f"{what}: entry {i} is {row!r}; expected a list of numbers", (i,)
            )
        lengths[i] = len(row)
    offsets = offsets_of(lengths)
    flat = list(itertools.chain.from_iterable(rows))
    if any(isinstance(entry, (list, tuple, np.ndarray)) for entry in flat):
        raise InvalidMesh(
            f"{what}: lists nested too deeply; expected a list of lists of vertex numbers"
        )
    return integers(flat, what), offsets


def rows(values: Any, what: str) -> tuple[npt.NDArray[Any], ...]:
    """Rows of numbers in any form: one rectangular array, or (indices, offsets).

    Accepted: (m, k) integers, rows filled up with -1; a list of lists; (indices, offsets) as two
    one-dimensional arrays.
    """
    if isinstance(values, tuple) and len(values) == 2 and all(map(_is_row_array, values)):
        indices, offsets = integers(values[0], what), integers(values[1], f"{what} (offsets)")
        return _same_type(indices, offsets)
    if isinstance(values, np.ndarray) and values.dtype != object:
        array = integers(values, what)
        if array.ndim == 2:
            return (array,)
        if array.size == 0:
            return (np.zeros((0, 3), dtype=np.int32),)
        raise InvalidMesh(
            f"{what}: shape {shape_of(array)}; expected (m, k) with rows filled up with -1,"
            " a list of lists, or a tuple (indices, offsets)"
        )
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise InvalidType(
            f"{what}: {type(values).__name__}; expected (m, k) integers, a list of lists, or"
            " a tuple (indices, offsets)"
        )
    listed = list(values)
    indices, offsets = _ragged(listed, what)
    return _same_type(indices, offsets)


def csr_rows(values: Any, what: str) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """The same always as (indices, offsets), both int64."""
    parts = rows(values, what)
    if len(parts) == 2:
        return parts[0].astype(np.int64), parts[1].astype(np.int64)
    kept = parts[0] != -1
    if np.any(kept[:, 1:] & ~kept[:, :-1]):
        raise InvalidMesh(f"{what}: -1 may only fill up the ends of rows")
    return parts[0][kept].astype(np.int64), offsets_of(kept.sum(axis=1))


def _same_type(*arrays: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], ...]:
    if all(array.dtype == np.int32 for array in arrays):
        return arrays
    return tuple(array.astype(np.int64, copy=False) for array in arrays)


def ids(values: Any, what: str) -> Ints:
    """Numbers of vertices, faces or cells as one-dimensional int32."""
    array = integers(values, what)
    if array.ndim > 1:
        raise InvalidOption(f"{what}: shape {shape_of(array)}; expected a list of numbers")
    array = array.reshape(-1)
    limits = np.iinfo(np.int32)
    if array.size and (array.min() < limits.min or array.max() > limits.max):
        worst = array.max() if array.max() > limits.max else array.min()
        raise InvalidOption(f"{what}: {worst} does not exist")
    return np.ascontiguousarray(array, dtype=np.int32)


def values_at(values: Any, n: int, what: str, of: str) -> Floats:
    """One number for each of n: an array of n, or one number for all."""
    array = floats(values, what)
    if array.ndim == 0:
        return np.full(n, float(array))
    if array.shape == (n, 1):
        array = array.reshape(n)
    if array.shape != (n,):
        raise InvalidOption(
            f"{what}: shape {shape_of(array)}; expected ({n},), one number for each of the {n} {of}"
        )
    return array


def field(values: Any, n: int, what: str, of: str) -> Floats:
    """A field for files and views: (n,) or (n, components)."""
    array = floats(values, what)
    if array.ndim not in (1, 2) or array.shape[0] != n or array.shape[-1] == 0 < n:
        raise InvalidOption(
            f"{what}: shape {shape_of(array)}; expected ({n},) or ({n}, k), one row for each of"
            f" the {n} {of}"
        )
    return array
