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
try 0 "$a" "$b" "$c" "$d"
echo "$text" | grep -q '^plain .*: 1.200 times as many$'
echo "$text" | grep -q '^copy .* 20.0000 bytes .* 4.00 times as many as plain$'
try 1 "$a" 'hazards staged 100 300 100 341' "$c" "$d"
echo "$text" | grep -q '^staged .*TOO MANY$'
try 1 "$a" "$c" "$d"
try 1 "$a" "$b" "$c"
try 1 "$a" "$b" "$d"
try 1 "$a" 'hazards staged 100 300 100' "$c" "$d"
try 1 "$a" 'hazards staged 100 100 100 100' "$c" "$d"
try 1 "$a" "$b" "$c" 'remap copy 100 200 1000 1000'
try 1 ''
