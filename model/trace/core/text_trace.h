// A bus trace as plain text, for hand-written and foreign traces: see README.md.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/trace/core/trace.h"

namespace fovea::trace {

/// Every defect is a UserError that names the line.
class TextTrace : public RecordSource {
 public:
  static constexpr std::string_view kHeader = "# dramtrace 1";
  static constexpr unsigned kMaxReads = 48, kWrites = 16, kMaxBytes = 4096;
  static constexpr Picoseconds kLatest = 100 * kPsPerSecond;
  static constexpr unsigned kMaxMasters = 10;
  /// The port of the n-th master: those behind the core's, which are narrower and slower.
  static constexpr Master port(std::size_t n) { return wide_master(n); }

  TextTrace(std::string name, std::string_view text);
  static bool recognises(std::string_view text) { return text.starts_with("# dramtrace"); }
  const TraceInfo& info() const { return info_; }
  bool next(unsigned stream, Record& record) override;
  std::string place(unsigned stream) const override;

 private:
  struct Line {
    Picoseconds at;
    std::uint32_t number;  // in the file
    std::uint32_t address;
    std::uint16_t bytes;
    bool write;
  };
  struct Stream {
    std::vector<Line> lines;
    std::size_t next = 0;
    unsigned done = 0;  // bytes of the next line
  };
  [[noreturn]] void bad(std::string what) const;
  void read_line(std::string_view line);
  void read_master(const std::vector<std::string_view>& words);
  void read_record(const std::vector<std::string_view>& words);
  std::uint64_t number(std::string_view word, const char* what, std::uint64_t least,
                       std::uint64_t most) const;

  std::string name_;
  std::uint64_t line_ = 0;
  TraceInfo info_;
  std::vector<std::uint64_t> ids_;  // of the streams
  std::vector<Stream> streams_;
};

}  // namespace fovea::trace
