#!/bin/sh
# profile_gate.sh accepts 1.30 times the host instructions and no more, and misses no program.
set -eu
gate=$(dirname "$0")/profile_gate.sh
line() { echo "$1  100 guest  100 host  $2 each"; }
if "$gate" compare </dev/null; then exit 1; fi
{ line a 10.00; line b 20.00; line a 13.00; line b 26.00; } | "$gate" compare
if { line a 10.00; line b 20.00; line a 13.01; line b 26.00; } | "$gate" compare; then exit 1; fi
if { line a 10.00; line b 20.00; line a 13.00; } | "$gate" compare; then exit 1; fi
