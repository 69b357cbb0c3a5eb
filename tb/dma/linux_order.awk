# What `--log-registers '^edma\.'` has recorded, without what differs from run to run: times, program counters,
# fields, addresses of buffers. A set that is written word by word is one line, and so are neighbouring sets with the
# same contents.
function flush() {
  if (sets) print "set " first (last > first ? " to " last : "") ": " contents
  sets = 0
}
{
  value = ""
  for (i = 2; i < NF; i++)
    if ($i == "=") { what = $(i - 2); name = $(i - 1); value = substr($(i + 1), 3) }
  if (value == "") next
  sub(/^edma\./, "", name)
  if (match(name, /[0-9]+$/) && name ~ /^PARAM_(OPT|SRC|A_B_CNT|DST|SRC_DST_BIDX|LINK_BCNTRLD|SRC_DST_CIDX|CCNT)[0-9]+$/) {
    number = substr(name, RSTART) + 0
    word = substr(name, 7, RSTART - 7)
    if ((word == "SRC" || word == "DST") && value != "00000000") value = "address"
    if (what == "wrote" && word == "OPT") { set = number; text = "" }
    if (what == "wrote" && number == set) {
      text = text (text == "" ? "" : " ") word "=" value
      if (word == "CCNT") {
        if (!sets || text != contents || number != last + 1) { flush(); first = number; contents = text }
        last = number
        sets = 1
        set = -1
      }
      next
    }
  }
  flush()
  print what, name, value
}
BEGIN { set = -1 }
END { flush() }
