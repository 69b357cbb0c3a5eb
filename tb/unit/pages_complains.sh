#!/usr/bin/env bash
# pages.py complains of each kind of defect, and of nothing in a source without one. Usage: pages_complains.sh SOURCE
set -uo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/part" "$folder/build"
columns() { printf "%0$1d" 0; } # COUNT
headings='## Purpose\n\n## Use\n\n## How it works\n\n## Limits\n'
printf "# Part\n\n$headings" >"$folder/part/README.md"
printf '# Page\n\n[Part](part/README.md#how-it-works)\n\n%s\n| %s |\n```\n[code](nowhere) of nobody\n```\n' \
  "$(columns 120)" "$(columns 200)" >"$folder/page.md"
printf '// %s\n' "$(columns 117)" >"$folder/part/a.cpp"
columns 300 >"$folder/build/b.cpp"
check() { "$1/tb/unit/pages.py" "$folder"; }
git -C "$folder" init -q
touch "$folder/.dot" "$folder/LICENSE" "$folder/not_tracked"
echo '*.pyc' >"$folder/.gitignore"
git -C "$folder" add .dot .gitignore LICENSE
said=$(check "$1") || { echo "complaints of a source without defects: $said"; exit 1; }

printf '\n[a](part/none.md) [b](part/README.md#none)\n%s\n' "$(columns 121)" >>"$folder/page.md"
printf '# Part\n\n## Purpose\n\n## Limits\n' >"$folder/part/README.md"
for file in a.cpp b.h c.c d.sv e.S; do printf '// %s\n' "$(columns 118)" >"$folder/part/$file"; done
printf '%s\n' 'wait() # for whoever' 'nobody_waits Somebody' >"$folder/part/f.py"
printf 'Nobody knows, everybody asks.\n' >>"$folder/page.md"
mkdir "$folder/run"
touch "$folder/run/stats.json"
touch "$folder/part/a.pyc" "$folder/part/b.pyc"
git -C "$folder" add run/stats.json not_tracked
git -C "$folder" add --force part/a.pyc
said=$(check "$1" | sed 's/\(at the top\),.*/\1/'; exit "${PIPESTATUS[0]}") && { echo 'defects are not found'; exit 1; }
expected="not_tracked: does not belong at the top
part: does not belong at the top
run: does not belong at the top
part/a.pyc: is tracked, though .gitignore names it
page.md:3: no heading for the link part/README.md#how-it-works
page.md:11: no file for the link part/none.md
page.md:11: no heading for the link part/README.md#none
page.md:12: 121 columns; at most 120, rows of tables excepted
$(for word in page.md:13:Nobody page.md:13:everybody part/f.py:1:whoever part/f.py:2:Somebody; do
  echo "${word%:*}: '${word##*:}'; name the part: the caller, another process, no master, a user"; done)
part/README.md: no heading '## Concepts|Use'
part/README.md: no heading '## How it works'
$(for file in a.cpp b.h c.c d.sv e.S; do echo "part/$file:1: 121 columns; at most 120"; done)"
diff <(sort <<<"$expected") <(sort <<<"$said")
