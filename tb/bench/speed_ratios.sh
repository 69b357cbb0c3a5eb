#!/bin/sh
# Speed of the simulator itself against an earlier state, in host instructions of the main thread, which callgrind
# counts: they are the same on each run of one build. The reference is speed_reference.txt.
#   speed_ratios.sh BUILD [exec|replay|board|default]...  measures (default: all; minutes) and prints the ratios
#   speed_ratios.sh FOVEA [replay|board|default]...       the same for a program of any build
#   speed_ratios.sh compare                       ratios of lines "NAME COUNT" from standard input
# Exit 1: something costs more than its floor, or was not measured.
# board: the last displayed frame of paper-pal, within which one frame is remapped: 720 x 576 / 2 pairs.
# default: a frame of default.yaml with the kernel $KERNEL (plain, its former one), as the difference of runs with three
# frames and with one.
set -eu
here=$(dirname "$0")
compare() {
  awk -v record="$here/speed_reference.txt" '
    BEGIN {
      while ((getline line < record) > 0)
        if (line !~ /^#/) { split(line, f, " "); want[f[1]] = f[2]; goal[f[1]] = f[3]; least[f[1]] = f[4] }
      printf "%-22s %9s %9s %8s %6s %6s\n", "", "before", "now", "ratio", "goal", "floor"
    }
    {
      if (!($1 in want) || $2 + 0 <= 0) { printf "%s: NOTHING TO COMPARE\n", $1; bad = 1; next }
      n++
      percent = 100 * $2 / want[$1]
      verdict = percent <= goal[$1] ? "goal met" : percent <= least[$1] ? "floor met" : "ABOVE THE FLOOR"
      if (percent > least[$1]) bad = 1
      printf "%-22s %9.2f %9.2f %6.1f %% %4d %% %4d %%  %s\n", $1, want[$1], $2, percent, goal[$1], least[$1], verdict
    }
    END { if (!n) print "nothing measured"; exit bad || !n }'
}
[ "${1-}" = compare ] && { compare; exit; }
what=${1:?usage: speed_ratios.sh BUILD|FOVEA [exec|replay|board]...}
shift
[ $# -gt 0 ] || set -- exec replay board default
if [ -d "$what" ]; then build=$what fovea=$what/fovea; else build= fovea=$what; fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

count() {  # COMMAND...: host instructions of the main thread
  rm -rf "$work"/count* "$work/out"  # a folder that is there already costs something too
  valgrind --tool=callgrind --separate-threads=yes --callgrind-out-file="$work/count" "$@" >"$work/log" 2>&1 ||
    { cat "$work/log" >&2; exit 1; }
  awk '/^totals:/ { print $2 }' "$work/count-01"
}
make() {  # KIND RECORDS
  awk -v kind="$1" -v records="$2" 'BEGIN {
    print "# dramtrace 1\n# master 0 window 8 m0"
    seed = 1
    for (i = 0; i < records; i++) {
      seed = (seed * 16807) % 2147483647
      if (kind == "sequential") printf "0 0 R 0x%x 32\n", i * 32 % 1048576
      else printf "0 0 %s 0x%x 32\n", seed % 4 ? "R" : "W", seed % 2097152 * 32
    }
  }'
}
exec_programs() { "$here/host_instructions.sh" "$build" | awk '{ print "exec." $1, $6 }'; }
replays() {
  for kind in sequential random; do  # the difference of two lengths, so that start-up does not count
    for n in 5000 20000; do make $kind $n >"$work/$n.txt"; done
    short=$(count "$fovea" replay "$work/5000.txt" -o "$work/out")
    long=$(count "$fovea" replay "$work/20000.txt" -o "$work/out")
    echo "replay.text.$kind $(((long - short) / 15000))"
  done
}
board() {
  rm -rf "$work/out"  # a run does not replace what a replay has left
  valgrind --tool=callgrind --separate-threads=yes --dump-before='fovea::board::FrameLog::shown*' \
    --callgrind-out-file="$work/board" "$fovea" run "${EXPERIMENT:-$here/../../scripts/experiments/paper-pal.yaml}" \
    -s run.frames=2 -s firmware.lut=fixed_point --no-frames -o "$work/out" >"$work/log" 2>&1 ||
    { cat "$work/log" >&2; exit 1; }
  last=$(ls "$work"/board.*-01 | sort -V | tail -n 1)
  awk '/^totals:/ { printf "board.paper-pal %.0f\n", $2 / (720 * 576 / 2) }' "$last"
}
default_frames() {  # FRAMES
  count "$fovea" run "$here/../../scripts/experiments/default.yaml" -s firmware.kernel="${KERNEL:-plain}" \
    -s run.frames="$1" --no-frames -o "$work/out"
}
default_board() {
  one=$(default_frames 1)
  three=$(default_frames 3)
  echo "board.default $(((three - one) / (2 * 720 * 576 / 2)))"
}
for part in "$@"; do
  case $part in
    exec) exec_programs ;;
    replay) replays ;;
    board) board ;;
    default) default_board ;;
    *) echo "speed_ratios.sh: '$part' is not known: exec, replay, board, default" >&2; exit 2 ;;
  esac
done >"$work/lines"
compare <"$work/lines"
