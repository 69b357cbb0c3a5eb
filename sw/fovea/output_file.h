// A single file of results under a name that the user gave.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "sw/fovea/checked_file.h"

namespace fovea::app {

/// A file that is whole under its name or not there: it is written as NAME.tmp and renamed when it
/// is complete; an earlier one stays until then. Only a file of the same kind, or an empty one, is
/// ever replaced, and no symbolic link is followed. A device or a pipe is written directly.
class OutputFile {
 public:
  /// Opens the file, so that a name that cannot be used shows at once. `is_ours` looks at the first
  /// kilobytes of an earlier file; `option` and `kind` ("--bus-trace", "a bus trace") are for
  /// messages.
  /// @throws UserError
  OutputFile(const std::filesystem::path& name, std::string_view option, std::string_view kind,
             const std::function<bool(std::string_view)>& is_ours);
  /// Removes NAME.tmp if commit() was not called.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes) { file_->write(bytes); }
  /// Puts the complete file in place. @throws UserError
  void commit();

 private:
  std::filesystem::path name_, working_;
  std::optional<CheckedFile> file_;
  bool device_ = false, committed_ = false;
};

}  // namespace fovea::app
