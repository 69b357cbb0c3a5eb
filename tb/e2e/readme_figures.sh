#!/usr/bin/env bash
# The figures in README.md and scripts/experiments/README.md are those that the program gives; another figure is found.
# Usage: readme_figures.sh FOVEA SOURCE OUT [kernels]
set -euo pipefail
fovea=$1 source=$2 out=$3
"$source/scripts/figures" --check "$fovea" "$out" ${4:+"$4"} 2>&1
# The same comparison against one changed digit.
for page in README.md scripts/experiments/README.md; do
  sed -E '0,/^(\| remap of a frame, mean \(ms\) \| [0-9]+\.)([0-9])/s//\19\2/' "$source/$page" >"$out/changed.md"
  if diff -q "$source/$page" "$out/changed.md" >/dev/null; then echo "$page: no figure was changed"; exit 1; fi
  if diff -q "$out/changed.md" "$out/${page//\//_}" >/dev/null; then echo "$page: another figure was not found"; exit 1; fi
done
