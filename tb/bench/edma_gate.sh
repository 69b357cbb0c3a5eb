#!/bin/sh
# Host instructions of a simulation in which the EDMA moves pixels, counted by callgrind.
#   edma_gate.sh check FOVEA OUT   measures (some minutes, two runs at a time); exit 0: --hazards costs at most 20 % more; 1: more
#   edma_gate.sh compare           the same of measured lines from standard input:
#                                  hazards KERNEL COUNT COUNT COUNT COUNT   two and four frames without, then with
#                                  remap KERNEL COUNT COUNT BYTES BYTES     few and many remaps in each of two frames
#                                  seconds KERNEL SECONDS SECONDS BYTES BYTES   few and very many, without callgrind
#   edma_gate.sh speed FOVEA OUT   the lines `seconds` alone (a minute), and what `compare` says of them
# The start does not count, as two lengths are subtracted. BYTES: what core and EDMA read from and wrote to SDRAM. The
# second part prints bytes of the SDRAM for each host instruction and for each second of the host's processor, and how
# many times those of `plain`, with which the core corrects. Seconds depend on the host: they are shown, not judged.
set -eu
compare() {  # [seconds]: lines of that kind are all that is wanted
  awk -v only="${1-}" '
    function times(kernel, what, each, value, first) {
      if (kernel == "plain") first[what] = value
      if (!first[what]) { print kernel ": nothing to compare with"; bad = 1; return 0 }
      printf "%-7s " each ", %.2f times as many as plain\n", kernel, value, value / first[what]
      return 1
    }
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
      m += times($2, "instruction", "%.4f bytes of the SDRAM for each host instruction", bytes / cost, plain)
    }
    $1 == "seconds" {
      cost = $4 - $3; bytes = $6 - $5
      if (NF != 6 || cost <= 0 || bytes <= 0) { print $2 ": nothing was measured"; bad = 1; next }
      s += times($2, "second", "%.1f MB of the SDRAM for each second of the host", bytes / cost / 1e6, plain)
    }
    END {
      if (s < 2 || only == "" && (n < 2 || m < 2)) { print "not all was measured"; bad = 1 }
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
seconds() {  # KERNEL REPEAT: seconds of the processor, the least of three runs; the results are in $out/KERNEL
  for _ in 1 2 3; do
    (
      "$fovea" run "$out/small.yaml" --no-frames -s firmware.kernel="$1" -s run.frames=2 -s firmware.repeat="$2" \
        -o "$out/$1" >/dev/null 2>&1
      times >"$out/$1.times"
    )
    # The second line: user and system time of what the shell has run, "1m2.345s 0m0.678s".
    awk -F '[ms ]+' 'NR == 2 { print 60 * ($1 + $3) + $2 + $4 }' "$out/$1.times"
  done | sort -g | head -n 1
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
time_all() {
  for k in plain staged copy; do
    few=$(seconds $k 2)
    few_bytes=$(bytes $k)
    many=$(seconds $k 400)
    echo "seconds $k $few $many $few_bytes $(bytes $k)"
  done
}
prepare() {  # FOVEA OUT
  fovea=$1 out=$2
  mkdir -p "$out"
  printf '%s\n' 'run: {start_limit: 2s}' 'camera: {kind: chart, stamp: false}' 'video: {width: 240, height: 64}' \
    'firmware: {lut: fixed_point}' >"$out/small.yaml"
}
case ${1-} in
  check)
    prepare "$2" "$3"
    time_all >"$out/seconds"
    measure staged >"$out/one" &
    measure plain copy >"$out/two"
    wait
    cat "$out/two" "$out/one" "$out/seconds" | tee "$out/lines" | compare ;;
  speed)
    prepare "$2" "$3"
    time_all | tee "$out/lines" | compare seconds ;;
  compare) compare ;;
  *) echo "usage: edma_gate.sh check|compare|speed ..." >&2; exit 2 ;;
esac
