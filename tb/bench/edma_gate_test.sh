#!/bin/sh
# The gate complains of a checker of hazards that costs too much, and of measurements that are missing.
set -eu
gate=$(dirname "$0")/edma_gate.sh
try() {  # STATUS LINE...
  want=$1 got=0
  shift
  text=$(printf '%s\n' "$@" | "$gate" compare) || got=$?
  [ "$got" = "$want" ] || { echo "status $got instead of $want for: $*: $text"; exit 1; }
}
a='hazards plain 100 300 110 350' b='hazards staged 100 300 100 340' c='remap plain 100 300 1000 2000'
d='remap copy 100 200 1000 3000'
e='seconds plain 0.5 2.5 1000000 5000000' f='seconds copy 0.5 1.5 1000000 7000000'
try 0 "$a" "$b" "$c" "$d" "$e" "$f"
echo "$text" | grep -q '^plain .*: 1.200 times as many$'
echo "$text" | grep -q '^copy .* 20.0000 bytes .* 4.00 times as many as plain$'
echo "$text" | grep -q '^plain .* 2.0 MB .* second .* 1.00 times as many as plain$'
echo "$text" | grep -q '^copy .* 6.0 MB .* second .* 3.00 times as many as plain$'
try 1 "$a" "$b" "$c" "$d"
try 1 "$a" "$b" "$c" "$d" "$e"
try 1 "$a" "$b" "$c" "$d" "$f" "$e"
try 1 "$a" "$b" "$c" "$d" "$e" 'seconds copy 0.5 0.5 1000000 7000000'
try 1 "$a" "$b" "$c" "$d" "$e" 'seconds copy 0.5 1.5 1000000 '
try 1 "$a" 'hazards staged 100 300 100 341' "$c" "$d" "$e" "$f"
echo "$text" | grep -q '^staged .*TOO MANY$'
try 1 "$a" "$c" "$d" "$e" "$f"
try 1 "$a" "$b" "$c" "$e" "$f"
try 1 "$a" "$b" "$d" "$e" "$f"
try 1 "$a" 'hazards staged 100 300 100' "$c" "$d" "$e" "$f"
try 1 "$a" 'hazards staged 100 100 100 100' "$c" "$d" "$e" "$f"
try 1 "$a" "$b" "$c" 'remap copy 100 200 1000 1000' "$e" "$f"
try 1 ''
