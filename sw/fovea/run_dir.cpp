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

#include "model/common/check.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

std::string in_quotes(const fs::path& path) { return "'" + one_line(path.string()) + "'"; }

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw UserError(fmt::format("output folder {}: {}", in_quotes(path), why));
}

fs::path with_suffix(const fs::path& path, std::string_view suffix) {
  fs::path out = path;
  out += suffix;
  return out;
}

/// Folders to be removed when the program ends without destructors, at a broken invariant
/// (FOVEA_CHECK).
std::vector<fs::path>& abandoned_at_exit() {
  static std::vector<fs::path> folders;
  [[maybe_unused]] static const int registered = std::at_quick_exit([] {
    for (const fs::path& folder : abandoned_at_exit()) remove_run_files(folder);
  });
  return folders;
}

mode_t umask_now() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return mask;
}

/// fsync() fails with EINVAL on file systems that do not support it.
void sync_to_disk(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) fail(path, std::strerror(errno));
  const int error = ::fsync(fd) == 0 ? 0 : errno;
  ::close(fd);
  if (error != 0 && error != EINVAL && error != EROFS) fail(path, std::strerror(error));
}

}  // namespace

RunDir::RunDir(const fs::path& dir, std::string_view command) : command_(command) {
  if (dir.empty()) throw UserError("output folder '': a name is needed");
  std::error_code error;
  // Resolves symbolic links, "." and a trailing slash, so that DIR.tmp is in the same folder as
  // DIR.
  final_ = fs::weakly_canonical(fs::absolute(dir), error);
  if (error) fail(dir, error.message());
  if (!final_.has_filename()) final_ = final_.parent_path();
  if (!final_.has_filename()) fail(dir, "a name is needed");
  working_ = with_suffix(final_, ".tmp");

  const std::string why = obstacle(inspect_run_folder(final_));
  if (!why.empty()) fail(dir, why + "; choose another name, or move it away");
  fs::create_directories(final_.parent_path(), error);
  if (error) fail(dir, error.message());
  try {
    take_working();
  } catch (...) {
    abandon();
    throw;
  }
}

std::string RunDir::obstacle(const RunFolder& found) const {
  if (!found.exists || found.vacant) return "";
  if (!found.ours) return "it exists and is not the folder of a Fovea run";
  if (!found.foreign.empty())
    return fmt::format("it holds {}, which is not a file of a Fovea run", in_quotes(found.foreign));
  if (!found.command.empty() && found.command != command_)
    return fmt::format("it holds {}, of 'fovea {}'", found.results(), one_line(found.command));
  return "";
}

void RunDir::take_working() {
  const bool made = ::mkdir(working_.c_str(), 0700) == 0;
  if (!made && errno != EEXIST) fail(working_, std::strerror(errno));
  lock_ = ::open(working_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (lock_ < 0) fail(working_, std::strerror(errno));
  struct stat mine {};
  struct stat there {};
  if (::fstat(lock_, &mine) != 0) fail(working_, std::strerror(errno));
  if (mine.st_uid != ::geteuid())
    fail(working_, "it belongs to another user; choose another name or remove it");
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) fail(working_, "another run is writing it");
  // The run that used it may just have renamed it to DIR.
  if (::lstat(working_.c_str(), &there) != 0 || there.st_ino != mine.st_ino ||
      there.st_dev != mine.st_dev)
    fail(working_, "another run is writing it");
  const RunFolder found = inspect_run_folder(working_);
  if (!found.vacant && !found.ours)
    fail(working_, "it exists and is not left by a Fovea run; remove it or choose another name");
  if (!found.foreign.empty())
    fail(working_, fmt::format("it holds {}, which is not a file of a Fovea run; move it away",
                               in_quotes(found.foreign)));
  // Only the owner may enter, so that nobody can place links in the folder while the run writes.
  mode_ = (0777 & ~umask_now()) | (mine.st_mode & S_ISGID);
  if (!made && ::fchmod(lock_, 0700) != 0) fail(working_, std::strerror(errno));
  set_remove(true);
  if (!remove_run_files(working_, true))
    fail(working_, "what an earlier run left cannot be removed");
}

RunDir::~RunDir() { abandon(); }

void RunDir::set_remove(bool remove) {
  remove_ = remove;
  auto& folders = abandoned_at_exit();
  std::erase(folders, working_);
  if (remove) folders.push_back(working_);
}

/// Removes the folder while it is locked, so that no other run can have started in it.
void RunDir::abandon() {
  if (remove_) {
    set_remove(false);
    remove_run_files(working_);
  }
  for (const int fd : folders_) ::close(fd);
  folders_.clear();
  if (lock_ >= 0) ::close(lock_);
  lock_ = -1;
}

fs::path RunDir::file(std::string_view name) const {
  FOVEA_CHECK(is_run_file(name), "run_files.cpp does not list the file " + std::string(name));
  return working_ / name;
}

bool RunDir::covers(const fs::path& name) const {
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(fs::absolute(name), error).parent_path();
  return !error && (folder == final_ || folder == working_);
}

std::unique_ptr<CheckedFile> RunDir::create(std::string_view name) {
  const fs::path path = file(name);
  return std::make_unique<CheckedFile>(path, lock_);
}

void RunDir::write(std::string_view name, std::string_view text) {
  ::unlinkat(lock_, std::string(name).c_str(), 0);
  const auto out = create(name);
  out->write(text);
  out->close();
}

int RunDir::make_folder(std::string_view name) {
  const std::string text(name);
  if (::mkdirat(lock_, text.c_str(), 0777) != 0) fail(working_ / text, std::strerror(errno));
  const int fd = ::openat(lock_, text.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd < 0) fail(working_ / text, std::strerror(errno));
  return folders_.emplace_back(fd);
}

/// Without this, files could be empty after a power failure.
void RunDir::sync() const {
  for (const auto& entry : fs::recursive_directory_iterator(working_))
    if (!entry.is_symlink() && (entry.is_regular_file() || entry.is_directory()))
      sync_to_disk(entry.path());
  sync_to_disk(working_);
}

std::string RunDir::commit(bool complete) {
  FOVEA_CHECK(!committed_, "run folder committed twice");
  set_remove(false);
  try {
    sync();
  } catch (const fs::filesystem_error& e) {
    fail(working_, e.code().message());
  }
  if (::fchmod(lock_, mode_) != 0) fail(working_, std::strerror(errno));
  const RunFolder old = inspect_run_folder(final_);
  std::string note;
  if (const std::string why = obstacle(old); !why.empty()) {
    const fs::path kept = put_beside(".new");
    fail(final_, fmt::format("it was changed during the run: {}; the results are in {}", why,
                             in_quotes(kept)));
  }
  if (old.complete && !complete) {
    placed_ = put_beside(".partial");
    note = fmt::format("{} keeps {}; the partial results of this run are in {}", in_quotes(final_),
                       old.results(), in_quotes(placed_));
  } else {
    if (old.ours) note = "replaces " + old.results();
    note += replace(final_);
    placed_ = final_;
  }
  committed_ = true;
  sync_to_disk(final_.parent_path());
  return note;
}

/// Renames DIR.tmp to `target`, which may exist. At any time one of the two results exists. @return
/// what to add to the note about earlier results
std::string RunDir::replace(const fs::path& target) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(target, error))) {
    if (::rename(working_.c_str(), target.c_str()) != 0)
      fail(target,
           fmt::format("{}; the results are in {}", std::strerror(errno), in_quotes(working_)));
    return "";
  }
  // The old folder is locked too, so that no other run takes it for an abandoned DIR.tmp.
  const int old = ::open(target.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (old >= 0) {
    ::flock(old, LOCK_EX | LOCK_NB);
    folders_.push_back(old);
  }
  fs::path aside = working_;
  if (::renameat2(AT_FDCWD, working_.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) != 0) {
    // File systems that cannot exchange names: the old result is renamed first.
    aside = with_suffix(target, ".old");
    for (int n = 2; fs::exists(fs::symlink_status(aside, error)); ++n)
      aside = with_suffix(target, fmt::format(".old.{}", n));
    if (::rename(target.c_str(), aside.c_str()) != 0)
      fail(target,
           fmt::format("{}; the results are in {}", std::strerror(errno), in_quotes(working_)));
    if (::rename(working_.c_str(), target.c_str()) != 0) {
      const int reason = errno;
      ::rename(aside.c_str(), target.c_str());
      fail(target,
           fmt::format("{}; the results are in {}", std::strerror(reason), in_quotes(working_)));
    }
  }
  if (remove_run_files(aside)) return "";
  return fmt::format("; what could not be removed of it is in {}", in_quotes(aside));
}

/// DIR with the suffix, and with a number if that name is used for anything but partial results.
fs::path RunDir::put_beside(std::string_view suffix) {
  for (int n = 1;; ++n) {
    fs::path name = with_suffix(final_, suffix);
    if (n > 1) name += fmt::format(".{}", n);
    const RunFolder found = inspect_run_folder(name);
    const bool partial = suffix == ".partial" && found.ours && !found.complete;
    if (found.exists && !(partial && obstacle(found).empty())) continue;
    replace(name);
    return name;
  }
}

}  // namespace fovea::app
