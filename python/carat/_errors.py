"""Exceptions: one class for each kind of trouble, all derived from :class:`Error`."""

from __future__ import annotations

from typing import Iterable


class Error(Exception):
    """Base of everything that carat raises on purpose.

    Attributes
    ----------
    elements : tuple of int
        Numbers (0-based) of the vertices, faces or cells concerned; may be empty.
    """

    elements: tuple[int, ...]

    def __init__(self, message: str = "", elements: Iterable[int] = ()) -> None:
        super().__init__(message)
        self.elements = tuple(int(element) for element in elements)

    def __reduce__(self) -> tuple[type[Error], tuple[str, tuple[int, ...]]]:
        return type(self), (str(self), self.elements)


class InvalidMesh(Error, ValueError):
    """Points and faces that are no mesh: a number out of range, NaN, a face of two vertices."""


class DegenerateElement(Error, ValueError):
    """An element without area or volume, where ``strict=True`` asked for an error."""


class InvalidOption(Error, ValueError):
    """An argument outside of what the function is defined for."""


class InvalidType(InvalidOption, TypeError):
    """An argument of a type that nothing can be made of."""


class IoError(Error, OSError):
    """A file that cannot be read or written; the message starts with its path."""


class SolverFailure(Error, RuntimeError):
    """A system without a trustworthy solution: not positive definite, or data out of balance."""
