#!/bin/sh
# Installs what libatlas needs, and only what is missing, from Debian's (12 or newer) or Ubuntu's
# (24.04 or newer) packages.
# Usage: scripts/install-deps.sh [build|test|all|windows|blender]     (all by default)
#   build    compiler, tools and libraries for the library, the programs and the sample scene
#   test     what the tests and benchmarks need on top
#   windows  what scripts/windows.sh needs on top
#   blender  what the heavy tests of the Blender extension need on top
set -eu

build_packages="
  g++ cmake ninja-build ccache pkg-config
  libopenmesh-dev libopenimageio-dev libglm-dev libeigen3-dev libtbb-dev libfmt-dev
  nlohmann-json3-dev libtinygltf-dev libmeshoptimizer-dev libdraco-dev zlib1g-dev libpng-dev libjpeg-dev
  libwebp-dev
  libcli11-dev
  libembree-dev
  libglfw3-dev libepoxy-dev libegl-dev libgl-dev libimgui-dev"
test_packages="
  libgtest-dev libbenchmark-dev libcgal-dev libcoin-dev xvfb xauth pngcheck gnuplot-nox valgrind
  libgl1-mesa-dri libegl1 abigail-tools python3"
# Not every release has these. Tests that need them are skipped there.
test_packages_if_any="view3dscene chromium python3-websocket clang-format clang-tidy emscripten nodejs
  python3-numpy python3-pytest python3-matplotlib"
windows_packages="g++-mingw-w64-x86-64-posix wine64 googletest"
blender_packages="blender xvfb xauth python3-venv"

case "${1:-all}" in
  build) wanted="$build_packages" if_any="" ;;
  test) wanted="$test_packages" if_any="$test_packages_if_any" ;;
  all) wanted="$build_packages $test_packages" if_any="$test_packages_if_any" ;;
  windows) wanted="$windows_packages" if_any="" ;;
  blender) wanted="$blender_packages" if_any="" ;;
  *) echo "usage: scripts/install-deps.sh [build|test|all|windows|blender]" >&2; exit 2 ;;
esac

if ! command -v apt-get >/dev/null 2>&1; then
  echo "install-deps.sh: this system has no apt-get. Install the equivalents of these Debian packages," >&2
  echo "then run the command again with LIBATLAS_SKIP_DEPS=1:" >&2
  echo $wanted >&2
  exit 1
fi

# Prints those of the packages that are not installed.
not_installed() {
  for package in "$@"; do
    status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || printf ' %s' "$package"
  done
}
missing=$(not_installed $wanted)
missing_if_any=$(not_installed $if_any)
[ -n "$missing$missing_if_any" ] || exit 0

as_root=""
[ "$(id -u)" -eq 0 ] || as_root="sudo"
if [ -n "$as_root" ] && ! command -v sudo >/dev/null 2>&1; then
  [ -n "$missing" ] || exit 0
  echo "install-deps.sh: not root, and there is no sudo. As root, run:" >&2
  echo "  apt-get install --no-install-recommends$missing" >&2
  exit 1
fi
# The lists of a fresh system are empty, and say nothing about what the release has.
[ -z "$missing" ] || $as_root apt-get update -qq
for package in $missing_if_any; do
  if LC_ALL=C apt-cache policy "$package" | grep -q 'Candidate: [^(]'; then
    missing="$missing $package"
  else
    echo "not in this release, so tests that need it are skipped: $package"
  fi
done
[ -n "$missing" ] || exit 0
echo "installing:$missing"
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
