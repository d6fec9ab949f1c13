"""What unwrapping returns."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

from libatlas import _arrays as arrays
from libatlas import _structs as structs
from libatlas._library import Context, Handle

if TYPE_CHECKING:
    from libatlas._unwrapping import Atlas


class ChartOrigin(IntEnum):
    """What a chart has of the uvs of `like`."""

    MADE = 0  #: nothing: it is new, or has been moved
    REPAIRED = 1  #: unchanged triangles lie where they lay; others were lost, or have been laid beside
    KEPT = 2  #: all that it had, at its place: its texels need not be made again


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
    #: `ChartOrigin` of each; empty if nothing of `like` was found again.
    origins: npt.NDArray[np.uint8]

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


@dataclass(frozen=True)
class Instances:
    """Where the instances of a mesh have its uvs: at uv * scale + offset of their page. Arrays are read only."""

    page: npt.NDArray[np.uint32]  #: (N,)
    scale: npt.NDArray[np.float32]  #: (N, 2)
    offset: npt.NDArray[np.float32]  #: (N, 2): 0..1 over the page, origin bottom left

    def __len__(self) -> int:
        return len(self.page)


class UnwrappedMesh:
    """Vertices to draw a mesh with. A vertex on a seam has a copy for each side.

    `vmapping, faces, uvs = mesh` unpacks what is needed most. Arrays look into the library's memory: they
    are read only, and keep it alive.
    """

    vmapping: npt.NDArray[np.uint32]  #: (V,): the given vertex that each new one copies
    faces: npt.NDArray[np.uint32]  #: (F, 3), into the new vertices; given triangles in order, or those of polygons
    corners: npt.NDArray[np.uint32]  #: in the shape of the given faces: the new vertex of each corner
    uvs: npt.NDArray[np.float32]  #: (V, 2): 0..1 over the page, origin bottom left
    triangle_page: npt.NDArray[np.uint32]  #: (F,), into `atlas.pages`
    triangle_chart: npt.NDArray[np.uint32]  #: (F,), into `atlas.charts`
    triangle_polygon: npt.NDArray[np.uint32]  #: (F,): the given face that each triangle is of
    cut_polygons: npt.NDArray[np.uint32]  #: those with a seam inside, of which `corners` has one part only
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
        self._shape = atlas._atlas._shapes[index]
        self._read_polygons(owner)

    def _read_polygons(self, owner: Handle) -> None:
        c = structs.PolygonUvs(size=ctypes.sizeof(structs.PolygonUvs))
        Context().call("get_polygons", owner.pointer, self.index, c)
        if not c.polygon_count:
            self.corners = self.faces
            self.triangle_polygon = np.arange(len(self.faces), dtype=np.uint32)
            self.cut_polygons = np.zeros(0, np.uint32)
            return
        self.corners = arrays.view(c.corners, (c.corner_count,), "u4", owner).reshape(self._shape)
        self.triangle_polygon = arrays.view(c.triangle_polygon, (len(self.faces),), "u4", owner)
        self.cut_polygons = arrays.view(c.cut_polygons, (c.cut_count,), "u4", owner)

    @property
    def corner_uvs(self) -> npt.NDArray[np.float32]:
        """The uvs of each corner, in the shape of the given faces: (F, 3, 2) of triangles. A new array."""
        return self.uvs[self.corners]

    @property
    def seams(self) -> npt.NDArray[np.bool_]:
        """Whether the edge from this corner to the next is a seam of the result: (F, 3) of triangles. A new array.

        Another face has the same edge in space then, but not in uv. Borders are no seams.
        """
        return self.atlas._seams(self.index, self._shape)

    @property
    def instances(self) -> Instances:
        """The instances that the mesh was added with; none of other meshes.

        The uvs of the mesh are 0..1 over a rectangle of its own then, and `triangle_page` is that of the first instance.
        """
        c = structs.Instances(size=ctypes.sizeof(structs.Instances))
        owner = self.atlas._handle
        Context().call("get_instances", owner.pointer, self.index, c)
        all_of_them = arrays.view(c.instances, (c.instance_count,), structs.INSTANCE, owner)
        return Instances(*(all_of_them[name] for name in Instances.__annotations__))

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
        kinds = dict(mesh="u4", page="u4", material="u4", triangle_count="u4", kept="?", origins="u1")
        columns = {}
        for name in Charts.__annotations__:
            place = getattr(c, name)
            columns[name] = arrays.view(place, (c.chart_count if place else 0,), kinds.get(name, "f8"), self._handle)
        return Charts(**columns)

    def _seams(self, index: int, shape: tuple[int, ...]) -> npt.NDArray[np.bool_]:
        seams = np.zeros(shape, np.uint8)
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
