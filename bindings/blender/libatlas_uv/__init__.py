"""Unwrapping and packing by libatlas in Blender, from 3.4 on."""

import bpy

from . import wheel

bl_info = {  # for Blender before 4.2, which does not read blender_manifest.toml
    "name": "libatlas UV",
    "description": "Unwraps within a bound on stretch, packs islands, and makes UVs for lightmaps",
    "author": "The authors of libatlas",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "UV Editor > Sidebar > libatlas; menus UV and Object",
    "category": "UV",
}

MENUS = {"IMAGE_MT_uvs": "draw_uv_menu", "VIEW3D_MT_uv_map": "draw_uv_menu", "VIEW3D_MT_object": "draw_object_menu"}


def register():
    wheel.provide()
    from . import operators, panels

    for cls in (*operators.CLASSES, *panels.PANELS):
        bpy.utils.register_class(cls)
    for menu, draw in MENUS.items():
        getattr(bpy.types, menu).append(getattr(panels, draw))


def unregister():
    from . import operators, panels

    for menu, draw in MENUS.items():
        getattr(bpy.types, menu).remove(getattr(panels, draw))
    for cls in reversed((*operators.CLASSES, *panels.PANELS)):
        bpy.utils.unregister_class(cls)
