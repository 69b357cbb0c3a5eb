#!/usr/bin/env bash
# What the remap engine is built for, on the shipped experiments with capture and display running: at least 250 remapped
# PAL frames a second with a table and 400 with a grid or the radial function; at most 1.3 times the least traffic; a
# bird's-eye view made 25 times a second, of four cameras in turn and of a quad processor, with the core idle for at
# least 95 % of the time.
# Usage: goals.sh FOVEA SOURCE OUT [TABLE GRID TRAFFIC MOSAIC IDLE]: other limits, for a test of this one.
set -uo pipefail
fovea=$(realpath "$1") source=$2 out=$3
table=${4:-250} grid=${5:-400} traffic=${6:-1.3} mosaic=${7:-25} idle=${8:-0.95}
mkdir -p "$out"
cd "$out" || exit 1
failures=0
run() { # NAME EXPERIMENT FRAMES ARGUMENTS...
  timeout 600 "$fovea" run "$source/scripts/experiments/$2.yaml" -s engine=tlm -s run.frames="$3" --no-frames \
    "${@:4}" -o "$1" >"$1.log" 2>&1 || { echo "$1: status $?: $(tail -3 "$1.log")"; exit 1; }
}
value() { # NAME STATISTIC
  grep -oE "\"$2\": \{\"value\": [0-9.e+-]+" "$1/stats.json" | grep -oE '[0-9.e+-]+$' || { echo "no $2 in $1" >&2; echo nan; }
}
bytes() { # of map, source and result for each byte of the result: the window does not hold whole remaps
  awk -v m="$(value "$1" engine.map_bytes)" -v s="$(value "$1" engine.source_bytes)" \
    -v w="$(value "$1" engine.write_bytes)" 'BEGIN { if (w > 0) print (m + s + w) / w; else print "nan" }'
}
check() { # WHAT VALUE at_least|at_most LIMIT
  if awk -v v="$2" -v l="$4" -v how="$3" 'BEGIN { exit !(v ~ /^[0-9.]+/ && (how == "at_least" ? v + 0 >= l : v + 0 <= l)) }'; then
    echo "$1: $2"
  else
    echo "$1: $2, which should be ${3/_/ } $4"
    failures=$((failures + 1))
  fi
}
for kernel in engine engine_grid engine_radial; do
  run "$kernel" throughput 1 -s firmware.kernel="$kernel"
  run "${kernel}_least" throughput 1 -s firmware.kernel="$kernel" -s engine.cache=128KiB
  limit=$grid
  [ "$kernel" = engine ] && limit=$table
  check "$kernel, remaps a second" "$(value "$kernel" frame.remap_rate)" at_least "$limit"
  check "$kernel, traffic by the least" \
    "$(awk -v a="$(bytes "$kernel")" -v b="$(bytes "${kernel}_least")" 'BEGIN { if (b > 0) print a / b; else print "nan" }')" \
    at_most "$traffic"
done
for view in birds-eye birds-eye-quad; do
  run "$view" "$view" 4 -s firmware.kernel=engine
  check "$view, mosaics a second" "$(value "$view" frame.remap_rate)" at_least "$mosaic"
  check "$view, share of the core's time that is idle" \
    "$(awk -v i="$(value "$view" cpu.idle)" -v t="$(value "$view" cpu.cycles)" 'BEGIN { if (t > 0) print i / t; else print "nan" }')" \
    at_least "$idle"
done
exit "$((failures != 0))"
