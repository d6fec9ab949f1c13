"""Exceptions of libatlas. Their text is the library's message, which names the element and the remedy."""

from __future__ import annotations


class Error(Exception):
    """Base of all exceptions that the library's calls raise.

    Wrong types of arguments (a string in place of a number, complex positions) raise TypeError.
    """


class InputError(Error, ValueError):
    """The data contradicts itself, holds nothing usable, or an array has the wrong shape."""


class OptionError(Error, ValueError):
    """An option is out of range."""


class UnsupportedError(Error, NotImplementedError):
    """The input is valid, but beyond what this version handles."""


class NoSolutionError(Error, RuntimeError):
    """More than the pages hold."""


class CancelledError(Error):
    """The call was cancelled."""


class OutOfMemoryError(Error, MemoryError):
    """There is not enough memory."""


class InternalError(Error, RuntimeError):
    """A defect of the library."""


class RepairWarning(UserWarning):
    """Something of the input was repaired, or is worth knowing. `warnings.simplefilter` silences it."""


#: By the values of `libatlas_status`.
BY_STATUS: dict[int, type[Error]] = {
    1: CancelledError,
    2: InputError,
    3: OptionError,
    4: UnsupportedError,
    5: NoSolutionError,
    6: OutOfMemoryError,
    7: InternalError,
    8: InternalError,
}
