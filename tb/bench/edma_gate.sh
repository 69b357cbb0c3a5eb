#!/bin/sh
# Host instructions of a simulation in which the EDMA moves pixels, counted by callgrind.
#   edma_gate.sh check FOVEA OUT   measures (some minutes, two runs at a time); exit 0: --hazards costs at most 20 % more; 1: more
#   edma_gate.sh compare           the same of measured lines from standard input:
#                                  hazards KERNEL COUNT COUNT COUNT COUNT   two and four frames without, then with
#                                  remap KERNEL COUNT COUNT BYTES BYTES     few and many remaps in each of two frames
# The start does not count, as two lengths are subtracted. BYTES: what core and EDMA read from and wrote to SDRAM. The
# second part prints bytes of the SDRAM for each host instruction, and how many times those of `plain`, with which the
# core corrects; host seconds go with host instructions.
set -eu
compare() {
  awk '
    $1 == "hazards" {
      without = $4 - $3; with = $6 - $5; n++
      if (NF != 6 || without <= 0 || with <= 0) { print $2 ": nothing was measured"; bad = 1; next }
      over = with > 1.2 * without
      printf "%-7s %.0f host instructions in two frames, with --hazards %.0f: %.3f times as many%s\n", $2, without, with,
             with / without, over ? ": TOO MANY" : ""
      if (over) bad = 1
    }
    $1 == "remap" {
      cost = $4 - $3; bytes = $6 - $5
      if (NF != 6 || cost <= 0 || bytes <= 0) { print $2 ": nothing was measured"; bad = 1; next }
      if ($2 == "plain") plain = bytes / cost
      if (!plain) { print $2 ": nothing to compare with"; bad = 1; next }
      printf "%-7s %.4f bytes of the SDRAM for each host instruction, %.2f times as many as plain\n", $2, bytes / cost,
             bytes / cost / plain
      m++
    }
    END {
      if (n < 2 || m < 2) { print "not all was measured"; bad = 1 }
      exit bad
    }'
}
count() {  # KERNEL FRAMES REPEAT OPTION...: host instructions; the results are in $out/KERNEL
  kernel=$1 frames=$2 repeat=$3
  shift 3
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$fovea" run "$out/small.yaml" --no-frames \
    -s firmware.kernel="$kernel" -s run.frames="$frames" -s firmware.repeat="$repeat" -o "$out/$kernel" "$@" 2>&1 |
    awk '/Collected/ { print $NF }'
}
bytes() {  # KERNEL
  grep -oE '"bus\.(arm_d|edma_tc[0-3])\.(read|write)_bytes": \{"value": [0-9]+' "$out/$1/stats.json" |
    awk '{ sum += $NF } END { print sum }'
}
measure() {  # KERNEL...
  for k; do
    few=$(count "$k" 2 2)
    few_bytes=$(bytes "$k")
    many=$(count "$k" 2 6)
    echo "remap $k $few $many $few_bytes $(bytes "$k")"
    case $k in
      plain | staged) echo "hazards $k $many $(count "$k" 4 6) $(count "$k" 2 6 --hazards) $(count "$k" 4 6 --hazards)" ;;
    esac
  done
}
case ${1-} in
  check)
    fovea=$2 out=$3
    mkdir -p "$out"
    printf 'run: {start_limit: 2s}\ncamera: {kind: chart, stamp: false}\nvideo: {width: 240, height: 64}\nfirmware: {lut: fixed_point}\n' \
      >"$out/small.yaml"
    measure staged >"$out/one" &
    measure plain copy >"$out/two"
    wait
    cat "$out/two" "$out/one" | tee "$out/lines" | compare ;;
  compare) compare ;;
  *) echo "usage: edma_gate.sh check|compare ..." >&2; exit 2 ;;
esac
