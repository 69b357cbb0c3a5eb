// The folder that a run leaves: complete under its name, or unfinished under NAME.tmp.
#pragma once
#include <filesystem>
#include <span>
#include <string_view>

#include "sw/fovea/checked_file.h"

namespace fovea::app {

/// Files of a run go to `DIR.tmp`; commit() renames it to `DIR`. An existing `DIR` is replaced if
/// it is a Fovea run folder (its config.json says so), at the moment of commit() and not before;
/// anything else is refused. Without commit() (an error, a broken invariant) `DIR.tmp` is removed
/// and `DIR` is as it was; after a crash `DIR.tmp` stays, until the next run into `DIR`.
class RunDir {
 public:
  /// Creates `DIR.tmp` and `DIR.tmp/frames`, so that an output that cannot be written shows before
  /// the simulation starts. A `DIR.tmp` left by an earlier run is emptied.
  /// @throws UserError: not writable, not ours, or another run is writing it now
  explicit RunDir(const std::filesystem::path& dir);
  ~RunDir();
  RunDir(const RunDir&) = delete;
  RunDir& operator=(const RunDir&) = delete;

  /// Full name of a file of the run; valid until commit().
  std::filesystem::path file(std::string_view name) const { return working_ / name; }
  std::filesystem::path frames() const { return working_ / "frames"; }
  /// Where the files are now: DIR.tmp, after commit() DIR.
  const std::filesystem::path& folder() const { return committed_ ? final_ : working_; }
  void write(std::string_view name, std::string_view text) { write_file(file(name), text); }
  /// Renames DIR.tmp to DIR. @throws UserError; the results are then in DIR.tmp, which stays
  void commit();

 private:
  void abandon();
  void set_remove(bool remove);
  std::filesystem::path final_, working_;
  int lock_ = -1;
  bool committed_ = false;
  bool remove_ = false;  ///< DIR.tmp is ours, and nobody needs what is in it
};

/// What config.json of a run folder has under "format".
inline constexpr std::string_view kRunFormat = "fovea run 1";

/// True if `dir` holds a config.json written by Fovea.
bool is_run_folder(const std::filesystem::path& dir);

}  // namespace fovea::app
