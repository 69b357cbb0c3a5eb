// A single file with a name that the user gave.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "sw/fovea/files/checked_file.h"

namespace fovea::app {

/// The file appears under its name only when it is complete: it is written as NAME.tmp and then
/// renamed; an earlier file is kept until then. Only an empty file or one of the same kind is
/// replaced, and symbolic links are not followed. A device or a pipe is written directly.
/// NAME.tmp is locked as long as the object exists: a process that constructs the object, and then
/// reads NAME, changes it and commits it, does all of that alone. A NAME.tmp that a crash left is
/// taken over.
class OutputFile {
 public:
  /// Opens the file, so that an unusable name is reported at once. `is_ours` checks the first
  /// kilobytes of an existing file; `option` and `kind` ("--bus-trace", "a bus trace") are used in
  /// messages. @throws UserError
  OutputFile(const std::filesystem::path& name, std::string_view option, std::string_view kind,
             const std::function<bool(std::string_view)>& is_ours);
  /// Removes NAME.tmp unless commit() was called.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes) { file_->write(bytes); }
  /// Makes sure that what was written is on the disk, so that hardly anything is left that may fail. @throws UserError
  void sync() { file_->sync(); }
  /// Gives the complete file its name. @throws UserError
  void commit();

 private:
  struct Place {
    std::filesystem::path name;  ///< for messages
    std::string option, kind;
    const std::function<bool(std::string_view)>& is_ours;
    [[noreturn]] void refuse(const std::string& why) const;
  };
  void take_working(const Place& place);
  bool is_still_ours() const;
  [[noreturn]] void fail(int error) const;

  std::filesystem::path name_, working_;
  int folder_ = -1;  ///< in which both lie; -1: the name is a device's
  std::optional<CheckedFile> file_;
  int fd_ = -1;  ///< of `file_`
  bool committed_ = false;
};

/// Puts `text` at once in the place of a file, or of a link, in the open folder `folder`. Its name is the last part of
/// `path`; the rest is for messages. For folders of Fovea's that this process has locked. @throws UserError
void replace_file(int folder, const std::filesystem::path& path, std::string_view text);

}  // namespace fovea::app
