"""Long calls: in the background while a modal operator waits for them, or at once."""

from __future__ import annotations

import threading

import bpy

from .calls import Refused


class Cancelled(Exception):
    """Esc was pressed."""


class Job(threading.Thread):
    """Runs work(progress) in a thread of its own. Nothing in there may use bpy."""

    def __init__(self, work):
        super().__init__(name="libatlas", daemon=True)
        self._work = work
        self._cancelled = False
        self.stage, self.fraction = "", 0.0
        self.result = None
        self.error = None

    def run(self):
        try:
            self.result = self._work(self._report)
        except BaseException as error:  # raised again in the main thread
            self.error = error

    def _report(self, stage, fraction):
        self.stage, self.fraction = stage, fraction
        if self._cancelled:
            raise Cancelled

    def cancel(self):
        """The work ends at its next report of progress."""
        self._cancelled = True


class JobOperator:
    """Base of the operators. `prepare(context)` reads the meshes and returns the work, `finish(result)` writes them."""

    def execute(self, context):
        manager = context.window_manager
        manager.progress_begin(0, 1)
        try:
            work = self.prepare(context)
            return self._finished(work(lambda stage, fraction: manager.progress_update(fraction)))
        except (Refused, MemoryError) as error:
            return self._refused(error)
        finally:
            manager.progress_end()

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self._job = Job(self.prepare(context))
        except (Refused, MemoryError) as error:
            return self._refused(error)
        self._job.start()
        self._job.join(0.1)
        if not self._job.is_alive():
            return self._ended()
        context.window_manager.progress_begin(0, 1)
        self._timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._job.cancel()
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}  # nobody edits the mesh meanwhile
        if self._job.is_alive():
            context.window_manager.progress_update(self._job.fraction)
            context.workspace.status_text_set(
                f"{self.bl_label}: {self._job.stage} {self._job.fraction:.0%}   Esc: cancel"
            )
            return {"RUNNING_MODAL"}
        self._stop_waiting(context)
        return self._ended()

    def cancel(self, context):
        """The window is closed."""
        self._job.cancel()
        self._stop_waiting(context)

    def _stop_waiting(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _ended(self):
        self._job.join()
        error = self._job.error
        if isinstance(error, Cancelled):
            self.report({"INFO"}, f"{self.bl_label}: cancelled")
            return {"CANCELLED"}
        if isinstance(error, (Refused, MemoryError)):
            return self._refused(error)
        if error is not None:
            raise error
        return self._finished(self._job.result)

    def _finished(self, laid):
        try:
            self.finish(laid)
        except Refused as error:
            return self._refused(error)
        for line in laid.warnings:
            self.report({"WARNING"}, line)
        self.report({"INFO"}, laid.told[0].upper() + laid.told[1:])
        return {"FINISHED"}

    def _refused(self, error):
        self.report({"ERROR"}, str(error) or type(error).__name__)
        return {"CANCELLED"}
