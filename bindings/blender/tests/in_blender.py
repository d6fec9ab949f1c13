"""Tests of the extension, run in Blender: blender -b --factory-startup -P in_blender.py -- EXTENSION.zip, or by Python
with the module bpy: python in_blender.py -- EXTENSION.zip. BLENDER_USER_RESOURCES must name a fresh folder.
"""

import math
import sys
import unittest

import bpy  # before bmesh, which it brings with it
import bmesh
import numpy as np

ZIP = sys.argv[sys.argv.index("--") + 1]
SIDE = 1024  # of the grid that overlaps are looked for in


def install():
    """As a user does from the preferences."""
    if bpy.app.version < (4, 2):
        bpy.ops.preferences.addon_install(filepath=ZIP)
        bpy.ops.preferences.addon_enable(module="libatlas_uv")
        return "libatlas_uv"
    bpy.ops.preferences.addon_enable(module="bl_pkg")
    bpy.ops.extensions.package_install_files(filepath=ZIP, repo="user_default", enable_on_install=True)
    return "bl_ext.user_default.libatlas_uv"


def reset():
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()


def cage(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    item = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(item)
    return item


def quad_sphere(cuts=7):
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=cuts)
    bpy.ops.transform.tosphere(value=1)
    bpy.ops.object.mode_set(mode="OBJECT")
    return bpy.context.object


def monkey():
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.object


def select(*items):
    bpy.ops.object.select_all(action="DESELECT")
    for item in items:
        item.select_set(True)
    bpy.context.view_layer.objects.active = items[0]
    bpy.context.view_layer.update()


def uvs_of(item, layer=None):
    layers = item.data.uv_layers
    data = (layers[layer] if layer else layers.active).data
    uvs = np.empty(2 * len(data), np.float32)
    data.foreach_get("uv", uvs)
    return uvs.reshape(-1, 2)


def triangles_of(item, layer=None):
    """(T, 3, 2) uvs."""
    item.data.calc_loop_triangles()
    loops = np.array([triangle.loops[:] for triangle in item.data.loop_triangles])
    return uvs_of(item, layer)[loops].astype(np.float64)


def areas(triangles):
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2


def areas_in_space(item):
    item.data.calc_loop_triangles()
    return np.array([triangle.area for triangle in item.data.loop_triangles])


def most_in_a_texel(triangles):
    """How many triangles cover the centre of a texel at most, but for centres near an edge."""
    count = np.zeros((SIDE, SIDE), int)
    for corners in triangles * SIDE:
        if areas(corners[None])[0] < 0:
            corners = corners[::-1]
        low = np.clip(np.floor(corners.min(0)), 0, SIDE).astype(int)
        high = np.clip(np.ceil(corners.max(0)), 0, SIDE).astype(int)
        x, y = np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1])[:, None] + 0.5
        inside = np.ones((len(y), x.size), bool)
        for p, q in zip(corners, np.roll(corners, -1, 0)):
            inside &= (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) > 0.01 * np.hypot(*(q - p))
        count[low[1] : high[1], low[0] : high[0]] += inside
    return count.max()


def mark(item, attribute, of_face):
    """Sets an attribute of faces by a function of the face, in edit mode."""
    editing = bmesh.from_edit_mesh(item.data)
    for face in editing.faces:
        getattr(face, attribute)(of_face(face))
    bmesh.update_edit_mesh(item.data)


class Extension(unittest.TestCase):
    def setUp(self):
        reset()

    def check_uvs(self, *items, layer=None):
        """In the page, not turned over, and apart from each other."""
        every = np.concatenate([triangles_of(item, layer) for item in items])
        self.assertGreaterEqual(every.min(), 0)
        self.assertLessEqual(every.max(), 1)
        self.assertGreater(areas(every).min(), 0)
        self.assertEqual(most_in_a_texel(every), 1)

    def test_a_quad_sphere(self):
        item = quad_sphere()
        self.assertEqual(bpy.ops.uv.libatlas_unwrap(), {"FINISHED"})
        self.check_uvs(item)
        self.assertEqual({len(face.vertices) for face in item.data.polygons}, {4})
        ratio = areas(triangles_of(item)) / areas_in_space(item)
        self.assertLess(ratio.max() / ratio.min(), 1.6)
        self.assertGreater(areas(triangles_of(item)).sum(), 0.5)

    def test_seams_that_were_marked_by_hand(self):
        item = monkey()
        mesh = item.data
        mirror = [edge.index for edge in mesh.edges if all(abs(mesh.vertices[v].co.x) < 1e-6 for v in edge.vertices)]
        self.assertGreater(len(mirror), 20)
        for seams in ([], mirror):
            for index in seams:
                mesh.edges[index].use_seam = True
            bpy.ops.uv.libatlas_unwrap()
            self.check_uvs(item)
            places = {}  # the uvs of both ends by edge and face
            uvs = uvs_of(item)
            for face in mesh.polygons:
                for loop in face.loop_indices:
                    following = loop + 1 if loop + 1 in face.loop_indices else face.loop_start
                    ends = {mesh.loops[i].vertex_index: tuple(uvs[i]) for i in (loop, following)}
                    places.setdefault(mesh.loops[loop].edge_index, []).append(sorted(ends.items()))
            torn = [edge for edge in mirror if len(places[edge]) == 2 and places[edge][0] != places[edge][1]]
            if seams:
                self.assertEqual(len(torn), len([edge for edge in mirror if len(places[edge]) == 2]))
            else:
                self.assertLess(len(torn), len(mirror) / 2)

    def test_two_objects_share_one_atlas(self):
        first, second = quad_sphere(), monkey()
        second.scale = (3, 3, 3)
        second.location = (5, 0, 0)
        select(first, second)
        self.assertEqual(bpy.ops.uv.libatlas_unwrap(page_size=1024), {"FINISHED"})
        self.check_uvs(first, second)
        density = [areas(triangles_of(item)).sum() / areas_in_space(item).sum() for item in (first, second)]
        self.assertAlmostEqual(density[1] / density[0] / 9, 1, delta=0.15)  # texels have one size in the scene

    def test_n_gons_stay_whole(self):
        bpy.ops.mesh.primitive_cylinder_add(vertices=48)
        item = bpy.context.object
        bpy.ops.uv.libatlas_unwrap()
        self.check_uvs(item)
        self.assertEqual(sorted(len(face.vertices) for face in item.data.polygons), [4] * 48 + [48] * 2)
        uvs = uvs_of(item)
        for face in item.data.polygons:
            if len(face.vertices) == 48:  # congruent to the face
                at = uvs[list(face.loop_indices)].astype(np.float64)
                radius = np.hypot(*(at - at.mean(0)).T)
                self.assertLess(radius.max() / radius.min(), 1.001)

    def test_a_mirrored_object_is_not_turned_over(self):
        item = monkey()
        item.scale = (-1, 1, 1)
        bpy.context.view_layer.update()
        bpy.ops.uv.libatlas_unwrap()
        self.check_uvs(item)

    def test_hidden_and_unselected_faces_keep_their_uvs(self):
        item = monkey()
        before = uvs_of(item).copy()
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="DESELECT")
        mark(item, "select_set", lambda face: face.calc_center_median().x > 0)
        mark(item, "hide_set", lambda face: face.calc_center_median().z > 0.3)
        chosen = [face.select and not face.hide for face in bmesh.from_edit_mesh(item.data).faces]
        self.assertTrue(any(chosen) and not all(chosen))
        for call in (bpy.ops.uv.libatlas_unwrap, bpy.ops.uv.libatlas_pack_islands):
            self.assertEqual(call(), {"FINISHED"})
            bpy.ops.object.mode_set(mode="OBJECT")
            after = uvs_of(item)
            for face in item.data.polygons:
                loops = list(face.loop_indices)
                self.assertEqual((before[loops] == after[loops]).all(), not chosen[face.index], face.index)
            picked = [
                triangle
                for triangle in zip(triangles_of(item), item.data.loop_triangles)
                if chosen[triangle[1].polygon_index]
            ]
            self.assertEqual(most_in_a_texel(np.array([uvs for uvs, _ in picked])), 1)
            bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.object.mode_set(mode="OBJECT")

    def test_edit_mode_of_two_objects(self):
        first, second = quad_sphere(), monkey()
        select(first, second)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.libatlas_unwrap()
        self.assertEqual(bpy.context.mode, "EDIT_MESH")
        bpy.ops.object.mode_set(mode="OBJECT")
        self.check_uvs(first, second)

    def pin_first_island(self, item):
        """Unwraps, moves one island to a place, and pins one of its uvs. Returns its faces."""
        bpy.ops.uv.libatlas_unwrap()
        mesh, uvs = item.data, uvs_of(item)
        at = {}
        for loop in mesh.loops:
            at.setdefault((loop.vertex_index, *uvs[loop.index].tolist()), []).append(loop.index)
        face_of = {loop: face.index for face in mesh.polygons for loop in face.loop_indices}
        island, fresh = set(), [0]
        while fresh:
            face = fresh.pop()
            if face in island:
                continue
            island.add(face)
            for loop in mesh.polygons[face].loop_indices:
                fresh += [face_of[i] for i in at[mesh.loops[loop].vertex_index, *uvs[loop].tolist()]]
        loops = [loop for face in island for loop in mesh.polygons[face].loop_indices]
        middle = (uvs[loops].max(0) + uvs[loops].min(0)) / 2
        uvs[loops] += 0.5 - middle
        mesh.uv_layers.active.data.foreach_set("uv", uvs.ravel())
        mesh.uv_layers.active.data[loops[0]].pin_uv = True
        return island, loops

    def test_pinned_islands_stay(self):
        item = monkey()
        island, loops = self.pin_first_island(item)
        self.assertLess(len(island), len(item.data.polygons))
        before = uvs_of(item).copy()
        for call in (bpy.ops.uv.libatlas_pack_islands, bpy.ops.uv.libatlas_unwrap):
            self.assertEqual(call(), {"FINISHED"})
            self.assertTrue((uvs_of(item)[loops] == before[loops]).all())
            self.assertFalse((uvs_of(item) == before).all())
            self.check_uvs(item)
        with self.assertRaisesRegex(RuntimeError, "(?i)pinned"):
            bpy.ops.uv.libatlas_pack_islands(pages=2)
        for loop in item.data.uv_layers.active.data:
            loop.pin_uv = True
        with self.assertRaisesRegex(RuntimeError, "(?i)pinned"):
            bpy.ops.uv.libatlas_unwrap()

    def test_packing_keeps_shapes(self):
        item = monkey()
        bpy.ops.uv.libatlas_unwrap()
        uvs = uvs_of(item) * 0.3 + 0.5
        item.data.uv_layers.active.data.foreach_set("uv", uvs.ravel())
        before = areas(triangles_of(item))
        self.assertEqual(bpy.ops.uv.libatlas_pack_islands(padding=4), {"FINISHED"})
        self.check_uvs(item)
        ratio = areas(triangles_of(item)) / before
        self.assertLess(ratio.max() / ratio.min(), 1.05)
        self.assertGreater(ratio.mean(), 5)
        item.data.uv_layers.active.data.foreach_set("uv", uvs.ravel())
        bpy.ops.uv.libatlas_pack_islands(scale=False)
        self.check_uvs(item)
        self.assertAlmostEqual((areas(triangles_of(item)) / before).mean(), 1, delta=0.01)

    def test_pages_are_tiles(self):
        item = monkey()
        bpy.ops.uv.libatlas_unwrap(pages=3, page_size=256, texels_per_unit=150)
        tiles = np.floor(triangles_of(item).mean(1)).astype(int)
        self.assertEqual(set(map(tuple, tiles)), {(0, 0), (1, 0), (2, 0)})
        for tile in range(3):
            self.assertEqual(most_in_a_texel(triangles_of(item)[tiles[:, 0] == tile] - [tile, 0]), 1)

    def test_given_uvs_are_kept(self):
        item = monkey()
        bpy.ops.uv.libatlas_unwrap()
        before = areas(triangles_of(item))
        bpy.ops.uv.libatlas_unwrap(keep_uvs=True, max_stretch=1.01, padding=8)
        ratio = areas(triangles_of(item)) / before
        self.assertLess(ratio.max() / ratio.min(), 1.05)

    def test_lightmap_of_objects_that_share_a_mesh(self):
        first, other = monkey(), quad_sphere()
        bpy.ops.uv.libatlas_unwrap()
        colour = {item: uvs_of(item).copy() for item in (first, other)}
        second = first.copy()
        bpy.context.collection.objects.link(second)
        second.scale = (2, 2, 2)
        select(first, second, other)
        self.assertEqual(bpy.ops.object.libatlas_lightmap(page_size=512), {"FINISHED"})
        for item, uvs in colour.items():
            self.assertTrue((uvs_of(item, "UVMap") == uvs).all())
            self.assertEqual(item.data.uv_layers.active.name, "Lightmap")
            self.assertTrue(item.data.uv_layers["UVMap"].active_render)
        own = triangles_of(first, "Lightmap")
        placed = [own * item["lightmap_scale"] + item["lightmap_offset"] for item in (first, second)]
        self.assertEqual(most_in_a_texel(np.concatenate([*placed, triangles_of(other, "Lightmap")])), 1)
        self.assertAlmostEqual(areas(placed[1]).sum() / areas(placed[0]).sum(), 4, delta=0.8)
        self.assertNotIn("lightmap_scale", other)
        self.assertEqual(bpy.ops.object.libatlas_lightmap(page_size=512), {"FINISHED"})  # again, into the same map
        self.assertEqual(len(first.data.uv_layers), 2)

    def test_only_islands_with_selected_uvs_are_packed_in_the_uv_editor(self):
        item = monkey()
        bpy.ops.uv.libatlas_unwrap()
        before = uvs_of(item).copy()
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.context.scene.tool_settings.use_uv_select_sync = False
        editing = bmesh.from_edit_mesh(item.data)
        layer = editing.loops.layers.uv.verify()
        editing.faces.ensure_lookup_table()
        for face in editing.faces:
            for loop in face.loops:
                for name in ("select", "select_edge"):
                    if hasattr(loop[layer], name):
                        setattr(loop[layer], name, face.index == 0)
                if hasattr(loop, "uv_select_vert"):
                    loop.uv_select_vert = face.index == 0
        bmesh.update_edit_mesh(item.data)
        area = bpy.context.window_manager.windows[0].screen.areas[0]
        area.type = "IMAGE_EDITOR"
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area):
            self.assertEqual(bpy.ops.uv.libatlas_pack_islands(), {"FINISHED"})
        bpy.ops.object.mode_set(mode="OBJECT")
        moved = (uvs_of(item) != before).any(1)
        self.assertTrue(moved[item.data.polygons[0].loop_start])
        self.assertTrue(0 < moved.sum() < len(moved) / 2)

    def test_what_cannot_be_done_is_reported(self):
        with self.assertRaisesRegex(RuntimeError, "No mesh is selected"):
            bpy.ops.uv.libatlas_unwrap()
        item = monkey()
        before = uvs_of(item).copy()
        with self.assertRaisesRegex(RuntimeError, "power of two"):
            bpy.ops.uv.libatlas_unwrap(page_size=1000)
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="DESELECT")
        with self.assertRaisesRegex(RuntimeError, "No face is selected"):
            bpy.ops.uv.libatlas_unwrap()
        bpy.ops.object.mode_set(mode="OBJECT")
        item.data.vertices[item.data.polygons[7].vertices[0]].co.x = math.nan
        with self.assertRaisesRegex(RuntimeError, "Suzanne.*finite"):
            bpy.ops.uv.libatlas_unwrap()
        self.assertTrue((uvs_of(item) == before).all())

    def test_a_mesh_without_uvs_gets_a_map(self):
        item = cage(
            "tent",
            [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)],
            [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
        )
        select(item)
        with self.assertRaisesRegex(RuntimeError, "unwrap first"):
            bpy.ops.uv.libatlas_pack_islands()
        bpy.ops.uv.libatlas_unwrap()
        self.assertEqual([layer.name for layer in item.data.uv_layers], ["UVMap"])
        self.check_uvs(item)

    def test_cancelling_a_job(self):
        jobs, meshes, calls = (sys.modules[f"{MODULE}.{name}"] for name in ("jobs", "meshes", "calls"))
        bpy.ops.mesh.primitive_uv_sphere_add(segments=400, ring_count=200)
        faces = [meshes.read(bpy.context.object)]
        options = {"page_size": 2048, "charts": "best", "packing": "best"}
        job = jobs.Job(lambda progress: calls.unwrap(faces, options, progress))
        job.cancel()  # at the first report
        job.start()
        job.join(60)
        self.assertFalse(job.is_alive())
        self.assertIsInstance(job.error, jobs.Cancelled)
        self.assertIsNone(job.result)

    def test_disabling_and_enabling(self):
        bpy.ops.preferences.addon_disable(module=MODULE)
        self.assertFalse(hasattr(bpy.types, "UV_OT_libatlas_unwrap"))
        bpy.ops.preferences.addon_enable(module=MODULE)
        self.assertTrue(hasattr(bpy.types, "UV_OT_libatlas_unwrap") and hasattr(bpy.types, "UV_PT_libatlas_unwrap"))


if __name__ == "__main__":
    bpy.ops.wm.read_factory_settings()
    MODULE = install()
    print("Blender", bpy.app.version_string, "with", MODULE, flush=True)
    result = unittest.main(argv=["in_blender.py", *sys.argv[sys.argv.index("--") + 2 :]], exit=False).result
    print("passed" if result.wasSuccessful() and result.testsRun else "failed", flush=True)
    sys.exit(0 if result.wasSuccessful() else 1)
