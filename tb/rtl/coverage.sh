#!/usr/bin/env bash
# scripts/rtl-coverage over prepared counts: its sums and limits at n and n + 1, and a faulty list of exclusions; and
# the list that is committed is one.
# Usage: coverage.sh SOURCE OUT
set -uo pipefail
source=$1 out=$2
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}
coverage() { # NAME STATUS ARGUMENTS...
  local name=$1 status=$2
  shift 2
  "$source/scripts/rtl-coverage" "$@" >"$name.out" 2>"$name.err"
  [ $? = "$status" ] || fail "$name: not status $status: $(cat "$name.out" "$name.err")"
}
says() { grep -qF -- "$2" "$1" || fail "$1 lacks '$2': $(cat "$1")"; }
# counts DIR MISSED: 100 lines and 100 toggles; the first MISSED toggles are reached by no test, others by one of two.
counts() {
  mkdir -p "$1/counts/a" "$1/counts/b"
  python3 - "$@" <<'P'
import sys
folder, missed = sys.argv[1], int(sys.argv[2])
for test in "ab":
    with open(f"{folder}/counts/{test}/1.dat", "w") as f:
        f.write("# SystemC::Coverage-3\n")
        for n in range(100):
            reached = n % 2 == (test == "a")
            for page, name, hit in (("v_line/m", "block", reached), ("v_toggle/m", f"bit[{n}]", reached and n >= missed)):
                f.write(f"C '\x01f\x02x/remap_fifo.sv\x01l\x02{n + 1}\x01page\x02{page}\x01o\x02{name}\x01h\x02TOP.{test}' {int(hit)}\n")
        f.write("C '\x01f\x02x/bench_top.sv\x01l\x021\x01page\x02v_line/m\x01o\x02block' 0\n")
P
}
printf '' >none.toml
counts good 5
coverage good 0 --counts good --list none.toml
says good.out 'line: 100 of 100 points, 100.00 %'
says good.out 'toggle: 95 of 100 points, 95.00 %'
counts short 6
coverage short 1 --counts short --list none.toml --missing
says short.out 'remap_fifo.sv:6: toggle bit[5]'
# An entry names lines by a text in them, and points by a pattern.
first=$(head -1 "$source/rtl/remap/remap_fifo.sv")
entry() { printf '[[exclude]]\nfile = "remap_fifo.sv"\nkind = "%s"\nline = "%s"\npoint = "%s"\nreason = "%s"\n' "$@"; }
entry toggle "$first" '.*' 'for the sake of this test' >one.toml
coverage one 1 --counts short --list one.toml
says one.out 'toggle: 94 of 99 points, 94.95 %'
says one.out 'excluded: 1 of 200 points, 0.50 %'
entry toggle '' 'bit.[01].' 'for the sake of this test' >two.toml
coverage two 0 --counts short --list two.toml
says two.out 'toggle: 94 of 98 points, 95.92 %'
entry toggle '' '.*' 'all of the bits, which is too many' >all.toml
coverage too_many 1 --counts short --list all.toml
entry toggle "$first" 'absent' 'a point that is not there' >unused.toml
coverage unused 1 --counts good --list unused.toml
says unused.err 'not needed'
entry toggle '' 'bit.[456].' 'a point that is reached is not constant' >reached.toml
coverage reached 1 --counts good --list reached.toml
says reached.err 'reached, but excluded: remap_fifo.sv:6: toggle bit[5]'
entry line 'no such text' '.*' 'a line that is not there' >nowhere.toml
coverage nowhere 2 --list nowhere.toml --check-list
entry branch "$first" '.*' 'a kind that is not there' >kind.toml
coverage kind 2 --list kind.toml --check-list
entry line "$first" '.*' 'because' >reason.toml
coverage reason 2 --list reason.toml --check-list
mkdir -p empty
coverage empty 2 --counts empty --list none.toml
coverage committed 0 --check-list
[ "$failures" = 0 ] && echo "sums, limits and the list: good"
exit "$((failures != 0))"
