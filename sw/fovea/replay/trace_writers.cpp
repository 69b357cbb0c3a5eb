#include "sw/fovea/replay/trace_writers.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>

#include "model/trace/core/text_trace.h"

namespace fovea::app {

void LineWriter::flush() {
  put_(buffer_);
  buffer_.clear();
}

void LineWriter::begin(const std::vector<std::pair<std::string, unsigned>>& masters) {
  if (settings_.format != TraceFormat::kText) return;
  buffer_ = std::string(trace::TextTrace::kHeader) + "\n";
  for (std::size_t i = 0; i < masters.size(); ++i)
    fmt::format_to(std::back_inserter(buffer_), "# master {} window {} {}\n", i, masters[i].second,
                   masters[i].first);
}

void LineWriter::add(const TimedRequest& r) {
  if (settings_.format == TraceFormat::kText)
    fmt::format_to(std::back_inserter(buffer_), "{} {} {} 0x{:x} {}\n", r.at, r.master,
                   r.write ? 'W' : 'R', r.address, r.bytes);
  else
    add_foreign(r, settings_.clock.stopped() ? 0 : clock_.edge_at_or_after(r.ready));
  if (buffer_.size() > (64u << 10)) flush();
}

void LineWriter::add_foreign(const TimedRequest& r, std::uint64_t cycle) {
  const auto out = std::back_inserter(buffer_);
  const std::uint64_t since = cycle - std::min(cycle, cycle_);
  cycle_ = std::max(cycle, cycle_);
  const char* const word = r.write ? "write" : "read";
  const std::uint64_t end = std::uint64_t{r.address} + r.bytes;
  unsigned pieces = 0;
  if (settings_.format == TraceFormat::kDramsysStl ||
      settings_.format == TraceFormat::kDramsysRstl) {
    const bool relative = settings_.format == TraceFormat::kDramsysRstl;
    for (std::uint64_t at = r.address, size; at < end; at += size, ++pieces) {
      size = std::bit_floor(end - at);
      if (at != 0) size = std::min(size, at & (~at + 1));
      fmt::format_to(out, "{}: ", !relative ? cycle : pieces == 0 ? since : 0);
      if (size != settings_.bytes) fmt::format_to(out, "({}) ", size);
      fmt::format_to(out, "{} 0x{:x}\n", word, at);
    }
    count(pieces, pieces == 1);
    return;
  }
  // One access for each block of that size which the request touches.
  for (std::uint64_t at = r.address & ~(settings_.bytes - 1); at < end; at += settings_.bytes, ++pieces)
    switch (settings_.format) {
      case TraceFormat::kRamulator:
        fmt::format_to(out, "0x{:x} {}\n", at, r.write ? 'W' : 'R');
        break;
      case TraceFormat::kRamulator2:
        fmt::format_to(out, "{} 0x{:x}\n", r.write ? "ST" : "LD", at);
        break;
      default:
        fmt::format_to(out, "0x{:x} {} {}\n", at, r.write ? "WRITE" : "READ", cycle);
    }
  count(pieces, pieces == 1 && r.bytes == settings_.bytes);
}

void LineWriter::count(unsigned pieces, bool as_it_was) {
  if (as_it_was) return;
  ++resized_;
  pieces_ += pieces;
}

}  // namespace fovea::app
