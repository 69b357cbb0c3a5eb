#!/usr/bin/env bash
# `fovea limits` on the real board with a small picture: three planted bottlenecks are named, and are not where
# nothing was planted; the relaxed run confirms each; a search over the size of the picture; a replay without a
# master. Usage: limits.sh FOVEA SOURCE OUT
set -uo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}
small=(-s run.frames=2 -s video.width=32 -s video.height=16 -s camera.kind=chart -s camera.stamp=false
  -s firmware.kernel=plain -s tvp5146.relock_fields=2)
# limits NAME STATUS OPTIONS...
limits() {
  local name=$1 status=$2 got
  shift 2
  timeout 120 "$fovea" limits "$source/scripts/experiments/default.yaml" "${small[@]}" "$@" -j 2 -o "$name" \
    >"$name.out" 2>"$name.err"
  got=$?
  [ "$got" = "$status" ] || fail "$name: status $got, expected $status: $(tail -2 "$name.err")"
}
# value FILE RESOURCE COLUMN of binds.csv
value() { awk -F, -v r="$2" -v c="$3" '$2 == r { print $c }' "$1/binds.csv"; }
binds() { [ "$(value "$1" "$2" 3)" = "$3" ] || fail "$1: $2 binds: '$(value "$1" "$2" 3)', expected '$3'"; }
figure() { grep -o "\"$2\": {\"value\": [^,]*" "$1/stats.json" | sed 's/.* //'; }
# confirm NAME RESOURCE SETTING...: the relaxed run, made by hand, has the figure that binds.csv says.
confirm() {
  local name=$1 resource=$2
  shift 2
  "$fovea" run "$source/scripts/experiments/default.yaml" "${small[@]}" "$@" --no-frames -o "$name.$resource" \
    >/dev/null 2>&1 || fail "$name: the relaxed run failed"
  local got want
  got=$(figure "$name.$resource" frame.remap_time.mean)
  want=$(value "$name" "$resource" 8)
  [ -n "$want" ] && [ "$got" = "$want" ] || fail "$name: $resource relaxed is $got, binds.csv has '$want'"
}

# A slow bridge: taking its latency away is worth most. 16 + 16 clocks stand for 3 + 3.
plant=(-s 'bus.arm_d.request_latency=16 cycles' -s 'bus.arm_d.response_latency=16 cycles')
limits bridge 0 "${plant[@]}" --binds frame.remap_time.mean --relax bridge_arm_d,pll1_clocks,bridge_vpfe
binds bridge bridge_arm_d yes
binds bridge bridge_vpfe no
[ "$(sed -n 2p bridge/binds.csv | cut -d, -f2)" = bridge_arm_d ] || fail "bridge: $(cat bridge/binds.csv)"
confirm bridge bridge_arm_d -s 'bus.arm_d.request_latency=0 cycles' -s 'bus.arm_d.response_latency=0 cycles'

# A slow SDRAM controller: 32 + 16 clocks stand for 8 + 2. The display's traffic, which a replay leaves out, is not to
# blame, and neither is the SDRAM's own timing.
plant=(-s 'ddr.request_latency=32 cycles' -s 'ddr.return_latency=16 cycles')
limits sdram 0 "${plant[@]}" --binds frame.remap_time.mean --relax ddr_latency,display,refresh,turnaround
binds sdram ddr_latency yes
for other in display refresh turnaround; do binds sdram $other no; done
confirm sdram ddr_latency -s 'ddr.request_latency=0 cycles' -s 'ddr.return_latency=0 cycles'
# A slow clock, which crossbar and bridges follow: each of the two is relaxed by itself too.
limits clock 0 -s clocks.ddr=130MHz --binds frame.remap_time.mean --relax pll1_clocks,sdram_clock,crossbar_clock
binds clock pll1_clocks yes
confirm clock pll1_clocks -s clocks.ddr=340MHz
confirm clock sdram_clock -s clocks.ddr=340MHz -s clocks.crossbar=65MHz
confirm clock crossbar_clock -s clocks.ddr=130MHz -s clocks.crossbar=170MHz
# The pixels' loop waits for the bridge, whose clock is the crossbar's, and little for the SDRAM itself.
awk -F, '$2 ~ /_clock/ { gain[$2] = $4 }
  END { exit !(gain["crossbar_clock"] > 2 * gain["sdram_clock"] && gain["pll1_clocks"] > gain["crossbar_clock"]) }' \
  clock/binds.csv || fail "clock: $(cut -d, -f2-4 clock/binds.csv)"

# The EDMA follows its run in a replay, which is believed then; but others wait for its transfers.
limits edma 0 -s firmware.kernel=copy --binds frame.remap_time.mean --relax display,edma_tc0
binds edma display no
awk -F, '$2 == "display" { d = $10 == "replay" && $7 > 0 } END { exit !d }' edma/binds.csv ||
  fail "edma: $(cat edma/binds.csv)"
grep -q 'Not tried: edma_tc0 (the core waits for its transfers' edma.out || fail "edma: $(cat edma.out)"
# The remap engine's requests keep their recorded times in a trace: what only a replay can relax is not tried, whatever
# that replay gives.
limits engine 0 -s engine=tlm -s firmware.kernel=engine --binds frame.remap_time.mean --relax display
binds engine display ''
grep -q 'Not tried: display (only a replay can do it, and the trace keeps the recorded times of .* of remap_engine' \
  engine.out || fail "engine: $(cat engine.out)"

# An assumed latency is said to be assumed, with what remains at both ends of what is believed, as runs have it.
grep -q 'This is assumed, no public figure: with bus.arm_d.request_latency=2 cycles' bridge.out ||
  fail "bridge: $(cat bridge.out)"
"$fovea" run "$source/scripts/experiments/default.yaml" "${small[@]}" -s 'bus.arm_d.request_latency=6 cycles' \
  -s 'bus.arm_d.response_latency=6 cycles' --no-frames -o bridge.high >/dev/null 2>&1 || fail "the run failed"
[ "$(value bridge bridge_arm_d 18)" = "$(figure bridge.high frame.remap_time.mean)" ] ||
  fail "bridge: $(value bridge bridge_arm_d 18), $(figure bridge.high frame.remap_time.mean)"

# Names of figures are checked in a run that ends at once. All that a whole run has are known.
limits typo 2 --binds frame.remap.mean
grep -q "did you mean 'frame.remap_time.mean'?" typo.err || fail "typo: $(cat typo.err)"
names=()
while read -r name; do names+=(--require "$name>=-1e30"); done < <(grep -o '^  "[^"]*": {"value": [-0-9]' \
  bridge.high/stats.json | sed 's/^  "//; s/".*//')
[ "${#names[@]}" -gt 500 ] || fail "names: ${#names[@]}"
limits names 0 --over firmware.kernel=plain "${names[@]}"

# A low priority beside a heavy load: only then does the priority bind.
load=(-s load.outstanding=8 -s load.gap=100ns -s load.priority=0 -s load.pattern=random -s load.start=130ms)
limits priority 0 "${load[@]}" -s priority.arm=7 --binds frame.remap_time.mean --relax priority_arm
binds priority priority_arm yes
confirm priority priority_arm "${load[@]}" -s priority.arm=0
limits no_load 0 -s priority.arm=7 --binds frame.remap_time.mean --relax priority_arm
binds no_load priority_arm no

# A load of the highest priority without pauses keeps the firmware from showing a frame: the search ends all the same,
# after two runs of the load that are a second longer than the plain one.
limits starved 0 --load --priorities 0 --load-slots 16 --load-kind mixed --load-pattern random --load-step 700 \
  --probes 0
grep -q 'the firmware showed no frame' starved/limits.csv || fail "starved: $(cat starved/limits.csv starved.out)"

# Every size is met.
limits size 0 --find video.height=16..32:16
grep -q 'video.height: all 2 values that were tried from 16 to 32 meet the conditions' size.out ||
  fail "size: $(cat size.out)"

# The replay without a master has none of its requests, and the core cannot be left out.
trace=$(echo sdram/points/*/bus.trace)
"$fovea" replay "$trace" --without vpbe -o without >/dev/null 2>&1 || fail "replay --without vpbe failed"
"$fovea" replay "$trace" -o with >/dev/null 2>&1 || fail "replay failed"
[ "$(figure with bus.vpbe.read_bytes)" -gt 0 ] || fail "no display in the trace"
[ "$(figure without bus.vpbe.read_bytes)" = 0 ] || fail "the display is still there"
[ "$(figure without bus.vpfe.write_bytes)" = "$(figure with bus.vpfe.write_bytes)" ] || fail "the camera changed"
"$fovea" replay "$trace" --without arm_d -o core 2>core.err
[ $? = 2 ] && grep -q "error: --without 'arm_d': allowed here.*: .*vpbe, vpfe$" core.err ||
  fail "arm_d: $(cat core.err)"

[ "$failures" = 0 ] || exit 1
echo "three planted bottlenecks named"
