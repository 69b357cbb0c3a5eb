#include "sw/fovea/files/checked_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "model/common/check.h"

namespace fovea::app {
namespace {
constexpr std::size_t kBufferBytes = 64 * 1024;

/// Closes a descriptor at the end of its scope.
struct OpenFile {
  int fd;
  ~OpenFile() {
    if (fd >= 0) ::close(fd);
  }
};

/// Bytes of the character that begins at byte i, if it is one of UTF-8 (RFC 3629) that controls no terminal: no C0, DEL
/// or C1 (U+0080 to U+009F), which some terminals interpret too. Otherwise 0.
std::size_t harmless(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0u; };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7F;
  const std::size_t size = first >= 0xC2 && first < 0xE0   ? 2
                           : (first & 0xF0) == 0xE0        ? 3
                           : first >= 0xF0 && first < 0xF5 ? 4
                                                           : 0;
  for (std::size_t k = 1; k < size; ++k)
    if ((byte(k) & 0xC0) != 0x80) return 0;
  const bool longer_than_needed = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool no_character = (first == 0xED && byte(1) >= 0xA0) || (first == 0xF4 && byte(1) >= 0x90);
  const bool c1 = first == 0xC2 && byte(1) < 0xA0;
  return longer_than_needed || no_character || c1 ? 0 : size;
}

/// Appends the character at byte i, or its first byte as an escape. @return bytes of `text` used
std::size_t append_printable(std::string& out, std::string_view text, std::size_t i) {
  const std::size_t size = harmless(text, i);
  if (size == 0) {
    out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i]));
    return 1;
  }
  out += text.substr(i, size);
  return size;
}
}  // namespace

CheckedFile::CheckedFile(std::filesystem::path path, int folder) : path_(std::move(path)) {
  fd_ = ::openat(folder, path_.filename().c_str(),
                 O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (fd_ < 0) fail(errno);
}

CheckedFile::CheckedFile(std::filesystem::path path, New) : path_(std::move(path)) {
  fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (fd_ < 0) fail(errno);
}

CheckedFile::CheckedFile(std::filesystem::path path, Open open) : path_(std::move(path)), fd_(open.fd) {}

CheckedFile::~CheckedFile() {
  if (fd_ >= 0) ::close(fd_);
}

void CheckedFile::write(std::string_view text) {
  FOVEA_CHECK(fd_ >= 0, "write to the closed file " + path_.string());
  if (buffer_.size() + text.size() > kBufferBytes) flush();
  if (text.size() >= kBufferBytes)
    put(text.data(), text.size());
  else
    buffer_ += text;
}

void CheckedFile::write(std::span<const std::uint8_t> bytes) {
  write(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void CheckedFile::close() {
  if (fd_ < 0) return;
  flush();
  // Network file systems may report a full disk only at this point.
  const int fd = std::exchange(fd_, -1);
  if (::close(fd) != 0) fail(errno);
}

void CheckedFile::sync() {
  flush();
  // fsync() fails with EINVAL on file systems that do not support it.
  if (::fsync(fd_) != 0 && errno != EINVAL && errno != EROFS) fail(errno);
}

void CheckedFile::flush() {
  put(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void CheckedFile::put(const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t n = ::write(fd_, data, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail(n < 0 ? errno : ENOSPC);
    data += n;
    size -= static_cast<std::size_t>(n);
  }
}

void CheckedFile::fail(int error) {
  buffer_.clear();
  throw UserError(
      fmt::format("cannot write '{}': {}", one_line(path_.string()), std::strerror(error)));
}

std::string read_file(const std::filesystem::path& path, std::size_t max_bytes) {
  const auto fail = [&](const std::string& why) {
    throw UserError(fmt::format("cannot read '{}': {}", one_line(path.string()), why));
  };
  // O_NONBLOCK: opening a pipe without a writer must not block before the check below.
  const OpenFile file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (file.fd < 0) fail(std::strerror(errno));
  struct stat info {};
  if (::fstat(file.fd, &info) != 0) fail(std::strerror(errno));
  if (S_ISDIR(info.st_mode)) fail("it is a folder; a file is needed");
  if (!S_ISREG(info.st_mode)) fail("it is not a regular file");
  const std::string limit = fmt::format("it is larger than the {} bytes allowed", max_bytes);
  if (static_cast<std::uint64_t>(info.st_size) > max_bytes) fail(limit);
  std::string text(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::read(file.fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(std::strerror(errno));
    if (n == 0) break;
    done += static_cast<std::size_t>(n);
  }
  text.resize(done);
  return text;
}

std::string one_line(std::string_view text, std::size_t max_chars) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    if (out.size() >= max_chars) return out + "...";
    if (text[i] == '\n' || text[i] == '\t')
      out += text[i++] == '\n' ? "\\n" : " ";
    else
      i += append_printable(out, text, i);
  }
  return out;
}

std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '\n')
      out += text[i++];
    else
      i += append_printable(out, text, i);
  }
  return out;
}

}  // namespace fovea::app
