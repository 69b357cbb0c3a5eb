#!/bin/sh
# speed_ratios.sh complains about a count above its floor, an unknown name, a count of 0 and no measurement at all.
set -u
tool=$(dirname "$0")/speed_ratios.sh
status=0
expect() {  # EXIT TEXT MEASURED
  out=$(printf "$3" | "$tool" compare)
  got=$?
  [ $got -eq "$1" ] || { echo "exit $got, expected $1 for: $3"; status=1; }
  case $out in *"$2"*) ;; *) echo "'$2' is missing in: $out"; status=1 ;; esac
}
expect 0 'goal met' 'board.paper-pal 1458\n'        # 60 % of 2430
expect 0 'floor met' 'board.paper-pal 1459\n'
expect 0 'floor met' 'board.paper-pal 1944\n'       # 80 %
expect 1 'ABOVE THE FLOOR' 'board.paper-pal 1945\n'
expect 1 'ABOVE THE FLOOR' 'board.paper-pal 1000\nexec.remap 114.07\n'
expect 0 'floor met' 'board.default 2601\n'         # 101 % of 2576
expect 1 'ABOVE THE FLOOR' 'board.default 2602\n'
expect 1 'board.ntsc: NOTHING TO COMPARE' 'board.ntsc 1000\n'
expect 1 'board.paper-pal: NOTHING TO COMPARE' 'board.paper-pal 0\n'
expect 1 'exec.copy: NOTHING TO COMPARE' 'board.paper-pal 1000\nexec.copy 1\n'
expect 1 'nothing measured' ''
exit $status
