#!/bin/sh
# Installs what is missing, builds with warnings as errors, runs the tests.
# Usage: scripts/test.sh [quick|heavy|all] [ctest options]
#   quick  (default) every test but the long ones; heavy  million-triangle runs and other long ones
# LIBATLAS_SKIP_DEPS=1 leaves the system's packages alone; LIBATLAS_PRESET=asan or tsan tests under a
# sanitizer instead.
set -eu
cd "$(dirname "$0")/.."
preset="${LIBATLAS_PRESET:-dev}"
label=quick
case "${1:-}" in
  quick | heavy) label="$1"; shift ;;
  all) label='quick|heavy'; shift ;;
esac

[ -n "${LIBATLAS_SKIP_DEPS:-}" ] || scripts/install-deps.sh all
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
# LeakSanitizer falls over the dynamic thread storage of threads that end with the program (GCC 12): one
# run in three on a busy machine.
export ASAN_OPTIONS="intercept_tls_get_addr=0"
export UBSAN_OPTIONS="print_stacktrace=1" TSAN_OPTIONS="suppressions=$PWD/scripts/tsan.supp history_size=7"
jobs=$(nproc 2>/dev/null || echo 2)
# A heavy test takes gigabytes: one at a time.
[ "$label" = quick ] || jobs=1
ctest --test-dir "build-$preset" -L "$label" --output-on-failure -j "$jobs" "$@"
