"""Where the operators are: a tab in the uv editor's sidebar, and the menus UV and Object."""

from bpy.types import Panel

from .operators import CLASSES, OBJECT_OT_libatlas_lightmap, UV_OT_libatlas_pack_islands, UV_OT_libatlas_unwrap

IN_UV_MENUS = (UV_OT_libatlas_unwrap, UV_OT_libatlas_pack_islands)


class _OperatorPanel:
    """One operator with its properties, which keep what was used last."""

    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "libatlas"

    def draw(self, context):
        operator = self.operator
        layout = self.layout
        layout.operator(operator.bl_idname)
        layout.use_property_split = True
        layout.use_property_decorate = False
        properties = context.window_manager.operator_properties_last(operator.bl_idname)
        for name in operator.__annotations__:
            layout.prop(properties, name)


def _panel(operator):
    name = operator.__name__.replace("_OT_", "_PT_")
    return type(name, (_OperatorPanel, Panel), {"bl_idname": name, "bl_label": operator.bl_label, "operator": operator})


PANELS = tuple(map(_panel, CLASSES))


def draw_uv_menu(self, context):
    self.layout.separator()
    for operator in IN_UV_MENUS:
        self.layout.operator(operator.bl_idname)


def draw_object_menu(self, context):
    self.layout.separator()
    self.layout.operator(OBJECT_OT_libatlas_lightmap.bl_idname)
