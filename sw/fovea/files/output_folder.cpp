#include "sw/fovea/files/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "model/common/check.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

std::string in_quotes(const fs::path& path) { return "'" + one_line(path.string()) + "'"; }

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw UserError(fmt::format("output folder {}: {}", in_quotes(path), why));
}

bool has_type(const fs::path& file, fs::file_type type) {
  std::error_code ignored;
  return fs::symlink_status(file, ignored).type() == type;
}

/// Calls `f(relative name, is a folder of the kind)` for everything in `dir` and in its folders of the kind, sorted by
/// name but for the mark, which is the last.
template <class F>
void each_entry(const fs::path& dir, const FolderKind& kind, const F& f) {
  const auto sorted = [](const fs::path& folder) {
    std::error_code ignored;
    std::vector<fs::path> names;
    for (fs::directory_iterator i(folder, ignored), end; !ignored && i != end; i.increment(ignored))
      names.push_back(i->path().filename());
    std::sort(names.begin(), names.end());
    return names;
  };
  std::vector<fs::path> names = sorted(dir);
  std::stable_partition(names.begin(), names.end(), [&](const fs::path& n) { return n != fs::path(kind.mark); });
  for (const fs::path& name : names) {
    const bool inner = std::find(kind.folders.begin(), kind.folders.end(), name.string()) != kind.folders.end() &&
                       has_type(dir / name, fs::file_type::directory);
    if (inner)
      for (const fs::path& file : sorted(dir / name)) f(name / file, false);
    f(name, inner);
  }
}

bool is_of(const FolderKind& kind, const fs::path& dir, const fs::path& name) {
  return kind.is_file(name.string()) && has_type(dir / name, fs::file_type::regular);
}

/// Folders to be removed when the program ends without destructors, at a broken invariant (FOVEA_CHECK).
using Abandoned = std::vector<std::pair<fs::path, const FolderKind*>>;
Abandoned& abandoned_at_exit() {
  static Abandoned folders;
  [[maybe_unused]] static const int registered = std::at_quick_exit([] {
    for (const auto& [folder, kind] : abandoned_at_exit()) remove_folder(folder, *kind);
  });
  return folders;
}

mode_t umask_now() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return mask;
}

}  // namespace

fs::path with_suffix(const fs::path& path, std::string_view suffix) {
  fs::path out = path;
  out += suffix;
  return out;
}

void sync_to_disk(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) fail(path, std::strerror(errno));
  const int error = ::fsync(fd) == 0 ? 0 : errno;
  ::close(fd);
  // fsync() fails with EINVAL on file systems that do not support it.
  if (error != 0 && error != EINVAL && error != EROFS) fail(path, std::strerror(error));
}

FolderContents folder_contents(const fs::path& dir, const FolderKind& kind) {
  FolderContents found;
  struct stat info {};
  found.exists = ::lstat(dir.c_str(), &info) == 0;
  found.folder = found.exists && S_ISDIR(info.st_mode);
  found.other_users = found.exists && info.st_uid != ::geteuid();
  if (!found.folder) return found;
  found.vacant = found.only_inner = true;
  each_entry(dir, kind, [&](const fs::path& name, bool inner) {
    if (inner) return;
    found.vacant = false;
    if (!name.has_parent_path()) found.only_inner = false;
    if (found.foreign.empty() && !is_of(kind, dir, name)) found.foreign = name.string();
  });
  return found;
}

bool remove_folder(const fs::path& dir, const FolderKind& kind, bool keep_folder) {
  bool empty = true;
  each_entry(dir, kind, [&](const fs::path& name, bool inner) {
    // The mark stays with what cannot be removed.
    if (!empty && name == fs::path(kind.mark)) return;
    std::error_code error;
    // fs::remove() removes a folder only if it is empty.
    if (!(inner || is_of(kind, dir, name)) || !fs::remove(dir / name, error)) empty = false;
  });
  std::error_code error;
  return empty && (keep_folder || fs::remove(dir, error));
}

OutputFolder::OutputFolder(const fs::path& name, const FolderKind& kind)
    : kind_(kind), working_(with_suffix(name, ".tmp")) {
  try {
    take();
  } catch (...) {
    abandon();
    throw;
  }
}

OutputFolder::~OutputFolder() { abandon(); }

void OutputFolder::take() {
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
  // The process that used it may just have renamed it.
  if (::lstat(working_.c_str(), &there) != 0 || there.st_ino != mine.st_ino ||
      there.st_dev != mine.st_dev)
    fail(working_, "another run is writing it");
  const FolderContents found = folder_contents(working_, kind_);
  if (found.only_inner && !found.vacant)
    fail(working_, fmt::format("it exists and is not left by {}; remove it or choose another name", kind_.owner));
  if (!found.foreign.empty())
    fail(working_, fmt::format("it holds {}, which is not a file of {}; move it away",
                               in_quotes(found.foreign), kind_.owner));
  const fs::path mark = working_ / kind_.mark;
  if (has_type(mark, fs::file_type::regular) && kind_.is_foreign_mark(mark))
    fail(working_, fmt::format("it exists and is not left by {}; remove it or choose another name", kind_.owner));
  // Only the owner may enter, so that no other user can place links in the folder while the files are written.
  mode_ = (0777 & ~umask_now()) | (mine.st_mode & S_ISGID);
  if (!made && ::fchmod(lock_, 0700) != 0) fail(working_, std::strerror(errno));
  set_remove(true);
  if (!remove_folder(working_, kind_, true))
    fail(working_, "what an earlier run left cannot be removed");
}

void OutputFolder::set_remove(bool remove) {
  remove_ = remove;
  Abandoned& folders = abandoned_at_exit();
  std::erase_if(folders, [&](const auto& f) { return f.first == working_; });
  if (remove) folders.emplace_back(working_, &kind_);
}

/// Removes the folder while it is locked, so that no other process can have started in it.
void OutputFolder::abandon() {
  if (remove_) {
    set_remove(false);
    remove_folder(working_, kind_);
  }
  for (const int fd : folders_) ::close(fd);
  folders_.clear();
  if (lock_ >= 0) ::close(lock_);
  lock_ = -1;
}

std::unique_ptr<CheckedFile> OutputFolder::create(std::string_view name) {
  return std::make_unique<CheckedFile>(working_ / name, lock_);
}

void OutputFolder::write(std::string_view name, std::string_view text) {
  ::unlinkat(lock_, std::string(name).c_str(), 0);
  const auto out = create(name);
  out->write(text);
  out->close();
}

int OutputFolder::make_folder(std::string_view name) {
  const std::string text(name);
  if (::mkdirat(lock_, text.c_str(), 0777) != 0) fail(working_ / text, std::strerror(errno));
  const int fd = ::openat(lock_, text.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (fd < 0) fail(working_ / text, std::strerror(errno));
  return folders_.emplace_back(fd);
}

/// Without fsync(), files could be empty after a power failure.
void OutputFolder::complete() {
  set_remove(false);
  try {
    for (const auto& entry : fs::recursive_directory_iterator(working_))
      if (!entry.is_symlink() && (entry.is_regular_file() || entry.is_directory()))
        sync_to_disk(entry.path());
  } catch (const fs::filesystem_error& e) {
    fail(working_, e.code().message());
  }
  sync_to_disk(working_);
  if (::fchmod(lock_, mode_) != 0) fail(working_, std::strerror(errno));
}

void OutputFolder::stays(const fs::path& target, int error) const {
  fail(target, fmt::format("{}; the results are in {}", std::strerror(error), in_quotes(working_)));
}

fs::path OutputFolder::place(const fs::path& target) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(target, error))) {
    if (::rename(working_.c_str(), target.c_str()) != 0) stays(target, errno);
    sync_to_disk(target.parent_path());
    return {};
  }
  // The old folder is locked too, so that no other process takes it for an abandoned NAME.tmp.
  const int old = ::open(target.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (old >= 0) {
    ::flock(old, LOCK_EX | LOCK_NB);
    folders_.push_back(old);
  }
  if (::renameat2(AT_FDCWD, working_.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) {
    sync_to_disk(target.parent_path());
    return working_;
  }
  // File systems that cannot exchange names: the old folder is renamed first.
  fs::path aside = with_suffix(target, ".old");
  for (int n = 2; fs::exists(fs::symlink_status(aside, error)); ++n)
    aside = with_suffix(target, fmt::format(".old.{}", n));
  if (::rename(target.c_str(), aside.c_str()) != 0) stays(target, errno);
  if (::rename(working_.c_str(), target.c_str()) != 0) {
    const int reason = errno;
    ::rename(aside.c_str(), target.c_str());
    stays(target, reason);
  }
  sync_to_disk(target.parent_path());
  return aside;
}

}  // namespace fovea::app
