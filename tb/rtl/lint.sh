#!/usr/bin/env bash
# lint.sh SOURCE: Verilator's lint finds nothing in rtl/ with all its warnings, and finds what is planted.
set -euo pipefail
rtl=$1/rtl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
lint() {  # FOLDER TOP [PARAMETERS]
  verilator --lint-only -Wall --top-module "$2" "${@:3}" -y "$1/remap" "$rtl/lint.vlt" "$1/remap/remap_pkg.sv" \
    "$1/remap/remap_regs_pkg.sv" "$1/remap/$2.sv" >"$work/log" 2>&1
}
for top in remap_addrgen remap_top; do
  lint "$rtl" "$top" || { cat "$work/log"; echo "lint.sh: $top is not clean"; exit 1; }
done
for sizes in "-GLogLines=3 -GPrefetch=1" "-GLogLines=12 -GPrefetch=7"; do
  read -ra sizes <<<"$sizes"
  lint "$rtl" remap_top "${sizes[@]}" || { cat "$work/log"; echo "lint.sh: ${sizes[*]} is not clean"; exit 1; }
done
cp -r "$rtl/remap" "$work/remap"
sed -i "s/pair <= pair + 1'b1;/pair <= pair + 14'd1;/" "$work/remap/remap_scan.sv"
if lint "$work" remap_addrgen; then echo "lint.sh: a planted width error is not found"; exit 1; fi
grep -q 'Warning-WIDTH.*remap_scan.sv' "$work/log"
