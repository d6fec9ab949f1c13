"""The wheel builds, installs into a fresh environment, and works there without a compiler."""

import os
import re
import resource
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1]
pytestmark = [
    pytest.mark.heavy,
    pytest.mark.skipif(not (PACKAGE / "pyproject.toml").exists(), reason="needs the repository"),
]


def run(command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    if done.returncode != 0 and re.search("No matching distribution|Connection|Temporary failure", done.stderr):
        pytest.skip("no package index can be reached")
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    if subprocess.run([sys.executable, "-m", "venv", folder / "build"], capture_output=True).returncode != 0:
        pytest.skip("needs venv")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = dict(os.environ, CMAKE_CXX_COMPILER_LAUNCHER="env")  # not ccache, which would hide the work
    pip = [folder / "build/bin/python", "-m", "pip", "wheel", "--no-deps", "-w", folder, PACKAGE]
    run([*pip, f"--config-settings=build-dir={folder}/tree"], env=environment)  # -C is of later versions of pip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    (path,) = folder.glob("*.whl")
    return path, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def test_building_takes_at_most_300_cpu_seconds(wheel):
    assert wheel[1] <= 300


def test_one_wheel_for_every_python(wheel):
    assert re.fullmatch(r"libatlas-[0-9.]+-py3-none-\w+\.whl", wheel[0].name)
    with zipfile.ZipFile(wheel[0]) as files:
        names = set(files.namelist())
    sources = {f"libatlas/{path.name}" for path in (PACKAGE / "src/libatlas").glob("*.py*") if path.is_file()}
    assert {name for name in names if name.startswith("libatlas/")} == sources | {"libatlas/py.typed", "libatlas/libatlasgeo-c.so"}


def test_the_library_needs_the_c_library_only(wheel, tmp_path):
    with zipfile.ZipFile(wheel[0]) as files:
        library = files.extract("libatlas/libatlasgeo-c.so", tmp_path)
    needed = set(re.findall(r"NEEDED\s+(\S+)", run(["objdump", "-p", library])))
    assert needed <= {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}


def test_it_works_in_a_fresh_environment_without_a_compiler(wheel, tmp_path):
    run([sys.executable, "-m", "venv", tmp_path / "fresh"])
    python = tmp_path / "fresh/bin/python"
    run([python, "-m", "pip", "install", wheel[0]])
    program = "import libatlas; print(len(libatlas.unwrap([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).charts))"
    environment = {"PATH": str(tmp_path / "fresh/bin")}
    assert run([python, "-c", program], env=environment, cwd=tmp_path) == "1\n"
