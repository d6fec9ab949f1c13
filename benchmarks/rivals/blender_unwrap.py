# Unwraps an OBJ with Blender's own operators:
#   blender -b --factory-startup -P blender_unwrap.py -- smart|lightmap IN.obj OUT.obj
# Needs Blender 3.3 or newer (wm.obj_import, wm.obj_export).
import sys

import bpy

kind, source, target = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=source, forward_axis="Y", up_axis="Z")
mesh = bpy.context.selected_objects[0]
bpy.context.view_layer.objects.active = mesh
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.select_all(action="SELECT")
if kind == "smart":
    bpy.ops.uv.smart_project(angle_limit=1.15192, island_margin=2 / 2048)
else:
    bpy.ops.uv.lightmap_pack(PREF_CONTEXT="ALL_FACES", PREF_MARGIN_DIV=0.1)
bpy.ops.object.mode_set(mode="OBJECT")
bpy.ops.wm.obj_export(
    filepath=target, export_selected_objects=True, export_materials=False,
    export_normals=False, forward_axis="Y", up_axis="Z",
)
