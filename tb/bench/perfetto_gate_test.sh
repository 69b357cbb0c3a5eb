#!/bin/sh
# perfetto_gate.sh accepts twice the host instructions and no more, and a measurement that failed is none.
set -eu
gate=$(dirname "$0")/perfetto_gate.sh
printf '100\n200\n150\n350\n' | "$gate" compare
if printf '100\n200\n150\n351\n' | "$gate" compare; then exit 1; fi
if printf '100\n200\n150\n' | "$gate" compare; then exit 1; fi
if printf '100\n200\n150\n150\n' | "$gate" compare; then exit 1; fi
