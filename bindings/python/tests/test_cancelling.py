"""Whatever is raised in the caller's thread stops a call, and the library works on."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import libatlas
from meshes import terrain, torus

MESH = torus(100, 40)


class Stop(Exception):
    pass


def unwrap(**more):
    return libatlas.unwrap(*MESH, **more)


def typical_time():
    unwrap()
    begin = time.perf_counter()
    unwrap()
    return time.perf_counter() - begin


def test_exceptions_of_progress_are_passed_on():
    counts = []
    unwrap(progress=lambda stage, fraction: counts.append(fraction))
    rng = np.random.default_rng(3)
    for _ in range(60):
        left = rng.integers(1, 4)

        def progress(stage, fraction):
            nonlocal left
            left -= 1
            if left == 0:
                raise Stop(stage)

        try:
            unwrap(progress=progress)
            assert left > 0, "nothing was raised, though progress did"
        except Stop:
            assert left == 0
    assert len(counts) >= 2


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_two_hundred_interrupts_at_random_times():
    expected = unwrap().uvs.tobytes()
    usual = typical_time()
    rng = np.random.default_rng(5)
    interrupted = 0
    for _ in range(200):
        timer = threading.Timer(rng.random() * 0.8 * usual, os.kill, (os.getpid(), signal.SIGINT))
        try:
            timer.start()
            unwrap()
            timer.join()  # the call was faster than usual
            time.sleep(0.01)
        except KeyboardInterrupt:
            interrupted += 1
        timer.join()
    assert interrupted >= 195
    assert unwrap().uvs.tobytes() == expected


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_an_interrupt_ends_a_long_call_soon():
    vertices, faces = terrain(250)
    begin = time.perf_counter()
    libatlas.unwrap(vertices, faces, charts="best", packing="best")
    whole = time.perf_counter() - begin
    timer = threading.Timer(whole / 10, os.kill, (os.getpid(), signal.SIGINT))
    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        libatlas.unwrap(vertices, faces, charts="best", packing="best")
    assert time.perf_counter() - begin < whole / 2


def test_progress_can_stop_a_call_whenever_it_wants():
    vertices, faces = terrain(250)
    reports = []

    def progress(*report):
        reports.append(report)

    libatlas.unwrap(vertices, faces, charts="best", packing="best", progress=progress)
    assert len(set(reports)) < len(reports)  # the same again
    for stage in ("charts", "packing"):
        fractions = [fraction for name, fraction in reports if name == stage]
        assert fractions == sorted(fractions)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_ends_a_program():
    program = (
        "import libatlas, meshes, sys\n"
        "print('ready', flush=True)\n"
        "while True: libatlas.unwrap(*meshes.terrain(300), charts='best')\n"
    )
    paths = [os.path.dirname(__file__), str(Path(libatlas.__file__).parents[1])]
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(paths))
    with subprocess.Popen([sys.executable, "-c", program], env=environment, stdout=-1, stderr=-1, text=True) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors and process.returncode != 0


def test_other_threads_run_meanwhile():
    ticks = 0
    done = threading.Event()

    def count():
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    begin = time.perf_counter()
    libatlas.unwrap(*terrain(300))
    took = time.perf_counter() - begin
    done.set()
    thread.join()
    assert ticks > 100 * took  # a call that kept the lock would have let none pass


def test_calls_from_several_threads():
    expected = unwrap().uvs.tobytes()
    results = []
    threads = [threading.Thread(target=lambda: results.append(unwrap().uvs.tobytes())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 4


def test_one_atlas_in_several_threads():
    atlas = libatlas.Atlas()
    atlas.add(*torus())
    results = []
    threads = [threading.Thread(target=lambda: results.append(atlas.unwrap()[0].seams.sum())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(results)) == 1 and len(results) == 4
