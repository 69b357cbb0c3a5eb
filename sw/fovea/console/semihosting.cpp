#include "sw/fovea/console/semihosting.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

enum Operation : std::uint32_t {
  kOpen = 0x01, kClose = 0x02, kWriteC = 0x03, kWrite0 = 0x04, kWrite = 0x05, kRead = 0x06,
  kReadC = 0x07, kIsError = 0x08, kIsTty = 0x09, kSeek = 0x0A, kFlen = 0x0C, kTmpNam = 0x0D,
  kRemove = 0x0E, kRename = 0x0F, kClock = 0x10, kTime = 0x11, kSystem = 0x12, kErrno = 0x13,
  kGetCmdLine = 0x15, kHeapInfo = 0x16, kExit = 0x18, kExitExtended = 0x20, kElapsed = 0x30,
  kTickFreq = 0x31,
};

constexpr std::uint32_t kError = 0xFFFF'FFFFu;
constexpr std::uint32_t kApplicationExit = 0x20026;
constexpr std::size_t kMaxFiles = 64, kMaxName = 4096, kChunk = 4096;
constexpr std::uint32_t kTicksPerSecond = 1'000'000'000;
/// ":semihosting-features": magic number, then EXT_EXIT_EXTENDED and EXT_STDOUT_STDERR.
constexpr std::array<std::uint8_t, 5> kFeatureBytes = {'S', 'H', 'F', 'B', 0x03};

/// Modes of SYS_OPEN: those of fopen, each as text and as binary.
constexpr std::array<int, 6> kModes = {
    O_RDONLY, O_RDWR, O_WRONLY | O_CREAT | O_TRUNC, O_RDWR | O_CREAT | O_TRUNC,
    O_WRONLY | O_CREAT | O_APPEND, O_RDWR | O_CREAT | O_APPEND};

/// newlib (errno.h) numbers some errors differently from Linux.
int guest_errno(int error) {
  switch (error) {
    case ENOSYS: return 88;
    case ENOTEMPTY: return 90;
    case ENAMETOOLONG: return 91;
    case ELOOP: return 92;
    case EOVERFLOW: return 139;
    default: return error <= ERANGE ? error : EIO;
  }
}

}  // namespace

Semihosting::Semihosting(const SemihostingSettings& settings, SemihostingConsole& console)
    : settings_(settings), console_(console), files_(settings.root) {}

Semihosting::~Semihosting() {
  for (const File& f : open_)
    if (f.kind == File::Kind::kHost) ::close(f.fd);
}

void Semihosting::call(SemihostingTarget& t) { t.set_r0(operate(t, t.r(0), t.r(1))); }

std::uint32_t Semihosting::failed(int error) {
  errno_ = guest_errno(error);
  return kError;
}

bool Semihosting::arguments(SemihostingTarget& t, std::uint32_t block, unsigned count,
                            Arguments& a) {
  std::array<std::uint8_t, 16> bytes{};
  if (!t.read(block, std::span(bytes).first(4 * count))) return false;
  std::memcpy(a.data(), bytes.data(), sizeof a);
  return true;
}

bool Semihosting::text(SemihostingTarget& t, std::uint32_t address, std::uint32_t bytes,
                       std::string& out) {
  if (bytes > kMaxName) return false;
  out.resize(bytes);
  return t.read(address, {reinterpret_cast<std::uint8_t*>(out.data()), bytes});
}

Semihosting::File* Semihosting::file(std::uint32_t handle) {
  if (handle == 0 || handle > open_.size()) return nullptr;
  File& f = open_[handle - 1];
  return f.kind == File::Kind::kFree ? nullptr : &f;
}

/// Number of words in the parameter block of each operation that has one.
unsigned Semihosting::words_of(std::uint32_t operation) {
  switch (operation) {
    case kClose: case kIsError: case kIsTty: case kFlen: return 1;
    case kSeek: case kRemove: case kSystem: case kGetCmdLine: case kExitExtended: return 2;
    case kOpen: case kWrite: case kRead: case kTmpNam: return 3;
    case kRename: return 4;
    default: return 0;
  }
}

std::uint32_t Semihosting::operate(SemihostingTarget& t, std::uint32_t operation,
                                   std::uint32_t parameter) {
  Arguments a{};
  const unsigned words = words_of(operation);
  if (words && !arguments(t, parameter, words, a)) return failed(EFAULT);
  switch (operation) {
    case kOpen: return open(t, a);
    case kClose: return close(a[0]);
    case kWriteC: return write_character(t, parameter);
    case kWrite0: return write_text(t, parameter);
    case kWrite: return write(t, a);
    case kRead: return read(t, a);
    case kReadC: {
      std::uint8_t c;
      return console_.read({&c, 1}) == 1 ? c : kError;
    }
    case kIsError: return static_cast<std::int32_t>(a[0]) < 0;
    case kIsTty: return is_terminal(a[0]);
    case kSeek: return seek(a);
    case kFlen: return length(a[0]);
    case kTmpNam: return temporary_name(t, a);
    case kRemove: return remove(t, a);
    case kRename: return rename(t, a);
    case kClock: return static_cast<std::uint32_t>(t.now() / (kPsPerSecond / 100));
    case kTime: return static_cast<std::uint32_t>(t.now() / kPsPerSecond);
    case kSystem:
      diagnostics_.guest("semihosting: SYS_SYSTEM is refused");
      return failed(EACCES);
    case kErrno: return static_cast<std::uint32_t>(errno_);
    case kGetCmdLine: return command_line(t, parameter, a);
    case kHeapInfo: return heap_info(t, parameter);
    case kExit:  // in 32-bit states, the only argument is the reason
      exit_code_ = parameter == kApplicationExit ? 0 : 1;
      return 0;
    case kExitExtended:
      exit_code_ = a[0] == kApplicationExit ? static_cast<int>(a[1] & 0xFFu) : 1;
      return 0;
    case kElapsed: return elapsed(t, parameter);
    case kTickFreq: return kTicksPerSecond;
    default:
      diagnostics_.not_modelled(fmt::format("semihosting operation 0x{:x}", operation));
      return failed(ENOSYS);
  }
}

std::uint32_t Semihosting::write_character(SemihostingTarget& t, std::uint32_t address) {
  std::uint8_t c;
  if (!t.read(address, {&c, 1})) return failed(EFAULT);
  return console_.write(false, {reinterpret_cast<const char*>(&c), 1}) ? 0 : failed(EIO);
}

std::uint32_t Semihosting::is_terminal(std::uint32_t handle) {
  const File* f = file(handle);
  if (!f) return failed(EBADF);
  return f->kind != File::Kind::kHost && f->kind != File::Kind::kFeatures;
}

std::uint32_t Semihosting::remove(SemihostingTarget& t, const Arguments& a) {
  std::string name;
  if (!text(t, a[0], a[1], name)) return failed(EFAULT);
  const int status = files_.remove(name);
  return status == 0 ? 0 : failed(-status);
}

std::uint32_t Semihosting::rename(SemihostingTarget& t, const Arguments& a) {
  std::string from, to;
  if (!text(t, a[0], a[1], from) || !text(t, a[2], a[3], to)) return failed(EFAULT);
  const int status = files_.rename(from, to);
  return status == 0 ? 0 : failed(-status);
}

std::uint32_t Semihosting::elapsed(SemihostingTarget& t, std::uint32_t address) {
  const std::uint64_t ticks = t.now() / (kPsPerSecond / kTicksPerSecond);
  std::array<std::uint8_t, 8> bytes;
  std::memcpy(bytes.data(), &ticks, 8);
  return t.write(address, bytes) ? 0 : failed(EFAULT);
}

std::uint32_t Semihosting::open(SemihostingTarget& t, const Arguments& a) {
  std::string name;
  if (a[2] > kMaxName) return failed(ENAMETOOLONG);
  if (!text(t, a[0], a[2], name)) return failed(EFAULT);
  const std::uint32_t mode = a[1];
  if (mode >= 2 * kModes.size()) return failed(EINVAL);
  File f;
  if (name == ":tt") {
    f.kind = mode < 4 ? File::Kind::kInput : mode < 8 ? File::Kind::kOutput : File::Kind::kError;
  } else if (name == ":semihosting-features") {
    if (mode >= 2) return failed(EACCES);
    f.kind = File::Kind::kFeatures;
  }
  const auto free = std::find_if(open_.begin(), open_.end(), [](const File& o) {
    return o.kind == File::Kind::kFree;
  });
  if (free == open_.end() && open_.size() >= kMaxFiles) return failed(EMFILE);
  if (f.kind == File::Kind::kFree) {
    f.fd = files_.open(name, kModes[mode / 2]);
    if (f.fd == -EACCES && !refused_) {
      refused_ = true;  // one warning is enough; a program may try thousands of names
      diagnostics_.guest(
          fmt::format("semihosting: the file '{}' is refused; allowed: names relative to --root, "
                      "without '..' and symbolic links",
                      one_line(name, 100)));
    }
    if (f.fd < 0) return failed(-f.fd);
    f.kind = File::Kind::kHost;
  }
  if (free != open_.end()) {
    *free = f;
    return static_cast<std::uint32_t>(free - open_.begin()) + 1;
  }
  open_.push_back(f);
  return static_cast<std::uint32_t>(open_.size());
}

std::uint32_t Semihosting::close(std::uint32_t handle) {
  File* f = file(handle);
  if (!f) return failed(EBADF);
  const int status = f->kind == File::Kind::kHost ? ::close(f->fd) : 0;
  *f = {};
  return status == 0 ? 0 : failed(errno);
}

std::int64_t Semihosting::put(File& f, std::span<const std::uint8_t> bytes) {
  switch (f.kind) {
    case File::Kind::kOutput:
    case File::Kind::kError:
      return console_.write(f.kind == File::Kind::kError,
                            {reinterpret_cast<const char*>(bytes.data()), bytes.size()})
                 ? static_cast<std::int64_t>(bytes.size())
                 : -EIO;
    case File::Kind::kHost: {
      ssize_t n;
      do n = ::write(f.fd, bytes.data(), bytes.size());
      while (n < 0 && errno == EINTR);
      return n < 0 ? -errno : n;
    }
    default: return -EBADF;
  }
}

std::int64_t Semihosting::get(File& f, std::span<std::uint8_t> bytes) {
  switch (f.kind) {
    case File::Kind::kInput: return static_cast<std::int64_t>(console_.read(bytes));
    case File::Kind::kFeatures: {
      const std::size_t n = std::min(bytes.size(), kFeatureBytes.size() - f.at);
      std::memcpy(bytes.data(), kFeatureBytes.data() + f.at, n);
      f.at += static_cast<std::uint32_t>(n);
      return static_cast<std::int64_t>(n);
    }
    case File::Kind::kHost: {
      ssize_t n;
      do n = ::read(f.fd, bytes.data(), bytes.size());
      while (n < 0 && errno == EINTR);
      return n < 0 ? -errno : n;
    }
    default: return -EBADF;
  }
}

/// @return number of bytes that were not written
std::uint32_t Semihosting::write(SemihostingTarget& t, const Arguments& a) {
  File* f = file(a[0]);
  if (!f) return failed(EBADF), a[2];
  std::array<std::uint8_t, kChunk> chunk;
  for (std::uint32_t done = 0; done < a[2];) {
    const auto piece = std::span(chunk).first(std::min<std::size_t>(a[2] - done, kChunk));
    if (!t.read(a[1] + done, piece)) return failed(EFAULT), a[2] - done;
    const std::int64_t n = put(*f, piece);
    if (n < 0) return failed(static_cast<int>(-n)), a[2] - done;
    done += static_cast<std::uint32_t>(n);
  }
  return 0;
}

/// @return number of bytes that were not read; all of them at the end of the file
std::uint32_t Semihosting::read(SemihostingTarget& t, const Arguments& a) {
  File* f = file(a[0]);
  if (!f) return failed(EBADF), kError;
  std::array<std::uint8_t, kChunk> chunk;
  std::uint32_t done = 0;
  while (done < a[2]) {
    const auto piece = std::span(chunk).first(std::min<std::size_t>(a[2] - done, kChunk));
    const std::int64_t n = get(*f, piece);
    if (n < 0) return failed(static_cast<int>(-n));
    if (n > 0 && !t.write(a[1] + done, piece.first(static_cast<std::size_t>(n))))
      return failed(EFAULT);
    done += static_cast<std::uint32_t>(n);
    // The console returns what was typed; another call would wait for more.
    if (n == 0 || f->kind == File::Kind::kInput) break;
  }
  return a[2] - done;
}

std::uint32_t Semihosting::seek(const Arguments& a) {
  File* f = file(a[0]);
  if (!f) return failed(EBADF);
  if (f->kind == File::Kind::kFeatures) {
    if (a[1] > kFeatureBytes.size()) return failed(EINVAL);
    f->at = a[1];
    return 0;
  }
  if (f->kind != File::Kind::kHost) return failed(ESPIPE);
  return ::lseek(f->fd, static_cast<off_t>(a[1]), SEEK_SET) < 0 ? failed(errno) : 0;
}

std::uint32_t Semihosting::length(std::uint32_t handle) {
  File* f = file(handle);
  if (!f) return failed(EBADF);
  if (f->kind == File::Kind::kFeatures) return static_cast<std::uint32_t>(kFeatureBytes.size());
  if (f->kind != File::Kind::kHost) return failed(EINVAL);
  struct stat s {};
  if (::fstat(f->fd, &s) != 0) return failed(errno);
  return s.st_size > INT32_MAX ? failed(EOVERFLOW) : static_cast<std::uint32_t>(s.st_size);
}

std::uint32_t Semihosting::temporary_name(SemihostingTarget& t, const Arguments& a) {
  if (a[1] > 255) return failed(EINVAL);
  const std::string name = fmt::format("guest{:03}.tmp", a[1]);
  if (name.size() + 1 > a[2]) return failed(EINVAL);
  return t.write(a[0], {reinterpret_cast<const std::uint8_t*>(name.c_str()), name.size() + 1})
             ? 0
             : failed(EFAULT);
}

std::uint32_t Semihosting::command_line(SemihostingTarget& t, std::uint32_t block,
                                        const Arguments& a) {
  const std::string& line = settings_.command_line;
  if (line.size() + 1 > a[1]) {
    diagnostics_.guest(fmt::format("semihosting: a command line of {} bytes does not fit into the program's {}",
                                   line.size() + 1, a[1]));
    return failed(E2BIG);
  }
  const auto length = static_cast<std::uint32_t>(line.size());
  std::array<std::uint8_t, 4> word;
  std::memcpy(word.data(), &length, 4);
  const bool ok =
      t.write(a[0], {reinterpret_cast<const std::uint8_t*>(line.c_str()), line.size() + 1}) &&
      t.write(block + 4, word);
  return ok ? 0 : failed(EFAULT);
}

std::uint32_t Semihosting::heap_info(SemihostingTarget& t, std::uint32_t parameter) {
  Arguments a{};
  if (!arguments(t, parameter, 1, a)) return failed(EFAULT);
  const Arguments answer = {settings_.heap_base, settings_.heap_limit, settings_.stack_base,
                            settings_.stack_limit};
  std::array<std::uint8_t, 16> bytes;
  std::memcpy(bytes.data(), answer.data(), 16);
  return t.write(a[0], bytes) ? 0 : failed(EFAULT);
}

std::uint32_t Semihosting::write_text(SemihostingTarget& t, std::uint32_t address) {
  std::string line;
  for (std::uint8_t c;; ++address) {
    if (!t.read(address, {&c, 1})) return failed(EFAULT);
    if (c != 0) line += static_cast<char>(c);
    if (c == 0 || line.size() == kChunk) {
      if (!console_.write(false, line)) return failed(EIO);
      line.clear();
    }
    if (c == 0) return 0;
  }
}

std::string guest_command_line(std::span<const std::string> arguments) {
  std::string line;
  for (const auto& a : arguments) {
    const bool quote = a.empty() || a.find_first_of(" \t\n'\"") != std::string::npos;
    const char mark = a.find('"') == std::string::npos ? '"' : '\'';
    if (quote && (a.empty() || a.find(mark) != std::string::npos))
      throw UserError(fmt::format(
          "argument '{}': newlib's start-up code cannot split it off; allowed: not empty, and not "
          "both kinds of quotes",
          one_line(a)));
    if (!line.empty()) line += ' ';
    line += quote ? mark + a + mark : a;
  }
  return line;
}

}  // namespace fovea::app
