#!/usr/bin/env bash
# page_names.py complains of each kind of name that does not exist, and of nothing in the project's pages and in one
# that has each kind of name that does. Usage: page_names.sh FOVEA SOURCE BUILD OUT
set -uo pipefail
fovea=$1 source=$2 build=$3 out=$4
rm -rf "$out"
mkdir -p "$out"
cat >"$out/good.md" <<'T'
`fovea run`, `fovea trace convert`, `fovea run X --no-frames -s ddr.part=mt47h64m16`, `fovea`, `stats.json`, `a.b`
`ddr.tRP`, `ddr.*`, `camera.N.phase`, `bus.MASTER.width`, `frame.latency`, `exec.ram_base`, `unit.pages`, `camera.7.phase`
```
build/release/fovea report DIR --text   # with --nothing
```
T
cat >"$out/bad.md" <<'T'
`fovea explain`, `fovea trace explain`, `fovea run --nothing`
`ddr.tRPQ`, `frame.latencies.max`, `cpu.idle_until.*`, `bus.MASTER.widths`
```
fovea check DIR --explain
```
T
"$source/tb/unit/page_names.py" "$fovea" "$source" "$build" "$out" "$out/bad.md" "$out/good.md" >"$out/said"
diff "$out/said" - <<'T' || { echo 'on the left: what page_names.py says, on the right: what it should'; exit 1; }
bad.md:1: no command 'fovea explain'
bad.md:1: no command 'fovea trace explain'
bad.md:1: 'fovea run' has no option --nothing
bad.md:2: 'ddr.tRPQ' is neither a key nor a figure
bad.md:2: 'frame.latencies.max' is neither a key nor a figure
bad.md:2: 'cpu.idle_until.*' is neither a key nor a figure
bad.md:2: 'bus.MASTER.widths' is neither a key nor a figure
bad.md:4: 'fovea check' has no option --explain
T
