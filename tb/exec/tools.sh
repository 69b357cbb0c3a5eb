#!/usr/bin/env bash
# The tools of `fovea exec`: their window is the whole run, on the core with its SDRAM and on the board; what a machine
# does not have it refuses; without a folder nothing that was asked for is lost.
# Usage: tools.sh FOVEA PROGRAMS OUT
set -uo pipefail
fovea=$1 core=$2/arguments_arm_O2.elf board=$2/remap_methods.elf out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
fail() { echo "$*"; exit 1; }
for machine in core board; do
  program=("$core" 0) flag=()
  [ $machine = board ] && program=("$board" 1) flag=(--board)
  "$fovea" exec -q "${flag[@]}" "${program[@]}" >words -o "plain_$machine" 2>said || fail "$machine fails: $(<said)"
  "$fovea" exec -q "${flag[@]}" --command-trace "$machine.csv" -o "traced_$machine" "${program[@]}" >also 2>said ||
    fail "$machine with a command trace: $(<said)"
  cmp words also && cmp "plain_$machine/stats.json" "traced_$machine/stats.json" || fail "$machine: the trace changes it"
  # A trace of the whole run has each command that the figures count.
  for kind in 'activates ACT' 'refreshes REF' 'bursts \(RD\|WR\)A\?'; do
    read -r figure commands <<<"$kind"
    traced=$(grep -c ",$commands," "$machine.csv")
    counted=$(grep -o "\"ddr.$figure\": {\"value\": [0-9]*" "plain_$machine/stats.json" | grep -o '[0-9]*$')
    [ "$counted" -gt 9 ] && [ "$traced" = "$counted" ] || fail "$machine: $traced in the trace, $counted $figure"
  done
  "$fovea" exec -q "${flag[@]}" --around 1ms "${program[@]}" >words 2>said || fail "$machine fails: $(<said)"
  [ "$(head -1 said | cut -d, -f1-3)" = master,direction,port ] || fail "$machine: no list of requests: $(<said)"
done
"$fovea" exec -q --board --perfetto board.pf "$board" 1 >words 2>said || fail "no Perfetto trace: $(<said)"
[ "$(stat -c %s board.pf)" -gt 10000 ] || fail "the Perfetto trace of a program has nothing in it"
refused() {
  local why=$1
  shift
  "$fovea" exec "$@" "$core" >words 2>said
  [ $? = 2 ] && [ "$(wc -l <said)" = 1 ] && grep -qF -- "$why" said || fail "exec $*: $(<said)"
}
refused "--perfetto: there are no frames" --perfetto x.pf
refused "--hazards: there is no DMA; allowed: with --board" --hazards
refused "--hazards: there is no DMA; allowed: with --board" --fast-memory --hazards
refused "--command-trace: there is no SDRAM; allowed: without --fast-memory" --fast-memory --command-trace x.csv
refused "--command-trace 'r/x.csv': it lies in the output folder" -o r --command-trace r/x.csv
refused "a file name is needed" --command-trace ''
# A number in another base is that number, and a flag that is false was not given.
"$fovea" exec -q --hazards=false -o unasked "$core" 0 >words 2>said || fail "a flag that is false: $(<said)"
cmp unasked/stats.json plain_core/stats.json || fail "a flag that is false changes the figures"
for kept in 16 0x10 020; do
  "$fovea" exec -q --log-registers '.' --log-registers-kept "$kept" -o "kept_$kept" --board "$board" 1 >words 2>said ||
    fail "--log-registers-kept $kept: $(<said)"
  cmp "kept_$kept/registers.log" kept_16/registers.log || fail "--log-registers-kept $kept is another number"
done
refused "--log-registers-kept: Value" --log-registers . --log-registers-kept 0x0
[ ! -e x.pf ] && [ ! -e x.csv ] && [ ! -e r ] || fail "a refusal leaves a file"
echo "the tools of exec work"
