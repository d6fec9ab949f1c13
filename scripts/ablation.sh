#!/bin/sh
# The ablation bench: measures what each step and constant of charts and packing is worth (hours; it can be
# ended, and goes on where it was), and writes docs/generated/ablation.md.
# Usage: scripts/ablation.sh run [--rows REGEX] [--draws N] [--minutes N] [--half checking] | table
# LIBATLAS_SKIP_DEPS=1 leaves the system's packages alone.
set -eu
cd "$(dirname "$0")/.."
[ -n "${LIBATLAS_SKIP_DEPS:-}" ] || scripts/install-deps.sh all
cmake --preset tuning >/dev/null
cmake --build --preset tuning --target atlas-ablation-measure
exec python3 benchmarks/ablation/ablation.py "${@:-run}" --build build-tuning --docs docs/generated
