// A file writer that reports every failure. The host program writes all its files with it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace fovea::app {

/// Buffered output file. A short write, a full disk or a failed close causes a UserError of one
/// line with the name of the file and the reason; data are never lost silently.
class CheckedFile {
 public:
  /// Creates a new file in the open folder `folder`. Its name is the last component of `path`; the
  /// rest is used in messages. The file must not exist, not even as a symbolic link. @throws UserError
  CheckedFile(std::filesystem::path path, int folder);
  /// The same with the folder that `path` names.
  struct New {};
  CheckedFile(std::filesystem::path path, New);
  /// Writes to the open descriptor `fd`, and closes it. `path` is for messages.
  struct Open {
    int fd;
  };
  CheckedFile(std::filesystem::path path, Open open);
  /// Closes without reporting errors; call close() first to have them reported.
  ~CheckedFile();
  CheckedFile(const CheckedFile&) = delete;
  CheckedFile& operator=(const CheckedFile&) = delete;

  void write(std::string_view text);
  void write(std::span<const std::uint8_t> bytes);
  /// Flushes and closes. @throws UserError if the last bytes could not be written
  void close();
  /// Makes sure that everything written has reached the disk. @throws UserError
  void sync();
  const std::filesystem::path& path() const { return path_; }

 private:
  void flush();
  void put(const char* data, std::size_t size);
  [[noreturn]] void fail(int error);
  std::filesystem::path path_;
  std::string buffer_;
  int fd_ = -1;
};

/// Upper limit of the size of an experiment or a calibration, in bytes.
inline constexpr std::size_t kMaxSettingsBytes = 1u << 20;

/// Reads a whole regular file of at most `max_bytes`. @throws UserError that names the file
std::string read_file(const std::filesystem::path& path, std::size_t max_bytes);

/// `text` with every control character except the line feed, and every byte that is not UTF-8, written as an escape, so
/// that text from a file or from the guest cannot control the terminal or spoil a page.
std::string printable(std::string_view text);

/// `text` on one line: control characters and bytes that are not UTF-8 become escapes, and it is cut after `max_chars`
/// bytes, behind a whole character.
std::string one_line(std::string_view text, std::size_t max_chars = 400);

}  // namespace fovea::app
