// Opening of bus traces: which format a file has, and a reader for it.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "model/trace/core/foreign_trace.h"
#include "model/trace/core/trace.h"

namespace fovea::app {

/// Formats of trace files.
enum class TraceFormat : std::uint8_t {
  kBinary,
  kText,
  kDramsysStl,
  kDramsysRstl,
  kRamulator,
  kRamulator2,
  kDramsim3
};
inline constexpr std::string_view kTraceFormats[] = {
    "binary", "text", "dramsys-stl", "dramsys-rstl", "ramulator", "ramulator2", "dramsim3"};
inline std::string_view name_of(TraceFormat f) {
  return kTraceFormats[static_cast<std::size_t>(f)];
}
/// The format of that name; none if there is none.
std::optional<TraceFormat> trace_format(std::string_view name);
/// The foreign format; none for Fovea's own.
std::optional<trace::ForeignFormat> foreign(TraceFormat f);

/// A regular file that is read piece by piece, without the mark of UTF-8 that some programs put in front of text.
std::unique_ptr<trace::ByteSource> open_bytes(const std::filesystem::path& file);

/// The format of a file, by its first bytes; the name's suffix, `.stl` or `.rstl`, tells DRAMSys'
/// two formats apart. @throws UserError if the format is unknown or ambiguous
TraceFormat format_of(const std::string& file);
/// True if these first bytes are of any of the formats.
bool is_any_trace(std::string_view first_bytes);

struct OpenTrace {
  TraceFormat format = TraceFormat::kBinary;
  unsigned version = 0;  ///< of the binary format
  std::unique_ptr<trace::RecordSource> source;
  const trace::TraceInfo* info = nullptr;  ///< part of `source`
  const trace::ForeignTrace* foreign = nullptr;  ///< `source`, if it is one
};

/// One sentence about the masters whose requests keep their recorded times; empty: all follow what they wait for.
std::string words_of_kept(const trace::TraceInfo& info);

/// Opens a trace in one of Fovea's own formats. @throws UserError for any other file
OpenTrace open_own_trace(const std::string& file);
/// Opens a trace of any format. `reading` is for foreign formats. @throws UserError
OpenTrace open_trace(const std::string& file, TraceFormat format, trace::ForeignReading reading);

}  // namespace fovea::app
