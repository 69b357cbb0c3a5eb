#!/bin/sh
# replay_gate.sh complains about a cost that grows with masters or with length, about a load that was not
# measured with ten masters, or without one to compare with, and about no lines at all.
set -u
gate=$(dirname "$0")/replay_gate.sh
status=0
expect() {  # EXIT SENTENCE MEASURED
  out=$(printf "$3" | "$gate" compare)
  got=$?
  [ $got -eq "$1" ] || { echo "$2: exit $got, expected $1: $out"; status=1; }
}
head='load masters window rows/req first next\n'
one='dealt 1 40 0.02 2500 2500\n'
expect 0 'the same' "$head${one}dealt 4 10 0.02 2500 2500\ndealt 10 4 0.02 2500 2500\n"
expect 0 'within the margin' "$head${one}dealt 10 4 0.02 2624 2624\n"
expect 1 'with masters' "$head${one}dealt 10 4 0.02 2626 2626\n"
expect 1 'with four, not with ten' "$head${one}dealt 4 10 0.02 2626 2626\ndealt 10 4 0.02 2500 2500\n"
expect 1 'with length' "$head${one}dealt 10 4 0.02 2500 2551\n"
expect 1 'one master, with length' "${head}dealt 1 40 0.02 2500 2551\ndealt 10 4 0.02 2551 2551\n"
expect 1 'ten are missing' "$head${one}dealt 4 10 0.02 2500 2500\n"
expect 1 'ten of another load are missing' "$head${one}dealt 10 4 0.02 2500 2500\nrandom 1 40 1 3000 3000\n"
expect 1 'one is missing' "${head}dealt 10 4 0.02 2500 2500\n"
rows='random 1 40 1 3000 3000\n'
expect 0 'random, within its margin' "$head${rows}random 10 4 1 3239 3239\n"
expect 1 'random, with masters' "$head${rows}random 10 4 1 3241 3241\n"
expect 1 'a load without a margin' "${head}apart 1 40 0.02 2500 2500\napart 10 4 0.02 2500 2500\n"
expect 1 'nothing' "$head"
exit $status
