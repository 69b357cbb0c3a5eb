#!/usr/bin/env bash
# Random settings of memory, crossbar, core and loads: strict and default synchronisation must leave the
# same bytes. Usage: strict_random.sh FOVEA EXPERIMENT OUT CASE...
# LOAD_START: the loads of a seed begin then (default: with the SDRAM).
# CASE: a seed; SEED:KERNEL, a seed that draws this kernel, and a picture that it can make; or copy_on_one_port, where a
# copy's write and the next read of one port met in an instant.
set -uo pipefail
fovea=$1 experiment=$2 out=$3
shift 3
mkdir -p "$out"

# Leaves one of its arguments in ${word}. Not by $(...): bash seeds RANDOM anew in a subshell.
one_of() { local words=("$@"); word=${words[RANDOM % $#]}; }
load() {  # NAME PORT OUTSTANDING KIND BYTES GAP PATTERN [START]
  [ -z "${8:-}" ] || keys+=(-s "$1.start=$8")
  keys+=(-s "$1.port=$2" -s "$1.outstanding=$3" -s "$1.kind=$4" -s "$1.bytes=$5" -s "$1.gap=$6" -s "$1.pattern=$7")
}
copy_on_one_port() {
  keys=(-s run.frames=1 -s video.width=32 -s video.height=24 -s ddr.scheduler=closed_page -s ddr.command_fifo=16
    -s ddr.return_latency=16cycles -s firmware.kernel=ldm -s vpss.write_buffer_bursts=1
    -s bus.arm_d.request_latency=16cycles -s bus.load.response_latency=16cycles)
  load load load 2 copy 32B 2us sequential
  load load.1 edma_tc1 16 mixed 4B 2us random
  load load.2 edma_tc2 16 copy 64B 317ns sequential
}
settings() {  # SEED: keys in ${keys[@]}
  RANDOM=$1
  keys=(-s run.frames=1 -s video.width=$((16 * (2 + RANDOM % 4))) -s video.height=$((8 * (2 + RANDOM % 4)))
    -s ddr.check=commands)
  local name n port outstanding kind bytes gap
  while read -r name n; do
    ((RANDOM % 4)) && continue
    # shellcheck disable=SC2086 # the values are words
    one_of $n
    keys+=(-s "$name=$word")
  done <<'K'
clocks.preset 297/243 297/270 270/216 216/172 432/340
ddr.scheduler ti fcfs frfcfs closed_page
ddr.command_fifo 1 3 16
ddr.read_fifo 64B 72B 512B
ddr.write_fifo 64B 72B 512B
ddr.request_latency 0cycles 1cycles 32cycles
ddr.return_latency 0cycles 16cycles
ddr.refresh.gap 1 3 64
ddr.refresh.must 0 11 64
ddr.refresh.need 0 7 32
cpu.ahb_ratio 1 2 3 8
cpu.dcache.size 4KiB 128KiB
cpu.fill_latency 0cycles 8cycles
firmware.kernel plain codes staged gather runs copy
firmware.flow double serial
firmware.overlay true false
vpss.burst 32B 64B
vpss.read_outstanding 1 16
vpss.write_buffer_bursts 1 32
vpss.osd_latch field frame
bus.config.fast_latency 1ps 1us
bus.arm_d.request_latency 0cycles 16cycles
bus.arm_d.response_latency 0cycles 16cycles
bus.arm_d.width 16bit 64bit
bus.vpfe.width 16bit 32bit
bus.vpbe.request_latency 0cycles 16cycles
bus.load.response_latency 0cycles 16cycles
edma.event_clocks 1 64
edma.request_clocks 1 128
edma.completion_clocks 1 64
edma.tc.burst 16B 64B
edma.tc.fifo 128B 512B
edma.tc.depth 1 2
edma.tc.outstanding 1 16
cpu.tcm.banks 1 2
cpu.tcm.dma_word_clocks 1cycles 8cycles
cpu.tcm.dma_latency 0cycles 32cycles
cpu.tcm.first core dma
bus.edma_tc0.request_latency 0cycles 16cycles
bus.edma_tc1.response_latency 0cycles 16cycles
bus.edma_tc2.width 16bit 32bit
K
  # Pauses in whole microseconds: bursts then end in the instant in which others begin.
  for n in load load.1 load.2; do
    ((RANDOM % 2)) && continue
    port=edma_tc${n#load}
    port=${port/tc./tc}
    [ "$n" = load ] && port=load
    one_of 317ns 1us 2us && gap=$word
    one_of 1 2 16 && outstanding=$word
    one_of read write mixed copy && kind=$word
    one_of 4B 32B 64B && bytes=$word
    one_of sequential random
    load "$n" "$port" "$outstanding" "$kind" "$bytes" "$gap" "$word" "${LOAD_START:-}"
  done
}
play() {  # MODE FOLDER
  "$fovea" run "$experiment" "${keys[@]}" --sync="$1" -o "$out/$2" >"$out/$2.log" 2>&1
}
differ() {  # FOLDER FOLDER
  local f
  for f in stats.json frames.csv timeline.csv stalls.csv uart.log; do
    cmp "$out/$1/$f" "$out/$2/$f" || return 0
  done
  ! diff -r "$out/$1/frames" "$out/$2/frames"
}

failures=0
for case; do
  if [[ $case == copy_on_one_port ]]; then copy_on_one_port; else settings "${case%:*}"; fi
  play strict strict
  a=$?
  play default default
  b=$?
  if [ $a -ne 0 ] || [ $b -ne 0 ]; then
    echo "$case: exit $a and $b: ${keys[*]}: $(tail -1 "$out/strict.log") / $(tail -1 "$out/default.log")"
    failures=$((failures + 1))
  elif differ strict default; then
    echo "$case: differs: ${keys[*]}"
    failures=$((failures + 1))
  elif [[ $case == *:* ]] && ! grep -q "^kernel: ${case#*:}, " "$out/default/uart.log"; then
    echo "$case: another kernel: ${keys[*]}: $(grep '^kernel' "$out/default/uart.log")"
    failures=$((failures + 1))
  fi
done
# The comparison can fail.
keys+=(-s bus.arm_i.request_latency=9cycles)
play default other
if ! differ other default >/dev/null; then
  echo 'another bridge makes no difference'
  failures=$((failures + 1))
fi
echo "$# settings, $failures failures"
exit $((failures > 0))
