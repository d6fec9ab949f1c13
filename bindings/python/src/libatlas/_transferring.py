"""Values at vertices into textures."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from libatlas import _options
from libatlas import _structs as structs
from libatlas._library import Context, Progress
from libatlas._results import UnwrappedAtlas, UnwrappedMesh
from libatlas.errors import InputError


def transfer(
    unwrapped: UnwrappedMesh | UnwrappedAtlas,
    values: npt.ArrayLike | Sequence[npt.ArrayLike],
    *,
    page: int = 0,
    shifts: int = 4,
    threads: int = 0,
    progress: Progress | None = None,
) -> npt.NDArray[Any]:
    """The texture that shows values at vertices: the colours of a scan, say.

    Texels are those whose bilinear interpolation is nearest to the values over each chart, in the least squares
    sense. Texels beside charts are filled from those of the charts, so that mip levels are right, too.

    Args:
        unwrapped: what `unwrap()` returned for one mesh, or `Atlas.unwrap()` for several.
        values: (V,) or (V, C), finite, one a given vertex of the mesh; of an atlas a list with one such array a mesh.
            uint8, or numbers that become float32.
        page: the number of the page.
        shifts: samples a texel, 1..64.
        threads: how many to use; 0: as many as the machine has.
        progress: as of `Atlas.unwrap()`.

    Returns:
        (height, width) or (height, width, C), uint8 if the values are, else float32. Row 0 is the lowest, as v = 0
        is: files of images want `texture[::-1]`.

    Raises:
        InputError: the values have the wrong shape, or are not finite.
        OptionError: there is no such page, or `shifts` is out of range.
        TypeError: the values are no numbers.
    """
    meshes = list(unwrapped) if isinstance(unwrapped, UnwrappedAtlas) else [unwrapped]
    atlas = meshes[0].atlas
    if len(meshes) != len(atlas):
        raise InputError(f"values: the atlas has {len(atlas)} meshes; pass it with values for each of them")
    given: Any = values if isinstance(unwrapped, UnwrappedAtlas) else [values]
    vertices = _of_vertices(meshes, given)
    channels = vertices.reshape(len(vertices), -1)
    options = structs.TransferOptions()
    _options.fill(options, {"page": page, "shifts": shifts}, "transfer")
    width, height = atlas.pages[page].tolist() if page < len(atlas.pages) else (1, 1)
    texture = np.empty((height, width, channels.shape[1]), np.float32)
    for first in range(0, channels.shape[1], 3):
        three = np.zeros((len(channels), 3), np.float32)  # the library's number of channels
        part = channels[:, first : first + 3]
        three[:, : part.shape[1]] = part
        three[:, part.shape[1] :] = part[:, :1]  # so that the range of values stays
        texels = np.empty((height, width, 3), np.float32)
        # The library reads and writes these until its call has ended, whoever waits for that.
        context = Context(_options.convert("threads", threads, ctypes.c_int32), progress)
        context.run(
            "transfer",
            atlas._handle.pointer,
            three.ctypes.data,
            len(three),
            options,
            texels.ctypes.data,
            width * height,
            keep=(atlas, three, texels),
        )
        texture[:, :, first : first + 3] = texels[:, :, : part.shape[1]]
    shown: npt.NDArray[Any] = texture if vertices.ndim == 2 else texture[:, :, 0]
    return (np.clip(shown, 0, 255) + 0.5).astype(np.uint8) if vertices.dtype == np.uint8 else shown


def _of_vertices(meshes: list[UnwrappedMesh], values: Sequence[Any]) -> npt.NDArray[Any]:
    """The values of the vertices of all meshes, one after the other, as float32 or uint8."""
    if len(values) != len(meshes):
        raise InputError(f"values: there are {len(values)} arrays, but {len(meshes)} meshes")
    parts = []
    for mesh, value in zip(meshes, values):
        try:
            array = np.asarray(value)
        except ValueError as error:
            raise InputError(f"values: {error}") from None
        if array.dtype.kind not in "fiu":
            raise TypeError(f"values: dtype is {array.dtype}, but numbers are needed")
        needed = mesh.atlas._atlas._vertex_counts[mesh.index]
        if array.ndim not in (1, 2) or len(array) != needed or 0 in array.shape:
            raise InputError(f"values: shape is {array.shape}, but ({needed},) or ({needed}, C) is needed")
        parts.append(array[mesh.vmapping])
    if len({(part.shape[1:], part.dtype) for part in parts}) > 1:
        raise InputError("values: the meshes' arrays have different types or numbers of channels")
    together: npt.NDArray[Any] = np.concatenate(parts)
    if together.dtype != np.uint8:
        with np.errstate(over="ignore"):  # too large becomes infinite, which the library refuses
            together = together.astype(np.float32)
    return together
