"""The package libatlas, which lies beside as a wheel. Blender 4.2 and later have installed it; for earlier ones it is
unpacked, as it holds a library that must be a file."""

from __future__ import annotations

import os
import platform
import shutil
import sys
import tempfile
import zipfile
import zlib
from pathlib import Path

import bpy


def provide():
    """Makes `import libatlas` work. Raises ImportError where no wheel suits this system."""
    if bpy.app.version >= (4, 2) and __package__.startswith("bl_ext."):
        return
    wheel = _of_this_system(sorted(Path(__file__).with_name("wheels").glob("*.whl")))
    checksum = zlib.crc32(wheel.read_bytes())
    parent = Path(bpy.utils.user_resource("DATAFILES", path="libatlas_uv", create=True))
    folder = parent / f"{wheel.stem}-{checksum:08x}"
    if not folder.exists():
        part = tempfile.mkdtemp(dir=parent)
        with zipfile.ZipFile(wheel) as files:
            files.extractall(part)
        try:
            os.rename(part, folder)
        except OSError:  # another Blender was faster
            shutil.rmtree(part)
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))


def _of_this_system(wheels):
    machine = "x86_64" if platform.machine() == "AMD64" else platform.machine()
    wanted = {"win32": ("win_", "amd64" if machine == "x86_64" else machine), "darwin": ("macosx_", machine)}
    system, processor = wanted.get(sys.platform, ("linux_", machine))
    for wheel in wheels:
        tag = wheel.stem.rpartition("-")[2]
        if system in tag and tag.endswith(processor):
            return wheel
    raise ImportError(
        f"libatlas: no wheel for {system}{processor} in this extension; it has {[w.name for w in wheels]}"
    )
