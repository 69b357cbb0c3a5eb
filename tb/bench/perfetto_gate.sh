#!/bin/sh
# Host instructions of a simulation that records a Perfetto trace of everything, against those without: both as the
# difference of a run of four frames and one of two, so that the start does not count. Counted by callgrind.
#   perfetto_gate.sh check FOVEA OUT   exit 0: at most twice as many; 1: more
#   perfetto_gate.sh compare           the same of four numbers from standard input: two and four frames without, then with
set -eu
compare() {
  awk '{ n[NR] = $1 }
    END {
      without = n[2] - n[1]; with = n[4] - n[3]
      if (NR != 4 || without <= 0 || with <= 0) { print "nothing was measured"; exit 1 }
      printf "%.0f host instructions in two frames, with a trace %.0f: %.3f times as many%s\n", without, with,
             with / without, (with > 2 * without ? ": TOO MANY" : "")
      exit with > 2 * without
    }'
}
count() {  # FRAMES OPTION...: host instructions
  frames=$1
  shift
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$fovea" run "$out/small.yaml" --no-frames \
    -s run.frames="$frames" -o "$out/run" "$@" 2>&1 | awk '/Collected/ { print $NF }'
}
case ${1-} in
  check)
    fovea=$2 out=$3
    mkdir -p "$out"
    printf 'run: {start_limit: 2s}\ncamera: {kind: chart, stamp: false}\nvideo: {width: 360, height: 96}\nfirmware: {kernel: plain}\n' \
      >"$out/small.yaml"
    {
      count 2
      count 4
      count 2 --perfetto "$out/trace"
      count 4 --perfetto "$out/trace"
    } | compare ;;
  compare) compare ;;
  *) echo "usage: perfetto_gate.sh check|compare ..." >&2; exit 2 ;;
esac
