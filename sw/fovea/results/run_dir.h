// The folder of results of a command: complete under its name, or unfinished under NAME.tmp.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "sw/fovea/files/output_folder.h"
#include "sw/fovea/results/run_files.h"

namespace fovea::app {

/// Files of a run are written to `DIR.tmp`; commit() renames it to `DIR` and replaces an earlier
/// result. The following is never lost:
/// - Files that Fovea does not write are never removed: a folder with such files is refused, before
///   the run and again after it.
/// - Results of one command are not replaced by those of another, nor those of one user by another's.
/// - Complete results are replaced only by complete ones; partial ones go to `DIR.partial`.
/// Without commit() (an error, a broken invariant), `DIR.tmp` is removed and `DIR` stays unchanged.
/// After a crash, `DIR.tmp` remains until the next run into `DIR`.
class RunDir {
 public:
  /// Creates `DIR.tmp`, which only its owner may enter until it is complete. A `DIR.tmp` left by an
  /// earlier run of the same user is emptied. `command` is "run", "replay" or "exec", which
  /// host.json names first. @throws UserError: not writable, not Fovea's, or another run is writing
  /// it now
  RunDir(const std::filesystem::path& dir, std::string_view command);

  /// Full name of a file of the run; valid until commit(). Names that is_run_file() does not know
  /// are a defect.
  std::filesystem::path file(std::string_view name) const;
  /// The folder of the files now: DIR.tmp, after commit() DIR or DIR.partial.
  const std::filesystem::path& folder() const { return committed_ ? placed_ : files_->working(); }
  /// True if a file of this name would be in the folder.
  bool covers(const std::filesystem::path& name) const;
  /// Writes or replaces a file of the run. @throws UserError
  void write(std::string_view name, std::string_view text);
  /// Creates a file that is written during the run. @throws UserError
  std::unique_ptr<CheckedFile> create(std::string_view name);
  /// Creates a folder for numbered files ("frames"). @return its descriptor, open until the end
  int make_folder(std::string_view name);

  /// Makes sure that everything is on the disk, and gives the folder its final name.
  /// @return a sentence about earlier results for the user; empty if there were none
  /// @throws UserError if DIR was changed during the run; the message says where the results are
  std::string commit(bool complete);

 private:
  /// Why an existing folder cannot be replaced by results of this command; empty if it can.
  std::string obstacle(const RunFolder& found) const;
  std::string replace(const std::filesystem::path& target);
  std::filesystem::path put_beside(std::string_view suffix);

  std::filesystem::path final_, placed_;
  std::string command_;
  std::optional<OutputFolder> files_;
  bool committed_ = false;
};

}  // namespace fovea::app
