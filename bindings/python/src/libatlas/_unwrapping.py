"""Unwrapping: meshes in, uvs out."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from libatlas import _arrays as arrays
from libatlas import _options
from libatlas import _structs as structs
from libatlas._library import Context, Handle, Progress, library
from libatlas._results import UnwrappedAtlas, UnwrappedMesh
from libatlas.errors import InputError

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from libatlas._options import UnwrapOptions


class Atlas:
    """Meshes that are to share an atlas.

    They are never joined to each other: a chart holds triangles of one mesh only, also where meshes touch.
    """

    def __init__(self) -> None:
        self._handle = Handle("atlas")
        self._lock = threading.Lock()  # the library's atlas is for one thread at a time
        self._shapes: list[tuple[int, ...]] = []  # of the faces that were given, one a mesh
        self._vertex_counts: list[int] = []
        Context().call("atlas_create", self._handle.out)

    def __len__(self) -> int:
        return len(self._shapes)

    def add(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike | Sequence[Sequence[int]],
        *,
        polygon_sizes: npt.ArrayLike | None = None,
        normals: npt.ArrayLike | None = None,
        uvs: npt.ArrayLike | None = None,
        uv_faces: npt.ArrayLike | None = None,
        materials: npt.ArrayLike | None = None,
        seams: npt.ArrayLike | None = None,
        seam_weights: npt.ArrayLike | None = None,
        triangle_density: npt.ArrayLike | None = None,
        density: float = 1,
        instances: npt.ArrayLike | None = None,
    ) -> int:
        """Adds a copy of a mesh, and returns its number, counted from 0.

        Args:
            vertices: (V, 3) positions, finite. float32 is read in place; other numbers are converted.
            faces: (F, 3) integers into `vertices`. uint16, int32 and uint32 are read in place. Polygons are (F, N)
                integers, or lists of different lengths, or, with `polygon_sizes`, their corners one after the other.
                They may be concave, and enclose holes that are joined to the outline by an edge there and back.
            polygon_sizes: (F,) integers: how many corners each polygon has, at least 3.
            normals: (V, 3). Edges at which they differ become seams, as baked normal maps need them.
            uvs: (T, 2), for `keep_uvs`: one a vertex, or as `uv_faces` says.
            uv_faces: integers into `uvs`, one a corner, in the shape of `faces`.
            materials: (F,) integers.
            seams: one a corner, in the shape of `faces`: true if the edge from that corner to the next is a seam,
                across which no chart continues. Either side may say so.
            seam_weights: (V,) floats, at least 0: a seam along an edge counts its length times the mean of its ends'
                weights, so that seams keep away from high ones; default 1.
            triangle_density: (F,) floats > 0: relative texel density, times `density`.
            density: relative linear texel density of the mesh, finite and > 0.
            instances: (N,) floats > 0, at least one: the mesh is shown N times. It is unwrapped once, and each instance
                gets a place for a copy of its uvs (`UnwrappedMesh.instances`), larger by its relative linear density.

        Raises:
            InputError: an array has the wrong shape, or a value that is not usable.
            TypeError: an array has the wrong kind of numbers.
            UnsupportedError: beyond 2^30 triangles, 2^32 positions or 2^30 instances in all.
        """
        mesh = structs.Mesh()
        polygons = arrays.Faces(faces, polygon_sizes, wide=uv_faces is not None)
        keep = _fill_mesh(mesh, vertices, polygons, density)
        if normals is not None:
            array = arrays.floats(normals, (mesh.position_count, 3), "normals")
            mesh.normals, mesh.normal_stride = array.ctypes.data, array.strides[0]
            keep.append(array)
        if uv_faces is not None and uvs is None:
            raise InputError("uv_faces: there are no uvs that they could index")
        if uvs is not None:
            keep.extend(_fill_uvs(mesh, uvs, uv_faces, polygons))
        if materials is not None:
            keep.append(arrays.indices(materials, (polygons.count,), "materials", wide=True))
            mesh.materials = keep[-1].ctypes.data
        if seams is not None:
            keep.append(polygons.of_corners(arrays.flags(arrays.flat(seams), "seams"), "seams"))
            mesh.seams = keep[-1].ctypes.data
        if seam_weights is not None:
            keep.append(arrays.floats(seam_weights, (mesh.position_count,), "seam_weights"))
            mesh.seam_weights = keep[-1].ctypes.data
        if triangle_density is not None:
            keep.append(arrays.floats(triangle_density, (polygons.count,), "triangle_density"))
            mesh.triangle_density = keep[-1].ctypes.data
        number = ctypes.c_uint32()
        call, more = "add_mesh", ()  # type: tuple[str, tuple[Any, ...]]
        if instances is not None:
            keep.append(arrays.floats(instances, (None,), "instances"))
            call, more = "add_instances", (keep[-1].ctypes.data, len(keep[-1]))
        with self._lock:
            Context().call(call, self._handle.pointer, mesh, *more, ctypes.byref(number))
            self._shapes.append(polygons.shape)
            self._vertex_counts.append(mesh.position_count)
        return number.value

    def unwrap(
        self,
        *,
        threads: int = 0,
        progress: Progress | None = None,
        **options: Unpack[UnwrapOptions],
    ) -> UnwrappedAtlas:
        """Unwraps all meshes. May be called again, with other options.

        Nothing is left out: triangle t of a mesh is triangle t of its result, with its corners in the same
        order. The result is the same for any number of threads. Other Python threads run meanwhile.

        Args:
            threads: how many to use; 0: as many as the machine has.
            progress: called in this thread with the name of a stage and rising fractions from 0 to 1; with the same
                again where nothing new comes for a tenth of a second. Whatever it raises stops the call, and is passed
                on; so does Ctrl-C in the main thread.
            options: those of `UnwrapOptions`.

        Raises:
            InputError: there is no mesh, or something of `like` is not usable.
            OptionError: an option is out of range.
            NoSolutionError: there are more charts than the pages hold texels for.
            TypeError: there is no such option, or it has the wrong type.
        """
        context = Context(_options.convert("threads", threads, ctypes.c_int32), progress)
        c = structs.UnwrapOptions()
        _options.fill(c, dict(options), "unwrap")
        handle = Handle("unwrapped")
        with self._lock:
            context.run("unwrap", self._handle.pointer, c, handle.out, keep=(self, handle, options))
        return UnwrappedAtlas(handle, self)


def _fill_mesh(mesh: structs.Mesh, vertices: Any, polygons: arrays.Faces, density: Any) -> list[npt.NDArray[Any]]:
    """Returns what must live as long as `mesh`."""
    library.libatlas_mesh_init(mesh, ctypes.sizeof(mesh))
    positions, corners = arrays.floats(vertices, (None, 3), "vertices"), polygons.corners
    mesh.positions, mesh.position_count = positions.ctypes.data, len(positions)
    mesh.position_stride = positions.strides[0]
    mesh.indices, mesh.index_count, mesh.index_bytes = corners.ctypes.data, corners.size, corners.itemsize
    mesh.density = _options.convert("density", density, ctypes.c_double)
    if polygons.sizes is not None:
        mesh.polygon_sizes, mesh.polygon_count = polygons.sizes.ctypes.data, len(polygons.sizes)
        return [positions, corners, polygons.sizes]
    return [positions, corners]


def _fill_uvs(mesh: structs.Mesh, uvs: Any, uv_faces: Any, polygons: arrays.Faces) -> list[npt.NDArray[Any]]:
    shape = (mesh.position_count if uv_faces is None else None, 2)
    texcoords = arrays.floats(uvs, shape, "uvs")
    mesh.texcoords, mesh.texcoord_count = texcoords.ctypes.data, len(texcoords)
    mesh.texcoord_stride = texcoords.strides[0]
    if uv_faces is None:
        return [texcoords]
    corners = polygons.of_corners(arrays.indices(arrays.flat(uv_faces), None, "uv_faces", wide=True), "uv_faces")
    mesh.texcoord_indices = corners.ctypes.data
    return [texcoords, corners]


def unwrap(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike | Sequence[Sequence[int]],
    *,
    polygon_sizes: npt.ArrayLike | None = None,
    normals: npt.ArrayLike | None = None,
    uvs: npt.ArrayLike | None = None,
    uv_faces: npt.ArrayLike | None = None,
    materials: npt.ArrayLike | None = None,
    seams: npt.ArrayLike | None = None,
    seam_weights: npt.ArrayLike | None = None,
    triangle_density: npt.ArrayLike | None = None,
    threads: int = 0,
    progress: Progress | None = None,
    **options: Unpack[UnwrapOptions],
) -> UnwrappedMesh:
    """Unwraps one mesh: `vmapping, faces, uvs = unwrap(vertices, faces)`.

    Arrays are those of `Atlas.add()`, the rest is that of `Atlas.unwrap()`, and so are the errors.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) integers into `vertices`, or polygons.
        options: those of `UnwrapOptions`, such as `page_size=1024`.
    """
    atlas = Atlas()
    atlas.add(
        vertices,
        faces,
        polygon_sizes=polygon_sizes,
        normals=normals,
        uvs=uvs,
        uv_faces=uv_faces,
        materials=materials,
        seams=seams,
        seam_weights=seam_weights,
        triangle_density=triangle_density,
    )
    return atlas.unwrap(threads=threads, progress=progress, **options)[0]
