// The file of a bus trace: blocks of compressed records, see README.md.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/trace/core/byte_source.h"
#include "model/trace/core/trace.h"
#include "model/trace/core/trace_code.h"

namespace fovea::trace {

/// Takes records of all streams and gives the file's bytes at the end. Keeps the compressed blocks:
/// their order in the file must not depend on when they were filled.
class TraceWriter {
 public:
  explicit TraceWriter(unsigned streams) : streams_(streams) {}
  void add(unsigned stream, const Record& record);
  std::uint64_t records() const { return records_; }
  /// Hands the file's bytes over, piece by piece.
  void finish(const TraceInfo& info, const std::function<void(std::string_view)>& put);

 private:
  struct Stream {
    CodeState state;
    std::string raw;
    std::uint32_t count = 0;
    std::vector<std::string> blocks;
  };
  void close_block(Stream& s, unsigned index);
  std::vector<Stream> streams_;
  std::uint64_t records_ = 0;
};

/// Reads a trace file, one block of each stream at a time, so that memory does not grow with the
/// file. Every defect is a UserError of one line.
class TraceFile : public RecordSource {
 public:
  /// `name` is for messages. The constructor checks the description and the checksums of all
  /// blocks; next() checks each record.
  TraceFile(std::string name, std::unique_ptr<ByteSource> bytes);
  TraceFile(std::string name, std::string bytes);
  /// True if the bytes begin as a trace does, of whatever version.
  static bool recognises(std::string_view bytes);
  const TraceInfo& info() const { return info_; }
  /// Version of the format, 1 to 5.
  unsigned version() const { return version_; }
  std::uint64_t records() const { return records_; }
  bool next(unsigned stream, Record& record) override;

 private:
  struct Block {
    std::uint64_t offset = 0;  // of its packed bytes
    std::uint32_t packed = 0, raw = 0, count = 0, crc = 0;
  };
  struct Stream {
    std::vector<Block> blocks;
    std::size_t next_block = 0;
    std::uint32_t left = 0;
    bool transfers = false;  // it may have them
    std::uint64_t records = 0, read = 0, longest_gap = 0;
    std::vector<std::uint8_t> raw;
    ByteReader in;
    CodeState state;
  };
  [[noreturn]] void bad(const std::string& what) const;
  std::uint32_t checksum_of(const Block& b, std::uint32_t from) const;
  std::vector<std::uint8_t> unpack(const Block& b) const;
  void read_info(std::string_view text);
  void info_line(const std::string& key, std::string_view rest);
  void check_info();
  void open_block(Stream& s);

  void read(std::uint64_t offset, char* to, std::size_t bytes) const;

  std::string name_;
  std::unique_ptr<ByteSource> bytes_;
  TraceInfo info_;
  std::vector<Stream> streams_;
  std::array<unsigned, kMasterCount> stream_of_ = [] {
    std::array<unsigned, kMasterCount> none;
    none.fill(~0u);
    return none;
  }();
  unsigned version_ = 0;
  bool version_told_ = false;  // by the description, too
  std::uint64_t records_ = 0;
};

}  // namespace fovea::trace
