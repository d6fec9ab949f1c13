"""The operators. Their properties have the names of the library's options."""

import libatlas
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy.types import Operator

from . import calls, meshes
from .calls import Refused
from .jobs import JobOperator

PRESETS = [
    ("fast", "Fast", "For many meshes at once"),
    ("standard", "Standard", "What most meshes want"),
    ("best", "Best", "Tries several layouts; takes several times as long"),
]


def _page_size(default):
    return IntProperty(
        name="Page Size",
        description="Side of the square image in texels, a power of two",
        default=default,
        min=64,
        max=16384,
    )


def _padding():
    return IntProperty(name="Padding", description="Texels kept free around each chart", default=2, min=0, max=4096)


def _pages():
    return IntProperty(
        name="Pages",
        description="The most images to use. Page p lies on the UDIM tile 1001 + p",
        default=1,
        min=1,
        max=100,
    )


def _allow_rotation():
    return BoolProperty(name="Rotate", description="Turn charts to pack better", default=True)


def _preset(name, description):
    return EnumProperty(name=name, description=description, items=PRESETS, default="standard")


def _in_mode(context):
    return context.mode in {"OBJECT", "EDIT_MESH"}


def _options(operator, *names):
    return {name: getattr(operator, name) for name in names}


def _read(operator, items, **how):
    """The faces of all objects, of those that have any."""
    faces = [meshes.read(item, **how) for item in items]
    operator.read = [(item, part) for item, part in zip(items, faces) if len(part.sizes)]
    if not operator.read:
        raise Refused("No face is selected")
    return [part for _, part in operator.read]


class _WritesUVs(JobOperator):
    """Writes what was laid out to the faces that _read() has read."""

    def finish(self, laid):
        for (item, faces), uvs in zip(self.read, laid.uvs):
            meshes.write(item, faces, uvs)


class UV_OT_libatlas_unwrap(_WritesUVs, Operator):
    """Cut the selected faces into charts, flatten them within a bound on stretch, and pack them on one atlas"""

    bl_idname = "uv.libatlas_unwrap"
    bl_label = "Unwrap (libatlas)"
    bl_options = {"REGISTER", "UNDO"}

    max_stretch: FloatProperty(
        name="Max Stretch",
        description="Bound on stretch over 99.9 % of each chart's area",
        default=1.25,
        min=1.001,
        soft_max=2,
    )
    charts: _preset("Charts", "Effort for charts")
    crease_degrees: FloatProperty(
        name="Crease", description="Bend of an edge from which on a seam costs only a quarter; degrees", default=60, min=0, max=180
    )
    cone_degrees: FloatProperty(
        name="Cone", description="Most degrees between a chart's axis and its normals; 0: any", default=0, min=0, max=90
    )
    min_fill: FloatProperty(
        name="Min Fill",
        description="Charts that leave the page emptier than this are cut; 0: only marked seams and stretch cut",
        default=0.72,
        min=0,
        max=0.99,
    )
    seam_weight: FloatProperty(
        name="Seam Weight",
        description="What seams count beside stretch: more gives fewer charts and shorter seams",
        default=1,
        min=0.001,
        soft_min=0.1,
        soft_max=10,
        max=1000,
    )
    split_at_materials: BoolProperty(
        name="Split at Materials", description="A chart holds one material only", default=False
    )
    keep_uvs: BoolProperty(
        name="Keep UVs", description="Keep the islands that are there where they are usable", default=False
    )
    page_size: _page_size(2048)
    padding: _padding()
    pages: _pages()
    texels_per_unit: FloatProperty(
        name="Texels per Unit", description="Of length in the scene; 0: as many as the pages hold", default=0, min=0
    )
    allow_rotation: _allow_rotation()
    packing: _preset("Packing", "Effort for packing")

    @classmethod
    def poll(cls, context):
        return _in_mode(context)

    def prepare(self, context):
        faces = _read(self, meshes.objects_to_unwrap(context))
        options = _options(self, *list(UV_OT_libatlas_unwrap.__annotations__))
        return lambda progress: calls.unwrap(faces, options, progress)


class UV_OT_libatlas_pack_islands(_WritesUVs, Operator):
    """Move, turn and scale the islands of the selected faces so that they fill the page. Pinned islands stay"""

    bl_idname = "uv.libatlas_pack_islands"
    bl_label = "Pack Islands (libatlas)"
    bl_options = {"REGISTER", "UNDO"}

    page_size: _page_size(2048)
    padding: _padding()
    pages: _pages()
    scale: BoolProperty(
        name="Scale", description="Fill the page. Off: islands keep their size if the page holds them", default=True
    )
    allow_rotation: _allow_rotation()
    preset: _preset("Preset", "Effort")

    @classmethod
    def poll(cls, context):
        return _in_mode(context)

    def prepare(self, context):
        items = [item for item in meshes.objects_to_unwrap(context) if item.data.uv_layers]
        if not items:
            raise Refused("There are no UVs to pack: unwrap first")
        in_editor = context.area is not None and context.area.type == "IMAGE_EDITOR"
        only_selected = in_editor and context.mode == "EDIT_MESH" and not context.scene.tool_settings.use_uv_select_sync
        faces = _read(self, items, selected_uvs=only_selected)
        options = _options(self, "page_size", "padding", "pages", "allow_rotation", "preset")
        options["texels_per_uv"] = 0 if self.scale else self.page_size
        return lambda progress: calls.pack(faces, options, progress)


class OBJECT_OT_libatlas_lightmap(JobOperator, Operator):
    """Make a UV map for one lightmap of all selected objects. Objects that share a mesh get places of their own as \
custom properties"""

    bl_idname = "object.libatlas_lightmap"
    bl_label = "Lightmap UVs (libatlas)"
    bl_options = {"REGISTER", "UNDO"}

    uv_map: StringProperty(name="UV Map", description="Its name; made where there is none", default="Lightmap")
    texels_per_metre: FloatProperty(
        name="Texels per Metre", description="0: as many as the page holds", default=0, min=0
    )
    page_size: _page_size(1024)

    @classmethod
    def poll(cls, context):
        return context.mode == "OBJECT"

    def prepare(self, context):
        if not self.uv_map:
            raise Refused("UV Map: a name is needed")
        items = meshes.objects_to_unwrap(context)
        self.shown = {
            item.data: [other for other in context.selected_objects if other.data == item.data] for item in items
        }
        faces = _read(self, items, layer=self.uv_map, world=lambda item: len(self.shown[item.data]) == 1)
        for item, part in self.read:
            part.pinned[:] = False  # all is made anew
            if len(self.shown[item.data]) > 1:
                part.densities = meshes.scales(self.shown[item.data])
        options = dict(
            libatlas.lightmap_options(self.texels_per_metre, context.scene.unit_settings.scale_length or 1),
            page_size=self.page_size,
        )
        return lambda progress: calls.unwrap(faces, options, progress)

    def finish(self, laid):
        for (item, faces), uvs, places in zip(self.read, laid.uvs, laid.instances):
            meshes.write(item, faces, uvs, layer=self.uv_map)
            item.data.uv_layers[self.uv_map].active = True
            for shown, scale, offset in zip(self.shown[item.data], places.scale, places.offset):
                shown["lightmap_scale"], shown["lightmap_offset"] = scale.tolist(), offset.tolist()


CLASSES = (UV_OT_libatlas_unwrap, UV_OT_libatlas_pack_islands, OBJECT_OT_libatlas_lightmap)
