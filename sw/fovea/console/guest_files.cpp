#include "sw/fovea/console/guest_files.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string_view>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {

GuestFiles::GuestFiles(const std::filesystem::path& root) {
  if (root.empty()) return;
  root_ = ::open(root.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (root_ < 0)
    throw UserError(fmt::format("--root '{}': {}; allowed: a folder that can be read",
                                one_line(root.string()), ::strerror(errno)));
}

GuestFiles::~GuestFiles() {
  if (root_ >= 0) ::close(root_);
}

GuestFiles::Parent::~Parent() {
  if (folder >= 0) ::close(folder);
}

GuestFiles::Parent GuestFiles::parent(const std::string& name) const {
  Parent p;
  const auto refuse = [&p](int error) {
    if (p.folder >= 0) ::close(p.folder);
    p.folder = -error;
    return std::move(p);
  };
  if (root_ < 0 || name.starts_with('/') || name.find('\0') != std::string::npos)
    return refuse(EACCES);
  if (name.empty() || name.ends_with('/')) return refuse(ENOENT);
  p.folder = ::fcntl(root_, F_DUPFD_CLOEXEC, 0);
  if (p.folder < 0) return refuse(errno);
  std::string_view rest = name;
  for (;;) {
    const std::size_t slash = rest.find('/');
    p.name = rest.substr(0, slash);
    if (p.name == "..") return refuse(EACCES);
    if (slash == std::string_view::npos) break;
    rest.remove_prefix(slash + 1);
    if (p.name.empty() || p.name == ".") continue;
    const int next = ::openat(p.folder, p.name.c_str(),
                              O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (next < 0) {
      // Both ENOTDIR and ELOOP may mean a symbolic link, or a file.
      struct stat s {};
      const int error = errno;
      const bool link = ::fstatat(p.folder, p.name.c_str(), &s, AT_SYMLINK_NOFOLLOW) == 0 &&
                        S_ISLNK(s.st_mode);
      return refuse(link ? EACCES : error);
    }
    ::close(p.folder);
    p.folder = next;
  }
  if (p.name.empty() || p.name == ".") return refuse(EISDIR);
  return p;
}

/// 0 for a regular file, ENOENT if there is none, EACCES or EISDIR for anything else.
int GuestFiles::check_file(const Parent& p) {
  struct stat s {};
  if (::fstatat(p.folder, p.name.c_str(), &s, AT_SYMLINK_NOFOLLOW) != 0) return errno;
  if (S_ISREG(s.st_mode)) return 0;
  return S_ISDIR(s.st_mode) ? EISDIR : EACCES;
}

int GuestFiles::open(const std::string& name, int flags) const {
  const Parent p = parent(name);
  if (p.folder < 0) return p.folder;
  if (const int e = check_file(p); e != 0 && !(e == ENOENT && (flags & O_CREAT))) return -e;
  // The name may refer to something else by now: do not follow links or wait for FIFOs.
  const int fd = ::openat(p.folder, p.name.c_str(),
                          flags | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0644);
  if (fd < 0) return errno == ELOOP ? -EACCES : -errno;
  struct stat s {};
  if (::fstat(fd, &s) != 0 || !S_ISREG(s.st_mode)) {
    ::close(fd);
    return -EACCES;
  }
  return fd;
}

int GuestFiles::remove(const std::string& name) const {
  const Parent p = parent(name);
  if (p.folder < 0) return p.folder;
  if (const int e = check_file(p)) return -e;
  return ::unlinkat(p.folder, p.name.c_str(), 0) == 0 ? 0 : -errno;
}

int GuestFiles::rename(const std::string& from, const std::string& to) const {
  const Parent a = parent(from), b = parent(to);
  if (a.folder < 0) return a.folder;
  if (b.folder < 0) return b.folder;
  if (const int e = check_file(a)) return -e;
  if (const int e = check_file(b); e != 0 && e != ENOENT) return -e;
  return ::renameat(a.folder, a.name.c_str(), b.folder, b.name.c_str()) == 0 ? 0 : -errno;
}

}  // namespace fovea::app
