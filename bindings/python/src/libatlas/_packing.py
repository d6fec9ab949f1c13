"""Packing of rectangles, and of the islands of uvs that are there."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from libatlas import _arrays as arrays
from libatlas import _options
from libatlas import _structs as structs
from libatlas._library import Context, Handle, Progress, library

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from libatlas._options import IslandOptions, PackOptions

_NO_PAGE = 2**32 - 1


@dataclass(frozen=True)
class PackedRects:
    """Where rectangles lie. Item i covers x..x + width, y..y + height of its page.

    Its sides are swapped if it is rotated, which is a quarter turn counterclockwise. Arrays are read only.
    """

    page: npt.NDArray[np.uint32]  #: (N,); of those that are not placed 2^32 - 1
    x: npt.NDArray[np.int32]  #: (N,), texels
    y: npt.NDArray[np.int32]  #: (N,), texels
    rotated: npt.NDArray[np.bool_]  #: (N,)
    placed: npt.NDArray[np.bool_]  #: (N,); false: there was no room
    pages: npt.NDArray[np.int32]  #: (P, 2): width and height in texels
    utilization: float  #: area of what was placed / area of the pages
    page_lower_bound: int  #: no packing of all that fit a page needs fewer pages


@dataclass(frozen=True)
class PackedIslands:
    """Where islands lie. A given uv p goes to island_offset + texels_per_uv R(island_angle) p, in texels.

    Arrays look into the library's memory: they are read only, and keep it alive.
    """

    uvs: npt.NDArray[np.float32]  #: (U, 2): 0..1 over the page, origin bottom left; 0 where no face names it
    triangle_island: npt.NDArray[np.uint32]  #: (F,)
    island_page: npt.NDArray[np.uint32]  #: (I,)
    island_angle: npt.NDArray[np.float64]  #: (I,): radians counterclockwise
    island_offset: npt.NDArray[np.float64]  #: (I, 2): texel of the given uv (0, 0)
    pages: npt.NDArray[np.int32]  #: (P, 2): width and height in texels
    texels_per_uv: float  #: that were reached
    utilization: float  #: area of the islands / area of the pages


def pack_rects(
    sizes: npt.ArrayLike,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    **options: Unpack[PackOptions],
) -> PackedRects:
    """Packs rectangles onto pages. Those for which there is no room are not placed, which is no error.

    Args:
        sizes: (N, 2) integers: width and height in texels.
        threads: how many to use; 0: as many as the machine has.
        progress: as of `Atlas.unwrap()`.
        options: those of `PackOptions`, such as `page=(1024, 1024)`.

    Raises:
        InputError: a side is negative, or the array has the wrong shape.
        OptionError: an option is out of range.
        TypeError: the array has the wrong kind of numbers, or there is no such option.
    """
    context = Context(_options.convert("threads", threads, ctypes.c_int32), progress)
    extents = arrays.sides(sizes, "sizes")
    c = structs.PackOptions()
    _options.fill(c, dict(options), "pack_rects")
    owner = Handle("packed")
    context.run("pack_rects", extents.ctypes.data, len(extents), c, owner.out, keep=(extents, owner))
    info = structs.PackedInfo(size=ctypes.sizeof(structs.PackedInfo))
    context.call("get_packed", owner.pointer, info)
    placements = arrays.view(info.placements, (info.placement_count,), structs.PLACEMENT, owner)
    return PackedRects(
        page=placements["page"],
        x=placements["x"],
        y=placements["y"],
        rotated=placements["rotated"] != 0,
        placed=placements["page"] != _NO_PAGE,
        pages=arrays.view(info.pages, (info.page_count, 2), "i4", owner),
        utilization=info.utilization,
        page_lower_bound=info.page_lower_bound,
    )


def pack_islands(
    uvs: npt.ArrayLike,
    faces: npt.ArrayLike,
    *,
    threads: int = 0,
    progress: Progress | None = None,
    **options: Unpack[IslandOptions],
) -> PackedIslands:
    """Moves, turns and scales the islands of given uvs by one factor, so that none lies on another.

    Triangles that name a uv in common are one island.

    Args:
        uvs: (U, 2), finite.
        faces: (F, 3) integers into `uvs`.
        threads: how many to use; 0: as many as the machine has.
        progress: as of `Atlas.unwrap()`.
        options: those of `IslandOptions`, such as `padding=4`.

    Raises:
        InputError: an array has the wrong shape, or a value that is not usable.
        OptionError: an option is out of range.
        NoSolutionError: there are more islands than the pages hold texels for.
        TypeError: an array has the wrong kind of numbers, or there is no such option.
    """
    context = Context(_options.convert("threads", threads, ctypes.c_int32), progress)
    given = arrays.floats(uvs, (None, 2), "uvs")
    corners = arrays.indices(faces, (None, 3), "faces")
    islands = structs.Islands()
    library.libatlas_islands_init(islands, ctypes.sizeof(islands))
    islands.uvs, islands.uv_count, islands.uv_stride = given.ctypes.data, len(given), given.strides[0]
    islands.indices, islands.index_count = corners.ctypes.data, corners.size
    islands.index_bytes = corners.itemsize
    c = structs.IslandOptions()
    _options.fill(c, dict(options), "pack_islands")
    owner = Handle("packed_islands")
    context.run("pack_islands", islands, c, owner.out, keep=(given, corners, owner))
    return _read_islands(context, owner)


def _read_islands(context: Context, owner: Handle) -> PackedIslands:
    info = structs.PackedIslandsInfo(size=ctypes.sizeof(structs.PackedIslandsInfo))
    context.call("get_packed_islands", owner.pointer, info)

    def column(name: str, shape: tuple[int, ...], kind: str) -> npt.NDArray[Any]:
        return arrays.view(getattr(info, name), shape, kind, owner)

    return PackedIslands(
        uvs=column("uvs", (info.uv_count, 2), "f4"),
        triangle_island=column("triangle_island", (info.triangle_count,), "u4"),
        island_page=column("island_page", (info.island_count,), "u4"),
        island_angle=column("island_angle", (info.island_count,), "f8"),
        island_offset=column("island_offset", (info.island_count, 2), "f8"),
        pages=column("pages", (info.page_count, 2), "i4"),
        texels_per_uv=info.texels_per_uv,
        utilization=info.utilization,
    )
