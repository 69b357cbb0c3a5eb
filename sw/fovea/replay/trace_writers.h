// Writers of traces whose requests have times and no dependences: Fovea's text and foreign formats.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/clock.h"
#include "sw/fovea/replay/open_trace.h"

namespace fovea::app {

/// One request of a trace, in the order of time.
struct TimedRequest {
  Picoseconds at = 0;     ///< earliest time
  Picoseconds ready = 0;  ///< the same, but not before the requests of its master that precede it
  unsigned master = 0;    ///< index of the master
  bool write = false;
  std::uint32_t address = 0;
  unsigned bytes = 0;
};

struct WriterSettings {
  TraceFormat format = TraceFormat::kText;  ///< any but kBinary
  Frequency clock;                          ///< of the cycles, if the format has them
  unsigned bytes = 64;  ///< size of a request, a power of two, where the format cannot say it
};

/// Writes lines of one format.
class LineWriter {
 public:
  using Put = std::function<void(std::string_view)>;
  LineWriter(const WriterSettings& settings, Put put)
      : settings_(settings), clock_(settings.clock), put_(std::move(put)) {}

  /// What stands before the first request: label and window of each master.
  void begin(const std::vector<std::pair<std::string, unsigned>>& masters);
  void add(const TimedRequest& request);
  void end() { flush(); }
  /// Requests that went as others: of WriterSettings::bytes, or of a power of two each, at a multiple of it, where
  /// the format says sizes. And how many these were.
  std::uint64_t resized() const { return resized_; }
  std::uint64_t pieces() const { return pieces_; }

 private:
  void add_foreign(const TimedRequest& r, std::uint64_t cycle);
  void count(unsigned pieces, bool as_it_was);
  void flush();

  WriterSettings settings_;
  Clock clock_;
  Put put_;
  std::string buffer_;
  std::uint64_t cycle_ = 0;  // of the request before
  std::uint64_t resized_ = 0, pieces_ = 0;
};

}  // namespace fovea::app
