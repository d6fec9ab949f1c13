"""Builds the wheel of bindings/python for this system, and makes the extension of it.

python build.py FOLDER OUT.zip: what is built on the way stays in FOLDER.
"""

import subprocess
import sys
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent


def main() -> None:
    folder, target = Path(sys.argv[1]), Path(sys.argv[2])
    environment = folder / "python"
    if not environment.exists():
        venv.create(environment, with_pip=True)
    wheels = folder / "wheels"
    for old in wheels.glob("*.whl"):
        old.unlink()
    pip = [environment / "bin/python", "-m", "pip", "--disable-pip-version-check"]
    build = f"--config-settings=build-dir={folder / 'tree'}"
    subprocess.run([*pip, "wheel", "-q", "--no-deps", "-w", wheels, HERE.parent / "python", build], check=True)
    subprocess.run([sys.executable, HERE / "package.py", target, *wheels.glob("*.whl")], check=True)


if __name__ == "__main__":
    main()
