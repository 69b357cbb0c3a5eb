#!/usr/bin/env bash
# scripts/engine-compare on a small picture, and what it says of prepared results in which something differs.
# Usage: compare.sh FOVEA SOURCE OUT
set -uo pipefail
fovea=$(realpath "$1") source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
failures=0
fail() {
  echo "$*"
  failures=$((failures + 1))
}
small=(-s video.width=96 -s video.height=32 -s camera.kind=chart -s camera.stamp=false)
compare() { # NAME STATUS PROGRAM ARGUMENTS...
  local name=$1 status=$2 program=$3 got
  shift 3
  timeout 100 "$source/scripts/engine-compare" --fovea "$program" -o "$out/$name" "$@" >"$name.out" 2>"$name.err"
  got=$?
  [ "$got" = "$status" ] || fail "$name: status $got, expected $status: $(tail -3 "$name.err")"
}
default=$source/scripts/experiments/default.yaml
compare good 0 "$fovea" "$default" --frames 2 -j 1 "${small[@]}"
# name, displayed frames, frames that are equal; then the same time and the same bytes.
grep -qE '^default +2 +2 +0\.[0-9]{3} +0\.[0-9]{3} +[01]\.[0-9]{4} +[0-9.]+ +equal +[0-9.]+$' good.out || fail "$(cat good.out)"

# In place of the program: the results of above, with a fault in those of the RTL.
cat >stand_in <<'P'
#!/usr/bin/python3
import os, pathlib, re, shutil, sys
out = pathlib.Path(sys.argv[sys.argv.index("-o") + 1])
shutil.copytree(pathlib.Path(os.environ["GOOD"]) / out.name, out, dirs_exist_ok=True)
fault = os.environ["FAULT"] if out.name == "rtl" else ""
def change(name, edit):
    (out / name).write_text(edit((out / name).read_text()))
def slower(text, by):  # the second remap
    rows = [l.split(",") for l in text.splitlines()]
    at = [rows[0].index(c) for c in ("remap_start_ns", "remap_end_ns")]
    start, end = (float(rows[2][n]) for n in at)
    rows[2][at[1]] = str(start + (end - start) * by)
    return "\n".join(",".join(r) for r in rows) + "\n"
if os.environ.get("FREE"):
    change("config.json", lambda t: t.replace('"cameras.genlocked": {"value": "true"', '"cameras.genlocked": {"value": "false"'))
if os.environ["FAULT"] == "moment" and out.name != "plain":  # frames that the plain run does not have
    change("frames.csv", lambda t: re.sub(r"^(\d+,\d+,\d+,)", r"\g<1>1", t, flags=re.M))
if fault == "picture":
    shutil.copy(out / "frames/frame_000000.png", out / "frames/frame_000001.png")
elif fault == "late":
    change("frames.csv", lambda t: slower(t, 1.0201))
elif fault == "early":
    change("frames.csv", lambda t: slower(t, 0.9799))
elif fault == "within":
    change("frames.csv", lambda t: slower(t, 1.0199))
elif fault == "bytes":
    change("stats.json", lambda t: re.sub(r'("engine.source_bytes": \{"value": \d*)\d', r"\g<1>1", t)
           .replace('"engine.map_bytes": {"value": ', '"engine.map_bytes": {"value": 1'))
elif fault == "unused":
    change("stats.json", lambda t: re.sub(r'("engine\.\w+": \{"value": )\d+', r"\g<1>0", t))
elif fault == "fails":
    print("fovea: error: the guest failed")
    sys.exit(3)
P
chmod +x stand_in
export GOOD=$out/good/default
fault() { # FAULT STATUS TEXT
  export FAULT=$1
  compare "$1" "$2" "$out/stand_in" "$default" --frames 2
  [ -z "$3" ] || grep -q -- "default.*$3" "$1.err" || fail "$1: $(cat "$1.err")"
}
fault none 0 ''
fault within 0 ''
fault picture 1 '1 of 2 pictures differ'
fault late 1 'the time of a remap differs by 2.01 %; allowed: 2 %'
fault early 1 'the time of a remap differs by 2.01 %'
fault bytes 1 'bytes of map, source, result'
fault unused 1 'the engine had nothing to do'
fault fails 3 'rtl: status 3: fovea: error: the guest failed'
fault moment 1 '2 of 2 pictures differ'
grep -qE '^default +2 +0 ' moment.out || fail "$(cat moment.out)"
# Cameras with clocks of their own may give others: the model's pictures are those to be equal to.
FREE=1 fault moment 0 ''
grep -qE '^default +2 +2\* ' moment.out || fail "$(cat moment.out)"
FREE=1 fault picture 1 '1 of 2 pictures differ'

# A page with these rows, and others.
page() { # NAME STATUS ROW...
  local name=$1 status=$2
  shift 2
  { echo '<!-- compare: begin (scripts/engine-compare) -->'
    printf '%s\n' '| experiment |' '|---|' "$@"
    echo '<!-- compare: end -->'; } >"$name.md"
  FAULT=none compare "$name" "$status" "$out/stand_in" "$default" --frames 2 --check "$name.md"
}
row=$(awk '/^default/ { printf "|"; for (n = 1; n < NF; ++n) printf " %s |", $n; print " 77.7 |" }' good.out)
page same 0 "$row"
page changed 1 "${row/equal/differ}"
page more 1 "$row" "${row/default/another}"
page less 1
grep -q "less.md: default: no row, not \['default', '2'" less.err || fail "$(cat less.err)"
compare key 2 "$fovea" -s engine=tlm
grep -q 'engine is what this command sets' key.err || fail "$(cat key.err)"
compare absent 2 "$fovea" absent.yaml
[ "$failures" = 0 ] && echo "one row, each fault: good"
exit "$((failures != 0))"
