// Access of a guest program to host files below one folder.
#pragma once
#include <filesystem>
#include <string>
#include <utility>

namespace fovea::app {

/// Resolves names component by component from the folder's descriptor, so that no change of the
/// host's file system during a run can lead out of the folder. Refused with EACCES: absolute names,
/// `..`, symbolic links anywhere in the name, and anything but regular files and the folders on the
/// way to them. Hard links cannot be distinguished from files.
class GuestFiles {
 public:
  /// @param root the folder; empty: the guest has no files @throws UserError if it is not a folder
  explicit GuestFiles(const std::filesystem::path& root);
  ~GuestFiles();
  GuestFiles(const GuestFiles&) = delete;
  GuestFiles& operator=(const GuestFiles&) = delete;

  /// Like open(2). @return a file descriptor, or -errno
  int open(const std::string& name, int flags) const;
  /// @return 0 or -errno
  int remove(const std::string& name) const;
  int rename(const std::string& from, const std::string& to) const;

 private:
  /// An open folder and a name in it.
  struct Parent {
    int folder = -1;  ///< or -errno
    std::string name;
    Parent() = default;
    Parent(Parent&& p) noexcept : folder(std::exchange(p.folder, -1)), name(std::move(p.name)) {}
    ~Parent();
  };
  Parent parent(const std::string& name) const;
  static int check_file(const Parent& p);

  int root_ = -1;
};

}  // namespace fovea::app
