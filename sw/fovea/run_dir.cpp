#include "sw/fovea/run_dir.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "model/common/check.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxConfigBytes = 16u << 20;

std::string quoted(const fs::path& path) { return "'" + one_line(path.string()) + "'"; }

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw UserError(fmt::format("output folder {}: {}", quoted(path), why));
}

/// A folder that a run created and left before it wrote config.json.
bool is_empty_start(const fs::path& dir) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(dir, error)) {
    if (entry.path().filename() != "frames") return false;
    if (!entry.is_directory() || !fs::is_empty(entry.path())) return false;
  }
  return !error;
}

/// Folders to be removed also when the program ends without destructors: at a broken invariant
/// (FOVEA_CHECK).
std::vector<fs::path>& abandoned_at_exit() {
  static std::vector<fs::path> folders;
  [[maybe_unused]] static const int registered = std::at_quick_exit([] {
    std::error_code ignored;
    for (const fs::path& folder : abandoned_at_exit()) fs::remove_all(folder, ignored);
  });
  return folders;
}

}  // namespace

bool is_run_folder(const fs::path& dir) {
  try {
    const auto config =
        nlohmann::json::parse(read_file(dir / "config.json", kMaxConfigBytes), nullptr, false);
    return config.is_object() && config.contains("format") && config["format"] == kRunFormat;
  } catch (const UserError&) {
    return false;
  }
}

RunDir::RunDir(const fs::path& dir) {
  if (dir.empty()) throw UserError("output folder '': a name is needed");
  std::error_code error;
  // Resolves symbolic links, "." and a trailing slash: DIR.tmp must be a neighbour of the real DIR.
  final_ = fs::weakly_canonical(fs::absolute(dir), error);
  if (error) fail(dir, error.message());
  if (!final_.has_filename()) final_ = final_.parent_path();
  if (!final_.has_filename()) fail(dir, "a name is needed");
  working_ = final_;
  working_ += ".tmp";

  if (fs::exists(fs::symlink_status(final_, error)) && !is_run_folder(final_) &&
      !(fs::is_directory(final_, error) && is_empty_start(final_)))
    fail(dir, "it exists and is not the folder of a Fovea run; choose another name or remove it");

  fs::create_directories(final_.parent_path(), error);
  if (error) fail(dir, error.message());
  if (::mkdir(working_.c_str(), 0777) != 0 && errno != EEXIST) fail(working_, std::strerror(errno));
  lock_ = ::open(working_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (lock_ < 0) fail(working_, std::strerror(errno));
  try {
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) fail(working_, "another run is writing it");
    if (!is_run_folder(working_) && !is_empty_start(working_))
      fail(working_, "it exists and is not left by a Fovea run; remove it or choose another name");
    set_remove(true);
    for (const auto& entry : fs::directory_iterator(working_)) fs::remove_all(entry.path());
    if (::mkdir(frames().c_str(), 0777) != 0) fail(frames(), std::strerror(errno));
    // A folder may exist on a full or read-only file system: a file is the proof.
    write_file(frames() / ".probe", "x");
    fs::remove(frames() / ".probe");
  } catch (const fs::filesystem_error& e) {
    abandon();
    fail(working_, e.code().message());
  } catch (...) {
    abandon();
    throw;
  }
}

RunDir::~RunDir() { abandon(); }

void RunDir::set_remove(bool remove) {
  remove_ = remove;
  auto& folders = abandoned_at_exit();
  std::erase(folders, working_);
  if (remove) folders.push_back(working_);
}

/// Removed under the lock: no other run can have begun in it.
void RunDir::abandon() {
  std::error_code ignored;
  if (remove_) {
    set_remove(false);
    fs::remove_all(working_, ignored);
  }
  if (lock_ >= 0) ::close(lock_);
}

void RunDir::commit() {
  FOVEA_CHECK(!committed_, "run folder committed twice");
  set_remove(false);
  std::error_code error;
  const bool replace = fs::exists(fs::symlink_status(final_, error));
  if (replace && !is_run_folder(final_) && !is_empty_start(final_))
    fail(final_,
         fmt::format("it was changed during the run; the results are in {}", quoted(working_)));
  if (replace) {
    // One step: at no time is there neither the old result nor the new one.
    if (::renameat2(AT_FDCWD, working_.c_str(), AT_FDCWD, final_.c_str(), RENAME_EXCHANGE) == 0) {
      fs::remove_all(working_, error);
      if (error) fail(working_, "the previous run cannot be removed: " + error.message());
      committed_ = true;
      return;
    }
    // File systems without exchange: the old result goes first.
    fs::remove_all(final_, error);
    if (error) fail(final_, error.message());
  }
  if (::rename(working_.c_str(), final_.c_str()) != 0) fail(final_, std::strerror(errno));
  committed_ = true;
}

}  // namespace fovea::app
