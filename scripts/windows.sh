#!/bin/sh
# Builds the component uv and the C library for Windows with Debian's mingw-w64, and runs their quick
# tests under Wine. Usage: scripts/windows.sh [ctest options]
# LIBATLAS_SKIP_DEPS=1 leaves the system's packages alone.
set -eu
cd "$(dirname "$0")/.."
if [ -z "${LIBATLAS_SKIP_DEPS:-}" ]; then
  scripts/install-deps.sh build
  scripts/install-deps.sh windows
fi
cmake -S tests/windows -B build-windows -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_TOOLCHAIN_FILE=mingw.cmake >/dev/null
cmake --build build-windows
export WINEDEBUG=-all WINEPREFIX="$PWD/build-windows/wine"
# Left out: what measures shorter CPU times than Windows' clock of threads counts in ticks of 15 ms, and what
# holds sine and arc cosine against long double functions, which this C library has with errors of its own.
left_out='ACallKnowsTheTimeOfItsLoops|ManyBecomeChartsInParallel|PartsStayWithinTheirSums'
left_out="$left_out|PortableMath[.](SineAndCosine|ArcTangentAndArcCosine)"
ctest --test-dir build-windows -L quick -E "$left_out" --output-on-failure -j "$(nproc)" "$@"
