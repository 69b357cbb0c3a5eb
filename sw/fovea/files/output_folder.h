// A folder of files with known names that takes the place of an earlier one at once.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/files/checked_file.h"

namespace fovea::app {

/// What folders of one kind hold. A file with another name is not Fovea's, and is never removed.
struct FolderKind {
  std::string_view owner;           ///< for messages: "a Fovea run"
  bool (*is_file)(std::string_view name);  ///< of a file's name relative to the folder
  std::span<const std::string_view> folders;  ///< names of folders in it that hold files too
  std::string_view mark;  ///< the file that tells whose the folder is: it is written first and removed last
  /// True if this mark is of another program. One that is cut off, as after a crash, is not.
  bool (*is_foreign_mark)(const std::filesystem::path& mark);
};

struct FolderContents {
  bool exists = false;        ///< something of this name exists, of whatever type
  bool folder = false;        ///< it is a folder, and no symbolic link
  bool other_users = false;   ///< it belongs to another user
  bool vacant = false;        ///< no files, except in empty folders of the kind
  bool only_inner = false;    ///< all files lie in folders of the kind: there is no sign that Fovea wrote them
  std::string foreign;        ///< relative name of something that is not of the kind; empty: none
};
FolderContents folder_contents(const std::filesystem::path& dir, const FolderKind& kind);

/// Removes the files of the kind, the mark last, and then the folder (unless `keep_folder`), provided that nothing
/// else is left in it. Errors of the file system are ignored: what cannot be removed stays.
/// @return false if anything is left
bool remove_folder(const std::filesystem::path& dir, const FolderKind& kind, bool keep_folder = false);

/// The unfinished folder NAME.tmp, locked against other processes until the object ends. Its files are created through
/// its descriptor, and never through a symbolic link. place() gives it the name of the earlier one, which at every
/// moment exists whole: under its own name, or beside it. Without place() it is removed; after a crash it remains
/// until the next run makes a folder of this name.
class OutputFolder {
 public:
  /// Creates NAME.tmp, which only its owner may enter. One that the same user's earlier process left is emptied.
  /// @param name absolute @param kind must outlive the object
  /// @throws UserError: not writable, not of this kind, or another process is writing it
  OutputFolder(const std::filesystem::path& name, const FolderKind& kind);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// NAME.tmp
  const std::filesystem::path& working() const { return working_; }
  /// Writes or replaces a file. @throws UserError
  void write(std::string_view name, std::string_view text);
  /// Creates a file that is not there. @throws UserError
  std::unique_ptr<CheckedFile> create(std::string_view name);
  /// Creates a folder in it. @return its descriptor, open until the end @throws UserError
  int make_folder(std::string_view name);

  /// Makes sure that everything is on the disk. From here on the folder is a result: it is no longer removed, whatever
  /// follows. @throws UserError
  void complete();
  /// Renames NAME.tmp to `target`; what is there steps aside. Call complete() before.
  /// @return where the earlier one is now, to be removed; empty: there was none @throws UserError
  std::filesystem::path place(const std::filesystem::path& target);

 private:
  void take();
  void abandon();
  void set_remove(bool remove);
  [[noreturn]] void stays(const std::filesystem::path& target, int error) const;

  const FolderKind& kind_;
  std::filesystem::path working_;
  mode_t mode_ = 0;  ///< of the complete folder
  int lock_ = -1;
  std::vector<int> folders_;
  bool remove_ = false;  ///< NAME.tmp is ours, and its contents are not needed
};

/// NAME with the suffix.
std::filesystem::path with_suffix(const std::filesystem::path& path, std::string_view suffix);

/// Makes sure that a file or a folder's list of names is on the disk. @throws UserError
void sync_to_disk(const std::filesystem::path& path);

}  // namespace fovea::app
