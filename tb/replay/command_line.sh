#!/usr/bin/env bash
# `fovea replay` and `--bus-trace` towards people: results and wrong input, on the real program.
# Usage: command_line.sh FOVEA PROJECT_SOURCE OUT
set -uo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }

# expect NAME STATUS 'pattern'... -- command...
expect() {
  local name=$1 status=$2 got text
  shift 2
  local patterns=()
  while [ "$1" != -- ]; do patterns+=("$1"); shift; done
  shift
  text=$("$@" 2>&1)
  got=$?
  [ "$got" = "$status" ] || fail "$name: exit status $got, expected $status: $text"
  if [ "$status" = 2 ] && [ "$(wc -l <<<"$text")" != 1 ]; then fail "$name: not one line: $text"; fi
  for p in "${patterns[@]}"; do
    grep -qE "$p" <<<"$text" || fail "$name: no '$p' in: $text"
  done
}

cat >"$out/small.yaml" <<'Y'
run: {frames: 2, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 64, height: 16}
load: {port: edma_tc0, kind: copy, outstanding: 2, gap: 20us, start: 100ms, 1: {outstanding: 1, gap: 50us}}
Y
trace=$out/small.trace
run() { "$fovea" run "$out/small.yaml" --no-frames "$@"; }
replay() { "$fovea" replay "$@" -o "$out/replay"; }
expect record 0 -- run -o "$out/run" --bus-trace "$trace"
expect without 0 -- run -o "$out/without"
cmp "$out/run/stats.json" "$out/without/stats.json" || fail 'recording changes the run'
# Also where the recorder looks on while core and EDMA work in internal RAM side by side.
staged=(-s firmware.kernel=staged -s video.width=320 -s video.height=240 -s firmware.repeat=4)
expect staged_recorded 0 -- run "${staged[@]}" -o "$out/staged" --bus-trace "$out/staged.trace"
expect staged_without 0 -- run "${staged[@]}" -o "$out/staged_without"
expect staged_memory_only 0 '^replayed [0-9]{5,} requests' -- replay "$out/staged.trace" --memory-only
cmp "$out/staged/stats.json" "$out/staged_without/stats.json" || fail 'recording changes a run by staged'
# By a trace of version 4, which lacks the core's accesses to internal RAM, bursts wait there as recorded whatever the
# settings are; this is said where there are other settings. version4.trace was made by the program of commit 6a507366:
#   fovea run scripts/experiments/throughput.yaml -s run.frames=1 -s firmware.kernel=staged -s firmware.lut=fixed_point \
#     -s video.width=96 -s video.height=64 -s camera.kind=chart -s camera.stamp=false --no-frames --bus-trace FILE
kept_waits='bursts of the EDMA waited [1-9][0-9]* core clocks in internal RAM for the core: as in the recorded run'
old=$source/tb/replay/version4.trace
expect info_old 0 '^binary, version 4$' -- "$fovea" trace info "$old"
expect staged_old 0 "warning \(configuration\): $kept_waits" -- replay "$old" -s ddr.scheduler=fcfs
grep -qE "$kept_waits" "$out/replay/stats.json" || fail 'stats.json does not name the waits that are kept'
text=$(replay "$old" 2>&1)
grep -qE "$kept_waits" <<<"$text" && fail 'waits are said to be kept where nothing is set'
# Newer traces have these accesses: what a burst waits follows the settings.
ram_waits() { grep -oE '"replay.ram_waits": \{"value": [1-9][0-9]*' "$out/replay/stats.json"; }
replay "$out/staged.trace" >"$out/text" 2>&1 || fail 'no replay of staged'
as_recorded=$(ram_waits) || fail 'no replay.ram_waits'
expect staged_other 0 -- replay "$out/staged.trace" -s ddr.scheduler=fcfs
text=$(replay "$out/staged.trace" -s ddr.scheduler=fcfs 2>&1)
grep -qE "$kept_waits" <<<"$text" && fail 'waits are said to be kept where they follow'
[ "$(ram_waits)" = "$as_recorded" ] && fail 'bursts wait in internal RAM as recorded'
expect strict 0 -- run -o "$out/strict" --sync=strict --bus-trace "$out/strict.trace"
cmp "$trace" "$out/strict.trace" || fail 'strict and default record different traces'
# The EDMA's copies between places of the SDRAM wait for nothing that the trace does not hold.
expect record_edma 0 -- run -o "$out/edma" -s firmware.kernel=copy --bus-trace "$out/edma.trace" \
  -s load.outstanding=0 -s load.1.outstanding=0
"$fovea" trace info "$out/edma.trace" | grep -q 'keep their recorded times' && fail 'the EDMA is said not to wait'
expect replay_edma 0 '^replayed [0-9]+ requests' -- replay "$out/edma.trace"
bytes() { grep -oE '"bus\.(edma_tc[0-3]|vp[bf]e)\.(read|write)_bytes": \{"value": [1-9][0-9]*' "$1/stats.json"; }
[ "$(bytes "$out/edma" | grep -c edma_tc)" = 8 ] || fail "the controllers copy nothing: $(bytes "$out/edma")"
diff <(bytes "$out/edma") <(bytes "$out/replay") || fail 'other bytes of the EDMA in the replay than in the run'

# What is not a trace is not overwritten, and no link is followed.
echo dear >"$out/letter"
cp "$out/letter" "$out/other.tmp"
ln -s "$out/letter" "$out/link"
for name in letter link other; do
  expect "bus_trace_$name" 2 "$name" 'bus trace|symbolic link' -- run -o "$out/refused" --bus-trace "$out/$name"
done
expect bus_trace_in_folder 2 'output folder' -- run -o "$out/refused" --bus-trace "$out/refused/x.trace"
[ "$(cat "$out/letter" "$out/other.tmp")" = $'dear\ndear' ] || fail 'a file that is not a trace was overwritten'
[ ! -e "$out/refused" ] && [ ! -e "$out/refused.tmp" ] || fail 'a refused trace left a folder'
expect record_again 0 -- run -o "$out/run" --bus-trace "$trace"
cmp "$trace" "$out/strict.trace" || fail 'a trace recorded over another differs'

expect replay 0 '^replayed [0-9]+ requests in [0-9.]+ ms of simulated time, [0-9.]+ MB/s$' '^times   a remap' -- replay "$trace"
moved() { awk -F, 'NR > 1 { for (i = 3; i <= NF; i++) s += $i } END { print s + 0 }' "$1"; }
all=$(grep -oE '"bus\.[a-z_0-9]*\.(read|write)_bytes": \{"value": [0-9]+' "$out/replay/stats.json" | awk '{ s += $NF } END { print s }')
rows=$(moved "$out/replay/timeline.csv")
[ "$rows" = "$all" ] || fail "timeline.csv has $rows of $all bytes"
for key in replay.time replay.bandwidth replay.requests ddr.row_hits ddr.utilisation \
  bus.arm_d.write_bytes ddr.vpbe.latency.p99 bus.edma_tc0.write_bytes ddr.edma_tc0.latency.max; do
  grep -q "\"$key\": {\"value\": [0-9]" "$out/replay/stats.json" || fail "no $key"
done
# The commands of a run's window and of a replay: as many of each as the statistics count, and at most one a
# clock, in order.
expect commands 0 -- run -o "$out/commands" --command-trace "$out/run.csv"
cmp "$out/commands/stats.json" "$out/without/stats.json" || fail 'tracing commands changes the run'
expect commands_strict 0 -- run -o "$out/commands" --sync=strict --command-trace "$out/strict.csv"
cmp "$out/run.csv" "$out/strict.csv" || fail 'strict and default have different commands'
expect commands_replay 0 -- replay "$trace" --command-trace "$out/replay.csv"
counts() { awk -F, 'NR > 1 { n[$2]++; if ($2 != "OPEN" && $1 <= last) bad = 1; last = $1 }
  END { print n["ACT"] + 0, n["REF"] + 0, n["RD"] + n["WR"] + 0; exit bad }' "$1" || echo "out of order: $1"; }
figure() { grep -oE "\"$2\": \{\"value\": [0-9]+" "$1/stats.json" | grep -oE '[0-9]+$'; }
for pair in run:commands replay:replay; do
  folder=$out/${pair#*:}
  want="$(figure "$folder" ddr.activates) $(figure "$folder" ddr.refreshes) $(figure "$folder" ddr.bursts)"
  got=$(counts "$out/${pair%:*}.csv")
  [ "$got" = "$want" ] || fail "${pair%:*}.csv has $got commands, stats.json $want"
done
expect commands_over 2 'command trace' -- run -o "$out/refused" --command-trace "$out/letter"
expect commands_in_folder 2 'output folder' -- run -o "$out/refused" --command-trace "$out/refused/x.csv"
expect commands_in_replay 2 'output folder' -- "$fovea" replay "$trace" -o "$out/refused" --command-trace "$out/refused/x.csv"
expect commands_no_name 2 'a file name is needed' -- run -o "$out/refused" --command-trace ''
head -1 "$out/replay/latency.csv" | grep -qx 'master,direction,beat,low_ns,high_ns,count' || fail 'latency.csv of a replay'
beats=$(awk -F, 'NR > 1 { n[$3] += $6 } END { print n["first"], n["last"] }' "$out/replay/latency.csv")
n=$(figure "$out/replay" replay.requests)
[ "$beats" = "$n $n" ] || fail "latency.csv has $beats beats of $n requests"
# The slowest read of a label, seen again: the replay is the same, and lists it once.
slow=$(awk -F, '$2 == "read" { print $1 " " $4 " " $5; exit }' "$out/replay/slowest.csv")
cp "$out/replay/stats.json" "$out/before.json"
expect around 0 -- replay "$trace" --around "$(awk '{ printf "%sns", $2 }' <<<"$slow")"
cmp "$out/before.json" "$out/replay/stats.json" || fail '--around changes a replay'
awk -F, -v slow="$slow" '
  { end = $2 == "read" ? $7 : $8; if ($1 " " $6 " " sprintf("%.3f", end - $6) == slow && $2 == "read") ++n }
  END { exit n != 1 }' "$out/replay/requests.csv" || fail "requests.csv does not have '$slow' once"
expect around_what 2 "around: 'soon' is not allowed" -- replay "$trace" --around soon
expect again 0 -- "$fovea" replay "$trace" -o "$out/again"
cmp "$out/replay/stats.json" "$out/again/stats.json" || fail 'two replays differ'
expect memory_only 0 -- replay "$trace" --memory-only
expect memory_only_keys 0 "warning: key 'bus.clock' has no effect with --memory-only" -- replay "$trace" --memory-only -s bus.clock=1GHz
text=$(replay "$trace" --memory-only -s ddr.clock=270MHz 2>&1)
grep -q bus.clock <<<"$text" && fail "without a crossbar its clock is named: $text"
expect other 0 -- replay "$trace" -s ddr.clock=270MHz -s ddr.tRCD=6cycles -s bus.arm_d.request_latency=1cycles
grep -q '"ddr.clock": {"value": "270MHz"' "$out/replay/config.json" || fail 'config.json: ddr.clock'
grep -q '"bus.clock": {"value": "135MHz", .*"origin": "half of ddr.clock"' "$out/replay/config.json" ||
  fail 'config.json: bus.clock does not follow'
expect follows 0 'fovea: bus.clock follows ddr.clock as on the chip: 135 MHz, it was 121.5 MHz' -- replay "$trace" -s ddr.clock=270MHz
cp "$out/replay/stats.json" "$out/by_clock.json"
expect chip_preset 0 'fovea: bus.clock follows' -- replay "$trace" -s clocks.preset=297/270
cmp "$out/by_clock.json" "$out/replay/stats.json" || fail 'clocks.preset=297/270 is not ddr.clock=270MHz'
expect deviates 0 'fovea: warning: bus.clock is 121.5 MHz' -- replay "$trace" -s ddr.clock=270MHz -s bus.clock=121.5MHz
cmp -s "$out/by_clock.json" "$out/replay/stats.json" && fail 'bus.clock by hand changes nothing'
grep -q '"ddr.tRP": {.*"origin": ".*small.trace"' "$out/replay/config.json" || fail 'config.json: origin'
# A key that cannot act is warned of; what the trace sets is not, as nobody chose it for this replay.
idle="warning \(configuration\): 'ddr.ti_open_row' is set \(command line\) but has no effect with"
idle+=" ddr.scheduler = fcfs: it needs ddr.scheduler = ti or closed_page"
expect idle 0 "$idle" -- replay "$trace" -s ddr.scheduler=fcfs -s ddr.ti_open_row=ready
grep -q "ddr.ti_open_row' is set" "$out/replay/stats.json" || fail 'stats.json: no warning of a key that cannot act'
text=$(replay "$trace" -s ddr.scheduler=closed_page -s ddr.ti_open_row=ready 2>&1)
grep -q 'no effect' <<<"$text" && fail "a key that acts is said to have no effect: $text"
expect record_fcfs 0 -- run -o "$out/run" -s ddr.scheduler=fcfs --bus-trace "$out/fcfs.trace"
text=$(replay "$out/fcfs.trace" 2>&1)
grep -q 'no effect' <<<"$text" && fail "a key of the trace is said to have no effect: $text"

printf '# dramtrace 1\n# master 5 window 4 left\n# master 6 window 2 right\n0 5 R 0x0 256\n0 6 W 0x40000 64\n' >"$out/good.txt"
expect text 0 '^replayed ' -- replay "$out/good.txt"
grep -q '"bus.left.read_bytes": {"value": 256,' "$out/replay/stats.json" || fail 'no bus.left'
[ "$(head -1 "$out/replay/timeline.csv")" = start_ns,end_ns,left.read_bytes,left.write_bytes,right.read_bytes,right.write_bytes ] ||
  fail "timeline.csv: $(head -1 "$out/replay/timeline.csv")"
grep -q '"ddr.right.latency.mean": {"value": null' "$out/replay/stats.json" || fail 'no ddr.right'

cp "$trace" "$out/earlier.trace"
expect kept 3 -- run -o "$out/run" -s run.start_limit=10ms --bus-trace "$out/earlier.trace"
cmp "$trace" "$out/earlier.trace" || fail 'a run that fails destroys an earlier trace'
[ ! -e "$out/earlier.trace.tmp" ] || fail 'a run that fails leaves a piece of a trace'
expect empty_name 2 -- run -o "$out/run" --bus-trace ''
expect unwritable 2 '/nowhere/a.trace' -- run -o "$out/run" --bus-trace /nowhere/a.trace
ln -s /dev/full "$out/full"
text=$(run -o "$out/run" --bus-trace "$out/full" 2>&1)
grep -q 'No space left' <<<"$text" || fail "a full disk is not named: $text"
[ -L "$out/full" ] || fail 'a device that takes no trace is removed'
expect no_file 2 'missing.trace' -- replay "$out/missing.trace"
expect not_a_trace 2 'none of the known trace formats; a replay takes a file of .fovea run --bus-trace' -- replay "$out/small.yaml"
head -c 900 "$trace" >"$out/cut.trace"
expect truncated 2 'cut off' -- replay "$out/cut.trace"
{ head -c 700 "$trace"; printf 'XXXX'; tail -c +705 "$trace"; } >"$out/bad.trace"
expect corrupted 2 'corrupted' -- replay "$out/bad.trace"
sed '1s/[0-9]$/9/' "$trace" >"$out/version.trace"
expect version 2 'allowed: versions 1 to 5' -- replay "$out/version.trace"
printf '# dramtrace 7\n' >"$out/version.txt"
expect text_version 2 'version.txt.:1' '# dramtrace 1' -- replay "$out/version.txt"
printf '# dramtrace 1\n# master 0 window 1 a\n0 0 R 0x8000000 4\n' >"$out/outside.txt"
expect outside 2 'outside the SDRAM of 128 MiB' -- replay "$out/outside.txt"
expect timing 2 'ddr.tRC' 'ddr.tRAS' -- replay "$trace" -s ddr.tRC=12cycles
expect part_timing 0 'fovea: warning \(configuration\): SDTIMR T_RFC: 31 clocks programmed' '127.5 ns' -- replay "$trace" -s ddr.clock=340MHz
grep -q '"kind": "configuration", "what": "SDTIMR T_RFC: 31 clocks' "$out/replay/stats.json" || fail 'no warning in stats.json'
expect part_cl 2 'ddr.CL' 'more cycles at' -- replay "$trace" -s ddr.CL=3cycles
expect clock 2 'ddr.clock' '125' -- replay "$trace" -s ddr.clock=90MHz
expect part_alone 2 'ddr.preset=data_sheet' -- replay "$trace" -s ddr.part=mt46h32m16lf
expect stays 0 'fovea: the timings stay as recorded, in clocks; ddr.preset=data_sheet takes the part' -- replay "$trace" -s ddr.clock=270MHz
# No replay of a text trace warns of what nobody has set, whatever part, grade and clock it is for.
quiet() {
  replay "$out/good.txt" "$@" 2>"$out/quiet.err" >/dev/null || fail "$*: $(cat "$out/quiet.err")"
  grep -q 'warning' "$out/quiet.err" && fail "$* warns of defaults: $(cat "$out/quiet.err")"
}
quiet
for part in mt47h32m16 mt47h64m16 mt47h128m16 mt46h32m16lf mt46h64m16lf; do
  case $part in mt46*) grades='5 6 75' ;; *) grades='37e 3 25e 25' ;; esac
  for grade in default $grades; do quiet -s ddr.part=$part -s ddr.grade=$grade; done
done
for clock in 162MHz 270MHz; do quiet -s ddr.clock=$clock; done
quiet -s clocks.preset=297/270
expect chosen 0 'ddr.preset=data_sheet, as the trace has no recorded timings' -- replay "$out/good.txt" -s ddr.clock=270MHz
grep -q '"ddr.preset": {"value": "data_sheet", .*"origin": "a trace without recorded settings"' "$out/replay/config.json" ||
  fail 'config.json: ddr.preset of a text trace'
expect kept_default 0 'warning .*T_RFC' -- replay "$out/good.txt" -s ddr.clock=270MHz -s ddr.preset=as_recorded
expect preset 0 -- replay "$out/good.txt" -s ddr.part=mt46h32m16lf -s ddr.preset=data_sheet
grep -q '"ddr.clock": {"value": "166666666Hz", .*"origin": "ddr.preset: mt46h32m16lf, grade 6"' "$out/replay/config.json" ||
  fail 'config.json: ddr.clock by preset'
expect preset_recorded 0 -- replay "$trace" -s ddr.preset=data_sheet -s ddr.tRP=7cycles
grep -q '"ddr.tRP": {"value": "7 cycles", .*"origin": "command line"' "$out/replay/config.json" || fail 'a key by hand does not win'
grep -q '"ddr.tRRD": {"value": "4 cycles", .*"origin": "ddr.preset: ' "$out/replay/config.json" || fail 'config.json: ddr.tRRD by preset'
grep -q '"warnings": \[\]' "$out/replay/stats.json" || fail 'a preset of the data sheet has warnings'
expect no_effect 2 "'ddr.retention' has no effect in a replay" -- replay "$trace" -s ddr.retention=1s
expect sleep 0 -- replay "$trace" -s ddr.low_power=power_down
grep -qE '"ddr.power_downs": \{"value": [1-9]' "$out/replay/stats.json" || fail 'a replay does not sleep'
expect preset_clock 2 'has no CL for it' -- replay "$trace" -s ddr.preset=data_sheet -s ddr.clock=401MHz
expect unknown_key 2 'ddr.tRPC' 'did you mean' -- replay "$trace" -s ddr.tRPC=3cycles
expect cpu_key 2 'cpu.ahb_ratio' -- replay "$trace" -s cpu.ahb_ratio=1
expect params 0 'ddr.tRCD' 'bus.clock' -- "$fovea" params --replay
[ -e "$out/replay.tmp" ] && fail 'a replay with wrong input left a folder'
echo "$failures failures"
[ "$failures" = 0 ]
