"""One unwrapping of a mesh by one of the packages that compare.py compares, in a process of its own.

    python unwrappers.py NAME IN.obj OUT.obj

Prints a line of JSON: CPU and wall seconds of the unwrapping alone, and the sides of the page. All make one page of
about 2048 x 2048 texels with 2 texels of padding, and have their defaults otherwise.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np

PAGE, PADDING = 2048, 2


def by_libatlas(vertices, faces):
    import libatlas

    begin = clocks()
    result = libatlas.unwrap(vertices, faces, page_size=PAGE, padding=PADDING)
    uvs = result.corner_uvs
    return since(begin), uvs, result.pages[0]


def by_xatlas(vertices, faces):
    import xatlas

    begin = clocks()
    atlas = xatlas.Atlas()
    atlas.add_mesh(vertices, faces)
    options = xatlas.PackOptions()
    options.resolution, options.padding = PAGE, PADDING
    atlas.generate(pack_options=options)
    _, indices, uvs = atlas[0]
    uvs = uvs[indices]
    return since(begin), uvs, (atlas.width, atlas.height)


def by_uvunwrap(vertices, faces):
    import uvunwrap

    begin = clocks()
    mesh = uvunwrap.Mesh(np.ascontiguousarray(vertices, np.float32), np.ascontiguousarray(faces, np.uint32))
    atlas = uvunwrap.generate([mesh], page_size=PAGE, padding=PADDING)
    uvs = np.array(atlas.meshes[0].corner_uvs, np.float32).reshape(-1, 3, 2)
    return since(begin), uvs, (atlas.width, atlas.height)


def by_smart_uv(vertices, faces):
    return by_blender(vertices, faces, stretched=False)


def by_minimum_stretch(vertices, faces):
    return by_blender(vertices, faces, stretched=True)


def by_blender(vertices, faces, stretched):
    """Smart UV Project; with `stretched` its seams, along which Unwrap with minimum stretch flattens anew."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    item = bpy.data.objects.new("mesh", mesh)
    bpy.context.collection.objects.link(item)
    bpy.context.view_layer.objects.active = item
    item.select_set(True)
    begin = clocks()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=1.15192, island_margin=PADDING / PAGE)
    if stretched:
        bpy.ops.uv.seams_from_islands()
        bpy.ops.uv.unwrap(method="MINIMUM_STRETCH", margin=PADDING / PAGE)
    bpy.ops.object.mode_set(mode="OBJECT")
    took = since(begin)
    uvs = np.empty(6 * len(mesh.polygons), np.float32)
    mesh.uv_layers.active.data.foreach_get("uv", uvs)
    corners = np.empty(3 * len(mesh.polygons), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    if not np.array_equal(corners.reshape(-1, 3), faces):
        raise SystemExit("Blender has changed the faces")
    return took, uvs.reshape(-1, 3, 2), (PAGE, PAGE)


UNWRAPPERS = {
    "libatlas": by_libatlas,
    "xatlas": by_xatlas,
    "uvunwrap": by_uvunwrap,
    "Smart UV": by_smart_uv,
    "min. stretch": by_minimum_stretch,
}


def clocks():
    return time.process_time(), time.perf_counter()


def since(begin):
    return tuple(now - before for now, before in zip(clocks(), begin))


def read_obj(path: Path):
    """Positions and triangles. Polygons become fans; faces that name a vertex twice are left out."""
    vertices, faces = [], []
    for line in path.read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) for word in words[1:]]
            corners = [c - 1 if c > 0 else len(vertices) + c for c in corners]
            faces += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    return np.array(vertices), np.array([face for face in faces if len(set(face)) == 3])


def write_obj(path: Path, vertices, faces, uvs):
    """Corners whose uvs are equal share a line, as charts are told by it."""
    corner = np.concatenate([faces.reshape(-1, 1), uvs.reshape(-1, 2).view(np.int32)], 1)
    unique, index = np.unique(corner, axis=0, return_inverse=True)
    index = index.reshape(-1, 3)
    with path.open("w") as file:
        file.writelines(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in vertices.tolist())
        file.writelines(f"vt {u:.9g} {v:.9g}\n" for u, v in unique[:, 1:].astype(np.int32).view(np.float32).tolist())
        for face, uv in zip((faces + 1).tolist(), (index + 1).tolist()):
            file.write("f " + " ".join(f"{p}/{t}" for p, t in zip(face, uv)) + "\n")


def main():
    name, source, target = sys.argv[1:]
    vertices, faces = read_obj(Path(source))
    (cpu, wall), uvs, page = UNWRAPPERS[name](vertices, faces)
    write_obj(Path(target), vertices, faces, np.ascontiguousarray(uvs, np.float32))
    print(json.dumps({"cpu": cpu, "wall": wall, "page": [int(side) for side in page], "triangles": len(faces)}))


if __name__ == "__main__":
    main()
