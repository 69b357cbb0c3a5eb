#!/usr/bin/env bash
# scripts/phases: the display of a free run does not follow the camera, so a camera that starts 10 ms later has a latency
# that is 10 ms shorter, or a frame longer than that. Usage: phases.sh FOVEA SOURCE OUT
set -euo pipefail
fovea=$1 source=$2 out=$3
mkdir -p "$out"
small=(-s camera.kind=chart -s camera.stamp=false -s video.width=48 -s video.height=16)
"$source/scripts/phases" "$source/scripts/experiments/default.yaml" --fovea "$fovea" --phases 4 --frames 2 "${small[@]}" \
  >"$out/table.md"
cat "$out/table.md"
check() {
  awk -F'|' '
    $2 ~ /^ *[0-9.]+ *$/ {  # a phase: shortest, mean and longest of frames at one phase are one
      if ($5 - $3 > 0.05) bad = "the latency of phase " $2 " is not one"
      if (!n++) first = $4
      off = first - $4 - $2
      off -= 40 * int(off / 40 + (off < 0 ? -0.5 : 0.5))
      if (off > 0.05 || off < -0.05) bad = "phase " $2 " is off by " off " ms"
      low = n == 1 || $4 < low ? $4 : low
      high = $4 > high ? $4 : high
    }
    $2 ~ /all/ { if ($3 > low + 0.05 || $5 < high - 0.05) bad = "the range of all" ; all = 1 }
    END {
      if (n != 4 || !all) bad = n " phases"
      if (high - low < 29 || high - low > 31) bad = "a range of " high - low " ms; four phases span 30"
      if (bad) { print bad; exit 1 }
    }' "$1"
}
check "$out/table.md"
awk -F'|' -v OFS='|' 'NR == 4 { $4 = " " $4 + 3 " " } 1' "$out/table.md" >"$out/changed.md"
if cmp -s "$out/table.md" "$out/changed.md" || check "$out/changed.md" >/dev/null; then echo "the check cannot fail"; exit 1; fi
if "$source/scripts/phases" --fovea "$fovea" --phases 1 -s no.key=1 >/dev/null 2>"$out/wrong"; then exit 1; fi
grep -q "no.key" "$out/wrong"
