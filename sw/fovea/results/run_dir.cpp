#include "sw/fovea/results/run_dir.h"

#include <fmt/format.h>

#include "model/common/check.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

std::string in_quotes(const fs::path& path) { return "'" + one_line(path.string()) + "'"; }

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw UserError(fmt::format("output folder {}: {}", in_quotes(path), why));
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

  const std::string why = obstacle(inspect_run_folder(final_));
  if (!why.empty()) fail(dir, why + "; choose another name, or move it away");
  fs::create_directories(final_.parent_path(), error);
  if (error) fail(dir, error.message());
  files_.emplace(final_, kRunKind);
}

std::string RunDir::obstacle(const RunFolder& found) const {
  if (!found.exists || found.vacant) return "";
  if (!found.ours) return "it exists and is not the folder of a Fovea run";
  if (found.other_users) return "it belongs to another user";
  if (!found.foreign.empty())
    return fmt::format("it holds {}, which is not a file of a Fovea run", in_quotes(found.foreign));
  if (!found.command.empty() && found.command != command_)
    return fmt::format("it holds {}, of 'fovea {}'", found.results(), one_line(found.command));
  return "";
}

fs::path RunDir::file(std::string_view name) const {
  FOVEA_CHECK(is_run_file(name), "run_files.cpp does not list the file " + std::string(name));
  return files_->working() / name;
}

bool RunDir::covers(const fs::path& name) const {
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(fs::absolute(name), error).parent_path();
  return !error && (folder == final_ || folder == files_->working());
}

std::unique_ptr<CheckedFile> RunDir::create(std::string_view name) {
  return files_->create(file(name).filename().string());
}

void RunDir::write(std::string_view name, std::string_view text) {
  files_->write(file(name).filename().string(), text);
}

int RunDir::make_folder(std::string_view name) { return files_->make_folder(name); }

std::string RunDir::commit(bool complete) {
  FOVEA_CHECK(!committed_, "run folder committed twice");
  files_->complete();
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
  return note;
}

/// Renames DIR.tmp to `target`, which may exist. At any time one of the two results exists. @return
/// what to add to the note about earlier results
std::string RunDir::replace(const fs::path& target) {
  const fs::path aside = files_->place(target);
  if (aside.empty() || remove_folder(aside, kRunKind)) return "";
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
