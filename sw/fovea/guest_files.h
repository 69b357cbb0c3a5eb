// Host files for a guest, all below one folder.
#pragma once
#include <filesystem>
#include <string>
#include <utility>

namespace fovea::app {

/// Resolves names component by component from the folder's descriptor, so that nothing that changes
/// on the host meanwhile leads out of it. Refused with EACCES: absolute names, `..`, symbolic links
/// anywhere in the name, and whatever is neither a regular file nor a folder on the way to one. Hard
/// links cannot be told from files.
class GuestFiles {
 public:
  /// An empty name: no files at all.
  /// @throws UserError if it is no folder
  explicit GuestFiles(const std::filesystem::path& root);
  ~GuestFiles();
  GuestFiles(const GuestFiles&) = delete;
  GuestFiles& operator=(const GuestFiles&) = delete;

  /// As open(2). @return a file descriptor, or -errno
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
