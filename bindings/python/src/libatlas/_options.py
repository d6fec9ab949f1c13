"""Options by their names in libatlas/c/atlas.h, and how they become members of its structs."""

from __future__ import annotations

import ctypes
import operator
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from libatlas._library import library
from libatlas._structs import Extent
from libatlas._structs import UnwrapOptions as _UnwrapOptions
from libatlas.errors import BY_STATUS, OptionError

if TYPE_CHECKING:
    from libatlas._earlier import EarlierUvs

Preset = Literal["fast", "standard", "best"]
_PRESETS = {"fast": 0, "standard": 1, "best": 2}
_PRESET_NAMES = ("charts", "packing", "preset")
_INTEGERS = {
    ctypes.c_int32: (-(2**31), 2**31 - 1),
    ctypes.c_uint32: (0, 2**32 - 1),
    ctypes.c_uint64: (0, 2**64 - 1),
}


class UnwrapOptions(TypedDict, total=False):
    """Options of `unwrap()` and `Atlas.unwrap()`, given as keywords."""

    max_stretch: float  #: bound over 99.9 % of each chart's area, > 1; default 1.25
    cone_degrees: float  #: most degrees between a chart's axis and its normals; default 0: any
    crease_degrees: float  #: bend from which on a seam costs a quarter, above 0..180; default 60
    min_fill: float  #: wasteful charts are cut; 0: never, below 1; default 0.72
    uv_aspect: float  #: for keep_uvs: width / height of the page of the given uvs; default 1
    texels_per_unit: float  #: times density; default 0: as many as the pages hold
    pages: int  #: the most pages to use; default 1
    page_size: int  #: largest side in texels, 64..16384; default 2048
    padding: int  #: texels free around each chart; default 2
    mip_levels: int  #: that pages are to be baked with, 0..10; default 0
    alignment: int  #: charts begin and end at multiples of it; default 1
    charts: Preset  #: effort; default "standard"
    packing: Preset  #: likewise
    split_at_materials: bool  #: a chart holds one material only; default True
    keep_uvs: bool  #: keep the charts of the given uvs where they are usable; default False
    allow_rotation: bool  #: turn charts to pack better; default True
    square: bool  #: sides are equal and powers of two; default False
    part_gaps: bool  #: keep parts of one chart apart, as lightmaps need; default False
    like: EarlierUvs | None  #: charts, uvs and places of this stay wherever triangles are unchanged; not with keep_uvs
    seam_weight: float  #: what seams count beside stretch, 0.001..1000: more gives fewer charts; default 1


class PackOptions(TypedDict, total=False):
    """Options of `pack_rects()`, given as keywords."""

    page: tuple[int, int]  #: the largest page, default (2048, 2048); height 0: open; (0, 0): free
    max_pages: int  #: default 0: as many as needed
    allow_rotation: bool  #: by quarter turns; default False
    padding: int  #: texels between any two items; default 0
    border: int  #: texels along the page's edges; default 0
    alignment: int  #: items begin at multiples of it; default 1
    crop: bool  #: pages are cut to what is used; default False
    power_of_two: bool  #: then their sides are rounded up; default False
    square: bool  #: likewise
    preset: Preset  #: default "standard"
    time_budget: float  #: of "best", in seconds; default 1
    effort: int  #: the most layouts it tries; default 0: no limit
    seed: int  #: default 1


class IslandOptions(TypedDict, total=False):
    """Options of `pack_islands()`, given as keywords."""

    texels_per_uv: float  #: texels of the page per unit of uv; default 0: as many as fit
    pages: int  #: the most pages to use; default 1
    page_size: int  #: largest side in texels, 64..16384; default 2048
    padding: int  #: texels free around each island; default 2
    alignment: int  #: islands own whole cells of so many texels; default 1
    allow_rotation: bool  #: default True
    square: bool  #: sides are equal and powers of two; default False
    preset: Preset  #: default "standard"


def _integer(name: str, value: Any, kind: Any) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: {value!r} is no integer") from None
    low, high = _INTEGERS[kind]
    if not low <= number <= high:
        raise OptionError(f"{name} is {number} ({low} to {high})")
    return number


def convert(name: str, value: Any, kind: Any) -> Any:
    """What a member of the type `kind` takes. Ranges are the library's business."""
    if kind is Extent:
        try:
            width, height = value
        except (TypeError, ValueError):
            raise TypeError(f"{name}: {value!r} is no pair of width and height") from None
        return Extent(*(_integer(name, side, ctypes.c_int32) for side in (width, height)))
    if kind is ctypes.c_void_p:  # like
        struct = getattr(value, "_struct", None)
        if value is not None and struct is None:
            raise TypeError(f"{name}: {value!r} are no EarlierUvs")
        return None if struct is None else ctypes.addressof(struct)
    if name in _PRESET_NAMES:
        if isinstance(value, str) and value in _PRESETS:
            return _PRESETS[value]
        raise OptionError(f"{name} is {value!r} ({', '.join(_PRESETS)})")
    if kind is ctypes.c_double:
        if isinstance(value, (str, bytes)):
            raise TypeError(f"{name}: {value!r} is no number")
        try:
            return float(value)
        except OverflowError:
            raise OptionError(f"{name} is {value!r}, which is too large") from None
        except (TypeError, ValueError):
            raise TypeError(f"{name}: {value!r} is no number") from None
    return _integer(name, value, kind)


def fill(struct: ctypes.Structure, options: dict[str, Any], call: str) -> None:
    """Sets the defaults of a struct of options, and then members by their names."""
    kind = _INIT[type(struct).__name__]
    getattr(library, f"libatlas_{kind}_init")(struct, ctypes.sizeof(struct))
    types = {field[0]: field[1] for field in struct._fields_ if field[0] != "size"}
    for name, value in options.items():
        if name not in types:
            raise TypeError(f"{call}() has no option '{name}'; its options are {', '.join(types)}")
        setattr(struct, name, convert(name, value, types[name]))


_INIT = {
    "UnwrapOptions": "unwrap_options",
    "PackOptions": "pack_options",
    "IslandOptions": "island_options",
    "TransferOptions": "transfer_options",
}


def lightmap_options(texels_per_metre: float = 0, metres_per_unit: float = 1) -> UnwrapOptions:
    """The options for lightmaps of game engines: `unwrap(vertices, faces, **lightmap_options(20))`.

    Pages are square with sides that are powers of two, mip levels 0 to 2 can be built and blocks of 4 x 4
    texels compressed without mixing charts, and parts of a chart are kept apart.

    Args:
        texels_per_metre: 0 for as many as the pages hold.
        metres_per_unit: length of a unit of the vertices.
    """
    struct = _UnwrapOptions()
    status = library.libatlas_lightmap_options_init(
        struct,
        ctypes.sizeof(struct),
        convert("texels_per_metre", texels_per_metre, ctypes.c_double),
        convert("metres_per_unit", metres_per_unit, ctypes.c_double),
    )
    if status != 0:
        raise BY_STATUS[status](f"lightmap_options({texels_per_metre}, {metres_per_unit})")
    usual = _UnwrapOptions()
    fill(usual, {}, "lightmap_options")
    options: dict[str, Any] = {}
    for name in UnwrapOptions.__annotations__:
        value = getattr(struct, name)
        if value != getattr(usual, name):
            options[name] = bool(value) if name in ("square", "part_gaps") else value
    return options  # type: ignore[return-value]
