"""Arrays on their way into the C library, and out of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from libatlas._library import Handle
from libatlas.errors import InputError


class View:
    """An array of the C library as numpy's array interface describes it; keeps its owner alive."""

    def __init__(self, address: int, shape: tuple[int, ...], kind: Any, owner: Any) -> None:
        self._owner = owner
        dtype = np.dtype(kind)
        self.__array_interface__ = {
            "version": 3,
            "data": (address, True),  # read only
            "shape": shape,
            "typestr": dtype.str,
            "descr": dtype.descr,
        }


def view(address: int | None, shape: tuple[int, ...], kind: Any, owner: Handle) -> npt.NDArray[Any]:
    """A read-only array that looks into `owner`'s memory, without a copy."""
    if not address or 0 in shape:
        empty = np.empty(shape, kind)
        empty.flags.writeable = False
        return empty
    return np.asarray(View(address, shape, kind, owner))


def _as_array(value: Any, name: str, kinds: str, wanted: str) -> npt.NDArray[Any]:
    try:
        array = np.asarray(value)
    except ValueError as error:  # rows of different lengths
        raise InputError(f"{name}: {error}") from None
    if array.size == 0 and array.dtype.kind in "fO":  # the type of [] says nothing
        return np.zeros(array.shape, "f4" if "f" in kinds else "u4")
    if array.dtype.kind not in kinds:
        raise TypeError(f"{name}: dtype is {array.dtype}, but {wanted} are needed")
    return array


def _check_shape(array: npt.NDArray[Any], shape: tuple[int | None, ...], name: str) -> None:
    fits = array.ndim == len(shape) and all(wanted in (None, size) for wanted, size in zip(shape, array.shape))
    if not fits:
        wanted = ", ".join("N" if size is None else str(size) for size in shape)
        raise InputError(f"{name}: shape is {array.shape}, but ({wanted}) is needed")


def floats(value: Any, shape: tuple[int | None, ...], name: str, *, flat: bool = False) -> npt.NDArray[np.float32]:
    """Floats of 32 bits. Rows may be any distance apart unless `flat`; each is without gaps.

    Nothing is copied that has this form already.
    """
    array = _as_array(value, name, "fiu", "floats")
    _check_shape(array, shape, name)
    if array.dtype != np.float32:
        with np.errstate(over="ignore"):  # too large becomes infinite, which the library refuses
            array = array.astype(np.float32)
    row = array.itemsize * (array.shape[1] if array.ndim == 2 else 1)
    rows_fit = array.ndim == 2 and not flat and array.strides[1] == array.itemsize
    if rows_fit and array.strides[0] >= row:
        return array
    return np.ascontiguousarray(array)


def indices(value: Any, shape: tuple[int | None, ...] | None, name: str, wide: bool = False) -> npt.NDArray[Any]:
    """Indices without gaps, of 32 bits, or of 16 if they are so already and not `wide`; any shape if it is None."""
    array = _as_array(value, name, "iu", "integers")
    if shape is not None:
        _check_shape(array, shape, name)
    if array.dtype != np.uint32 and (wide or array.dtype != np.uint16):
        if array.size and (array.min() < 0 or array.max() > 0xFFFFFFFF):
            at = np.unravel_index(np.argmax((array < 0) | (array > 0xFFFFFFFF)), array.shape)
            place = ", ".join(str(int(i)) for i in at)
            raise InputError(f"{name}[{place}]: {array[at]} is out of range")
        same_bits = array.dtype == np.int32
        array = array.view(np.uint32) if same_bits else array.astype(np.uint32)
    return np.ascontiguousarray(array)


class Faces:
    """Triangles or polygons: `corners` are the indices without gaps, one face after the other."""

    def __init__(self, value: Any, polygon_sizes: Any, wide: bool) -> None:
        self.sizes: npt.NDArray[np.uint32] | None = None  # of polygons
        if polygon_sizes is not None:
            self.corners = indices(value, (None,), "faces", wide)
            self.sizes = indices(polygon_sizes, (None,), "polygon_sizes", wide=True)
        elif _is_ragged(value):
            self.sizes = np.array([len(face) for face in value], np.uint32)
            self.corners = indices(flat(value), (None,), "faces", wide)
        else:
            self.corners = indices(value, (None, None), "faces", wide)
            count, size = self.corners.shape
            if size != 3:
                self.sizes = np.full(count, size, np.uint32)
        self.shape: tuple[int, ...] = self.corners.shape
        self.count = self.corners.size // 3 if self.sizes is None else len(self.sizes)

    def of_corners(self, array: npt.NDArray[Any], name: str) -> npt.NDArray[Any]:
        """An array of one element a corner, in the shape of the faces or flat."""
        if array.shape not in (self.shape, (self.corners.size,)):
            raise InputError(f"{name}: shape is {array.shape}, but {self.shape} is needed")
        return np.ascontiguousarray(array)


def _is_ragged(value: Any) -> bool:
    """Whether these are polygons of different sizes, as lists."""
    if not isinstance(value, (list, tuple)) or not value:
        return False
    try:
        return len({len(face) for face in value}) > 1
    except TypeError:
        return False


def flat(value: Any) -> Any:
    """Lists of different lengths become one; all else stays."""
    return [corner for face in value for corner in face] if _is_ragged(value) else value


def flags(value: Any, name: str) -> npt.NDArray[np.uint8]:
    """0 or 1 for each element, of any shape."""
    array = _as_array(value, name, "biu", "booleans or integers")
    return np.ascontiguousarray(array != 0).view(np.uint8)


def sides(value: Any, name: str) -> npt.NDArray[np.int32]:
    """Pairs of signed integers of 32 bits without gaps."""
    array = _as_array(value, name, "iu", "integers")
    _check_shape(array, (None, 2), name)
    if array.dtype != np.int32:
        if array.size and (array.min() < -(2**31) or array.max() >= 2**31):
            raise InputError(f"{name}: {array.max()} and {array.min()} are not both below 2^31 in size")
        array = array.astype(np.int32)
    return np.ascontiguousarray(array)
