#!/bin/sh
# Installs what libatlas needs, and only what is missing, from Debian's (12 or newer) or Ubuntu's
# (24.04 or newer) packages.
# Usage: scripts/install-deps.sh [build|test|all]     (all by default)
#   build  compiler, tools and libraries for the library, the programs and the sample scene
#   test   what the tests and benchmarks need on top
set -eu

build_packages="
  g++ cmake ninja-build ccache pkg-config
  libcgal-dev libopenmesh-dev libopenimageio-dev libglm-dev libeigen3-dev libtbb-dev libfmt-dev
  nlohmann-json3-dev libtinygltf-dev zlib1g-dev libcli11-dev libembree-dev
  libglfw3-dev libepoxy-dev libegl-dev libgl-dev libimgui-dev"
test_packages="
  libgtest-dev libbenchmark-dev libcoin-dev view3dscene xvfb xauth pngcheck gnuplot-nox valgrind
  libgl1-mesa-dri libegl1"

case "${1:-all}" in
  build) wanted="$build_packages" ;;
  test) wanted="$test_packages" ;;
  all) wanted="$build_packages $test_packages" ;;
  *) echo "usage: scripts/install-deps.sh [build|test|all]" >&2; exit 2 ;;
esac

if ! command -v apt-get >/dev/null 2>&1; then
  echo "install-deps.sh: this system has no apt-get. Install the equivalents of these Debian packages," >&2
  echo "then run the command again with LIBATLAS_SKIP_DEPS=1:" >&2
  echo $wanted >&2
  exit 1
fi

missing=""
for package in $wanted; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null 2>&1; then
    echo "install-deps.sh: not root, and there is no sudo. As root, run:" >&2
    echo "  apt-get install --no-install-recommends$missing" >&2
    exit 1
  fi
  as_root="sudo"
fi
echo "installing:$missing"
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -qq
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing
