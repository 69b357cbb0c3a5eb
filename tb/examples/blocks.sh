#!/usr/bin/env bash
# Each block of model/howto that names a file ("<!-- FILE -->" in the line before it) is a part of that file.
# Usage: blocks.sh SOURCE
set -euo pipefail
source=$1
checked=0
check() {  # PAGE FILE BLOCK
  [ -f "$source/$2" ] || { echo "$1 names $2, which is not there"; exit 1; }
  [[ "$(<"$source/$2")" == *"$3"* ]] || { printf '%s: this block is not in %s:\n%s\n' "$1" "$2" "$3"; exit 1; }
  checked=$((checked + 1))
}
for page in "$source"/model/howto/*.md; do
  file= block= inside=
  while IFS= read -r line; do
    if [ -n "$inside" ]; then
      if [ "$line" = '```' ]; then check "${page#"$source"/}" "$file" "${block%$'\n'}"; file= inside=; else block+=$line$'\n'; fi
    elif [[ $line =~ ^'<!-- '([^ ]+)' -->'$ ]]; then
      file=${BASH_REMATCH[1]}
    elif [ -n "$file" ] && [[ $line == '```'* ]]; then
      inside=1 block=
    fi
  done <"$page"
  [ -z "$inside$file" ] || { echo "${page#"$source"/}: a block does not end"; exit 1; }
done
[ "$checked" -gt 0 ] || { echo "no block was checked"; exit 1; }
echo "$checked blocks are parts of their files"
