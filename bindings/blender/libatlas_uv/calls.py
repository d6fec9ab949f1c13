"""The library's calls, on faces that were read from Blender's meshes. Nothing here knows Blender."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass

import libatlas
import numpy as np

from . import islands

TILES = 10  # of a row of UDIM


@dataclass
class Faces:
    """Some faces of one mesh. Arrays have one element a vertex of the mesh, a face, or a corner, face after face."""

    name: str  # of the object
    vertices: np.ndarray  # (V, 3) float32
    sizes: np.ndarray  # (F,) int64: corners of each
    corners: np.ndarray  # (C,): vertices
    seams: np.ndarray  # (C,): whether the edge from this corner to the next is marked as one
    materials: np.ndarray  # (F,)
    uvs: np.ndarray  # (C, 2) float32
    pinned: np.ndarray  # (C,)
    triangles: np.ndarray  # (T, 3): corners
    triangle_face: np.ndarray  # (T,)
    numbers: np.ndarray  # (F,): of the faces in their mesh
    densities: np.ndarray | None = None  # one an instance

    def some(self, chosen):
        """Those faces for which the array is true."""
        of_corner = np.repeat(chosen, self.sizes)
        place = np.cumsum(of_corner) - 1
        face = np.cumsum(chosen) - 1
        kept = chosen[self.triangle_face]
        return Faces(
            name=self.name,
            vertices=self.vertices,
            sizes=self.sizes[chosen],
            corners=self.corners[of_corner],
            seams=self.seams[of_corner],
            materials=self.materials[chosen],
            uvs=self.uvs[of_corner],
            pinned=self.pinned[of_corner],
            triangles=place[self.triangles[kept]],
            triangle_face=face[self.triangle_face[kept]],
            numbers=self.numbers[chosen],
            densities=self.densities,
        )


@dataclass
class Laid:
    """Where an operator has put the faces."""

    uvs: list[np.ndarray]  # one a mesh: (C, 2)
    told: str  # the result in a line
    warnings: list[str]
    instances: list[libatlas.Instances]  # one a mesh


class Refused(Exception):
    """What was asked for cannot be done; the text says why."""


def collecting_warnings(call):
    """Adds the library's warnings to what the call returns."""

    def run(*arguments):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            laid = call(*arguments)
        laid.warnings += [str(warning.message) for warning in caught]
        return laid

    return run


@collecting_warnings
def unwrap(meshes, options, progress):
    """New uvs for all faces but those of pinned islands, on one atlas."""
    held = [_pinned_faces(mesh) for mesh in meshes]
    free = [mesh.some(~stays) for mesh, stays in zip(meshes, held)]
    if not any(len(mesh.sizes) for mesh in free):
        raise Refused("All islands are pinned, so there is nothing to unwrap")
    pinned = any(stays.any() for stays in held)
    if pinned and options.get("pages", 1) > 1:
        raise Refused("Pinned islands stay on their page: set Pages to 1, or unpin them")
    used = [mesh for mesh in free if len(mesh.sizes)]
    try:
        atlas = _atlas_of(used, options.get("keep_uvs", False))
        result = atlas.unwrap(progress=progress, **{**options, "square": not pinned})
    except libatlas.Error as error:
        raise Refused(_explained(error, used)) from error
    for mesh, unwrapped in zip(used, result):
        mesh.uvs = _tiled_uvs(mesh, unwrapped)
    told = f"{_counted(len(result.charts), 'chart')}, L2 stretch {result.distortion.stretch_l2:.4f}, "
    if pinned:
        taken = [mesh.some(stays) for mesh, stays in zip(meshes, held)]
        told += _pack_beside(taken, used, _pack_options(options), progress)
    else:
        told += _described(result.pages, result.utilization)
    return Laid(_merged(meshes, held, free), told, _cut_faces(used, result), [mesh.instances for mesh in result])


@collecting_warnings
def pack(meshes, options, progress):
    """The islands of the uvs that are there, moved, turned and scaled by one factor; pinned ones stay."""
    held = [_pinned_faces(mesh) for mesh in meshes]
    free = [mesh.some(~stays) for mesh, stays in zip(meshes, held)]
    used = [mesh for mesh in free if len(mesh.sizes)]
    if not used:
        raise Refused("All islands are pinned, so there is nothing to pack")
    if any(stays.any() for stays in held):
        if options.get("pages", 1) > 1:
            raise Refused("Pinned islands stay on their page: set Pages to 1, or unpin them")
        taken = [mesh.some(stays) for mesh, stays in zip(meshes, held)]
        told = _pack_beside(taken, used, options, progress)
    else:
        packed = _pack(used, {**options, "square": True}, progress)
        for mesh, uvs in zip(used, _of_meshes(used, packed, options["page_size"])):
            mesh.uvs = uvs
        told = _described(packed.pages, packed.utilization)
    return Laid(_merged(meshes, held, free), told, [], [])


def _explained(error, meshes):
    """The library's message with the names of objects and the numbers of their faces."""

    def name(match):
        mesh = meshes[int(match[1])]
        return mesh.name if match[3] is None else f"{mesh.name}: face {mesh.numbers[int(match[3])]}"

    return re.sub(r"\bmesh (\d+)(: polygon (\d+))?", name, str(error))


def _atlas_of(meshes, keep_uvs):
    atlas = libatlas.Atlas()
    for mesh in meshes:
        given = {}
        if keep_uvs:
            same, _ = islands.find_islands(mesh.corners, mesh.sizes, mesh.uvs)
            given = {"uvs": mesh.uvs, "uv_faces": same}
        atlas.add(
            mesh.vertices,
            mesh.corners,
            polygon_sizes=mesh.sizes,
            materials=mesh.materials,
            seams=mesh.seams,
            instances=mesh.densities,
            **given,
        )
    return atlas


def _pinned_faces(mesh):
    if not mesh.pinned.any():
        return np.zeros(len(mesh.sizes), bool)
    _, island = islands.find_islands(mesh.corners, mesh.sizes, mesh.uvs)
    return islands.faces_with(island, mesh.sizes, mesh.pinned)


def _tiled_uvs(mesh, unwrapped):
    """Uvs of corners, those of page p on the p-th tile of UDIM."""
    page = np.zeros(len(mesh.sizes), np.int64)
    page[unwrapped.triangle_polygon] = unwrapped.triangle_page
    return unwrapped.corner_uvs + _tile(np.repeat(page, mesh.sizes))


def _tile(page):
    return np.stack([page % TILES, page // TILES], 1).astype(np.float32)


def _merged(meshes, held, free):
    """The uvs of all faces: the new ones of those that were free."""
    merged = []
    for mesh, stays, part in zip(meshes, held, free):
        uvs = mesh.uvs.copy()
        uvs[np.repeat(~stays, mesh.sizes)] = part.uvs
        merged.append(uvs)
    return merged


def _pack(meshes, options, progress):
    uvs, faces, base = [], [], 0
    for mesh in meshes:
        same, _ = islands.find_islands(mesh.corners, mesh.sizes, mesh.uvs)
        uvs.append(mesh.uvs[same])
        faces.append(same[mesh.triangles] + base)
        base += len(mesh.uvs)
    try:
        return libatlas.pack_islands(np.concatenate(uvs), np.concatenate(faces), progress=progress, **options)
    except libatlas.Error as error:
        raise Refused(str(error)) from error


def _of_meshes(meshes, packed, page_size):
    """The packed uvs of each mesh's corners, in pages of this size, on the tiles of their pages."""
    uvs, triangle = [], 0
    for mesh in meshes:
        island = np.zeros(len(mesh.sizes), np.int64)
        island[mesh.triangle_face] = packed.triangle_island[triangle : triangle + len(mesh.triangles)]
        triangle += len(mesh.triangles)
        of_corner = np.repeat(island, mesh.sizes)
        angle, offset = packed.island_angle[of_corner], packed.island_offset[of_corner]
        x, y = (mesh.uvs * packed.texels_per_uv).T
        cosine, sine = np.cos(angle), np.sin(angle)
        turned = np.stack([cosine * x - sine * y, sine * x + cosine * y], 1) + offset
        uvs.append((turned / page_size).astype(np.float32) + _tile(packed.island_page[of_corner]))
    return uvs


def _pack_options(options):
    """Those of packing among those of unwrapping."""
    chosen = {
        name: options[name] for name in ("page_size", "padding", "alignment", "allow_rotation") if name in options
    }
    return {**chosen, "preset": options.get("packing", "standard")}


def _pack_beside(taken, free, options, progress):
    """Packs islands into the largest free rectangle that has the shape in which they pack best."""
    cells = islands.occupied_cells(np.concatenate([mesh.uvs[mesh.triangles] for mesh in taken]))
    page_size = size = options["page_size"]
    may_turn = options.get("allow_rotation", True)
    for _ in range(6):  # the shape depends a little on the size, which padding does not scale with
        packed = _pack(free, {**options, "page_size": size}, progress)
        width, height = (packed.pages[0] / page_size).tolist()
        rooms = [(*islands.largest_room(cells, width, height), False)]
        if may_turn:
            rooms.append((*islands.largest_room(cells, height, width), True))
        scale, left, low, turned = max(rooms, key=lambda room: room[0])
        if scale == 1 or size * scale < 64:
            break
        size = min(int(size * scale), size - 1)
    if size * scale < 64:
        raise Refused("Pinned islands leave too little room for the others: move or unpin some")
    for mesh, uvs in zip(free, _of_meshes(free, packed, page_size)):
        x, y = uvs.T
        mesh.uvs = np.stack([height - y, x] if turned else [x, y], 1) * np.float32(scale) + np.float32([left, low])
    return f"beside pinned islands, in {width * height * scale * scale:.0%} of the page"


def _cut_faces(meshes, result):
    warned = []
    for mesh, unwrapped in zip(meshes, result):
        cut = unwrapped.cut_polygons
        if len(cut):
            warned.append(
                f"{mesh.name}: {_counted(len(cut), 'face')} do not lie flat in one piece, the first is "
                f"{mesh.numbers[cut[0]]}; triangulate them"
            )
    return warned


def _described(pages, utilization):
    width, height = pages[0].tolist()
    many = "" if len(pages) == 1 else f"{len(pages)} pages, the first of "
    return f"{utilization:.0%} of {many or 'the page of '}{width} x {height} used"


def _counted(count, noun):
    return f"{count} {noun}" + ("" if count == 1 else "s")
