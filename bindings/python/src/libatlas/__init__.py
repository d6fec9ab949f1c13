"""Uvs for triangle meshes, several of them on one atlas, and packing.

    import libatlas

    vmapping, faces, uvs = libatlas.unwrap(vertices, faces)

`libatlas.xatlas` has the names of the package xatlas. Lengths are in the unit of the vertices, uvs run from 0 to
1 over their page with the origin at the bottom left, and sizes of pages are in texels.
"""

from libatlas._earlier import EarlierUvs, earlier_uvs
from libatlas._library import Progress, version
from libatlas._options import IslandOptions, PackOptions, Preset, UnwrapOptions, lightmap_options
from libatlas._packing import PackedIslands, PackedRects, pack_islands, pack_rects
from libatlas._plotting import plot
from libatlas._results import ChartOrigin, Charts, Distortion, Instances, UnwrappedAtlas, UnwrappedMesh
from libatlas._transferring import transfer
from libatlas._unwrapping import Atlas, unwrap
from libatlas.errors import (
    CancelledError,
    Error,
    InputError,
    InternalError,
    NoSolutionError,
    OptionError,
    OutOfMemoryError,
    RepairWarning,
    UnsupportedError,
)

__version__ = version()
__all__ = [
    "Atlas",
    "CancelledError",
    "ChartOrigin",
    "Charts",
    "Distortion",
    "EarlierUvs",
    "Error",
    "InputError",
    "Instances",
    "InternalError",
    "IslandOptions",
    "NoSolutionError",
    "OptionError",
    "OutOfMemoryError",
    "PackOptions",
    "PackedIslands",
    "PackedRects",
    "Preset",
    "Progress",
    "RepairWarning",
    "UnsupportedError",
    "UnwrapOptions",
    "UnwrappedAtlas",
    "UnwrappedMesh",
    "earlier_uvs",
    "lightmap_options",
    "pack_islands",
    "pack_rects",
    "plot",
    "transfer",
    "unwrap",
    "version",
]
