#!/bin/sh
# Builds all fuzz targets and runs each for a while, on the inputs of earlier runs and on seeds of
# each dialect. Writes a table of counts; ends with 1 if there is a finding.
# Usage: scripts/fuzz.sh [CPU seconds a target]      (120)
# LIBATLAS_FUZZ           the folder of what is kept: corpus/TARGET, findings/TARGET, logs, and in
#                         counts.md what all runs so far have tried (out/fuzz)
# LIBATLAS_FUZZ_TARGETS   the targets to run, such as "read_glb unwrap" (all)
# LIBATLAS_FUZZ_BUILD     a build to use as it is
# Earlier findings are tried again. An input may take 10 CPU s and 2 GiB; what reading and charts may
# take is checked in tests/fuzz/effort.h.
set -eu
cd "$(dirname "$0")/.."
seconds="${1:-120}"
case "$seconds" in '' | *[!0-9]* | 0) echo "usage: scripts/fuzz.sh [CPU seconds a target]" >&2; exit 2 ;; esac
kept="${LIBATLAS_FUZZ:-$PWD/out/fuzz}"
build="${LIBATLAS_FUZZ_BUILD:-}"
if [ -z "$build" ]; then
  build=build-fuzz
  cmake --preset fuzz >/dev/null
  if [ -n "${LIBATLAS_FUZZ_TARGETS:-}" ]; then
    # shellcheck disable=SC2046,SC2086  # a list of words
    cmake --build --preset fuzz --target write-seeds $(printf 'fuzz_%s ' $LIBATLAS_FUZZ_TARGETS)
  else
    cmake --build --preset fuzz --target fuzzers
  fi
fi
programs="$build/tests/fuzz"
targets="${LIBATLAS_FUZZ_TARGETS:-$(cd "$programs" && ls | sed -n 's/^fuzz_\([a-z_]*\)$/\1/p')}"
mkdir -p "$kept/logs"
"$programs/write-seeds" "$kept/seeds"
# The targets write many small files, and OpenImageIO leaks the texts of its errors.
[ ! -w /dev/shm ] || export TMPDIR=/dev/shm
export ASAN_OPTIONS=detect_leaks=0

# The figure NAME of a target's log; - if the run ended before it was printed.
figure() {
  sed -n "s/^stat::$1: *//p" "$kept/logs/$2" | tail -1 | grep . || echo -
}

found=0
for target in $targets; do
  corpus="$kept/corpus/$target" findings="$kept/findings/$target"
  mkdir -p "$corpus" "$findings" "$kept/seeds/${target##*_}"
  # What was found earlier is tried again first.
  find "$findings" -type f -exec mv {} "$corpus/" \;
  echo "== $target"
  # The limits of the clock are for what waits instead of working, and for busy machines.
  LIBATLAS_FUZZ_SECONDS="$seconds" "$programs/fuzz_$target" "$corpus" "$kept/seeds/${target##*_}" \
    -max_len=16384 -timeout=300 -report_slow_units=300 -rss_limit_mb=2048 \
    -max_total_time=$((20 * seconds + 600)) -print_final_stats=1 -artifact_prefix="$findings/" \
    >"$kept/logs/$target" 2>&1 ||
    tail -5 "$kept/logs/$target"
  count=$(find "$findings" -type f | wc -l)
  found=$((found + count))
  echo "$target $(figure cpu_seconds "$target") $(figure number_of_executed_units "$target")" \
    "$(figure slowest_cpu_seconds "$target") $(figure peak_rss_mb "$target")" \
    "$(find "$corpus" -type f | wc -l) $count" >>"$kept/runs.txt"
done
# All runs so far, together; findings are those of the last one.
sort -s -k1,1 "$kept/runs.txt" | awk '
  function row() {
    if (name != "")
      printf "| `%s` | %d | %d | %.2f | %d | %d | %d |\n", name, cpu, inputs, slowest, memory, kept, found
  }
  BEGIN {
    print "| target | CPU s | inputs tried | slowest, CPU s | most memory, MiB | inputs kept | findings left |"
    print "|---|---|---|---|---|---|---|"
  }
  $1 != name { row(); name = $1; cpu = inputs = slowest = memory = 0 }
  { cpu += $2; inputs += $3; if ($4 > slowest) slowest = $4; if ($5 > memory) memory = $5; kept = $6; found = $7
    all_cpu += $2; all += $3 }
  END { row(); printf "| all | %d | %d | | | | |\n", all_cpu, all }' >"$kept/counts.md"
cat "$kept/counts.md"
[ "$found" = 0 ] || { echo "$found findings in $kept/findings" >&2; exit 1; }
