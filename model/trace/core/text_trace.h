// Reader of bus traces in Fovea's own text format: see README.md, "Text".
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/trace/core/line_reader.h"
#include "model/trace/core/trace.h"

namespace fovea::trace {

/// How a text trace is read; tests choose other values to reach the borders.
struct TextReading {
  std::size_t block = 256 << 10;  ///< bytes that are read at a time
  std::size_t ahead = 1 << 16;    ///< records of a stream that are held while others are read
  bool one_pass = true;           ///< false: every line goes through the careful parser
};

/// Reads records of several masters from one file, in memory that does not depend on the file's
/// size. Record lines in the usual spelling are parsed in one pass; every other line goes to the
/// careful parser, which has all error messages. Every defect is a UserError that names the line. A
/// defect is reported when its line is reached: the first lines are read by the constructor, the
/// rest by next().
class TextTrace : public RecordSource {
 public:
  static constexpr std::string_view kHeader = "# dramtrace 1";
  /// Limits of a window (reads in flight), of writes in flight, of bytes of a record.
  static constexpr unsigned kMaxReads = 48, kWrites = 16, kMaxBytes = 4096;
  static constexpr Picoseconds kLatest = 100 * kPsPerSecond;
  static constexpr unsigned kMaxMasters = 10;
  static constexpr unsigned kMaxId = 65535, kMaxLabel = 32;
  static constexpr const char* kLabelRule =
      "1 to 32 letters, digits, '_' and '-', not the name of a cause of waiting";
  /// The port of the n-th master: those behind the core's, which are narrower and slower.
  static constexpr Master port(std::size_t n) { return wide_master(n); }
  /// True if a master may have this name.
  static bool is_label(std::string_view word);

  TextTrace(std::string name, std::string text, const TextReading& reading = {});
  TextTrace(std::string name, std::unique_ptr<ByteSource> bytes, const TextReading& reading = {});
  static bool recognises(std::string_view text) { return text.starts_with("# dramtrace"); }
  const TraceInfo& info() const { return info_; }
  bool next(unsigned stream, Record& record) override;
  std::string place(unsigned stream) const override;

 private:
  struct Line {
    Picoseconds at;
    std::uint64_t number;  // in the file
    std::uint32_t address;
    std::uint16_t bytes;
    bool write;
  };
  struct Stream {
    std::vector<Line> lines;  // from `next` on not yet handed out
    std::size_t next = 0;
    unsigned done = 0;           // bytes of the next line
    std::uint64_t current = 0;   // line of the record handed out last
    std::uint64_t declared = 0;  // line of its declaration
    // Reads the file for this stream alone, once more records than TextReading::ahead were held.
    std::unique_ptr<LineReader> own;
    bool ended = false;
  };
  using Words = std::vector<std::string_view>;

  [[noreturn]] void bad(std::string what) const;
  void find_masters();
  void find_start();
  void read_carefully();
  void declare(const Words& words);
  bool read_line(std::string_view line, Line& l, unsigned& stream);
  void read_record(const Words& words, Line& l, unsigned& stream) const;
  bool read_usual(const char*& at, Line& l, unsigned& stream) const;
  bool refill(Stream& s);
  bool read_chunk(LineReader& lines, Stream* only);
  std::uint64_t number(std::string_view word, const char* what, std::uint64_t least,
                       std::uint64_t most) const;

  std::string name_;
  std::unique_ptr<ByteSource> bytes_;
  TextReading reading_;
  std::uint64_t line_ = 0;  // for messages
  bool declaring_ = false;  // masters are declared as their lines come
  TraceInfo info_;
  std::vector<std::uint64_t> ids_;       // of the streams
  std::vector<std::uint8_t> stream_of_;  // by id
  std::vector<Stream> streams_;
  LineReader front_;  // for all streams without a reader of their own
  bool ended_ = false;
};

}  // namespace fovea::trace
