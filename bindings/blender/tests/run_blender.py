"""run_blender.py KIND BUILD EXTENSION.zip runs tests of the extension; it ends with 77 (skipped) where it finds no Blender.

build       makes the extension by the target libatlas_blender
background  in_blender.py, by `blender -b`
window      in_window.py, by Blender in a window of Xvfb
bpy         in_blender.py, by the module bpy, which pip installs into an environment of its own
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]


def skip(why):
    print("skipped:", why)
    sys.exit(77)


def needed(program, package):
    return shutil.which(program) or skip(f"{program} is not installed (apt-get install {package})")


def installing(command):
    """Runs pip, or what runs it; skips where no package index can be reached."""
    done = subprocess.run(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    if done.returncode != 0 and re.search(
        "No matching distribution|Connection|Temporary failure|ensurepip", done.stdout
    ):
        skip("pip cannot install what this needs")
    if done.returncode != 0:
        sys.exit(done.stdout)


def python_with_bpy(build):
    environment = build / "bindings/blender/bpy"
    python = environment / "bin/python"
    pinned = (ROOT / "benchmarks/python/requirements.txt").read_text().splitlines()
    wanted = [line for line in pinned if line.startswith(("bpy==", "numpy=="))]
    if not python.exists():
        installing([sys.executable, "-m", "venv", environment])
    installing([python, "-m", "pip", "install", "-q", *wanted])
    return python


def in_blender(kind, build):
    if kind == "bpy":
        return [python_with_bpy(build), HERE / "in_blender.py"]
    blender = needed("blender", "blender")
    if kind == "background":
        return [blender, "-b", "--factory-startup", "--python-exit-code", "3", "-P", HERE / "in_blender.py"]
    screen = [needed("xvfb-run", "xvfb xauth"), "-a", "-s", "-screen 0 1280x800x24"]
    return [*screen, blender, "--factory-startup", "--enable-event-simulate", "-P", HERE / "in_window.py"]


def main():
    kind, build, extension = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    if kind == "build":
        installing(["cmake", "--build", build, "--target", "libatlas_blender"])
        return
    command = [*map(str, in_blender(kind, build)), "--", extension]
    with tempfile.TemporaryDirectory() as folder:  # nothing of the user's Blender is touched
        environment = dict(os.environ, BLENDER_USER_RESOURCES=folder, PYTHONDONTWRITEBYTECODE="1")
        if kind != "bpy":  # Debian's Blender takes the libraries of the first Python in the path
            environment["PATH"] = f"{Path(shutil.which('blender')).parent}:{os.environ['PATH']}"
        for name in ("CONFIG", "SCRIPTS", "DATAFILES"):
            environment[f"BLENDER_USER_{name}"] = str(Path(folder, name.lower()))
            Path(folder, name.lower()).mkdir()
        done = subprocess.run(
            command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
        )
    print(done.stdout)
    # Blender ends with 0 whatever a script does in some versions, so the script has to say that all went well.
    if done.returncode != 0 or "\npassed\n" not in done.stdout or "Traceback" in done.stdout:
        sys.exit(f"failed with exit code {done.returncode}")


if __name__ == "__main__":
    main()
