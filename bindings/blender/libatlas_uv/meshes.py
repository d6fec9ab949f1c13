"""Blender's meshes as arrays, and uvs back into them."""

from __future__ import annotations

import contextlib

import bmesh
import bpy
import numpy as np

from . import islands
from .calls import Faces, Refused


def objects_to_unwrap(context):
    """The objects in edit mode, or the selected ones; of those that share a mesh the first."""
    if context.mode == "EDIT_MESH":
        chosen = context.objects_in_mode_unique_data
    else:
        chosen = {item.data: item for item in reversed(context.selected_objects)}.values()
    items = sorted((item for item in chosen if item.type == "MESH"), key=lambda item: item.name_full)
    if not items:
        raise Refused("No mesh is selected")
    for item in items:
        if item.data.library is not None:
            raise Refused(f"{item.name}: its mesh is linked from another file, and cannot be changed")
    return items


def read(item, *, selected_uvs=False, layer=None, world=lambda item: True):
    """The faces of an object; in edit mode those that are selected and not hidden.

    Positions are as large as in the scene where `world` says so: texels then have one size on all objects.
    `selected_uvs`: of those faces, only islands with a selected uv, as in the uv editor.
    """
    with _as_mesh(item.data) as mesh:
        chosen = np.ones(len(mesh.polygons), bool)
        if item.data.is_editmode:
            chosen = _column(mesh.polygons, "select", bool)  # which no hidden face is
        whole = _all_faces(item, mesh, layer or _active(mesh), world(item))
    faces = whole.some(chosen)
    if not selected_uvs:
        return faces
    selected = _selected_uvs(item.data)[np.repeat(chosen, whole.sizes)]
    _, island = islands.find_islands(faces.corners, faces.sizes, faces.uvs)
    return faces.some(islands.faces_with(island, faces.sizes, selected))


def write(item, faces, uvs, layer=None):
    """Writes the uvs of corners into the active layer, or the layer of that name, which is made where there is none."""
    if item.data.is_editmode:
        _write_edited(item.data, faces, uvs)
        return
    mesh = item.data
    layer = layer or _active(mesh) or "UVMap"
    target = mesh.uv_layers.get(layer) or mesh.uv_layers.new(name=layer)
    if target is None:
        raise Refused(f"{item.name}: there is no room for one more UV map")
    loops = _loops_of(mesh)
    place = np.concatenate([[0], np.cumsum(loops[1])])
    at = loops[0][faces.numbers].repeat(faces.sizes) + _within(faces.sizes)
    if place[-1] != len(mesh.loops):
        raise Refused(f"{item.name}: the mesh has changed meanwhile")
    values = _column(target.data, "uv", np.float32, 2)
    values[at] = uvs
    target.data.foreach_set("uv", values.ravel())
    mesh.update()


def scales(items):
    """The mean scale of each object."""
    return np.array([abs(item.matrix_world.to_3x3().determinant()) ** (1 / 3) for item in items], np.float32)


@contextlib.contextmanager
def _as_mesh(mesh):
    """The mesh as it is; in edit mode a copy of what is being edited."""
    if not mesh.is_editmode:
        yield mesh
        return
    copy = bpy.data.meshes.new("libatlas")
    try:
        bmesh.from_edit_mesh(mesh).to_mesh(copy)
        yield copy
    finally:
        bpy.data.meshes.remove(copy)


def _active(mesh):
    return mesh.uv_layers.active.name if mesh.uv_layers.active else None


def _column(collection, name, kind, width=1):
    values = np.empty(len(collection) * width, kind)
    collection.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def _loops_of(mesh):
    return _column(mesh.polygons, "loop_start", np.int32), _column(mesh.polygons, "loop_total", np.int32)


def _within(sizes):
    """0, 1, ... for the corners of each face."""
    return np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)


def _all_faces(item, mesh, layer, world):
    start, sizes = _loops_of(mesh)
    loops = start.repeat(sizes) + _within(sizes)  # in Blender they lie in the order of their faces
    place = np.empty(len(mesh.loops), np.int64)
    place[loops] = np.arange(len(loops))
    vertices = _column(mesh.vertices, "co", np.float32, 3)
    if world:
        vertices = vertices @ np.array(item.matrix_world.to_3x3(), np.float32).T
    mesh.calc_loop_triangles()
    uvs = np.zeros((len(loops), 2), np.float32)
    pinned = np.zeros(len(loops), bool)
    if layer and layer in mesh.uv_layers:
        data = mesh.uv_layers[layer].data
        uvs, pinned = _column(data, "uv", np.float32, 2)[loops], _column(data, "pin_uv", bool)[loops]
    edges = _column(mesh.loops, "edge_index", np.int32)[loops]
    return Faces(
        name=item.name,
        vertices=np.ascontiguousarray(vertices),
        sizes=sizes.astype(np.int64),
        corners=_column(mesh.loops, "vertex_index", np.int32)[loops].astype(np.uint32),
        seams=_column(mesh.edges, "use_seam", bool)[edges],
        materials=_column(mesh.polygons, "material_index", np.int32).astype(np.uint32),
        uvs=uvs,
        pinned=pinned,
        triangles=place[_column(mesh.loop_triangles, "loops", np.int32, 3)],
        triangle_face=_column(mesh.loop_triangles, "polygon_index", np.int32),
        numbers=np.arange(len(sizes)),
    )


def _selected_uvs(mesh):
    """One a corner: whether its uv is selected in the uv editor."""
    editing = bmesh.from_edit_mesh(mesh)
    layer = editing.loops.layers.uv.verify()
    loops = (loop for face in editing.faces for loop in face.loops)
    if bpy.app.version >= (5, 0):
        return np.array([loop.uv_select_vert for loop in loops], bool)
    return np.array([loop[layer].select for loop in loops], bool)


def _write_edited(mesh, faces, uvs):
    editing = bmesh.from_edit_mesh(mesh)
    layer = editing.loops.layers.uv.verify()
    editing.faces.ensure_lookup_table()
    values = iter(uvs.tolist())
    for number in faces.numbers.tolist():
        for loop in editing.faces[number].loops:
            loop[layer].uv = next(values)
    bmesh.update_edit_mesh(mesh, loop_triangles=False, destructive=False)
