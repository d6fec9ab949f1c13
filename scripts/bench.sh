#!/bin/sh
# Builds the benchmark programs, runs them and draws the page.
# Usage: scripts/bench.sh [full|small]     small: a few minutes, to see that all works
#   full  (default) to 3 million triangles; about half an hour on two cores
# LIBATLAS_RIVALS: rivals, one a line, each "name=command {in} {out}" (benchmarks/rivals/README.md).
# LIBATLAS_MODELS: a folder of OBJ files for the stability page. LIBATLAS_BENCH_BUILD: a build to use
# as it is. LIBATLAS_BENCH_DOCS=1 copies tables and plots into docs/.
set -eu
cd "$(dirname "$0")/.."
size="${1:-full}"
out="out/bench"
build="${LIBATLAS_BENCH_BUILD:-}"
if [ -z "$build" ]; then
  [ -n "${LIBATLAS_SKIP_DEPS:-}" ] || scripts/install-deps.sh all
  cmake --preset release -DLIBATLAS_BUILD_BENCHMARKS=ON >/dev/null
  cmake --build --preset release --target benchmarks
  build=build
fi
bin="$build/benchmarks"
mkdir -p "$out"
failed=0
run() { echo "== $*"; "$@" || failed=1; }

case "$size" in
  small)
    sweep="cabin:20000 scan:20000"; budget="--atlases 2 --atlas-size 1024"; repeats=1
    sizes="cabin:40000 scan:40000 cabin:20000"; sizes_budget="$budget"
    rivals="sphere:20000 assembly:20000"
    leak="cabin:50000"; texels="20 10 5"; full="" ;;
  full)
    sweep="cabin:100000 scan:100000"; budget="--atlases 8 --atlas-size 2048"; repeats=2
    sizes="cabin:10000 cabin:30000 cabin:300000 cabin:1000000 cabin:3000000 \
           scan:10000 scan:30000 scan:300000 scan:1000000"
    sizes_budget="--atlases 50"
    rivals="sphere:100000 assembly:100000 genus:100000 scan:1000000 terrain:1000000 assembly:1000000"
    leak="cabin:1000000"; texels="20 10 5 2.5"; full="--full" ;;
  *) echo "usage: scripts/bench.sh [full|small]" >&2; exit 2 ;;
esac

models=""
if [ -n "${LIBATLAS_MODELS:-}" ]; then models="--models $LIBATLAS_MODELS/*.obj"; fi
# shellcheck disable=SC2086  # the lists are meant to be split
{
  run "$bin/atlas-bench" --work $sweep $budget --repeats "$repeats" -o "$out/settings.json"
  run "$bin/atlas-bench" --work $sizes --standard $sizes_budget \
      --stages baseline charts downsizing simplify export -o "$out/sizes.json"
  run "$bin/atlas-bench-leak" --work "$leak" --texel $texels -o "$out/leak.json"
  run "$bin/atlas-bench-stability" --failures $full $models -o "$out/stability.json"
  set --
  if [ -n "${LIBATLAS_RIVALS:-}" ]; then
    while IFS= read -r rival; do [ -z "$rival" ] || set -- "$@" --rival "$rival"; done <<END
$LIBATLAS_RIVALS
END
  fi
  run "$bin/atlas-bench" --work $rivals --stages unwrap "$@" -o "$out/rivals.json"
}
"$bin/atlas-bench-page" "$out/settings.json" "$out/sizes.json" "$out/leak.json" \
  "$out/stability.json" "$out/rivals.json" -o "$out"
if [ -n "${LIBATLAS_BENCH_DOCS:-}" ]; then
  cp "$out/performance.md" "$out/stability.md" docs/
  mkdir -p docs/plots && cp "$out"/plots/*.svg docs/plots/
fi
exit $failed
