#!/usr/bin/env bash
# scripts/host-instructions with a valgrind and a simulator that count as they are told; `fovea trend` takes the number.
# Usage: host_instructions.sh FOVEA SOURCE OUT
set -uo pipefail
real=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out/bin"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
# 1000 host instructions of start-up, 90 for each of 50 guest instructions of a frame.
cat >"$out/bin/valgrind" <<'PROGRAM'
#!/bin/bash
for a; do case $a in --callgrind-out-file=*) file=${a#*=} ;; run.frames=*) frames=${a#*=} ;; esac; done
shift 2
"$@" || exit
printf 'version: 1\nevents: Ir\nsummary: %d\n\ntotals: %d\n' $((1000 + HOST * 50 * frames)) $((1000 + HOST * 50 * frames)) >"$file"
PROGRAM
cat >"$out/fovea" <<'PROGRAM'
#!/bin/bash
[ "$1 $2 $3" = 'run some.yaml --strict' ] || { echo "fovea: what is $*?" >&2; exit 2; }
for a; do case $a in run.frames=*) frames=${a#*=} ;; esac; last=$a; done
mkdir -p "$last"
echo '  "cpu.instructions": {"value": '$((GUEST * frames))', "unit": "1"},' >"$last/stats.json"
PROGRAM
chmod +x "$out/bin/valgrind" "$out/fovea"
count() { PATH=$out/bin:$PATH HOST=$1 GUEST=$2 "$source/scripts/host-instructions" "$out/fovea" "${@:3}" 2>"$out/err"; }
number=$(count 90 50 some.yaml --strict) || fail "status $?: $(cat "$out/err")"
[ "$number" = 90.00 ] || fail "90 instructions each, not $number"
[ "$(count 45 100 some.yaml --strict)" = 22.50 ] || fail "22.5 instructions each"
count 90 0 some.yaml --strict >/dev/null && fail 'no guest instructions are accepted'
grep -q 'took no instructions' "$out/err" || fail "no reason: $(cat "$out/err")"
count 90 50 other.yaml >/dev/null && fail 'a run that fails is accepted'
grep -q 'what is run other.yaml' "$out/err" || fail "no reason: $(cat "$out/err")"
"$source/scripts/host-instructions" 2>/dev/null && fail 'nothing to count is accepted'
"$source/scripts/host-instructions" --help | grep -q 'fovea trend --host-instructions' || fail 'no help'
"$real" trend --help | grep -q -- '--host-instructions' || fail 'fovea trend lacks the option'
echo "$failures failures"
[ "$failures" = 0 ]
