#!/usr/bin/env bash
# The installed project works in a folder of its own, without the source tree: shipped experiments by their names,
# `exec`, replay of a shipped trace, the manual with its links, completion, and Python.
# Usage: installed.sh BUILD PROGRAM OUT [EXPERIMENT...]
#   PROGRAM     for `fovea exec`: it prints its arguments
#   EXPERIMENT  those that are run, for one frame; none: all
set -uo pipefail
build=$1 program=$2 out=$3
shift 3
rm -rf "$out"
mkdir -p "$out"
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }
cmake --install "$build" --prefix "$out/first" >"$out/log" 2>&1 || { cat "$out/log"; exit 1; }
mv "$out/first" "$out/root"  # nothing knows where it was installed
root=$(realpath "$out/root") fovea=$(realpath "$out/root/bin/fovea")
cd "$out" || exit 1
if [ $# = 0 ]; then
  for file in "$root"/share/fovea/scripts/experiments/*.yaml; do
    name=$(basename "$file" .yaml)
    [ "$name" = evm ] || set -- "$@" "$name"  # evm has no program of its own
  done
  [ $# -gt 12 ] || fail "only $# experiments are installed: $*"
fi
for name in "$@"; do
  "$root/bin/fovea" run "$name" -s run.frames=1 --no-frames -o "$name" >log 2>&1 || fail "$name: $(<log)"
done
"$root/bin/fovea" run paper -o none >log 2>&1
[ $? = 2 ] && grep -q "^fovea: error: 'paper' is neither a file nor a shipped experiment; allowed: .*paper-pal" log ||
  fail "an experiment that does not exist: $(<log)"
touch default-b  # a file goes before a shipped name
"$root/bin/fovea" run default-b -o none >log 2>&1
grep -q 'shipped' log && fail "a file is not taken: $(<log)"
"$root/bin/fovea" exec -q "$program" one two 0 >printed 2>log && grep -q "2: 'two'" printed || fail "exec: $(<log)"
for trace in "$root"/share/fovea/traces/bus/*.trace; do
  "$root/bin/fovea" replay "$trace" -o replay >log 2>&1 || fail "$trace: $(<log)"
done
"$root/bin/fovea" report "$1" -o page.html >log 2>&1 && [ -s page.html ] || fail "report: $(<log)"
[ "$(man "$root/share/man/man1/fovea.1" 2>/dev/null | grep -c fovea)" -gt 20 ] ||
  [ "$(grep -c fovea "$root/share/man/man1/fovea.1")" -gt 20 ] || fail 'no manual page'
offered() {  # WORD...: what completes the last one
  bash -c "source '$root/share/bash-completion/completions/fovea'
    COMP_WORDS=($(printf ' %q' "$@")) COMP_CWORD=$(($# - 1)); _fovea; echo \${COMPREPLY[*]}" 2>&1
}
[ "$(offered fovea run paper-p)" = paper-pal ] && [ "$(offered fovea run -s firmware.kernel = offs)" = offsets16 ] &&
  [ "$(offered fovea limits two-cameras-)" = two-cameras-free ] || fail "completion: $(offered fovea run paper-p)"
python3 - "$root" <<'P' || fail 'the manual or Python is not complete'
import os, pathlib, re, sys
root = pathlib.Path(sys.argv[1])
doc = root / "share/doc/fovea"
pages = list(doc.rglob("*.md"))
links = lost = 0
for page in pages:
    for link in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text()):
        if re.match(r"\w+:", link):
            continue
        links += 1
        target = (page.parent / link).resolve()
        # Sources are not installed; other pages are.
        if target.suffix == ".md" and not target.is_file():
            lost += 1
            print(f"{page.relative_to(doc)}: no page {link}")
print(f"{len(pages)} pages, {links} links, {lost} lost")
assert len(pages) > 40 and links > 100 and not lost
package = next(root.glob("lib/python3*/*-packages/fovea"))
os.environ.pop("FOVEA", None)
os.environ["PATH"] = f"{root / 'bin'}:{os.environ['PATH']}"
sys.path.insert(0, str(package.parent))
import fovea
assert pathlib.Path(fovea.__file__).is_relative_to(root)
sim = fovea.run("default", {"run.frames": 1, "camera.kind": "chart", "video.width": 64, "video.height": 16})
assert sim.stats["frame.displayed"] == 1 and sim.frames[0]["frame"] == 0
P
[ "$failures" = 0 ] && echo "$# experiments, exec, traces, pages and Python of the installed program work"
exit "$((failures > 0))"
