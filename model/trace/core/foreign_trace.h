// Readers of the trace formats of public DRAM simulators: see README.md, "Foreign formats".
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/trace/core/bounds.h"
#include "model/trace/core/line_reader.h"
#include "model/trace/core/trace.h"

namespace fovea::trace {

/// kDramsysStl: `CYCLE: [(BYTES)] read|write 0xADDRESS [0xDATA]`, cycles from the start.
/// kDramsysRstl: the same with cycles since the request before.
/// kRamulator: `0xADDRESS R|W`; a line without a letter is a read. kRamulator2: `LD|ST ADDRESS`.
/// kDramsim3: `0xADDRESS READ|WRITE CYCLE`.
enum class ForeignFormat : std::uint8_t {
  kDramsysStl,
  kDramsysRstl,
  kRamulator,
  kRamulator2,
  kDramsim3
};

/// True if the format's lines say when a request comes; the others come one after another.
constexpr bool has_cycles(ForeignFormat f) {
  return f != ForeignFormat::kRamulator && f != ForeignFormat::kRamulator2;
}

/// The format that the first request line of these bytes, the beginning of a file, has. DRAMSys'
/// two formats look alike: kDramsysStl stands for both.
std::optional<ForeignFormat> recognise_foreign(std::string_view first_bytes);

/// Why a file that begins so is read in none of these formats, with its line if it has lines: the name of a format
/// that is known and not read, or the line that is of none of them.
struct ForeignRefusal {
  std::uint64_t line = 0;  ///< 0: the file as a whole
  std::string what;        ///< to be put behind the name of the file
};
ForeignRefusal refuse_foreign(std::string_view first_bytes);

/// What these formats leave to their simulator's configuration.
struct ForeignReading {
  ForeignFormat format = ForeignFormat::kDramsysStl;
  Frequency clock;            ///< of the cycles, if the format has them
  unsigned bytes = 64;        ///< of a request that does not say it, a power of two up to TextTrace::kMaxBytes
  std::string label = "cpu";  ///< the master that all requests are booked under
  unsigned window = 48;       ///< reads that it may have in flight, 1 to TextTrace::kMaxReads
  Bounds bounds;
};

/// Reads a foreign trace as records of one master, each with its earliest time. Every defect is a
/// UserError that names the line and what is allowed. A request covers a block of its size: the low bits of its
/// address do not count, as in the programs that these formats are of.
class ForeignTrace : public RecordSource {
 public:
  ForeignTrace(std::string name, std::unique_ptr<ByteSource> bytes, const ForeignReading& reading);
  const TraceInfo& info() const { return info_; }
  bool next(unsigned stream, Record& record) override;
  std::string place(unsigned) const override { return "line " + std::to_string(lines_.line); }
  /// Requests so far whose address was not a multiple of their size.
  std::uint64_t aligned() const { return aligned_; }

 private:
  struct Request {
    Picoseconds at = 0;
    std::uint64_t address = 0;
    unsigned bytes = 0;
    bool write = false;
  };
  using Words = std::vector<std::string_view>;

  [[noreturn]] void bad(std::string what) const;
  bool read_request();
  void read_line(const Words& words);
  void read_dramsys(const Words& words);
  void read_ramulator(const Words& words);
  void read_direction(std::string_view word, std::string_view reads, std::string_view writes);
  std::uint64_t address(std::string_view word, bool decimal_allowed) const;
  Picoseconds time(std::string_view word);

  std::string name_;
  std::unique_ptr<ByteSource> bytes_;
  ForeignReading reading_;
  TraceInfo info_;
  LineReader lines_;
  std::uint64_t cycle_ = 0;  // of the request before
  std::uint64_t requests_ = 0, aligned_ = 0;
  Request request_;
  unsigned done_ = 0;  // bytes of it
};

}  // namespace fovea::trace
