// Experiments: parameters from YAML files and from the command line, each with its origin.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/param.h"

namespace fovea::app {

/// The names of the shipped experiments: those of the installed program, or of the source tree in whose folder
/// build/PRESET the program lies. Experiment::load() takes them.
std::vector<std::string> shipped_experiments();

/// Where the value of a parameter was given.
struct ValueOrigin {
  enum class Kind { kDefault, kFile, kCommandLine, kOtherKey };
  Kind kind = Kind::kDefault;
  std::string file;   ///< as the user named it, or the key whose value it is; empty unless kFile or kOtherKey
  unsigned line = 0;  ///< from 1 on; 0 unless kFile, or if the file has no lines
  /// True if the value comes from a file without lines, such as a trace or a calibration, or from another key.
  bool preset() const { return (kind == Kind::kFile && line == 0) || kind == Kind::kOtherKey; }
  /// "default", "command line", "file:line", "file" or "as KEY".
  std::string text() const;
};

/// Fills a ParamSet. Order of precedence, lowest first: defaults, included files, the file itself,
/// `-s`.
///
/// The file is YAML: dotted keys, nested maps or both (`lens: {mapping: equisolid}` is
/// `lens.mapping: equisolid`). A sequence becomes the text `[a, b]`. `include: other.yaml` (or a
/// list) at the top level is relative to the including file and is read first, wherever it is
/// written. Not part of the format: aliases and anchors (a small file could expand without limit),
/// tags, several documents, files larger than 1 MiB, nesting deeper than 8. A key that occurs twice
/// in a file is an error. Every error is a UserError of one line: file:line, key, what is allowed,
/// suggestion.
class Experiment {
 public:
  explicit Experiment(ParamSet& params) : params_(params) {}

  /// Reads an experiment: a file or, where no file has that name, a shipped one by its name alone ("paper-pal").
  /// @throws UserError
  void load(const std::filesystem::path& name);
  /// Sets a key from a file without lines (a trace, a calibration). @throws UserError
  void preset(std::string_view key, std::string_view value, const std::string& file);
  /// Sets a key to the value of another one. @throws UserError
  void take_over(const std::string& key, const std::string& from);
  /// Applies one `key=value` from the command line. @throws UserError
  void override_with(std::string_view assignment);

  /// Precedence of the place where a key was set: -1 for the default, then the files (an included
  /// one below the one that includes it), highest for the command line.
  int rank(std::string_view key) const;

  /// Origin of the value of a key, even if it is the default.
  const ValueOrigin& origin(std::string_view key) const;
  /// Name of the experiment file without folder and extension; empty before load().
  const std::string& name() const { return name_; }
  /// All files that were read, in this order, as the user named them.
  const std::vector<std::string>& files() const { return files_; }

 private:
  void load(const std::filesystem::path& file, std::vector<std::filesystem::path>& chain);
  void set(std::string_view key, std::string value, const std::filesystem::path& folder);
  ParamSet& params_;
  std::map<std::string, ValueOrigin, std::less<>> origins_;
  std::map<std::string, int, std::less<>> ranks_;
  int next_rank_ = 0;
  std::vector<std::string> files_;
  std::string name_;
};

/// Warns about each key that was set although another one makes it ineffective. No warning is given
/// for a key from a file that became ineffective by a later choice (`-s camera.kind=chart`).
/// Nor is one given for a key that a trace or a calibration sets, because the user did not choose it.
void warn_without_effect(const ParamSet& params, const Experiment& experiment);

/// True for the keys of one camera, camera.N.*.
bool is_camera_row(std::string_view key);

/// True for text parameters that name a file (the key ends in `.file`, `.elf` or `.calibration`). A
/// relative name in an experiment file is relative to that file's folder; on the command line, to
/// the working folder.
bool is_path_key(const ParamBase& param);

}  // namespace fovea::app
