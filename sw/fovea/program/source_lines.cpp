#include "sw/fovea/program/source_lines.h"

#include <dwarf.h>
#include <elfutils/libdw.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>

#include "model/common/check.h"
#include "sw/fovea/program/die_names.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

std::optional<Dwarf_Word> number(Dwarf_Die* die, unsigned attribute) {
  Dwarf_Attribute a;
  Dwarf_Word value = 0;
  if (dwarf_formudata(dwarf_attr(die, attribute, &a), &value) != 0) return std::nullopt;
  return value;
}

/// Of C++, the symbol knows more than the debug information; and a piece of a function, such as `run.part.0`, is called
/// by the function itself, which would look like a recursion under one name. Where the compiler has left nothing but
/// the piece, it is the function.
bool mangled_or_piece(const ElfImage& image, const ElfSymbol& symbol, const std::string& name) {
  return symbol.name.starts_with("_Z") || (symbol.name.starts_with(name + ".") && image.find(name));
}

}  // namespace

struct SourceLines::Program {
  const ElfImage& image;
  int file = -1;
  Dwarf* dwarf = nullptr;
  fs::path root;  // the folder that all sources lie in
  DieNames names;

  explicit Program(const ElfImage& i) : image(i) {
    file = open(image.file().c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) throw UserError(fmt::format("program '{}': it can no longer be read", image.file()));
    dwarf = dwarf_begin(file, DWARF_C_READ);
    find_root();
  }
  ~Program() {
    if (dwarf) dwarf_end(dwarf);
    if (file >= 0) close(file);
  }

  /// A path of the debug information as an absolute one.
  static fs::path absolute(Dwarf_Die* unit, const char* path) {
    Dwarf_Attribute a;
    const char* const folder = dwarf_formstring(dwarf_attr(unit, DW_AT_comp_dir, &a));
    return (fs::path(folder ? folder : "") / path).lexically_normal();
  }
  template <class F>
  void each_unit(F f) {
    Dwarf_CU* cu = nullptr;
    Dwarf_Die die;
    while (dwarf_get_units(dwarf, cu, &cu, nullptr, nullptr, &die, nullptr) == 0)
      if (dwarf_tag(&die) == DW_TAG_compile_unit) f(&die);
  }
  /// Of the units that were compiled in the folder that most were compiled in: libraries may come from
  /// elsewhere.
  void find_root() {
    std::map<std::string, std::vector<fs::path>> folders;
    if (dwarf)
      each_unit([&](Dwarf_Die* unit) {
        Dwarf_Attribute a;
        const char* const name = dwarf_diename(unit);
        const char* const where = dwarf_formstring(dwarf_attr(unit, DW_AT_comp_dir, &a));
        if (name) folders[where ? where : ""].push_back(absolute(unit, name).parent_path());
      });
    const auto most = std::max_element(folders.begin(), folders.end(), [](const auto& a, const auto& b) {
      return a.second.size() < b.second.size();
    });
    if (most == folders.end()) return;
    root = most->second.front();
    for (const fs::path& folder : most->second) {
      fs::path common;
      for (auto a = root.begin(), b = folder.begin(); a != root.end() && b != folder.end() && *a == *b;
           ++a, ++b)
        common /= *a;
      root = common;
    }
  }
  std::string shown(Dwarf_Die* unit, const char* path) const {
    const fs::path whole = absolute(unit, path);
    const fs::path inside = whole.lexically_relative(root);
    return inside.empty() || *inside.begin() == ".." ? whole.string() : inside.string();
  }
  std::string file_of(Dwarf_Die* unit, Dwarf_Word number) const {
    Dwarf_Files* files = nullptr;
    std::size_t count = 0;
    if (dwarf_getsrcfiles(unit, &files, &count) != 0 || number >= count) return "";
    const char* const path = dwarf_filesrc(files, number, nullptr, nullptr);
    return path ? shown(unit, path) : "";
  }
  /// Whether the unit has a function there that the linker has dropped: such a one is described as lying at address 0.
  bool dropped(Dwarf_Die& unit, std::uint32_t address, const ElfSymbol* symbol) {
    Dwarf_Die* scopes = nullptr;
    const int count = dwarf_getscopes(&unit, address, &scopes);
    bool is = false;
    for (int k = 0; k < count; ++k) {
      Dwarf_Addr low = 0;
      if (dwarf_tag(&scopes[k]) != DW_TAG_subprogram) continue;
      is = dwarf_lowpc(&scopes[k], &low) == 0 && low == 0 &&
           !(symbol && (symbol->name == linkage_or_name(&scopes[k]) || symbol->shown == names.of(&scopes[k])));
      break;
    }
    std::free(scopes);
    return is;
  }
  /// Not every compiler writes the index of address ranges that dwarf_addrdie() needs.
  bool unit_at(std::uint32_t address, const ElfSymbol* symbol, Dwarf_Die& unit) {
    if (dwarf_addrdie(dwarf, address, &unit) && !dropped(unit, address, symbol)) return true;
    bool found = false;
    each_unit([&](Dwarf_Die* die) {
      if (found || dwarf_haspc(die, address) != 1 || dropped(*die, address, symbol)) return;
      unit = *die;
      found = true;
    });
    return found;
  }

  /// Empty if the program has no function there.
  std::vector<SourceFrame> at(std::uint32_t address) {
    std::vector<SourceFrame> out;
    const ElfSymbol* const symbol = image.function_at(address);
    SourceFrame here{"", "", 0};
    Dwarf_Die unit;
    if (dwarf && unit_at(address, symbol, unit)) {
      if (Dwarf_Line* const line = dwarf_getsrc_die(&unit, address)) {
        int number = 0;
        const char* const path = dwarf_linesrc(line, nullptr, nullptr);
        if (path) here.file = shown(&unit, path);
        if (dwarf_lineno(line, &number) == 0 && number > 0) here.line = static_cast<unsigned>(number);
      }
      Dwarf_Die* scopes = nullptr;
      int count = dwarf_getscopes(&unit, address, &scopes);
      if (count > 0) {
        // Around an inlined function this lists where it is defined; wanted is where it is inlined.
        Dwarf_Die innermost = scopes[0];
        std::free(scopes);
        scopes = nullptr;
        count = dwarf_getscopes_die(&innermost, &scopes);
      }
      for (int k = 0; k < count; ++k) {
        const int tag = dwarf_tag(&scopes[k]);
        if (tag != DW_TAG_inlined_subroutine && tag != DW_TAG_subprogram) continue;
        here.function = names.of(&scopes[k]);
        if (tag == DW_TAG_subprogram && symbol && mangled_or_piece(image, *symbol, here.function))
          here.function = symbol->shown;
        out.push_back(here);
        if (tag == DW_TAG_subprogram) break;
        here.file = file_of(&unit, number(&scopes[k], DW_AT_call_file).value_or(~Dwarf_Word{0}));
        here.line = static_cast<unsigned>(number(&scopes[k], DW_AT_call_line).value_or(0));
      }
      std::free(scopes);
      // An assembler file has lines but no functions.
      if (out.empty() && (symbol || here.line)) out.push_back(here);
    } else if (symbol) {
      out.push_back(here);
    }
    for (SourceFrame& f : out)
      if (f.function.empty()) f.function = symbol ? symbol->shown : "(unknown)";
    if (!out.empty() && out.back().file.empty() && symbol) out.back().file = symbol->file;
    return out;
  }
};

SourceLines::SourceLines() = default;
SourceLines::~SourceLines() = default;

void SourceLines::add(const ElfImage& image) {
  programs_.push_back(std::make_unique<Program>(image));
  known_.clear();
}

const std::vector<SourceFrame>& SourceLines::at(std::uint32_t address) {
  const auto [place, added] = known_.try_emplace(address);
  if (!added) return place->second;
  for (const auto& p : programs_) {
    place->second = p->at(address);
    if (!place->second.empty()) break;
  }
  if (place->second.empty()) place->second.push_back({"(unknown)", "", 0});
  return place->second;
}

std::pair<const ElfImage*, const ElfSymbol*> SourceLines::function_at(std::uint32_t address) const {
  for (const auto& p : programs_)
    if (const ElfSymbol* const s = p->image.function_at(address)) return {&p->image, s};
  return {};
}

std::string SourceLines::function_text(std::uint32_t address) {
  const SourceFrame& f = at(address).back();
  const ElfSymbol* const symbol = function_at(address).second;
  if (!symbol || symbol->file.empty()) return f.function;
  return fmt::format("{} ({})", f.function, f.file.empty() ? symbol->file : f.file);
}

std::uint32_t SourceLines::function_start(std::uint32_t address) const {
  const ElfSymbol* const s = function_at(address).second;
  return s ? s->address : address;
}

bool SourceLines::have_lines() const {
  for (const auto& p : programs_) {
    Dwarf_CU* cu = nullptr;
    if (p->dwarf && dwarf_get_units(p->dwarf, cu, &cu, nullptr, nullptr, nullptr, nullptr) == 0)
      return true;
  }
  return false;
}

}  // namespace fovea::app
