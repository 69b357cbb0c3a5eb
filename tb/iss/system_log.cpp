#include "tb/iss/system_log.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "tb/iss/assembler.h"

namespace fovea::cpu::test {
namespace {

constexpr unsigned kRecordWords = 22, kDumpWords = 27;
constexpr std::uint32_t kDump = 0x80, kNameOfCase = 0x90;
constexpr std::uint32_t kStatusBits = 0xF800'00FFu;

std::string register_name(const char* mode, unsigned r) {
  return std::string(mode) + "r" + std::to_string(r);
}

}  // namespace

std::vector<LogCase> parse_log(const std::string& bytes,
                               const std::function<std::uint8_t(std::uint32_t)>& memory) {
  if (bytes.size() % 4) throw std::runtime_error("a log is whole words");
  std::vector<std::uint32_t> w(bytes.size() / 4);
  if (!w.empty()) std::memcpy(w.data(), bytes.data(), bytes.size());
  std::vector<LogCase> out{{"start", {}}};
  for (std::size_t at = 0; at < w.size();) {
    LogEntry e;
    e.dump = w[at] == kDump;
    const std::size_t from = at + e.dump, to = from + (e.dump ? kDumpWords : kRecordWords);
    if (to > w.size()) throw std::runtime_error("a log ends in an entry");
    e.words.assign(w.begin() + static_cast<std::ptrdiff_t>(from),
                   w.begin() + static_cast<std::ptrdiff_t>(to));
    at = to;
    if (!e.dump && (e.kind() < 1 || e.kind() > 7)) throw std::runtime_error("no log");
    if (!e.dump && e.kind() == 2 && e.swi() == kNameOfCase) {
      std::string name;
      for (std::uint32_t a = e.words[7]; memory(a) && name.size() < 100; ++a)
        name += static_cast<char>(memory(a));
      out.push_back({name, {}});
    }
    out.back().entries.push_back(std::move(e));
  }
  return out;
}

std::string field_name(const LogEntry& e, unsigned word) {
  if (!e.dump) {
    constexpr const char* kFirst[] = {"kind", "lr", "cpsr", "spsr", "dfsr", "ifsr", "far"};
    return word < 7 ? kFirst[word] : register_name("", word - 7);
  }
  if (word < 7) return register_name("sys ", word + 8);
  if (word < 15) return word == 14 ? "fiq spsr" : register_name("fiq ", word + 1);
  constexpr const char* kModes[] = {"irq ", "svc ", "abt ", "und "};
  const char* mode = kModes[(word - 15) / 3];
  return (word - 15) % 3 == 2 ? std::string(mode) + "spsr"
                              : register_name(mode, 13 + (word - 15) % 3);
}

std::string Difference::text() const {
  std::ostringstream s;
  s << "'" << where << "' entry " << entry << " " << field << std::hex << ": core " << core
    << " qemu " << qemu;
  if (!context.words.empty() && !context.dump)
    s << " (kind " << context.words[0] << " lr " << context.words[1] << " dfsr " << context.words[4]
      << " far " << context.words[6] << ")";
  return s.str();
}

std::vector<Difference> compare_logs(const std::vector<LogCase>& core,
                                     const std::vector<LogCase>& qemu, const Open& open) {
  std::vector<Difference> out;
  for (std::size_t c = 0; c < std::max(core.size(), qemu.size()); ++c) {
    if (c >= core.size() || c >= qemu.size() || core[c].name != qemu[c].name) {
      out.push_back({c < core.size() ? core[c].name : "end",
                     0,
                     "cases",
                     static_cast<std::uint32_t>(core.size()),
                     static_cast<std::uint32_t>(qemu.size()),
                     {}});
      return out;
    }
    const auto& a = core[c].entries;
    const auto& b = qemu[c].entries;
    for (std::size_t k = 0; k < std::max(a.size(), b.size()); ++k) {
      if (k >= a.size() || k >= b.size() || a[k].dump != b[k].dump ||
          (!a[k].dump && a[k].words[0] != b[k].words[0])) {
        const auto kind = [k](const std::vector<LogEntry>& e) {
          return k < e.size() && !e[k].dump ? e[k].words[0] : 0;
        };
        out.push_back(
            {core[c].name, k, "entries", kind(a), kind(b), k < a.size() ? a[k] : LogEntry{}});
        break;
      }
      for (unsigned n = 0; n < a[k].words.size(); ++n) {
        const std::string field = field_name(a[k], n);
        const std::uint32_t mask = field.ends_with("psr") ? kStatusBits : ~0u;
        if (((a[k].words[n] ^ b[k].words[n]) & mask) == 0) continue;
        if (open && open(a[k], field)) continue;
        out.push_back({core[c].name, k, field, a[k].words[n], b[k].words[n], a[k]});
      }
    }
  }
  return out;
}

std::string by_qemu_system(const std::string& elf, const std::vector<std::uint8_t>& content,
                           std::uint32_t address) {
  namespace fs = std::filesystem;
  std::string pattern = (fs::temp_directory_path() / "fovea_system_XXXXXX").string();
  if (!::mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
  const fs::path folder = pattern;
  std::ostringstream command;
  command << "(QEMU_AUDIO_DRV=none timeout 60 " QEMU_SYSTEM_ARM
             " -M versatilepb -cpu arm926 -m 64 -display none -nodefaults -nic none"
             " -semihosting-config enable=on,target=native -kernel '"
          << elf << "'";
  if (!content.empty()) {
    const fs::path file = folder / "content.bin";
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(content.data()),
               static_cast<std::streamsize>(content.size()));
    command << " -device 'loader,file=" << file.string() << ",addr=0x" << std::hex << address
            << ",force-raw=on'";
  }
  command << " 2>'" << (folder / "messages").string() << "')";
  std::string out;
  try {
    out = output_of(command.str());
  } catch (const std::exception& e) {
    const auto words = read_file((folder / "messages").string());
    fs::remove_all(folder);
    throw std::runtime_error(command.str() + "\n" + std::string(words.begin(), words.end()));
  }
  fs::remove_all(folder);
  return out;
}

}  // namespace fovea::cpu::test
