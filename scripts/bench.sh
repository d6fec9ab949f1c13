#!/bin/sh
# Builds the benchmark programs, runs them and draws the pages out/bench/index.html and
# stability.html. Needs no hand; goes on where a part fails, and says so in the end.
# Usage: scripts/bench.sh [full|small]     small: a few minutes, to see that all works
#   full  (default) to 3 million triangles; about a quarter of an hour on two cores
# LIBATLAS_BENCH_DOCS=1   copies tables, plots and JSON into docs/generated/, nowhere else
# LIBATLAS_MODELS         a folder of OBJ files: charts of each, and the stability page
# LIBATLAS_RIVALS         rivals, one a line, each "name=command {in} {out}"; without it those are
#                         entered that are found: LIBATLAS_XATLAS (a clone of xatlas), LIBATLAS_NPM
#                         (a folder with node_modules/xatlas-web), blender on the path
# LIBATLAS_RIVAL_TIMEOUT  seconds a mesh (60)
# LIBATLAS_BENCH_BUILD    a build to use as it is
set -eu
cd "$(dirname "$0")/.."
size="${1:-full}"
out="out/bench"
results="$out/results"
build="${LIBATLAS_BENCH_BUILD:-}"
case "$size" in full | small) ;; *) echo "usage: scripts/bench.sh [full|small]" >&2; exit 2 ;; esac
if [ -z "$build" ]; then
  [ -n "${LIBATLAS_SKIP_DEPS:-}" ] || scripts/install-deps.sh all
  cmake --preset release -DLIBATLAS_BUILD_BENCHMARKS=ON >/dev/null
  cmake --build --preset release --target benchmarks
  build=build
fi
bin="$build/benchmarks"
rm -rf "$out"
mkdir -p "$results" "$out/plots"
started=$(date +%s)
failed=""
run() {
  echo "== $*"
  from=$(date +%s)
  "$@" || failed="$failed
  $*"
  echo "== $(($(date +%s) - from)) s"
}

if [ "$size" = small ]; then
  sweep="cabin:20000 scan:20000"; packed="genus:20000 assembly:3000"; budget="--atlases 2 --atlas-size 1024"; repeats=1
  sizes="cabin:40000 scan:40000 cabin:20000"; sizes_budget="$budget"
  components="assembly:10000 assembly:40000 rough:10000 rough:30000"
  threads="scan:40000"; counted="scan:5000"
  rivals="sphere:20000 assembly:20000"; small_rivals="sphere:2000"
  leak="cabin:50000"; texels="20 10 5"; full=""; shadows="--small"
else
  sweep="cabin:100000 scan:100000"; packed="genus:100000 scan:100000 assembly:10000"; budget="--atlases 8 --atlas-size 2048"; repeats=2
  sizes="cabin:10000 cabin:300000 cabin:1000000 cabin:3000000 scan:30000 scan:300000 scan:1000000"
  sizes_budget="--atlases 50"
  components="assembly:30000 assembly:300000 assembly:1000000 soup:30000 soup:300000"
  components="$components rough:30000 rough:100000 rough:300000"
  threads="cabin:300000"; counted="scan:5000"
  rivals="sphere:100000 assembly:100000 genus:100000 scan:1000000 terrain:1000000 assembly:1000000"
  small_rivals="sphere:5000 assembly:5000 genus:5000"
  leak="cabin:1000000"; texels="20 10 5 2.5"; full="--full"; shadows=""
fi

# Rivals as arguments: one a line, each "name=command {in} {out}".
rival_list() {
  if [ -n "${LIBATLAS_RIVALS:-}" ]; then
    echo "$LIBATLAS_RIVALS"
    return
  fi
  if [ -n "${LIBATLAS_XATLAS:-}" ] &&
     c++ -O2 -DNDEBUG -std=c++17 -I "$LIBATLAS_XATLAS/source/xatlas" benchmarks/rivals/xatlas_unwrap.cpp \
         "$LIBATLAS_XATLAS/source/xatlas/xatlas.cpp" -lpthread -o "$out/xatlas_unwrap" >&2; then
    echo "xatlas=$PWD/$out/xatlas_unwrap {in} {out}"
  else
    echo "xatlas=echo 'not found: set LIBATLAS_XATLAS to a clone of it' >&2; exit 1; {in} {out}"
  fi
  if [ -n "${LIBATLAS_NPM:-}" ]; then
    echo "xatlas (WebAssembly)=NODE_PATH='$LIBATLAS_NPM/node_modules' node $PWD/benchmarks/rivals/xatlas_unwrap.cjs {in} {out}"
  fi
  echo "Blender Smart UV=$(blender_rival smart)"
}

# Its time grows with the square of the triangles: entered for the small meshes only.
lightmap_rival() {
  echo "Blender Lightmap Pack=$(blender_rival lightmap)"
}

blender_rival() {
  if command -v blender >/dev/null; then
    echo "blender -b --factory-startup -P $PWD/benchmarks/rivals/blender_unwrap.py --python-exit-code 1 -- $1 {in} {out}"
  else
    echo "echo 'not installed' >&2; exit 1; {in} {out}"
  fi
}

# shellcheck disable=SC2086  # the lists are meant to be split
{
  run "$bin/atlas-bench" --work $sizes --standard $sizes_budget \
      --stages baseline charts export -o "$results/sizes.json"
  run "$bin/atlas-bench" --work $components --standard --stages baseline charts \
      -o "$results/components.json"
  run "$bin/atlas-bench" --work $threads --standard $sizes_budget --threads 1 2 \
      --stages baseline charts downsizing packing baking simplify export \
      -o "$results/threads.json"
  # From 1000 charts on, as the cabin has, boxes are filled in one way whatever the setting.
  run "$bin/atlas-bench" --work $sweep $budget --repeats "$repeats" \
      --stages baseline charts downsizing grouping baking simplify export \
      -o "$results/settings.json"
  run "$bin/atlas-bench" --work $packed $budget --repeats "$repeats" --stages packing \
      -o "$results/packing.json"
  run "$bin/atlas-bench" --work $counted --atlases 1 --atlas-size 512 --instructions \
      --stages baseline charts downsizing grouping simplify -o "$results/instructions.json"
  run "$bin/atlas-bench-leak" --work "$leak" --texel $texels \
      --picture "$out/plots/light_leak.png" -o "$results/leak.json"
  [ ! -x "$bin/atlas-bench-shadows" ] ||
    run "$bin/atlas-bench-shadows" $shadows -o "$results/shadows.json"
  set --
  if [ -n "${LIBATLAS_MODELS:-}" ]; then
    for model in "$LIBATLAS_MODELS"/*.obj; do set -- "$@" "file:$model"; done
    run "$bin/atlas-bench" --work "$@" --standard --stages baseline charts \
        -o "$results/models.json"
    set -- --models "$LIBATLAS_MODELS"/*.obj
  fi
  run "$bin/atlas-bench-stability" --failures $full "$@" -o "$results/stability.json"
  set --
  rival_list >"$out/rivals.txt"
  while IFS= read -r rival; do [ -z "$rival" ] || set -- "$@" --rival "$rival"; done <"$out/rivals.txt"
  run "$bin/atlas-bench" --work $rivals --stages unwrap "$@" \
      --timeout "${LIBATLAS_RIVAL_TIMEOUT:-60}" -o "$results/rivals.json"
  [ -n "${LIBATLAS_RIVALS:-}" ] || set -- "$@" --rival "$(lightmap_rival)"
  run "$bin/atlas-bench" --work $small_rivals --stages unwrap "$@" \
      --timeout "${LIBATLAS_RIVAL_TIMEOUT:-60}" -o "$results/small_rivals.json"
}
run "$bin/atlas-bench-page" "$results"/*.json -o "$out"
if [ -n "${LIBATLAS_BENCH_DOCS:-}" ]; then
  mkdir -p docs/generated
  rm -rf docs/generated/plots docs/generated/results
  cp "$out/performance.md" "$out/stability.md" docs/generated/
  cp -r "$out/plots" "$results" docs/generated/
  # Where things lie on this machine is nobody's business.
  for place in "LIBATLAS_MODELS=${LIBATLAS_MODELS:-}" "LIBATLAS_XATLAS=${LIBATLAS_XATLAS:-}" \
               "LIBATLAS_NPM=${LIBATLAS_NPM:-}" ".=$PWD"; do
    [ -z "${place#*=}" ] ||
      find docs/generated -type f ! -name '*.png' -exec sed -i "s#${place#*=}#${place%%=*}#g" {} +
  done
fi
echo "== all: $(($(date +%s) - started)) s after the build; $out/index.html, $out/stability.html"
[ -z "$failed" ] || { echo "failed:$failed" >&2; exit 1; }
