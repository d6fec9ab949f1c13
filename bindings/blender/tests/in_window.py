"""Tests of what needs a window: the modal operators, Esc, undo, the panels. Run by
xvfb-run blender --factory-startup --enable-event-simulate -P in_window.py -- EXTENSION.zip.
"""

import os
import sys
import threading
import time
import traceback
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from in_blender import install, select, uvs_of  # noqa: E402


def context():
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    return bpy.context.temp_override(window=window, area=area, region=area.regions[-1])


def large_sphere():
    bpy.ops.mesh.primitive_uv_sphere_add(segments=250, ring_count=150)
    return bpy.context.object


def working():
    return any(thread.name == "libatlas" for thread in threading.enumerate())


def press(key):
    window = bpy.context.window_manager.windows[0]
    for value in ("PRESS", "RELEASE"):
        window.event_simulate(type=key, value=value, x=400, y=300)


def waiting(condition, seconds, what):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, what
        yield
    for _ in range(3):  # until its events are handled
        yield


def noting(panel, drawn):
    usual = panel.mro()[1].draw

    def draw(self, context):
        usual(self, context)
        drawn.add(panel.__name__)

    return draw


def panels(module):
    """All of them are drawn, with all properties."""
    drawn = set()
    area = next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")
    area.type = "IMAGE_EDITOR"
    area.spaces.active.mode = "UV"
    area.spaces.active.show_region_ui = True
    classes = sys.modules[f"{module}.panels"].PANELS
    for category in ("Tool", "Image", "View", "libatlas"):  # one of which is open
        for panel in classes:
            bpy.utils.unregister_class(panel)
            panel.bl_category = category
            panel.draw = noting(panel, drawn)
            bpy.utils.register_class(panel)
        for _ in range(4):
            area.tag_redraw()
            yield
    assert drawn == {panel.__name__ for panel in classes}, drawn
    area.type = "VIEW_3D"
    yield


def cancelling():
    item = large_sphere()
    select(item)
    before = uvs_of(item).copy()
    with context():
        assert bpy.ops.uv.libatlas_unwrap("INVOKE_DEFAULT", charts="best", packing="best") == {"RUNNING_MODAL"}
    yield from waiting(working, 10, "nothing has begun")
    press("ESC")
    begin = time.monotonic()
    yield from waiting(lambda: not working(), 120, "Esc has stopped nothing")
    print(f"stopped {time.monotonic() - begin:.1f} s after Esc", flush=True)
    assert (uvs_of(item) == before).all(), "a call that was cancelled has changed uvs"


def unwrapping_and_undoing():
    item = large_sphere()
    select(item)
    name = item.name
    with context():
        bpy.ops.ed.undo_push(message="before")
    before = uvs_of(item).copy()
    with context():
        assert bpy.ops.uv.libatlas_unwrap("INVOKE_DEFAULT", charts="best") == {"RUNNING_MODAL"}
    yield from waiting(lambda: not working(), 300, "it does not end")
    yield from waiting(lambda: (uvs_of(bpy.data.objects[name]) != before).any(), 20, "nothing was unwrapped")
    with context():
        bpy.ops.ed.undo()
    yield
    assert (uvs_of(bpy.data.objects[name]) == before).all(), "undo does not bring the uvs back"
    # What was used last is what the panel shows.
    last = bpy.context.window_manager.operator_properties_last("uv.libatlas_unwrap")
    assert last.charts == "best", last.charts


def steps():
    module = install()
    print("Blender", bpy.app.version_string, "with", module, flush=True)
    yield
    for test in (panels(module), cancelling(), unwrapping_and_undoing()):
        print(test.__name__, flush=True)
        yield from test


running = steps()


def step():
    try:
        next(running)
        return 0.1
    except StopIteration:
        print("passed", flush=True)
        os._exit(0)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)


bpy.app.timers.register(step, first_interval=1)
