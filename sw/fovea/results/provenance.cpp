#include "sw/fovea/results/provenance.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gcrypt.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kModified = "-modified";

[[noreturn]] void unreadable(const fs::path& file) {
  throw UserError(fmt::format("'{}' cannot be read: {}", one_line(file.string()), std::strerror(errno)));
}

bool has_effect(const ParamBase& p) {
  return std::all_of(p.effects().begin(), p.effects().end(),
                     [](const auto& effect) { return effect.effective(); });
}

}  // namespace

std::string sha256_of(const fs::path& file) {
  std::error_code error;
  // Reading a pipe would consume its contents or block for ever.
  if (fs::exists(file, error) && !fs::is_regular_file(file, error)) return "";
  [[maybe_unused]] static const char* const initialised = gcry_check_version(nullptr);
  gcry_md_hd_t hash = nullptr;
  if (const gcry_error_t failed = gcry_md_open(&hash, GCRY_MD_SHA256, 0))
    throw UserError(
        fmt::format("'{}' cannot be hashed: libgcrypt: {}", one_line(file.string()), gcry_strerror(failed)));
  const std::unique_ptr<gcry_md_handle, void (*)(gcry_md_hd_t)> closes(hash, gcry_md_close);
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) unreadable(file);
  std::vector<char> block(std::size_t{1} << 18);
  ssize_t n = 0;
  while ((n = ::read(fd, block.data(), block.size())) > 0)
    gcry_md_write(hash, block.data(), static_cast<std::size_t>(n));
  const int failed = errno;
  ::close(fd);
  errno = failed;
  if (n < 0) unreadable(file);
  const unsigned char* const digest = gcry_md_read(hash, GCRY_MD_SHA256);
  std::string text;
  for (unsigned i = 0; i < gcry_md_get_algo_dlen(GCRY_MD_SHA256); ++i)
    text += fmt::format("{:02x}", digest[i]);
  return text;
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

Provenance provenance_of(const ParamSet& params, InputFiles inputs, const InputFiles& read) {
  Provenance out = program_provenance();
  for (const ParamBase* p : params.all()) {
    const bool named = std::any_of(inputs.begin(), inputs.end(),
                                   [&](const auto& i) { return i.first == p->key(); });
    if (!named && is_path_key(*p) && !p->text().empty() && has_effect(*p))
      inputs.emplace_back(p->key(), p->text());
  }
  std::error_code error;
  for (const auto& [name, file] : inputs)
    out.inputs.emplace_back(name, fs::exists(file, error) ? sha256_of(file) : "");
  for (const auto& [name, file] : read) out.inputs.emplace_back(name, sha256_of(file));
  std::sort(out.inputs.begin(), out.inputs.end());
  return out;
}

std::string provenance_text(const Provenance& program) {
  return fmt::format("{} (commit {}{})", program.version, program.commit,
                     program.modified ? ", modified" : "");
}

}  // namespace fovea::app
