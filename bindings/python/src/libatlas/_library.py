"""Loads the C library, and runs its calls."""

from __future__ import annotations

import ctypes
import os
import queue
import sys
import threading
import warnings
from collections.abc import Callable
from ctypes import POINTER, c_char_p, c_double, c_int, c_int32, c_size_t, c_uint32, c_void_p
from pathlib import Path
from typing import Any

from libatlas import _structs as structs
from libatlas.errors import BY_STATUS, InternalError, RepairWarning

#: Called with the name of a stage and rising fractions from 0 to 1, in the thread that made the call.
Progress = Callable[[str, float], object]

_PROGRESS = ctypes.CFUNCTYPE(c_int, c_void_p, c_char_p, c_double)
_WARNING = ctypes.CFUNCTYPE(None, c_void_p, c_char_p)
_OUT = POINTER(c_void_p)

# What functions take. Those that are not named in _RETURNS return a status.
_TAKES: dict[str, list[Any]] = {
    "version": [],
    "context_create": [],
    "context_destroy": [c_void_p],
    "message": [c_void_p],
    "set_threads": [c_void_p, c_int32],
    "set_progress": [c_void_p, _PROGRESS, c_void_p],
    "set_warning": [c_void_p, _WARNING, c_void_p],
    "cancel": [c_void_p],
    "mesh_init": [POINTER(structs.Mesh), c_size_t],
    "atlas_create": [c_void_p, _OUT],
    "atlas_destroy": [c_void_p],
    "add_mesh": [c_void_p, c_void_p, POINTER(structs.Mesh), POINTER(c_uint32)],
    "add_instances": [c_void_p, c_void_p, POINTER(structs.Mesh), c_void_p, c_size_t, POINTER(c_uint32)],
    "earlier_uvs_init": [POINTER(structs.EarlierUvs), c_size_t],
    "unwrap_options_init": [POINTER(structs.UnwrapOptions), c_size_t],
    "lightmap_options_init": [POINTER(structs.UnwrapOptions), c_size_t, c_double, c_double],
    "unwrap": [c_void_p, c_void_p, POINTER(structs.UnwrapOptions), _OUT],
    "unwrapped_destroy": [c_void_p],
    "get_info": [c_void_p, c_void_p, POINTER(structs.AtlasInfo)],
    "get_mesh": [c_void_p, c_void_p, c_uint32, POINTER(structs.MeshUvs)],
    "get_instances": [c_void_p, c_void_p, c_uint32, POINTER(structs.Instances)],
    "get_polygons": [c_void_p, c_void_p, c_uint32, POINTER(structs.PolygonUvs)],
    "get_charts": [c_void_p, c_void_p, POINTER(structs.Charts)],
    "get_seams": [c_void_p, c_void_p, c_void_p, c_uint32, c_void_p, c_size_t],
    "transfer_options_init": [POINTER(structs.TransferOptions), c_size_t],
    "transfer": [c_void_p, c_void_p, c_void_p, c_size_t, POINTER(structs.TransferOptions), c_void_p, c_size_t],
    "pack_options_init": [POINTER(structs.PackOptions), c_size_t],
    "pack_rects": [c_void_p, c_void_p, c_size_t, POINTER(structs.PackOptions), _OUT],
    "packed_destroy": [c_void_p],
    "get_packed": [c_void_p, c_void_p, POINTER(structs.PackedInfo)],
    "islands_init": [POINTER(structs.Islands), c_size_t],
    "island_options_init": [POINTER(structs.IslandOptions), c_size_t],
    "pack_islands": [c_void_p, POINTER(structs.Islands), POINTER(structs.IslandOptions), _OUT],
    "packed_islands_destroy": [c_void_p],
    "get_packed_islands": [c_void_p, c_void_p, POINTER(structs.PackedIslandsInfo)],
}
_RETURNS: dict[str, Any] = {
    "version": c_uint32,
    "context_create": c_void_p,
    "context_destroy": None,
    "message": c_char_p,
    "set_threads": None,
    "set_progress": None,
    "set_warning": None,
    "cancel": None,
    "atlas_destroy": None,
    "unwrapped_destroy": None,
    "packed_destroy": None,
    "packed_islands_destroy": None,
}
_MADE_FOR = (0, 1)  # major and minor version, which together are the version of the ABI


def _path() -> str:
    given = os.environ.get("LIBATLAS_LIBRARY")
    if given:
        return given
    suffix = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    return str(Path(__file__).with_name("libatlasgeo-c" + suffix))


def _load() -> ctypes.CDLL:
    path = _path()
    try:
        library = ctypes.CDLL(path)  # its calls give up the global lock
    except OSError as error:
        raise ImportError(
            f"libatlas: {path} cannot be loaded ({error}); install the package, or name the library "
            "in the environment variable LIBATLAS_LIBRARY"
        ) from error
    for name, arguments in _TAKES.items():
        function = getattr(library, "libatlas_" + name)
        function.argtypes = arguments
        function.restype = _RETURNS.get(name, c_int32)
    version = library.libatlas_version()
    if (version // 10000, version // 100 % 100) != _MADE_FOR:
        raise ImportError(f"libatlas: {path} has the version {version}, which is not {_MADE_FOR}")
    return library


library = _load()


def version() -> str:
    """The version of the library that runs, such as "0.1.0"."""
    number = library.libatlas_version()
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


class Handle:
    """Owns an object of the C library, which is destroyed with it."""

    __slots__ = ("_destroy", "pointer")

    def __init__(self, kind: str) -> None:
        self.pointer = c_void_p()
        self._destroy = getattr(library, f"libatlas_{kind}_destroy")

    def __del__(self) -> None:
        self._destroy(self.pointer)  # null is allowed

    @property
    def out(self) -> Any:
        return ctypes.byref(self.pointer)


class Context:
    """Runs calls of the C library, and raises its errors.

    Long calls run in a thread of their own if someone may want to stop them: Python runs the handlers
    of signals in the main thread, and only while that thread runs Python. So the caller's thread waits
    for reports of progress, which it passes on, and whatever is raised meanwhile (KeyboardInterrupt by
    Ctrl-C, or what `progress` raises) cancels the call.
    """

    def __init__(self, threads: int = 0, progress: Progress | None = None) -> None:
        self._handle = Handle("context")
        self._handle.pointer = c_void_p(library.libatlas_context_create())
        if not self._handle.pointer:
            raise MemoryError("libatlas: no memory for a context")
        self._progress = progress
        self._warnings = lines = []  # type: list[str]
        self._on_warning = _WARNING(lambda _, line: lines.append(line.decode()))
        library.libatlas_set_warning(self._handle.pointer, self._on_warning, None)
        library.libatlas_set_threads(self._handle.pointer, threads)

    def call(self, name: str, *arguments: Any) -> None:
        """Runs a short call in this thread."""
        self._check(getattr(library, "libatlas_" + name)(self._handle.pointer, *arguments))

    def run(self, name: str, *arguments: Any, keep: Any = None) -> None:
        """Runs a long call, which is cancelled by whatever is raised in this thread meanwhile.

        `keep` holds what the arguments point to, as long as the call runs.
        """
        if self._progress is None and threading.current_thread() is not threading.main_thread():
            self.call(name, *arguments)
            return
        run = _Run(self, getattr(library, "libatlas_" + name), arguments, keep)
        if self._progress is not None:
            library.libatlas_set_progress(self._handle.pointer, run.on_progress, None)
        try:
            threading.Thread(target=run.work, name="libatlas").start()
            status = run.wait(self._progress)
        except BaseException:
            run.cancel()
            raise
        self._check(status)

    @property
    def pointer(self) -> c_void_p:
        return self._handle.pointer

    def _check(self, status: int) -> None:
        if status == 0:
            for line in self._warnings:
                warnings.warn(line, RepairWarning, stacklevel=_frames_of_package())
            self._warnings.clear()
            return
        self._warnings.clear()
        message = library.libatlas_message(self._handle.pointer).decode()
        raise BY_STATUS.get(status, InternalError)(message)


class _Run:
    """A call in a thread of its own, which may outlive those who wait for it."""

    def __init__(self, context: Context, function: Any, arguments: tuple[Any, ...], keep: Any) -> None:
        self._context, self._function, self._arguments, self._keep = context, function, arguments, keep
        self._reports = reports = queue.SimpleQueue()  # type: queue.SimpleQueue[Any]

        def report(_: Any, stage: bytes, fraction: float) -> int:
            reports.put((stage, fraction))
            return 0

        self.on_progress = _PROGRESS(report)
        self._lock = threading.Lock()
        self._abandoned = False
        self._running = False
        self._done = threading.Event()

    def work(self) -> None:
        with self._lock:
            if self._abandoned:
                return
            self._running = True
        status = 8  # LIBATLAS_INTERNAL
        try:
            status = self._function(self._context.pointer, *self._arguments)
        finally:
            self._reports.put(status)
            self._done.set()

    def wait(self, progress: Progress | None) -> int:
        """Returns the status of the call. Of reports that pile up, only the last of a stage counts; one that nothing
        follows is repeated, so that those who look for a reason to stop there find it soon."""
        report = last = None
        while True:
            try:
                # Windows notices Ctrl-C only between two calls.
                newer = self._reports.get(timeout=0.1) if report is None else self._reports.get_nowait()
            except queue.Empty:
                newer = None
                report = report or last
            if report is not None and progress is not None and (newer is None or _ends(report, newer)):
                progress(report[0].decode(), report[1])
            if isinstance(newer, int):
                return newer
            report = newer
            last = report or last

    def cancel(self) -> None:
        """Cancels the call, and waits for its end, however often Ctrl-C is pressed."""
        while True:
            try:
                with self._lock:
                    self._abandoned = True
                    if not self._running:
                        return
                library.libatlas_cancel(self._context.pointer)
                if self._done.wait(0.1):
                    return
            except BaseException:
                continue


def _ends(report: Any, newer: Any) -> bool:
    """Whether `report` is the last of its stage."""
    return isinstance(newer, int) or newer[0] != report[0]


def _frames_of_package() -> int:
    """The stacklevel with which _check warns at the line that called the package."""
    frame, count = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("libatlas"):
        frame, count = frame.f_back, count + 1
    return count
