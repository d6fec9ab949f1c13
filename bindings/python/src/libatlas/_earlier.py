"""Earlier uvs, which the next unwrapping is to keep."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from libatlas import _arrays as arrays
from libatlas import _options
from libatlas import _structs as structs
from libatlas._library import library
from libatlas._results import UnwrappedAtlas, UnwrappedMesh
from libatlas.errors import InputError


class EarlierUvs:
    """An earlier state of the meshes of an atlas, with its uvs: the option `like` of `unwrap()`.

    `earlier_uvs()` makes one of a result. Numbers and orders of triangles and vertices need not be those of the new
    meshes: triangles are found by their positions. What is not usable (uvs that are not finite or beyond their page,
    charts that lie on others) is made as new.
    """

    def __init__(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike,
        uvs: npt.ArrayLike,
        pages: npt.ArrayLike,
        *,
        uv_faces: npt.ArrayLike | None = None,
        triangle_page: npt.ArrayLike | None = None,
        tolerance: float = 0.01,
        objects: npt.ArrayLike | None = None,
    ) -> None:
        """Refers to the arrays where these have the right types.

        Args:
            vertices: (V, 3) positions, finite.
            faces: (F, 3) integers into `vertices`; of several meshes all together.
            uvs: (T, 2): 0..1 over their page, origin bottom left; one a vertex, or as `uv_faces` says.
            pages: (P, 2), at least one: width and height in texels, 1..16384.
            uv_faces: (F, 3) integers into `uvs`. One out of range: that corner has none.
            triangle_page: (F,), or None: all lie on page 0.
            tolerance: how far a corner may have moved for its triangle to be unchanged, as a share of the mean edge;
                at least 0, below 1.
            objects: (V,): the number of the mesh that each vertex is of, in which alone its triangles are looked for;
                needed where meshes touch. None: triangles may be of any mesh.

        Raises:
            InputError: an array has the wrong shape. Values are looked at by `unwrap()`.
            TypeError: an array has the wrong kind of numbers.
        """
        c = self._struct = structs.EarlierUvs()
        library.libatlas_earlier_uvs_init(c, ctypes.sizeof(c))
        self.vertices = arrays.floats(vertices, (None, 3), "like: vertices")
        self.faces = arrays.indices(faces, (None, 3), "like: faces", wide=True)
        shape = (len(self.vertices) if uv_faces is None else None, 2)
        self.uvs = arrays.floats(uvs, shape, "like: uvs")
        self.pages = arrays.sides(pages, "like: pages")
        c.positions, c.position_count = self.vertices.ctypes.data, len(self.vertices)
        c.position_stride = self.vertices.strides[0]
        c.indices, c.index_count = self.faces.ctypes.data, self.faces.size
        c.uvs, c.uv_count, c.uv_stride = self.uvs.ctypes.data, len(self.uvs), self.uvs.strides[0]
        c.pages, c.page_count = self.pages.ctypes.data, len(self.pages)
        c.tolerance = _options.convert("tolerance", tolerance, ctypes.c_double)
        if uv_faces is not None:
            self.uv_faces = arrays.indices(uv_faces, self.faces.shape, "like: uv_faces", wide=True)
            c.uv_indices = self.uv_faces.ctypes.data
        if triangle_page is not None:
            self.triangle_page = arrays.indices(triangle_page, self.faces.shape[:1], "like: triangle_page", wide=True)
            c.triangle_page = self.triangle_page.ctypes.data
        if objects is not None:
            self.objects = arrays.indices(objects, (len(self.vertices),), "like: objects", wide=True)
            c.objects = self.objects.ctypes.data


def earlier_uvs(
    vertices: npt.ArrayLike | Sequence[npt.ArrayLike],
    unwrapped: UnwrappedMesh | UnwrappedAtlas,
    tolerance: float = 0.01,
) -> EarlierUvs:
    """A result as what the next one is to be like: `unwrap(edited, faces, like=earlier_uvs(vertices, result))`.

    Args:
        vertices: those that were unwrapped; of an atlas, a sequence of those of each mesh.
        unwrapped: the result.
        tolerance: as in `EarlierUvs`.

    Raises:
        InputError: `vertices` are not those that were unwrapped.
    """
    given: Any = vertices if isinstance(unwrapped, UnwrappedAtlas) else [vertices]
    meshes = list(unwrapped) if isinstance(unwrapped, UnwrappedAtlas) else [unwrapped]
    if len(given) != len(meshes):
        raise InputError(f"earlier_uvs: vertices of {len(given)} meshes for {len(meshes)}")
    positions, faces, objects, base = [], [], [], 0
    for mesh, own in zip(meshes, given):
        array = arrays.floats(own, (None, 3), f"vertices of mesh {mesh.index}")
        if mesh.vmapping.max() >= len(array):
            raise InputError(f"earlier_uvs: mesh {mesh.index} has more than these {len(array)} vertices")
        positions.append(array[mesh.vmapping])
        faces.append(mesh.faces + np.uint32(base))
        objects.append(np.full(len(mesh.vmapping), mesh.index, np.uint32))
        base += len(mesh.vmapping)
    return EarlierUvs(
        np.concatenate(positions),
        np.concatenate(faces),
        np.concatenate([mesh.uvs for mesh in meshes]),
        unwrapped.pages,
        triangle_page=np.concatenate([mesh.triangle_page for mesh in meshes]),
        tolerance=tolerance,
        objects=np.concatenate(objects),
    )
