"""Makes the Blender extension: python package.py OUT.zip WHEEL..., one wheel of libatlas for each system.

The zip file is for Blender 4.2 and later, which read its manifest, and for earlier ones, which find the add-on in its
folder.
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

SOURCE = Path(__file__).parent / "libatlas_uv"
LICENSE = Path(__file__).parents[2] / "LICENSE"
PLATFORMS = {  # by what the tags of wheels contain
    ("linux", "x86_64"): "linux-x64",
    ("linux", "aarch64"): "linux-arm64",
    ("win", "amd64"): "windows-x64",
    ("win", "arm64"): "windows-arm64",
    ("macosx", "x86_64"): "macos-x64",
    ("macosx", "arm64"): "macos-arm64",
}


def platform_of(wheel: Path) -> str:
    if not wheel.name.startswith("libatlas-") or "-py3-none-" not in wheel.name:
        raise SystemExit(f"{wheel}: no wheel of libatlas")
    tag = wheel.stem.rpartition("-")[2]
    for (system, machine), name in PLATFORMS.items():
        if system in tag and tag.endswith(machine):
            return name
    raise SystemExit(f"{wheel}: Blender has no platform for {tag}")


def listed(name: str, values: list[str]) -> str:
    return f"{name} = [{', '.join(repr(value) for value in values)}]\n"


def main() -> None:
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    target, wheels = Path(sys.argv[1]), [Path(word) for word in sys.argv[2:]]
    manifest = (SOURCE / "blender_manifest.toml").read_text()
    manifest += listed("platforms", [platform_of(wheel) for wheel in wheels])
    manifest += listed("wheels", [f"./wheels/{wheel.name}" for wheel in wheels])
    files = {"blender_manifest.toml": manifest.encode(), "LICENSE": LICENSE.read_bytes()}
    files.update({path.name: path.read_bytes() for path in SOURCE.glob("*.py")})
    files.update({f"wheels/{wheel.name}": wheel.read_bytes() for wheel in wheels})
    target.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):  # the same bytes whenever it is made
            archive.writestr(zipfile.ZipInfo(f"libatlas_uv/{name}"), files[name], zipfile.ZIP_DEFLATED)
    print(f"{target}: {target.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
