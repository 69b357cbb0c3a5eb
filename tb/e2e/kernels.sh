#!/usr/bin/env bash
# scripts/kernels: its arithmetic and its behaviour over a stand-in of fovea that gives prepared results,
# then two kernels of the real program with a small picture.
# Usage: kernels.sh FOVEA SOURCE OUT
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
# measure NAME STATUS OPTIONS...: the script's status; what it prints is in NAME.out and NAME.err.
measure() {
  local name=$1 status=$2 got
  shift 2
  timeout 120 "$source/scripts/kernels" "$@" -o "$out/$name" >"$name.out" 2>"$name.err"
  got=$?
  [ "$got" = "$status" ] || fail "$name: status $got, expected $status: $(tail -2 "$name.err")"
}
has() { grep -qE -- "$2" "$1" || fail "$1 lacks '$2': $(cat "$1")"; }
rows() {  # FILE ROW...: the rows below the header
  local file=$1
  shift
  [ "$(tail -n +2 "$file")" = "$(printf '%s\n' "$@")" ] || fail "$file: $(cat "$file")"
}

# A run of 10 remaps of 100 pairs. Kernel `one` is there; `two` falls back to it; `three` uses the EDMA;
# `four` fails; `five` says nothing on its UART. A remap takes 10 ms, or what the settings make of it.
cat >stand_in <<'P'
#!/usr/bin/python3
import json, os, re, sys
args = sys.argv[1:]
if args == ["params"]:
    print("key  default  allowed\nfirmware.kernel   one  one, two, three, four, five, six  -  choice  how")
    sys.exit()
settings = [args[i + 1] for i, a in enumerate(args) if a == "-s"]
kernel = next(s for s in settings if s.startswith("firmware.kernel="))[16:]
with open("calls", "a") as f:
    f.write(" ".join(args) + "\n")
if kernel == "four" or (kernel == "six" and "cpu.x=9" in settings):
    print("fovea: more\nfovea: the guest failed", file=sys.stderr)
    sys.exit(3)
folder = args[args.index("-o") + 1]
os.makedirs(folder, exist_ok=True)
edma = kernel == "three"
remap = 0.010
for s, t in {"bus.arm_d.width=64bit": .008, "cpu.x=9": .016, "cpu.x=1": .0125, "ddr.y=5 clocks": 1,
             "edma.z=2": .02}.items():
    if s in settings:
        remap = t
if {"bus.edma_tc0.w=1", "bus.edma_tc1.w=1"} <= set(settings):
    remap = .004
stats = {"frame.remapped": 10, "frame.remap_rate": 96.0, "frame.remap_time.mean": remap, "frame.window": .104,
         "edma.requests": 7 if edma else 0, "cpu.cycles": 50000, "cpu.idle": 4000, "cpu.issue": 11000,
         "cpu.stall.interlock": 1000, "cpu.stall.dcache": 25000, "cpu.stall.write_buffer": 6000,
         "ddr.read_bytes": 9000, "ddr.write_bytes": 8000, "bus.vpbe.read_bytes": 3000,
         "bus.vpfe.write_bytes": 2000, "bus.arm_d.read_bytes": 6000, "bus.load.read_bytes": 1000}
def put(name, text):
    with open(os.path.join(folder, name), "w") as f:
        f.write(text)
put("stats.json", json.dumps({"complete": True, **{k: {"value": v, "unit": "1"} for k, v in stats.items()}}))
put("stalls.csv", "cause,region,culprit,cycles\nuncached,registers,core,300\nuncached,registers,bridge,200\n"
    "uncached,.stacks,core,7000\ndcache,registers,core,9000\n")
def belief(value, low, high):
    return {"value": value, "belief": {"low": low, "high": high}}
put("config.json", json.dumps({"format": "fovea run 1", "params": {"run.frames": {"value": "26", "belief": None},
    "bus.arm_d.width": belief("32bit", "32bit", "64bit"), "bus.load.w": belief("2", "1", "3"),
    "bus.edma_tc0.w": belief("2", "1", "2"), "bus.edma_tc1.w": belief("2", "1", "2"),
    "cpu.x": belief("5", "1", "9"), "cpu.same": belief("5", "5", "5"), "cpu.none": {"value": "5", "belief": None},
    "ddr.retention": belief("64ms", "64ms", "10s"), "edma.z": belief("1", "1", "2"),
    "pll.go_time": belief("1us", "1us", "2us")}}))
put("uart.log", "Fovea\r\n" if kernel == "five" else
    "LUT: 100 entries in 93 ms\r\nLUT: 100 entries in 95 ms\r\n" +
    ("kernel two: no room\r\nkernel: one, 400 bytes of tables\r\n" * 2 if kernel == "two" else
     f"kernel: {kernel}, 300 bytes of tables in 12 ms\r\nkernel: {kernel}, 305 bytes of tables in 13 ms\r\n"))
P
chmod +x stand_in
header=kernel,used,uses,frames_per_second,clocks_per_pair,issue,interlock,dcache,write_buffer,edma,asleep
header+=,other,core_load,sdram_read_bytes,sdram_written_bytes,table_bytes,lut_ms,form_ms
# By hand: 1,000 pairs in the window; 500 clocks of registers belong to the EDMA's row only.
one='one,one,core,96.0,50.0,11.0,1.0,25.0,6.0,0.0,4.0,3.0,0.92,500,600,302,93,12,'
two='two,one,core,96.0,50.0,11.0,1.0,25.0,6.0,0.0,4.0,3.0,0.92,500,600,400,93,0,fallback: two: no room'
three='three,three,edma,96.0,50.0,11.0,1.0,25.0,6.0,4.5,0.0,2.5,0.92,500,600,302,93,12,'
four='four,,,,,,,,,,,,,,,,,,no result: fovea: the guest failed'
five='five,,,,,,,,,,,,,,,,,,no result: the program does not say on UART0 which kernel it uses'
touch mine.yaml

measure table 0 mine.yaml --fovea ./stand_in --kernels three,one,two --csv table.csv -s run.frames=3
[ "$(head -1 table.csv)" = "$header,note" ] || fail "header: $(head -1 table.csv)"
rows table.csv "$three" "$one" "$two"
has table.out '^three +three +edma +96\.0 +50\.00 +11\.00 +1\.00 +25\.00 +6\.00 +4\.50 +0\.00 +2\.50 +0\.920'
has table.out '^two: fallback: two: no room$'
has table.err '^\[3/3\] '
has calls '^run mine.yaml --no-frames -o .* -s run.frames=3 -s firmware.kernel=three$'

# A run that fails loses nothing of the others.
measure fails 3 mine.yaml --fovea ./stand_in --csv fails.csv
rows fails.csv "$one" "$two" "$three" "$four" "$five" "${one//one/six}"
has fails.out '^four +-'
has fails.err '^\[[1-6]/6\] four shipped: failed, status 3$'

# Each end of an interval that can matter, one at a time; the transfer controllers' together.
rm calls
measure spread 0 mine.yaml --fovea ./stand_in --kernels one,three --csv spread.csv --spread -j 2
[ "$(head -1 spread.csv)" = "$header,slowest,slowest_by,fastest,fastest_by,note" ] || fail "$(head -1 spread.csv)"
rows spread.csv "${one}60.0,cpu.x=9,120.0,bus.arm_d.width=64bit," \
  "${three}48.0,edma.z=2,240.0,bus.edma_tcN.w=1,"
[ "$(wc -l <calls)" = 12 ] || fail "other runs: $(cat calls)"
# The window of 0.104 s has 26 displayed frames of 4 ms; in one remap of 1 / 96 s after the other, eight take 20.8.
[ "$(grep -c 'run.frames=21' calls)" = 10 ] || fail "other windows: $(cat calls)"
grep -E 'bus\.load|retention|pll|cpu\.(same|none)' calls && fail 'these cannot matter'
[ "$(wc -l <spread/spread.csv)" = 9 ] || fail "spread.csv: $(cat spread/spread.csv)"
has spread/spread.csv '^one,cpu.x=1,76\.8$'
rm calls
measure chosen 0 mine.yaml --fovea ./stand_in --kernels one,three --csv chosen.csv --spread --spread-keys 'edma|pll' \
  --spread-frames 3
rows chosen.csv "${one},,,," "${three}48.0,edma.z=2,48.0,edma.z=2,"
[ "$(wc -l <calls)" = 4 ] || fail "runs of keys that were not chosen: $(cat calls)"
[ "$(grep -c 'run.frames=3' calls)" = 2 ] || fail "other windows: $(cat calls)"
measure no_key 2 mine.yaml --fovea ./stand_in --kernels one --csv no_key.csv --spread --spread-keys ddr.z
has no_key.err "no key with a belief interval that can matter begins like 'ddr.z'"
rows no_key.csv "${one},,,,"
measure hole 3 mine.yaml --fovea ./stand_in --kernels six,one --csv hole.csv --spread
rows hole.csv "${one//one/six}76.8,cpu.x=1,120.0,bus.arm_d.width=64bit,no spread with cpu.x=9: fovea: the guest failed" \
  "${one}60.0,cpu.x=9,120.0,bus.arm_d.width=64bit,"

# Wrong input: nothing runs.
rm calls
measure unknown 2 mine.yaml --fovea ./stand_in --kernels one,simd
has unknown.err "unknown kernel 'simd'; allowed: one, two, three, four, five, six"
measure twice 2 mine.yaml --fovea ./stand_in -s firmware.kernel=one
measure nowhere 2 mine.yaml --fovea ./stand_in --csv no/such/folder.csv
measure jobs 2 mine.yaml --fovea ./stand_in -j 0
measure regex 2 mine.yaml --fovea ./stand_in --spread --spread-keys '('
measure no_spread 2 mine.yaml --fovea ./stand_in --spread-keys ddr
measure program 2 mine.yaml --fovea ./no_such_program
[ ! -e calls ] || fail "runs with wrong input: $(cat calls)"
measure help 0 --help
has help.out 'frames_per_second +frame.remap_rate'

# The real program. All clocks of the core at 297 MHz are in the row, to an instruction at each end of the
# window.
cat >small.yaml <<'Y'
run: {frames: 1}
video: {width: 64, height: 16}
camera: {kind: chart, stamp: false}
firmware: {repeat: 1000, tables: 4}
Y
measure real 0 small.yaml --fovea "$fovea" --kernels plain,ldm --csv real.csv
awk -F, 'NR > 1 {
  ++n
  if ($1 != $2 || $3 != "core" || $16 != 64 * 16 / 2 * 4) { print "kernel or table: " $0; bad = 1 }
  if (($4 * $5 * 64 * 16 / 2 / 297e6 - 1) ^ 2 > 1e-9) { print "clocks of a second: " $0; bad = 1 }
  if (($6 + $7 + $8 + $9 + $10 + $11 + $12 - $5) ^ 2 > 1e-12) { print "sum of the clocks: " $0; bad = 1 }
  if ($19 != "") { print "not back to back: " $0; bad = 1 }
  if ($15 < 64 * 16 * 2 || $15 > 64 * 16 * 2 + 64) { print "bytes written: " $0; bad = 1 }
} END { exit bad || n != 2 }' real.csv || fail "real.csv: $(cat real.csv)"
measure waits 0 small.yaml --fovea "$fovea" --kernels ldm -s firmware.repeat=2
has waits.out '^ldm: the remaps wait for the camera'
measure wrong_key 2 small.yaml --fovea "$fovea" --kernels ldm -s no.such_key=1
has wrong_key.out '^ldm: no result: .*no.such_key'
echo "$failures failures"
[ "$failures" = 0 ]
