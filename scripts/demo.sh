#!/bin/sh
# From a clean clone to a walkable world: installs what is missing, builds what it runs, makes an
# aircraft cabin of about 100 000 lit triangles and exports it.
# Usage: scripts/demo.sh [triangles]       (LIBATLAS_SKIP_DEPS=1 leaves the system's packages alone)
set -eu
cd "$(dirname "$0")/.."
triangles="${1:-100000}"

[ -n "${LIBATLAS_SKIP_DEPS:-}" ] || scripts/install-deps.sh build
cmake --preset release >/dev/null
cmake --build --preset release --target atlas-export atlas-make-cabin

mkdir -p out
build/examples/cabin/atlas-make-cabin --triangles "$triangles" -o out/cabin.obj --preview out/cabin.png
build/apps/atlas-export/atlas-export out/cabin.obj -o out/cabin.wrl --up z
build/apps/atlas-export/atlas-export out/cabin.obj -o out/cabin.html --up z --report out/report.json

echo
echo "The world:  $PWD/out/cabin.html   (open it in any browser: a double click is enough)"
echo "As VRML:    $PWD/out/cabin.wrl   (for view3dscene, FreeWRL, atlas-play, ...)"
echo "The report: $PWD/out/report.json"
echo "A picture:  $PWD/out/cabin.png"
echo "Walk in:    cmake --build build --target atlas-play && build/apps/atlas-play/atlas-play out/cabin.wrl --up z"
