// The folder that keeps the results of points, each complete or not there.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/points/point.h"

namespace fovea::points {

/// DIR holds `points.json`, which says whose it is, and `points/NAME/` for each finished point:
/// `point.json` (key, command line, status, message), `messages.txt`, `output.txt` and the folder
/// `run/` of the run. A point is written as `NAME.tmp` and renamed when it has ended, so a folder
/// without the suffix is a whole result.
///
/// Whatever moment a process ends at, the next one goes on: what is unfinished is removed.
class PointStore {
 public:
  /// Creates the folder or continues in it, and locks it against other processes.
  /// @throws UserError: it is not writable, in use, of another user, or holds something else
  explicit PointStore(const std::filesystem::path& dir);
  ~PointStore();
  PointStore(const PointStore&) = delete;
  PointStore& operator=(const PointStore&) = delete;

  const std::filesystem::path& dir() const { return dir_; }
  /// Puts a file with the answers to a question into the folder, in the place of an earlier one. @throws UserError
  void write(std::string_view name, std::string_view text);
  std::filesystem::path folder(std::string_view key) const;
  /// The result of an earlier call, if there is one. @throws UserError if it cannot be read
  std::optional<PointResult> find(std::string_view key) const;
  /// An empty folder for a point that is about to run; what an interrupted one left is removed.
  std::filesystem::path begin(std::string_view key);
  /// Notes how the point of begin() ended, and gives the folder its name.
  void finish(PointResult& result, const std::vector<std::string>& command);
  /// Removes the folder of begin().
  void abandon(std::string_view key);
  /// Removes a finished point, so that it can run again.
  void forget(std::string_view key);

 private:
  void open();
  std::filesystem::path working(std::string_view key) const;
  std::filesystem::path dir_;
  int lock_ = -1;    ///< of the folder
  int points_ = -1;  ///< of its `points`
};

}  // namespace fovea::points
