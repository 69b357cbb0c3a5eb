#!/usr/bin/env bash
# The worked example of `fovea limits --load` in sw/fovea/README.md: the command there gives the answer there, and
# another figure in the page is found. Usage: load_example.sh FOVEA SOURCE OUT
set -euo pipefail
fovea=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
page=$source/sw/fovea/README.md
sed -n '/^<!-- load: begin -->$/,/^<!-- load: end -->$/p' "$page" | grep -v '^```\|^<!--' >"$out/example"
read -r -a command < <(grep '^fovea limits ' "$out/example")
(cd "$source" && "$fovea" "${command[@]:1}" -o "$out/run" >"$out/log" 2>&1) || { cat "$out/log"; exit 1; }
tr -s ' \n' ' ' <"$out/run/answer.txt" >"$out/answer"

# A statement of the page begins after two spaces and goes on after four.
differs() {  # EXAMPLE
  local found=1 line
  while read -r line; do
    grep -qF -- "$line" "$out/answer" || { echo "not in the answer: $line"; found=0; }
  done < <(grep '^  ' "$1" | sed -E 's/^  ([^ ])/\n\1/' | awk 'BEGIN { RS = "" } { gsub(/[ \n]+/, " "); print }')
  return $found
}
[ "$(grep -c '^  [^ ]' "$out/example")" -ge 4 ] || { echo "$page: no example"; exit 1; }
if differs "$out/example"; then exit 1; fi
sed -E '0,/[0-9]\.[0-9] MB/s//9.9 MB/' "$out/example" >"$out/changed"
if ! differs "$out/changed" >/dev/null; then echo "another figure was not found"; exit 1; fi
