#include "sw/fovea/provenance.h"

#include <fmt/format.h>
#include <sha2.h>

#include <algorithm>
#include <array>
#include <fstream>

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kModified = "-modified";

bool has_effect(const ParamBase& p) {
  return std::all_of(p.effects().begin(), p.effects().end(),
                     [](const auto& effect) { return effect.effective(); });
}

}  // namespace

std::string sha256_of(const fs::path& file) {
  std::error_code error;
  // Reading a pipe would consume its contents or block for ever.
  if (!fs::is_regular_file(file, error)) return "";
  std::array<char, SHA256_DIGEST_STRING_LENGTH> text{};
  return ::SHA256File(file.c_str(), text.data()) ? text.data() : "";
}

Provenance program_provenance() {
  Provenance out{.version = FOVEA_VERSION, .commit = "unknown"};
  std::error_code error;
  std::ifstream file(fs::read_symlink("/proc/self/exe", error).parent_path() / "fovea.commit");
  std::string commit;
  if (!std::getline(file, commit) || commit.empty()) return out;
  if (commit.ends_with(kModified)) {
    out.modified = true;
    commit.resize(commit.size() - kModified.size());
  }
  out.commit = commit;
  return out;
}

Provenance provenance_of(const ParamSet& params, InputFiles inputs) {
  Provenance out = program_provenance();
  for (const ParamBase* p : params.all()) {
    const bool named = std::any_of(inputs.begin(), inputs.end(),
                                   [&](const auto& i) { return i.first == p->key(); });
    if (!named && is_path_key(*p) && !p->text().empty() && has_effect(*p))
      inputs.emplace_back(p->key(), p->text());
  }
  std::sort(inputs.begin(), inputs.end());
  for (const auto& [name, file] : inputs) out.inputs.emplace_back(name, sha256_of(file));
  return out;
}

std::string provenance_text(const Provenance& program) {
  return fmt::format("{} (commit {}{})", program.version, program.commit,
                     program.modified ? ", modified" : "");
}

}  // namespace fovea::app
