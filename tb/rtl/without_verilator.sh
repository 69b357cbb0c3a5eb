#!/usr/bin/env bash
# without_verilator.sh SOURCE: the project configures without Verilator, and says what it leaves out.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
configure() { cmake -S "$1" -B "$work/$2" -D FOVEA_ONLY='rtl;model/contract;model/engine;sw/lens;tb/rtl;tb/cosim' "${@:3}" >"$work/log" 2>&1; }
configure "$1" none -D CMAKE_DISABLE_FIND_PACKAGE_verilator=ON || { cat "$work/log"; exit 1; }
grep -q 'Verilator is missing: left out are the tests' "$work/log"
if grep -q 'add_test.*rtl.addrgen' "$work/none/tb/rtl/CTestTestfile.cmake"; then echo 'a test that needs Verilator is there'; exit 1; fi
grep -q 'left out are engine=rtl and engine=both' "$work/log"
grep -q 'add_test.*cosim.adapters' "$work/none/tb/cosim/CTestTestfile.cmake"
if grep -q 'add_test.*cosim.rtl' "$work/none/tb/cosim/CTestTestfile.cmake"; then echo 'a test that needs Verilator is there'; exit 1; fi
