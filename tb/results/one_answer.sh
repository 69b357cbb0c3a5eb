#!/usr/bin/env bash
# Each command that reads a folder of results gives the same answer about one that was edited or damaged.
# Usage: one_answer.sh FOVEA OUT PYTHON
#   PYTHON  the folder of the Python package, which gives that answer, too
set -uo pipefail
fovea=$1 out=$2 python=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out" || exit 1
cat >small.yaml <<'Y'
run: {frames: 2, start_limit: 2s}
camera: {kind: chart, stamp: false}
video: {width: 64, height: 16}
Y
"$fovea" run small.yaml --no-frames --profile -o a >/dev/null 2>&1 || { echo "the run failed"; exit 1; }
"$fovea" bless a --against base.yaml --why first --tolerance 1% >/dev/null || { echo "bless failed"; exit 1; }
failures=0
fail() { echo "$1"; failures=$((failures + 1)); }

# answer NAME 0|TEXT: of the folder NAME, a copy of `a` that was edited; TEXT is in the one line of a refusal
answer() {
  local name=$1 want=$2 got status
  local commands=("compare a $name" "report --text $name" "check $name --against base.yaml"
    "trend $name --database $name.db --commit 1111111" "bless $name --against $name.yaml --why first --tolerance 1%")
  for command in "${commands[@]}"; do
    # shellcheck disable=SC2086 # words
    got=$("$fovea" $command 2>&1 >/dev/null)
    status=$?
    if [ "$want" = 0 ]; then
      [ "$status" = 0 ] || fail "$name, $command: status $status: $got"
    else
      [ "$status" = 2 ] || fail "$name, $command: status $status, expected 2: $got"
      grep -qF -- "$want" <<<"$got" || fail "$name, $command: no '$want' in: $got"
    fi
  done
  got=$(PYTHONPATH=$python python3 -c 'import sys, fovea; fovea.read(sys.argv[1]).stalls' "$name" 2>&1)
  [ "$want" = 0 ] && want=
  [ -z "$want$got" ] || { [ -n "$want" ] && grep -qF -- "ResultsError: $want" <<<"$got"; } ||
    fail "$name, Python: expected '$want': $got"
}
copy() { cp -r a "$1"; }

copy windows; sed -i 's/$/\r/' windows/*.csv; answer windows 0
copy blank; for f in blank/*.csv; do echo >>"$f"; done; answer blank 0
copy front
for f in front/*.csv; do
  python3 - "$f" <<'P'
import csv, sys
rows = list(csv.reader(open(sys.argv[1], newline="")))
with open(sys.argv[1], "w", newline="") as f:
    csv.writer(f, lineterminator="\n").writerows([["new" if n == 0 else str(n), *row] for n, row in enumerate(rows)])
P
done
answer front 0
copy more; sed -i '0,/{/s//{"later": {"value": 1, "unit": "1", "description": "of a later version"},/' more/host.json
sed -i '0,/{/s//{"later": [1, 2], /' more/config.json; answer more 0
copy text; sed -i 's/\("cpu.cycles": {"value": \)\([0-9]*\)/\1"\2"/' text/stats.json
answer text "'text/stats.json': 'cpu.cycles' is no figure with a number and a unit; it is damaged"
copy unsaid; sed -i '/"complete"/d' unsaid/stats.json
answer unsaid "'unsaid/stats.json': it does not say whether its results are complete; it is damaged"
copy partial; sed -i 's/"complete": true/"complete": false/' partial/stats.json
answer partial "'partial' holds partial results: its run was stopped or its guest failed; allowed: complete results"
copy other; sed -i 's/fovea run 1/fovea run 9/' other/config.json
answer other "'other': its format is 'fovea run 9'; this version reads 'fovea run 1' only"
copy unended; rm unended/stats.json; answer unended "'unended' has no stats.json: its run did not end"
copy cut; head -c 300 a/config.json >cut/config.json
answer cut "'cut' is not a folder of results: it has no config.json of Fovea's"
mkdir empty; answer empty "'empty' is not a folder of results: it has no config.json of Fovea's"
answer none "'none' is not a folder; allowed: a folder of results, as 'fovea run', 'exec' and 'replay' write it"
# What a page and a comparison read of a table is the same.
copy cell; sed -i '2s/,[0-9]*$/,many/' cell/stalls.csv; rm cell/profile.csv
for command in "compare a cell" "report --text cell"; do
  # shellcheck disable=SC2086 # words
  got=$("$fovea" $command 2>&1 >/dev/null)
  grep -qF "cell/stalls.csv:2: 'many' is not a whole number" <<<"$got" || fail "cell, $command: $got"
done
[ "$failures" = 0 ] && echo "12 folders, 5 commands and Python: one answer each"
exit "$((failures > 0))"
