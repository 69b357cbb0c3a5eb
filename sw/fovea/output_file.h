// A single file of results with a name that the user gave.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "sw/fovea/checked_file.h"

namespace fovea::app {

/// The file appears under its name only when it is complete: it is written as NAME.tmp and then
/// renamed; an earlier file is kept until then. Only an empty file or one of the same kind is
/// replaced, and symbolic links are not followed. A device or a pipe is written directly.
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
  /// Gives the complete file its name. @throws UserError
  void commit();

 private:
  std::filesystem::path name_, working_;
  std::optional<CheckedFile> file_;
  bool device_ = false, committed_ = false;
};

}  // namespace fovea::app
