#include "sw/fovea/files/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "model/common/check.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFirstBytes = 4096;

/// Why something with this state is no file that may be replaced; empty if it may be one.
std::string obstacle(const struct stat& info) {
  if (S_ISLNK(info.st_mode)) return "it is a symbolic link";
  if (S_ISDIR(info.st_mode)) return "it is a folder";
  return S_ISREG(info.st_mode) ? "" : "it is not a regular file";
}

std::string first_bytes(int fd) {
  std::string first(kFirstBytes, '\0');
  const ssize_t n = ::pread(fd, first.data(), first.size(), 0);
  first.resize(n < 0 ? 0 : static_cast<std::size_t>(n));
  return first;
}

bool is_device(const fs::path& name) {
  std::error_code error;
  const fs::file_status status = fs::status(name, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// The list of names is on the disk, too. File systems that cannot do that say EINVAL.
int sync_names(int folder) {
  const int fd = ::openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return errno;
  const int error = ::fsync(fd) == 0 ? 0 : errno;
  ::close(fd);
  return error == EINVAL || error == EROFS ? 0 : error;
}

}  // namespace

void OutputFile::Place::refuse(const std::string& why) const {
  throw UserError(
      fmt::format("{} '{}': {}; remove it or choose another name", option, one_line(name.string()), why));
}

OutputFile::OutputFile(const fs::path& name, std::string_view option, std::string_view kind,
                       const std::function<bool(std::string_view)>& is_ours)
    : name_(name), working_(name) {
  if (is_device(name)) {
    const int fd = ::open(name.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (fd < 0) fail(errno);
    file_.emplace(name_, CheckedFile::Open{fd});
    return;
  }
  const Place place{name, std::string(option), std::string(kind), is_ours};
  const fs::path parent = name.has_parent_path() ? name.parent_path() : fs::path(".");
  folder_ = ::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0) place.refuse(std::strerror(errno));
  try {
    struct stat info {};
    if (::fstatat(folder_, name.filename().c_str(), &info, AT_SYMLINK_NOFOLLOW) == 0) {
      if (const std::string why = obstacle(info); !why.empty()) place.refuse(why);
      const int fd = ::openat(folder_, name.filename().c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
      if (fd < 0) place.refuse(std::strerror(errno));
      const bool ours = info.st_size == 0 || is_ours(first_bytes(fd));
      ::close(fd);
      if (!ours) place.refuse(fmt::format("it exists and is not {}", kind));
    } else if (errno != ENOENT) {
      place.refuse(std::strerror(errno));
    }
    working_ += ".tmp";
    take_working({working_, place.option, place.kind, is_ours});
  } catch (...) {
    ::close(folder_);
    throw;
  }
}

/// Creates NAME.tmp or takes over one that a crash left. Two processes may open it at once: it belongs to the one that
/// gets the lock, provided that it still has its name then.
void OutputFile::take_working(const Place& place) {
  fd_ = ::openat(folder_, working_.filename().c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  if (fd_ < 0)
    place.refuse(errno == ELOOP ? "it is a symbolic link" : errno == EISDIR ? "it is a folder" : std::strerror(errno));
  file_.emplace(working_, CheckedFile::Open{fd_});
  struct stat info {};
  if (::fstat(fd_, &info) != 0) place.refuse(std::strerror(errno));
  if (const std::string why = obstacle(info); !why.empty()) place.refuse(why);
  if (info.st_uid != ::geteuid()) place.refuse("it belongs to another user");
  if (info.st_nlink > 1) place.refuse("it is a file with a second name");
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) place.refuse("another run is writing it");
  if (!is_still_ours()) place.refuse("another run is writing it");
  if (::fstat(fd_, &info) != 0) place.refuse(std::strerror(errno));
  if (info.st_size > 0 && !place.is_ours(first_bytes(fd_)))
    place.refuse(fmt::format("it exists and is not {}", place.kind));
  if (::ftruncate(fd_, 0) != 0) place.refuse(std::strerror(errno));
}

bool OutputFile::is_still_ours() const {
  struct stat mine {}, there {};
  return ::fstat(fd_, &mine) == 0 &&
         ::fstatat(folder_, working_.filename().c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0 &&
         mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

OutputFile::~OutputFile() {
  if (folder_ < 0) return;
  if (!committed_ && is_still_ours()) ::unlinkat(folder_, working_.filename().c_str(), 0);
  ::close(folder_);
}

void OutputFile::fail(int error) const {
  throw UserError(fmt::format("cannot write '{}': {}", one_line(name_.string()), std::strerror(error)));
}

void OutputFile::commit() {
  FOVEA_CHECK(!committed_, "output file committed twice");
  if (folder_ >= 0) {
    file_->sync();
    // Closing the file releases the lock, so it is renamed first.
    if (::renameat(folder_, working_.filename().c_str(), folder_, name_.filename().c_str()) != 0) fail(errno);
  }
  committed_ = true;
  file_->close();
  if (folder_ >= 0)
    if (const int error = sync_names(folder_)) fail(error);
}

void replace_file(int folder, const fs::path& path, std::string_view text) {
  fs::path working = path;
  working += ".tmp";
  const auto remove = [&] { ::unlinkat(folder, working.filename().c_str(), 0); };
  remove();  // what an earlier process left, or a link that another user planted
  CheckedFile file(working, folder);
  try {
    file.write(text);
    file.sync();
    file.close();
    if (::renameat(folder, working.filename().c_str(), folder, path.filename().c_str()) != 0)
      throw UserError(fmt::format("cannot write '{}': {}", one_line(path.string()), std::strerror(errno)));
  } catch (...) {
    remove();
    throw;
  }
  if (const int error = sync_names(folder))
    throw UserError(fmt::format("cannot write '{}': {}", one_line(path.string()), std::strerror(error)));
}

}  // namespace fovea::app
