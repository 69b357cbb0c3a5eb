// A file writer that reports every failure: the only way the host program writes files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace fovea::app {

/// Buffered output file. A short write, a full disk or a failed close is a UserError of one line
/// that names the file and the reason, never a silent loss.
class CheckedFile {
 public:
  /// Creates or truncates `path`. @throws UserError when it cannot be opened
  explicit CheckedFile(std::filesystem::path path);
  /// Creates the file in the open folder `folder`, by the last part of `path`; the rest of it is
  /// for messages. It must not exist yet either. @throws UserError
  CheckedFile(std::filesystem::path path, int folder);
  /// Creates a file that must not exist yet, not even as a symbolic link. @throws UserError
  struct New {};
  CheckedFile(std::filesystem::path path, New);
  /// Closes without reporting: a caller that cares has called close().
  ~CheckedFile();
  CheckedFile(const CheckedFile&) = delete;
  CheckedFile& operator=(const CheckedFile&) = delete;

  void write(std::string_view text);
  void write(std::span<const std::uint8_t> bytes);
  /// Flushes and closes. @throws UserError if the last bytes did not reach the file
  void close();
  /// Has everything written to the disk itself. @throws UserError
  void sync();
  /// Keeps others that ask for a lock away until the file is closed.
  void lock();
  const std::filesystem::path& path() const { return path_; }

 private:
  void flush();
  void put(const char* data, std::size_t size);
  [[noreturn]] void fail(int error);
  std::filesystem::path path_;
  std::string buffer_;
  int fd_ = -1;
};

/// Writes the whole file in one go. @throws UserError as CheckedFile
void write_file(const std::filesystem::path& path, std::string_view text);
void write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

/// Reads a whole regular file of at most `max_bytes`. @throws UserError naming the file
std::string read_file(const std::filesystem::path& path, std::size_t max_bytes);

/// `text` with every control character but the line's end written as an escape, so that text from a
/// file or from the guest cannot drive the terminal.
std::string printable(std::string_view text);

/// `text` on one line: control characters are written as escapes, and at most `max_chars` of it.
std::string one_line(std::string_view text, std::size_t max_chars = 400);

}  // namespace fovea::app
