#!/usr/bin/env bash
# `--profile` of the camera's firmware: it changes no figure, adds up to cpu.cycles, is the same with both
# synchronisations, names the function that does the work, and callgrind_annotate reads it.
# Usage: profile.sh FOVEA EXPERIMENT EXEC_PROGRAMS PROGRAMS OUT
set -euo pipefail
fovea=$1 experiment=$2 programs=$3 own=$4 out=$5
mkdir -p "$out"
run() {  # NAME OPTION...
  local name=$1
  shift
  "$fovea" run "$experiment" -s firmware.kernel=plain -s run.frames=2 -s video.width=128 -s video.height=64 \
    -s camera.stamp=false --no-frames "$@" -o "$out/$name" >"$out/$name.out" 2>"$out/$name.err" ||
    { echo "$name: status $?"; cat "$out/$name.err"; exit 1; }
}
run off
run on --profile
run strict --profile --sync=strict
run copy --profile -s firmware.kernel=copy
run gather --profile -s firmware.kernel=gather -s video.width=320 -s firmware.repeat=32
cmp "$out/off/stats.json" "$out/on/stats.json"
for file in stats.json frames.csv timeline.csv stalls.csv uart.log; do cmp "$out/off/$file" "$out/on/$file"; done
for file in profile.csv profile.folded profile.callgrind profile.txt interrupts.csv frame_parts.csv functions.csv \
            paths.csv objects.csv; do
  cmp "$out/on/$file" "$out/strict/$file"
  [ ! -e "$out/off/$file" ] || { echo "$file without --profile"; exit 1; }
done

python3 - "$out" <<'PYTHON'
import collections, csv, json, pathlib, sys
out = pathlib.Path(sys.argv[1])

def check(name):
    folder = out / name
    stats = {k: v["value"] for k, v in json.loads((folder / "stats.json").read_text()).items()
             if isinstance(v, dict) and "value" in v}
    rows = list(csv.DictReader((folder / "profile.csv").open()))
    window = [r for r in rows if r["phase"] in ("frames", "remap")]
    def total(which, what="clocks"):
        return sum(int(r[what]) for r in which)
    def by(*keys):
        sums = collections.Counter()
        for r in window:
            sums[tuple(r[k] for k in keys)] += int(r["clocks"])
        return sums
    assert [p for p in dict.fromkeys(r["phase"] for r in rows)] == ["boot", "lut", "lock", "frames", "remap"]
    assert all(int(r["clocks"]) > 0 for r in rows)
    assert total(window) == stats["cpu.cycles"], (total(window), stats["cpu.cycles"])
    for (cause,), clocks in by("cause").items():
        if cause.startswith(("idle.", "wait.")):
            continue
        figure = "cpu.issue" if cause == "issue" else "cpu.stall." + cause
        assert clocks == stats[figure], (cause, clocks, stats[figure])
    # Sleeps, by what ended them: within remaps (the same clocks as in the figures) and elsewhere.
    slept = by("cause")
    for event in ("dma", "engine", "capture", "display", "timer", "other"):
        within, outside = slept["wait." + event,], slept["idle." + event,]
        assert within == stats["cpu.remap.idle." + event], (event, within, stats["cpu.remap.idle." + event])
        assert within + outside == stats["cpu.idle." + event], (event, within, outside)
    spare = sum(n for (cause,), n in slept.items() if cause.startswith("idle.") and cause not in ("idle.dma", "idle.engine"))
    assert spare == stats["cpu.spare"], (spare, stats["cpu.spare"])
    idle = sum(v for k, v in stats.items() if k.startswith("cpu.idle."))
    assert idle == stats["cpu.idle"] and stats["cpu.idle.capture"] + stats["cpu.idle.display"] > 0
    stalls = collections.Counter()
    for r in csv.DictReader((folder / "stalls.csv").open()):
        stalls[r["cause"], r["region"]] += int(r["cycles"])
    for (cause, region), clocks in by("cause", "region").items():
        if region:
            assert clocks == stalls[cause, region], (cause, region, clocks)
    assert 0 <= stats["cpu.instructions"] - total(window, "instructions") <= 1
    # The remaps of the window are the same clocks as in the figures, which are read a microsecond behind their edges.
    remaps = total([r for r in rows if r["phase"] == "remap"])
    assert abs(remaps - stats["cpu.remap.cycles"]) <= 700 * stats["frame.remapped"], (remaps, stats["cpu.remap.cycles"])
    # All clocks of a phase have a call path.
    paths = collections.Counter()
    for r in csv.DictReader((folder / "paths.csv").open()):
        paths[r["phase"]] += int(r["clocks"])
    for phase in ("boot", "lut", "lock", "frames", "remap"):
        assert paths[phase] == total([r for r in rows if r["phase"] == phase]), (phase, paths[phase])
    folded = (folder / "profile.folded").read_text().splitlines()
    assert sum(int(line.rsplit(" ", 1)[1]) for line in folded) == stats["cpu.cycles"]
    # A frame's parts are its latency.
    parts = collections.Counter()
    for r in csv.DictReader((folder / "frame_parts.csv").open()):
        parts[r["frame"]] += round(float(r["time_ns"]) * 1000)
    frames = list(csv.DictReader((folder / "frames.csv").open()))
    assert len(parts) == len(frames) == 2
    for f in frames:
        latency = round(float(f["display_start_ns"]) * 1000) - round(float(f["capture_start_ns"]) * 1000)
        assert parts[f["frame"]] == latency, (f["frame"], parts[f["frame"]], latency)
    return stats, rows, folded

stats, rows, folded = check("on")
remap = sum(int(r["instructions"]) for r in rows
            if r["phase"] == "remap" and r["function"] == "remap_plain")
pairs = 128 * 64 // 2
assert remap > 2 * 4 * pairs, "the kernel loads, looks up and stores: five instructions for each pair"
assert any(r["file"].endswith("kernels/remap_plain.c") and int(r["line"]) > 0 for r in rows)
assert any(";remap_plain " in line for line in folded), folded
assert any(r["phase"] == "lut" and r["function"].startswith("__") for r in rows), "libgcc's functions"
stats, rows, folded = check("copy")
assert stats["cpu.idle.dma"] > 0, "the kernel waits for the EDMA"
# Remaps in a row, in the midst of which the interrupts of camera and display come: no idle time.
stats, rows, folded = check("gather")
cut = sum(stats["cpu.remap.idle." + event] for event in ("capture", "display"))
assert 0 < cut < stats["cpu.remap.idle"], (cut, stats["cpu.remap.idle"])
assert stats["cpu.spare"] == stats["cpu.idle"] - stats["cpu.remap.idle"] - (stats["cpu.idle.dma"] - stats["cpu.remap.idle.dma"])
PYTHON

callgrind_annotate --show=Clocks "$out/on/profile.callgrind" >"$out/annotated"
total=$(grep -o '"cpu.cycles": {"value": [0-9]*' "$out/on/stats.json" | sed 's/.*: //')
tr -d , <"$out/annotated" >"$out/plain"
grep -qE "^ *$total \(100.0%\) +PROGRAM TOTALS" "$out/plain"
grep -q 'remap_plain.c:remap_plain' "$out/plain"
grep -q 'remap_plain' "$out/on.out"
grep -q '^  frames ' "$out/on/profile.txt"
grep -q '^  remap  .*the measured window' "$out/on/profile.txt"

# Two interrupts within one access of the core are told apart in the same way with both synchronisations.
alarms=(-s firmware.elf="$own/two_alarms.elf" -s run.until=time:25ms)
run alarms --profile "${alarms[@]}"
run alarms_strict --profile --sync=strict "${alarms[@]}"
cmp "$out/alarms/interrupts.csv" "$out/alarms_strict/interrupts.csv"
awk -F, '/^timer0.tint(12|34)/ { if ($2 < 1000 || $3 <= 0 || $5 > 1000) exit 1; n++ } END { exit n != 2 }' \
  "$out/alarms/interrupts.csv" || { cat "$out/alarms/interrupts.csv"; exit 1; }

# A reset begins with the first phase again: a millisecond of the look-up table lies between two boots. No frame comes.
status=0
"$fovea" run "$experiment" -s camera.kind=chart -s firmware.elf="$own/phases_reset.elf" -s run.resets=1 --max-time 60ms \
  --profile --no-frames -o "$out/phases" >"$out/phases.out" 2>&1 || status=$?
[ "$status" = 3 ] || { echo "phases: status $status: $(cat "$out/phases.out")"; exit 1; }
awk -F, '{ n[$1] += $8 } END { exit !(n["lut"] > 0 && n["boot"] > 10 * n["lut"] && !("lock" in n)) }' "$out/phases/profile.csv" ||
  { awk -F, '{ n[$1] += $8 } END { for (p in n) print p, n[p] }' "$out/phases/profile.csv"; exit 1; }

# A program of `fovea exec`, with and without a result folder.
"$fovea" exec --profile -o "$out/exec" "$programs/registers.elf" >/dev/null 2>"$out/exec.err"
grep -q '_start' "$out/exec.err"
# It has no debug information, which one line says; the board's firmware has it.
[ "$(grep -c 'no debug information' "$out/exec.err")" = 1 ] || { cat "$out/exec.err"; exit 1; }
if grep 'no debug information' "$out/on.out"; then exit 1; fi
clocks=$(awk -F, 'NR > 1 { n += $8 } END { print n }' "$out/exec/profile.csv")
[ "$clocks" = "$(grep -o '"cpu.cycles": {"value": [0-9]*' "$out/exec/stats.json" | sed 's/.*: //')" ]
"$fovea" exec --profile --fast-memory "$programs/heap_arm_O2.elf" >/dev/null 2>"$out/flat.err"
grep -q ' %  ' "$out/flat.err"
