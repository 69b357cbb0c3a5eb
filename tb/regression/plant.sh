# Firmware with a change of its source, for scripts that include this one and have set `build`, `source` and `out` and
# defined `fail MESSAGE`.
# The commands that built the firmware, one a line.
ninja -C "$build" -t commands sw/firmware/fovea_firmware.elf >"$out/commands"
# firmware NAME FILE.c 'sed program': the firmware with one source file changed
firmware() {
  local name=$1 file=$2 command link
  mkdir -p "$out/$name.src"
  sed -E "$3" "$source/sw/firmware/$file" >"$out/$name.src/$(basename "$file")"
  cmp -s "$source/sw/firmware/$file" "$out/$name.src/$(basename "$file")" && fail "$name: nothing was planted"
  command=$(grep -- " -c $source/sw/firmware/$file " "$out/commands" | sed 's/.*&& \([^&]*-c [^&]*\) &&.*/\1/; s/ -MD -MF [^ ]*//')
  local object
  object=$(sed 's/.* -o \([^ ]*\).*/\1/' <<<"$command")
  command=${command/" -c $source/sw/firmware/$file "/" -I$source/sw/firmware/$(dirname "$file") -c $out/$name.src/$(basename "$file") "}
  command=${command/" -o $object"/" -o $out/$name.src/$(basename "$object")"}
  eval "$command" || fail "$name: cannot be compiled"
  link=$(grep -- ' -o .*fovea_firmware.elf' "$out/commands" | sed 's/^[^&]*&& //')
  link=${link//"$object"/"$out/$name.src/$(basename "$object")"}
  eval "$(sed -E "s|-Wl,-Map=[^ ]*||; s|-o [^ ]*fovea_firmware.elf|-o $out/$name.elf|" <<<"$link")" || fail "$name: cannot be linked"
}
