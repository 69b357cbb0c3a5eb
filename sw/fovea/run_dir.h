// The folder that a command leaves: whole under its name, or unfinished under NAME.tmp.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/checked_file.h"
#include "sw/fovea/run_files.h"

namespace fovea::app {

/// Files of a run go to `DIR.tmp`; commit() renames it to `DIR`, in place of an earlier result if
/// there is one. What must not be lost is not:
/// - Files that Fovea does not write are never removed: a folder that holds one is refused, before
///   the run and again after it.
/// - Results of one command are not replaced by those of another.
/// - Complete results are replaced by complete ones only; partial ones go to `DIR.partial`.
/// Without commit() (an error, a broken invariant) `DIR.tmp` is removed and `DIR` is as it was;
/// after a crash `DIR.tmp` stays, until the next run into `DIR`.
class RunDir {
 public:
  /// Creates `DIR.tmp`, which only its owner may enter until it is whole. A `DIR.tmp` left by an
  /// earlier run of the same user is emptied. `command`: "run", "replay" or "exec", which
  /// host.json names first.
  /// @throws UserError: not writable, not ours, or another run is writing it now
  RunDir(const std::filesystem::path& dir, std::string_view command);
  ~RunDir();
  RunDir(const RunDir&) = delete;
  RunDir& operator=(const RunDir&) = delete;

  /// Full name of a file of the run; valid until commit(). A name that is_run_file() does not know
  /// is a defect.
  std::filesystem::path file(std::string_view name) const;
  /// Where the files are now: DIR.tmp, after commit() DIR or DIR.partial.
  const std::filesystem::path& folder() const { return committed_ ? placed_ : working_; }
  /// True if a file of this name would lie in the folder itself.
  bool covers(const std::filesystem::path& name) const;
  /// Writes a file of the run, or writes it anew. @throws UserError
  void write(std::string_view name, std::string_view text);
  /// Opens a new file of the run that is written as the run goes on. @throws UserError
  std::unique_ptr<CheckedFile> create(std::string_view name);
  /// Makes a folder of numbered files ("frames"). @return its descriptor, open until the end
  int make_folder(std::string_view name);

  /// Everything is written, to the disk itself, and gets its final name.
  /// @return one sentence about earlier results, for the user; empty if there were none
  /// @throws UserError if DIR was changed during the run; it says where the results are then
  std::string commit(bool complete);

 private:
  void take_working();
  void abandon();
  void set_remove(bool remove);
  /// Why an existing folder cannot be replaced by results of this command; empty: it can.
  std::string obstacle(const RunFolder& found) const;
  void sync() const;
  std::string replace(const std::filesystem::path& target);
  std::filesystem::path put_beside(std::string_view suffix);

  std::filesystem::path final_, working_, placed_;
  std::string command_;
  mode_t mode_ = 0;  ///< of the finished folder
  int lock_ = -1;
  std::vector<int> folders_;
  bool committed_ = false;
  bool remove_ = false;  ///< DIR.tmp is ours, and nobody needs what is in it
};

}  // namespace fovea::app
