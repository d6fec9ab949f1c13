"""Unwrapping: meshes in, uvs out."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

from libatlas import _arrays as arrays
from libatlas import _options
from libatlas import _structs as structs
from libatlas._library import Context, Handle, Progress, library
from libatlas.errors import InputError

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from libatlas._options import UnwrapOptions


@dataclass(frozen=True)
class Charts:
    """The charts of an atlas, as arrays of one element a chart. They are read only."""

    mesh: npt.NDArray[np.uint32]
    page: npt.NDArray[np.uint32]
    material: npt.NDArray[np.uint32]
    triangle_count: npt.NDArray[np.uint32]
    kept: npt.NDArray[np.bool_]  #: with the shape that the given uvs had
    area: npt.NDArray[np.float64]  #: on the surface
    stretch_l2: npt.NDArray[np.float64]  #: as in `Distortion`
    stretch_999: npt.NDArray[np.float64]
    stretch_max: npt.NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.mesh)


@dataclass(frozen=True)
class Distortion:
    """How the charts of an atlas differ from the surface."""

    stretch_l2: float  #: over all charts (Sander et al. 2001); 1 is perfect
    stretch_999: float  #: of the worst chart: bound on stretch over 99.9 % of its area
    stretch_max: float  #: of the worst triangle
    conformal_mean: float  #: mean ratio of larger to smaller singular value; 1 keeps all angles
    seam_length: float  #: of edges that two triangles share in space, but not in uv
    surface_area: float
    flipped_triangles: int  #: whose uvs are clockwise, since their neighbours are turned so
    thin_triangles: int  #: slivers that rounding to floats closes or turns over


class UnwrappedMesh:
    """Vertices to draw a mesh with. A vertex on a seam has a copy for each side.

    `vmapping, faces, uvs = mesh` unpacks what is needed most. Arrays look into the library's memory: they
    are read only, and keep it alive.
    """

    vmapping: npt.NDArray[np.uint32]  #: (V,): the given vertex that each new one copies
    faces: npt.NDArray[np.uint32]  #: (F, 3), into the new vertices; given triangles and corners in order
    uvs: npt.NDArray[np.float32]  #: (V, 2): 0..1 over the page, origin bottom left
    triangle_page: npt.NDArray[np.uint32]  #: (F,), into `atlas.pages`
    triangle_chart: npt.NDArray[np.uint32]  #: (F,), into `atlas.charts`
    atlas: UnwrappedAtlas  #: its pages, charts and quality
    index: int  #: the number of the mesh in its atlas

    def __init__(self, atlas: UnwrappedAtlas, index: int) -> None:
        self.atlas, self.index = atlas, index
        c = structs.MeshUvs(size=ctypes.sizeof(structs.MeshUvs))
        owner = atlas._handle
        Context().call("get_mesh", owner.pointer, index, c)
        self.vmapping = arrays.view(c.vertices, (c.vertex_count,), "u4", owner)
        self.uvs = arrays.view(c.uvs, (c.vertex_count, 2), "f4", owner)
        self.faces = arrays.view(c.indices, (c.triangle_count, 3), "u4", owner)
        self.triangle_page = arrays.view(c.triangle_page, (c.triangle_count,), "u4", owner)
        self.triangle_chart = arrays.view(c.triangle_chart, (c.triangle_count,), "u4", owner)

    @property
    def corner_uvs(self) -> npt.NDArray[np.float32]:
        """(F, 3, 2): the uvs of each triangle's corners. A new array."""
        return self.uvs[self.faces]

    @property
    def seams(self) -> npt.NDArray[np.bool_]:
        """(F, 3): whether the edge from this corner to the next is a seam of the result. A new array.

        Another triangle has the same edge in space then, but not in uv. Borders are no seams.
        """
        return self.atlas._seams(self.index)

    @property
    def pages(self) -> npt.NDArray[np.int32]:
        """(P, 2): width and height of the atlas's pages in texels."""
        return self.atlas.pages

    @property
    def charts(self) -> Charts:
        """The charts of the atlas."""
        return self.atlas.charts

    @property
    def distortion(self) -> Distortion:
        """The distortion of the atlas."""
        return self.atlas.distortion

    def __iter__(self) -> Iterator[npt.NDArray[Any]]:
        return iter((self.vmapping, self.faces, self.uvs))

    def __repr__(self) -> str:
        return f"<UnwrappedMesh: {len(self.vmapping)} vertices, {len(self.faces)} triangles>"


class UnwrappedAtlas(Sequence[UnwrappedMesh]):
    """What `Atlas.unwrap()` returns: a sequence of one `UnwrappedMesh` for each mesh that was added."""

    pages: npt.NDArray[np.int32]  #: (P, 2): width and height in texels
    charts: Charts
    distortion: Distortion
    texels_per_unit: float  #: that were reached, where density is 1
    utilization: float  #: area of the charts / area of the pages
    texels_drawn_twice: int  #: whose centres more than one triangle covers
    kept_charts: int  #: with keep_uvs: given charts that were kept,
    reflattened_charts: int  #: and that were flattened anew

    def __init__(self, handle: Handle, atlas: Atlas) -> None:
        self._handle, self._atlas = handle, atlas
        info = structs.AtlasInfo(size=ctypes.sizeof(structs.AtlasInfo))
        Context().call("get_info", handle.pointer, info)
        self._mesh_count = int(info.mesh_count)
        self.pages = arrays.view(info.pages, (info.page_count, 2), "i4", handle)
        self.charts = self._read_charts()
        self.distortion = Distortion(**{name: getattr(info, name) for name in Distortion.__annotations__})
        self.texels_per_unit = info.texels_per_unit
        self.utilization = info.utilization
        self.texels_drawn_twice = info.texels_drawn_twice
        self.kept_charts = info.kept_charts
        self.reflattened_charts = info.reflattened_charts

    def _read_charts(self) -> Charts:
        c = structs.Charts(size=ctypes.sizeof(structs.Charts))
        Context().call("get_charts", self._handle.pointer, c)
        kinds = dict(mesh="u4", page="u4", material="u4", triangle_count="u4", kept="?")
        columns = {
            name: arrays.view(getattr(c, name), (c.chart_count,), kinds.get(name, "f8"), self._handle)
            for name in Charts.__annotations__
        }
        return Charts(**columns)

    def _seams(self, index: int) -> npt.NDArray[np.bool_]:
        faces = self[index].faces
        seams = np.zeros(faces.shape, np.uint8)
        with self._atlas._lock:
            Context().call(
                "get_seams",
                self._atlas._handle.pointer,
                self._handle.pointer,
                index,
                seams.ctypes.data,
                seams.size,
            )
        return seams.view(np.bool_)

    def __len__(self) -> int:
        return self._mesh_count

    @overload
    def __getitem__(self, index: int) -> UnwrappedMesh: ...
    @overload
    def __getitem__(self, index: slice) -> list[UnwrappedMesh]: ...
    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        number = range(len(self))[index]  # with its errors
        return UnwrappedMesh(self, number)

    def __repr__(self) -> str:
        return f"<UnwrappedAtlas: {len(self)} meshes, {len(self.charts)} charts, {len(self.pages)} pages>"


class Atlas:
    """Meshes that are to share an atlas.

    They are never joined to each other: a chart holds triangles of one mesh only, also where meshes touch.
    """

    def __init__(self) -> None:
        self._handle = Handle("atlas")
        self._lock = threading.Lock()  # the library's atlas is for one thread at a time
        self._count = 0
        Context().call("atlas_create", self._handle.out)

    def __len__(self) -> int:
        return self._count

    def add(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike,
        *,
        normals: npt.ArrayLike | None = None,
        uvs: npt.ArrayLike | None = None,
        uv_faces: npt.ArrayLike | None = None,
        materials: npt.ArrayLike | None = None,
        seams: npt.ArrayLike | None = None,
        triangle_density: npt.ArrayLike | None = None,
        density: float = 1,
    ) -> int:
        """Adds a copy of a mesh, and returns its number, counted from 0.

        Args:
            vertices: (V, 3) positions, finite. float32 is read in place; other numbers are converted.
            faces: (F, 3) integers into `vertices`. uint16, int32 and uint32 are read in place.
            normals: (V, 3). Edges at which they differ become seams, as baked normal maps need them.
            uvs: (T, 2), for `keep_uvs`: one a vertex, or as `uv_faces` says.
            uv_faces: (F, 3) integers into `uvs`.
            materials: (F,) integers.
            seams: (F, 3), true if the edge from that corner to the next is a seam, across which no chart
                continues. Either side may say so.
            triangle_density: (F,) floats > 0: relative texel density, times `density`.
            density: relative linear texel density of the mesh, finite and > 0.

        Raises:
            InputError: an array has the wrong shape, or a value that is not usable.
            TypeError: an array has the wrong kind of numbers.
            UnsupportedError: beyond 2^30 triangles or 2^32 positions in all.
        """
        mesh = structs.Mesh()
        keep = _fill_mesh(mesh, vertices, faces, uv_faces is not None, density)
        triangles = mesh.index_count // 3
        if normals is not None:
            array = arrays.floats(normals, (mesh.position_count, 3), "normals")
            mesh.normals, mesh.normal_stride = array.ctypes.data, array.strides[0]
            keep.append(array)
        if uv_faces is not None and uvs is None:
            raise InputError("uv_faces: there are no uvs that they could index")
        if uvs is not None:
            keep.extend(_fill_uvs(mesh, uvs, uv_faces))
        if materials is not None:
            keep.append(arrays.indices(materials, (triangles,), "materials", wide=True))
            mesh.materials = keep[-1].ctypes.data
        if seams is not None:
            keep.append(arrays.flags(seams, (triangles, 3), "seams"))
            mesh.seams = keep[-1].ctypes.data
        if triangle_density is not None:
            keep.append(arrays.floats(triangle_density, (triangles,), "triangle_density"))
            mesh.triangle_density = keep[-1].ctypes.data
        number = ctypes.c_uint32()
        with self._lock:
            Context().call("add_mesh", self._handle.pointer, mesh, ctypes.byref(number))
            self._count += 1
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
            progress: called in this thread with the name of a stage and rising fractions from 0 to 1. Whatever
                it raises stops the call, and is passed on; so does Ctrl-C in the main thread.
            options: those of `UnwrapOptions`.

        Raises:
            InputError: there is no mesh.
            OptionError: an option is out of range.
            NoSolutionError: there are more charts than the pages hold texels for.
            TypeError: there is no such option, or it has the wrong type.
        """
        context = Context(_options.convert("threads", threads, ctypes.c_int32), progress)
        c = structs.UnwrapOptions()
        _options.fill(c, dict(options), "unwrap")
        handle = Handle("unwrapped")
        with self._lock:
            context.run("unwrap", self._handle.pointer, c, handle.out, keep=(self, handle))
        return UnwrappedAtlas(handle, self)


def _fill_mesh(mesh: structs.Mesh, vertices: Any, faces: Any, wide: bool, density: Any) -> list[npt.NDArray[Any]]:
    """Returns what must live as long as `mesh`. `wide`: indices get 32 bits."""
    library.libatlas_mesh_init(mesh, ctypes.sizeof(mesh))
    positions = arrays.floats(vertices, (None, 3), "vertices")
    triangles = arrays.indices(faces, (None, 3), "faces", wide)
    mesh.positions, mesh.position_count = positions.ctypes.data, len(positions)
    mesh.position_stride = positions.strides[0]
    mesh.indices, mesh.index_count = triangles.ctypes.data, triangles.size
    mesh.index_bytes = triangles.itemsize
    mesh.density = _options.convert("density", density, ctypes.c_double)
    return [positions, triangles]


def _fill_uvs(mesh: structs.Mesh, uvs: Any, uv_faces: Any) -> list[npt.NDArray[Any]]:
    shape = (mesh.position_count if uv_faces is None else None, 2)
    texcoords = arrays.floats(uvs, shape, "uvs")
    mesh.texcoords, mesh.texcoord_count = texcoords.ctypes.data, len(texcoords)
    mesh.texcoord_stride = texcoords.strides[0]
    if uv_faces is None:
        return [texcoords]
    corners = arrays.indices(uv_faces, (mesh.index_count // 3, 3), "uv_faces", wide=True)
    mesh.texcoord_indices = corners.ctypes.data
    return [texcoords, corners]


def unwrap(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike,
    *,
    normals: npt.ArrayLike | None = None,
    uvs: npt.ArrayLike | None = None,
    uv_faces: npt.ArrayLike | None = None,
    materials: npt.ArrayLike | None = None,
    seams: npt.ArrayLike | None = None,
    triangle_density: npt.ArrayLike | None = None,
    threads: int = 0,
    progress: Progress | None = None,
    **options: Unpack[UnwrapOptions],
) -> UnwrappedMesh:
    """Unwraps one mesh: `vmapping, faces, uvs = unwrap(vertices, faces)`.

    Arrays are those of `Atlas.add()`, the rest is that of `Atlas.unwrap()`, and so are the errors.

    Args:
        vertices: (V, 3) positions.
        faces: (F, 3) integers into `vertices`.
        options: those of `UnwrapOptions`, such as `page_size=1024`.
    """
    atlas = Atlas()
    atlas.add(
        vertices,
        faces,
        normals=normals,
        uvs=uvs,
        uv_faces=uv_faces,
        materials=materials,
        seams=seams,
        triangle_density=triangle_density,
    )
    return atlas.unwrap(threads=threads, progress=progress, **options)[0]
