#include "sw/fovea/replay/open_trace.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/trace/core/text_trace.h"
#include "model/trace/core/trace_file.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

constexpr std::size_t kFirstBytes = 64 << 10;

class FileBytes final : public trace::ByteSource {
 public:
  explicit FileBytes(const std::filesystem::path& file) : name_(one_line(file.string())) {
    // O_NONBLOCK: opening a pipe that no process writes must not hang before the check below.
    fd_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd_ < 0) fail(std::strerror(errno));
    struct stat info {};
    const char* why = nullptr;
    if (::fstat(fd_, &info) != 0)
      why = std::strerror(errno);
    else if (S_ISDIR(info.st_mode))
      why = "it is a folder; a file is needed";
    else if (!S_ISREG(info.st_mode))
      why = "it is not a regular file";
    if (why) {
      ::close(fd_);
      fail(why);
    }
    size_ = static_cast<std::uint64_t>(info.st_size);
    std::string mark(kMark.size(), '\0');
    if (read(0, mark.data(), mark.size()) == mark.size() && mark == kMark) {
      skipped_ = kMark.size();
      size_ -= skipped_;
    }
  }
  ~FileBytes() override { ::close(fd_); }
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::uint64_t size() const override { return size_; }
  std::size_t read(std::uint64_t offset, char* to, std::size_t bytes) const override {
    std::size_t done = 0;
    while (done < bytes && offset + done < size_) {
      const std::size_t left = std::min<std::uint64_t>(bytes - done, size_ - offset - done);
      const ssize_t n = ::pread(fd_, to + done, left, static_cast<off_t>(skipped_ + offset + done));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(std::strerror(errno));
      if (n == 0) fail("it became shorter while it was read");
      done += static_cast<std::size_t>(n);
    }
    return done;
  }

 private:
  static constexpr std::string_view kMark = "\xef\xbb\xbf";
  [[noreturn]] void fail(const std::string& why) const {
    throw UserError(fmt::format("cannot read '{}': {}", name_, why));
  }
  std::string name_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
  std::uint64_t skipped_ = 0;  // of the file, before what is offered
};

constexpr TraceFormat kAllFormats[] = {
    TraceFormat::kBinary,    TraceFormat::kText,       TraceFormat::kDramsysStl, TraceFormat::kDramsysRstl,
    TraceFormat::kRamulator, TraceFormat::kRamulator2, TraceFormat::kDramsim3};
static_assert(std::size(kAllFormats) == std::size(kTraceFormats));

constexpr struct {
  TraceFormat format;
  trace::ForeignFormat foreign;
} kForeign[] = {{TraceFormat::kDramsysStl, trace::ForeignFormat::kDramsysStl},
                {TraceFormat::kDramsysRstl, trace::ForeignFormat::kDramsysRstl},
                {TraceFormat::kRamulator, trace::ForeignFormat::kRamulator},
                {TraceFormat::kRamulator2, trace::ForeignFormat::kRamulator2},
                {TraceFormat::kDramsim3, trace::ForeignFormat::kDramsim3}};

TraceFormat format_of(trace::ForeignFormat foreign) {
  for (const auto& row : kForeign)
    if (row.foreign == foreign) return row.format;
  FOVEA_CHECK(false, "a foreign format without a name");
}

/// Why a file that begins so is no foreign trace.
std::string refused(const std::string& file, std::string_view first_bytes) {
  const trace::ForeignRefusal why = trace::refuse_foreign(first_bytes);
  const std::string line = why.line ? fmt::format(":{}", why.line) : "";
  return one_line(fmt::format("'{}'{}: it is {}", file, line, why.what));
}

std::string first_bytes_of(const std::string& file) {
  const auto bytes = open_bytes(file);
  std::string first(kFirstBytes, '\0');
  first.resize(bytes->read(0, first.data(), first.size()));
  return first;
}

}  // namespace

std::optional<TraceFormat> trace_format(std::string_view name) {
  for (const TraceFormat f : kAllFormats)
    if (name_of(f) == name) return f;
  return std::nullopt;
}

std::optional<trace::ForeignFormat> foreign(TraceFormat f) {
  for (const auto& row : kForeign)
    if (row.format == f) return row.foreign;
  return std::nullopt;
}

std::unique_ptr<trace::ByteSource> open_bytes(const std::filesystem::path& file) {
  return std::make_unique<FileBytes>(file);
}

bool is_any_trace(std::string_view first_bytes) {
  return trace::TraceFile::recognises(first_bytes) || trace::TextTrace::recognises(first_bytes) ||
         trace::recognise_foreign(first_bytes);
}

TraceFormat format_of(const std::string& file) {
  const std::string first = first_bytes_of(file);
  if (trace::TraceFile::recognises(first)) return TraceFormat::kBinary;
  if (trace::TextTrace::recognises(first)) return TraceFormat::kText;
  const auto found = trace::recognise_foreign(first);
  if (!found)
    throw UserError(fmt::format("{}; formats: {}", refused(file, first), fmt::join(kTraceFormats, ", ")));
  if (*found != trace::ForeignFormat::kDramsysStl)
    return format_of(*found);
  const auto suffix = std::filesystem::path(file).extension();
  if (suffix == ".stl") return TraceFormat::kDramsysStl;
  if (suffix == ".rstl") return TraceFormat::kDramsysRstl;
  throw UserError(fmt::format(
      "'{}' is a DRAMSys trace, but its name does not say of which kind; give --from dramsys-stl "
      "(cycles from the start) or --from dramsys-rstl (cycles since the request before)",
      one_line(file)));
}

OpenTrace open_trace(const std::string& file, TraceFormat format, trace::ForeignReading reading) {
  OpenTrace out;
  out.format = format;
  const std::string name = one_line(file);
  auto bytes = open_bytes(file);
  const auto keep = [&out](auto source) {
    out.info = &source->info();
    out.source = std::move(source);
  };
  if (format == TraceFormat::kBinary) {
    auto source = std::make_unique<trace::TraceFile>(name, std::move(bytes));
    out.version = source->version();
    keep(std::move(source));
  } else if (format == TraceFormat::kText) {
    keep(std::make_unique<trace::TextTrace>(name, std::move(bytes)));
  } else {
    reading.format = *foreign(format);
    auto source = std::make_unique<trace::ForeignTrace>(name, std::move(bytes), reading);
    out.foreign = source.get();
    keep(std::move(source));
  }
  return out;
}

std::string words_of_kept(const trace::TraceInfo& info) {
  std::vector<std::string> labels;
  for (const trace::MasterInfo& m : info.masters)
    if (trace::keeps_times(info, m.id) && std::find(labels.begin(), labels.end(), m.label) == labels.end())
      labels.push_back(m.label);
  if (labels.empty()) return {};
  return fmt::format("the trace does not hold all that requests of {} wait for: figures that depend on them do not "
                     "follow a run",
                     fmt::join(labels, ", "));
}

OpenTrace open_own_trace(const std::string& file) {
  const std::string first = first_bytes_of(file);
  if (trace::TraceFile::recognises(first)) return open_trace(file, TraceFormat::kBinary, {});
  if (trace::TextTrace::recognises(first)) return open_trace(file, TraceFormat::kText, {});
  const std::string what =
      trace::recognise_foreign(first)
          ? fmt::format("'{}' looks like a trace of another simulator, which 'fovea trace convert' reads",
                        one_line(file))
          : refused(file, first);
  throw UserError(fmt::format("{}; a replay takes a file of 'fovea run --bus-trace', or text that begins with '{}'",
                              what, trace::TextTrace::kHeader));
}

}  // namespace fovea::app
