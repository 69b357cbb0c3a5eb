#!/usr/bin/env bash
# without_verilator.sh SOURCE: the project configures without Verilator, and says what it leaves out.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
configure() { cmake -S "$1" -B "$work/$2" -D FOVEA_ONLY='rtl;model/contract;sw/lens;tb/rtl' "${@:3}" >"$work/log" 2>&1; }
configure "$1" none -D CMAKE_DISABLE_FIND_PACKAGE_verilator=ON || { cat "$work/log"; exit 1; }
grep -q 'Verilator is missing: left out are the tests' "$work/log"
! grep -q 'add_test.*rtl.addrgen' "$work/none/tb/rtl/CTestTestfile.cmake"
