#include "sw/fovea/output_file.h"

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

/// Why the existing file `name` may not be replaced; empty if it may, or if there is none.
std::string obstacle(const fs::path& name, std::string_view kind,
                     const std::function<bool(std::string_view)>& is_ours) {
  struct stat info {};
  if (::lstat(name.c_str(), &info) != 0) return errno == ENOENT ? "" : std::strerror(errno);
  if (S_ISLNK(info.st_mode)) return "it is a symbolic link";
  if (S_ISDIR(info.st_mode)) return "it is a folder";
  if (!S_ISREG(info.st_mode)) return "it is not a regular file";
  if (info.st_size == 0) return "";
  const int fd = ::open(name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return std::strerror(errno);
  std::string first(kFirstBytes, '\0');
  const ssize_t n = ::read(fd, first.data(), first.size());
  ::close(fd);
  first.resize(n < 0 ? 0 : static_cast<std::size_t>(n));
  return is_ours(first) ? "" : fmt::format("it exists and is not {}", kind);
}

/// True if another process has the file open for writing.
bool is_locked(const fs::path& name) {
  const int fd = ::open(name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return false;
  const bool locked = ::flock(fd, LOCK_EX | LOCK_NB) != 0;
  ::close(fd);
  return locked;
}

bool is_device(const fs::path& name) {
  std::error_code error;
  const fs::file_status status = fs::status(name, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

}  // namespace

OutputFile::OutputFile(const fs::path& name, std::string_view option, std::string_view kind,
                       const std::function<bool(std::string_view)>& is_ours)
    : name_(name), working_(name), device_(is_device(name)) {
  if (device_) {
    file_.emplace(name_);
    return;
  }
  const auto refuse = [&](const fs::path& which, const std::string& why) {
    throw UserError(fmt::format("{} '{}': {}; remove it or choose another name", option,
                                one_line(which.string()), why));
  };
  if (const std::string why = obstacle(name_, kind, is_ours); !why.empty()) refuse(name_, why);
  working_ += ".tmp";
  if (const std::string why = obstacle(working_, kind, is_ours); !why.empty())
    refuse(working_, why);
  struct stat left {};
  if (::lstat(working_.c_str(), &left) == 0) {
    if (left.st_uid != ::geteuid()) refuse(working_, "it belongs to another user");
    if (is_locked(working_)) refuse(working_, "another run is writing it");
    ::unlink(working_.c_str());
  }
  file_.emplace(working_, CheckedFile::New{});
  file_->lock();
}

OutputFile::~OutputFile() {
  if (!committed_ && !device_ && file_) ::unlink(working_.c_str());
}

void OutputFile::commit() {
  FOVEA_CHECK(!committed_, "output file committed twice");
  if (!device_) file_->sync();
  // Closing the file releases the lock, so it is renamed first.
  if (!device_ && ::rename(working_.c_str(), name_.c_str()) != 0)
    throw UserError(
        fmt::format("cannot write '{}': {}", one_line(name_.string()), std::strerror(errno)));
  committed_ = true;
  file_->close();
}

}  // namespace fovea::app
