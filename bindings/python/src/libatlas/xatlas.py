"""The names of the package xatlas, done by libatlas: `import libatlas.xatlas as xatlas`.

Charts differ from those of xatlas: they obey a bound on stretch instead of weights, and no triangle is dropped. Of
the options these count; others may be set, and a warning says that they change nothing:

- `ChartOptions`: `use_input_mesh_uvs`; `max_iterations` above 1 takes the preset "best"; `normal_seam_weight` above
  1000 makes seams of all edges at which normals differ.
- `PackOptions`: `resolution`, `texels_per_unit`, `padding`, `bilinear`, `blockAlign`, `bruteForce`, `rotate_charts`.
"""

from __future__ import annotations

import enum
import os
import warnings
from typing import Any

import numpy as np
import numpy.typing as npt

import libatlas
from libatlas._plotting import chart_colours
from libatlas._raster import covered_texels

_MeshArrays = tuple[npt.NDArray[np.uint32], npt.NDArray[np.uint32], npt.NDArray[np.float32]]
_SEAMS_FROM = 1000  # a weight above it makes edges seams, as in xatlas


class ChartType(enum.IntEnum):
    """How a chart was flattened. libatlas's charts are `Piecewise`, and those of given uvs as well."""

    Planar = 0
    Ortho = 1
    LSCM = 2
    Piecewise = 3
    Invalid = 4


class _Options:
    """Attributes with defaults; those that do nothing here are named when they are set."""

    _without_effect: tuple[str, ...] = ()

    def __setattr__(self, name: str, value: Any) -> None:
        if not hasattr(type(self), name):
            raise AttributeError(f"{type(self).__name__} has no option '{name}'")
        if name in self._without_effect and value != getattr(type(self), name):
            warnings.warn(f"libatlas.xatlas: {type(self).__name__}.{name} changes nothing", stacklevel=2)
        super().__setattr__(name, value)


class ChartOptions(_Options):
    """Options of charts, with xatlas's names and defaults."""

    max_chart_area: float = 0.0
    max_boundary_length: float = 0.0
    normal_deviation_weight: float = 2.0
    roundness_weight: float = 0.01
    straightness_weight: float = 6.0
    normal_seam_weight: float = 4.0
    texture_seam_weight: float = 0.5
    max_cost: float = 2.0
    max_iterations: int = 1
    use_input_mesh_uvs: bool = False
    fix_winding: bool = False

    _without_effect = (
        "max_chart_area",
        "max_boundary_length",
        "normal_deviation_weight",
        "roundness_weight",
        "straightness_weight",
        "texture_seam_weight",
        "max_cost",
    )


class PackOptions(_Options):
    """Options of packing, with xatlas's names and defaults."""

    max_chart_size: int = 0
    padding: int = 0
    texels_per_unit: float = 0.0
    resolution: int = 0
    bilinear: bool = True
    blockAlign: bool = False
    bruteForce: bool = False
    create_image: bool = False
    rotate_charts: bool = True
    rotate_charts_to_axis: bool = True

    _without_effect = ("max_chart_size",)

    def _sizes(self) -> dict[str, Any]:
        """As xatlas has it: without a resolution one page of any size, with a density pages of that size."""
        both = self.resolution > 0 and self.texels_per_unit > 0
        size = self.resolution or (16384 if self.texels_per_unit > 0 else 1024)
        return dict(
            page_size=min(max(int(size), 64), 16384),
            pages=1024 if both else 1,
            padding=max(int(self.padding), 1 if self.bilinear else 0),
            alignment=4 if self.blockAlign else 1,
            allow_rotation=bool(self.rotate_charts),
        )

    def _unwrap_options(self) -> dict[str, Any]:
        effort = "best" if self.bruteForce else "standard"
        return dict(self._sizes(), texels_per_unit=float(self.texels_per_unit), packing=effort)

    def _island_options(self) -> dict[str, Any]:
        effort = "best" if self.bruteForce else "standard"
        return dict(self._sizes(), texels_per_uv=float(self.texels_per_unit), preset=effort)


class Chart:
    """A chart of a mesh."""

    def __init__(self, atlas_index: int, material: int, faces: npt.NDArray[np.uint32], kind: ChartType) -> None:
        self.atlas_index = atlas_index  #: the page
        self.material = material
        self.faces = faces  #: (N,) numbers of triangles
        self.type = kind


class _Mesh:
    """One mesh of a result, in the form that `Atlas` reads."""

    def __init__(self, arrays: Any, page: Any, chart: Any, material: Any) -> None:
        self.vmapping, self.faces, self.uvs = (np.array(array) for array in arrays)  # to be written to
        self.page = np.asarray(page)
        # The atlas's numbers of the mesh's charts, and by which of them each triangle lies in.
        self.charts, self.chart = np.unique(np.asarray(chart), return_inverse=True)
        self.material = material[self.charts]


class Atlas:
    """Meshes that share an atlas: `add_mesh()` or `add_uv_mesh()`, then `generate()`, then `atlas[i]`."""

    def __init__(self) -> None:
        self._given: list[dict[str, Any]] = []
        self._given_uvs: list[tuple[Any, Any, Any]] = []
        self._meshes: list[_Mesh] = []
        self._pages: npt.NDArray[np.int32] = np.zeros((0, 2), np.int32)
        self._utilization = 0.0
        self._texels_per_unit = 0.0

    def add_mesh(
        self,
        positions: npt.ArrayLike,
        indices: npt.ArrayLike,
        normals: npt.ArrayLike | None = None,
        uvs: npt.ArrayLike | None = None,
    ) -> None:
        """Adds a copy of a mesh: positions (V, 3), indices (F, 3), normals (V, 3), uvs (V, 2).

        Raises ValueError for a wrong shape, and RuntimeError for an index out of range.
        """
        if self._given_uvs:
            raise RuntimeError("Meshes with and without positions cannot share an atlas")
        mesh: dict[str, Any] = dict(vertices=_array(positions, 3, "Position"), faces=_indices(indices))
        _check_range(mesh["faces"], len(mesh["vertices"]))
        for name, value, columns in (("normals", normals, 3), ("uvs", uvs, 2)):
            if value is None:
                continue
            mesh[name] = _array(value, columns, name[:-1].capitalize())
            _check_length(mesh[name], len(mesh["vertices"]), name[:-1].capitalize())
        self._given.append(mesh)

    def add_uv_mesh(
        self, uvs: npt.ArrayLike, indices: npt.ArrayLike, face_materials: npt.ArrayLike | None = None
    ) -> None:
        """Adds uvs (V, 2) whose islands are to be packed, indices (F, 3), materials (F,)."""
        if self._given:
            raise RuntimeError("Meshes with and without positions cannot share an atlas")
        array, faces = _array(uvs, 2, "Uv"), _indices(indices)
        _check_range(faces, len(array))
        materials = np.zeros(len(faces), np.uint32)
        if face_materials is not None:
            materials = np.array(face_materials, np.uint32)
            _check_length(materials, len(faces), "Material")
        self._given_uvs.append((array, faces, materials))

    def generate(
        self,
        chart_options: ChartOptions | None = None,
        pack_options: PackOptions | None = None,
        verbose: bool = False,
    ) -> None:
        """Makes charts and packs them, or packs the islands of uv meshes. `verbose` prints the progress."""
        chart = chart_options if chart_options is not None else ChartOptions()
        pack = pack_options if pack_options is not None else PackOptions()
        progress = _print if verbose else None
        if self._given_uvs:
            self._pack(pack, progress)
        elif self._given:
            self._unwrap(chart, pack, progress)

    def _unwrap(self, chart: ChartOptions, pack: PackOptions, progress: Any) -> None:
        atlas = libatlas.Atlas()
        for mesh in self._given:
            used = dict(mesh)
            if chart.normal_seam_weight <= _SEAMS_FROM:
                used.pop("normals", None)
            atlas.add(**used)
        options = pack._unwrap_options()
        options["keep_uvs"] = bool(chart.use_input_mesh_uvs)
        options["charts"] = "best" if chart.max_iterations > 1 else "standard"
        unwrapped = atlas.unwrap(progress=progress, **options)
        material = unwrapped.charts.material
        self._meshes = [_Mesh(m, m.triangle_page, m.triangle_chart, material) for m in unwrapped]
        self._finish(unwrapped, unwrapped.texels_per_unit)

    def _pack(self, pack: PackOptions, progress: Any) -> None:
        first = np.cumsum([0] + [len(uvs) for uvs, _, _ in self._given_uvs])
        uvs = np.concatenate([uvs for uvs, _, _ in self._given_uvs])
        faces = np.concatenate([f + np.uint32(first[i]) for i, (_, f, _) in enumerate(self._given_uvs)])
        packed = libatlas.pack_islands(uvs, faces, progress=progress, **pack._island_options())
        material = np.zeros(len(packed.island_page), np.uint32)
        material[packed.triangle_island] = np.concatenate([m for _, _, m in self._given_uvs])
        self._meshes, face = [], 0
        for i, (given, f, _) in enumerate(self._given_uvs):
            island = packed.triangle_island[face : face + len(f)]
            face += len(f)
            arrays = (np.arange(len(given), dtype=np.uint32), f, packed.uvs[first[i] : first[i + 1]])
            self._meshes.append(_Mesh(arrays, packed.island_page[island], island, material))
        self._finish(packed, packed.texels_per_uv)

    def _finish(self, result: libatlas.UnwrappedAtlas | libatlas.PackedIslands, density: float) -> None:
        self._pages = np.array(result.pages)
        self._utilization, self._texels_per_unit = result.utilization, density

    def __len__(self) -> int:
        return len(self._meshes)

    def __getitem__(self, index: int) -> _MeshArrays:
        return self.get_mesh(index)

    def _mesh(self, index: int) -> _Mesh:
        if not 0 <= index < len(self._meshes):
            raise IndexError(f"Mesh index {index} out of bounds for atlas with {len(self._meshes)} meshes.")
        return self._meshes[index]

    def get_mesh(self, mesh_index: int) -> _MeshArrays:
        """vmapping (N,), indices (F, 3) and uvs (N, 2), which run from 0 to 1."""
        mesh = self._mesh(mesh_index)
        return mesh.vmapping, mesh.faces, mesh.uvs

    def get_mesh_vertex_assignment(self, mesh_index: int) -> tuple[npt.NDArray[np.uint32], npt.NDArray[np.uint32]]:
        """For each vertex of the result its page and its chart, which is counted in its mesh."""
        mesh = self._mesh(mesh_index)
        page, chart = np.zeros((2, len(mesh.vmapping)), np.uint32)
        page[mesh.faces] = mesh.page[:, None]
        chart[mesh.faces] = mesh.chart[:, None]
        return page, chart

    def get_mesh_chart_count(self, mesh_index: int) -> int:
        return len(self._mesh(mesh_index).charts)

    def get_mesh_chart(self, mesh_index: int, chart_index: int) -> Chart:
        mesh = self._mesh(mesh_index)
        if not 0 <= chart_index < len(mesh.charts):
            message = f"Chart index {chart_index} out of bounds for mesh with {len(mesh.charts)} charts."
            raise IndexError(message)
        faces = np.flatnonzero(mesh.chart == chart_index).astype(np.uint32)
        page, material = int(mesh.page[faces[0]]), int(mesh.material[chart_index])
        return Chart(page, material, faces, ChartType.Piecewise)

    def _check_page(self, index: int) -> None:
        if not 0 <= index < len(self._pages):
            raise IndexError(f"Atlas index {index} out of bounds.")

    def get_utilization(self, atlas_index: int) -> float:
        """Area of the charts / area of the pages, over all pages."""
        self._check_page(atlas_index)
        return self._utilization

    def get_chart_image(self, atlas_index: int) -> npt.NDArray[np.uint8]:
        """(height, width, 3): charts of a page in colours, rows from the bottom."""
        self._check_page(atlas_index)
        width, height = (int(side) for side in self._pages[atlas_index])
        image = np.zeros((height, width, 3), np.uint8)
        colours = (255 * chart_colours(self.chart_count)).astype(np.uint8)
        for mesh in self._meshes:
            here = mesh.page == atlas_index
            corners = mesh.uvs[mesh.faces[here]] * self._pages[atlas_index]
            chart = mesh.charts[mesh.chart[here]]
            for triangle, x, y in covered_texels(corners, width, height):
                image[y, x] = colours[chart[triangle]]
        return image

    @property
    def chart_image(self) -> npt.NDArray[np.uint8]:
        return self.get_chart_image(0)

    @property
    def mesh_count(self) -> int:
        return len(self._meshes)

    @property
    def atlas_count(self) -> int:
        return len(self._pages)

    @property
    def chart_count(self) -> int:
        return sum(len(mesh.charts) for mesh in self._meshes)

    @property
    def width(self) -> int:
        """Of the widest page."""
        return int(self._pages[:, 0].max(initial=0))

    @property
    def height(self) -> int:
        """Of the highest page."""
        return int(self._pages[:, 1].max(initial=0))

    @property
    def texels_per_unit(self) -> float:
        return self._texels_per_unit

    @property
    def utilization(self) -> float:
        return self.get_utilization(0)


def parametrize(
    positions: npt.ArrayLike,
    indices: npt.ArrayLike,
    normals: npt.ArrayLike | None = None,
    uvs: npt.ArrayLike | None = None,
) -> _MeshArrays:
    """vmapping (N,), indices (F, 3) and uvs (N, 2) of one mesh, with the default options."""
    atlas = Atlas()
    atlas.add_mesh(positions, indices, normals, uvs)
    atlas.generate()
    return atlas[0]


def export(
    path: str | os.PathLike[str],
    positions: npt.ArrayLike,
    indices: npt.ArrayLike | None = None,
    uvs: npt.ArrayLike | None = None,
    normals: npt.ArrayLike | None = None,
) -> None:
    """Writes an OBJ file: positions (V, 3), indices (F, 3), uvs (V, 2), normals (V, 3)."""
    blocks = [("v", _array(positions, 3, "Position"))]
    if uvs is not None:
        blocks.append(("vt", _array(uvs, 2, "Uv")))
    if normals is not None:
        blocks.append(("vn", _array(normals, 3, "Normal")))
    for name, array in blocks[1:]:
        _check_length(array, len(blocks[0][1]), name)
    corner = {(False, False): "{0}", (True, False): "{0}/{0}", (False, True): "{0}//{0}"}.get(
        (uvs is not None, normals is not None), "{0}/{0}/{0}"
    )
    with open(path, "w", encoding="ascii") as file:
        for name, array in blocks:
            row = " ".join([name] + ["%.9g"] * array.shape[1]) + "\n"
            file.writelines(row % tuple(values) for values in array.tolist())
        faces = np.arange(len(blocks[0][1])).reshape(-1, 3) if indices is None else _indices(indices)
        file.writelines("f " + " ".join(corner.format(i + 1) for i in face) + "\n" for face in faces.tolist())


def _array(value: Any, columns: int, name: str) -> npt.NDArray[np.float32]:
    array = np.array(value, np.float32)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name} array expected to be Nx{columns}.")
    return array


def _indices(value: Any) -> npt.NDArray[np.uint32]:
    array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError("Index array expected to be Nx3.")
    if array.size and not (np.min(array) >= 0 and np.max(array) <= 0xFFFFFFFF):
        raise RuntimeError("Adding mesh failed: Index out of range")
    return np.array(array, np.uint32)


def _check_range(faces: npt.NDArray[np.uint32], count: int) -> None:
    if faces.size and faces.max() >= count:
        raise RuntimeError("Adding mesh failed: Index out of range")


def _check_length(array: npt.NDArray[Any], length: int, name: str) -> None:
    if array.shape[0] != length:
        raise ValueError(
            f"{name} array has invalid number of elements in the first dimension "
            f"(expected {length}, got {array.shape[0]})"
        )


def _print(stage: str, fraction: float) -> None:
    print(f"{stage} {100 * fraction:.0f} %", flush=True)
