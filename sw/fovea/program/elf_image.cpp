#include "sw/fovea/program/elf_image.h"

#include <cxxabi.h>
#include <fmt/format.h>
#include <gelf.h>
#include <libelf.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <tuple>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/program/elf_target.h"

namespace fovea::app {
namespace {

constexpr std::size_t kMaxElfBytes = 256u << 20;
constexpr const char* kAllowed = "allowed: an ELF32 little-endian executable for ARM";

struct ElfEnd {
  void operator()(Elf* elf) const { elf_end(elf); }
};

std::string machine_name(unsigned machine) {
  switch (machine) {
    case EM_X86_64:
      return "x86-64";
    case EM_386:
      return "x86";
    case EM_AARCH64:
      return "AArch64";
    case EM_MIPS:
      return "MIPS";
    case EM_PPC:
      return "PowerPC";
    case EM_RISCV:
      return "RISC-V";
    default:
      return fmt::format("machine number {}", machine);
  }
}

std::string range(std::uint64_t base, std::uint64_t size) {
  return fmt::format("0x{:08x}..0x{:08x}", base, base + size - 1);
}

/// A program's file. Everything that is not as the core needs it is a UserError with the file's name.
class ElfFile {
 public:
  explicit ElfFile(const std::filesystem::path& path)
      : name_(one_line(path.string())), bytes_(read_file(path, kMaxElfBytes)) {
    if (bytes_.size() < EI_NIDENT || std::memcmp(bytes_.data(), ELFMAG, SELFMAG) != 0)
      fail(fmt::format("it is not an ELF file; {}", kAllowed));
    FOVEA_CHECK(elf_version(EV_CURRENT) != EV_NONE, "libelf knows the current ELF version");
    elf_.reset(elf_memory(bytes_.data(), bytes_.size()));
    if (!elf_ || elf_kind(elf_.get()) != ELF_K_ELF) fail(kCut);
  }
  Elf* elf() const { return elf_.get(); }

  /// The entry of an executable for this core; check_entry() tells whether it is in the program.
  std::uint32_t entry_of_header() const {
    GElf_Ehdr header{};
    if (!gelf_getehdr(elf(), &header)) fail(kCut);
    // Checked first: for a program built for the host, "ELF64" would not be a helpful message.
    if (header.e_machine != EM_ARM)
      fail(fmt::format("it is for {}; {}", machine_name(header.e_machine), kAllowed));
    if (header.e_ident[EI_CLASS] != ELFCLASS32)
      fail(fmt::format("it is no ELF32 file; {}", kAllowed));
    if (header.e_ident[EI_DATA] != ELFDATA2LSB)
      fail(fmt::format("it is big-endian; {}", kAllowed));
    if (header.e_type != ET_EXEC)
      fail(fmt::format("it is {}, not linked to fixed addresses; {}",
                       header.e_type == ET_REL ? "an object file" : "no executable", kAllowed));
    if (const std::string why = unfit_flags(header.e_flags); !why.empty())
      fail(fmt::format("{}; {}", why, kAllowedTarget));
    if (header.e_version != EV_CURRENT || header.e_ident[EI_VERSION] != EV_CURRENT)
      fail(fmt::format("it is of version {} of ELF; {}", header.e_version, kAllowed));
    if (header.e_phnum != 0 && header.e_phentsize != sizeof(Elf32_Phdr))
      fail(fmt::format("{}: an entry of the program header has {} bytes; allowed: {}", kCut, header.e_phentsize,
                       sizeof(Elf32_Phdr)));
    return static_cast<std::uint32_t>(header.e_entry);
  }

  /// The entry is where the file has put something, by a physical address, or by a virtual one as kernels have it that
  /// are loaded for their symbols. Bit 0 selects the Thumb state (ELF for the Arm Architecture, "Entry point"), which
  /// must be that of the code there as far as the file's mapping symbols tell.
  void check_entry(std::uint32_t entry, const std::vector<ElfSegment>& segments) const {
    const bool thumb = (entry & 1) != 0;
    const std::uint32_t address = entry & ~1u;
    const auto inside = [&](std::uint32_t ElfSegment::*base) {
      return std::find_if(segments.begin(), segments.end(),
                          [&](const ElfSegment& s) { return address - s.*base < s.data.size(); });
    };
    auto home = inside(&ElfSegment::address);
    const bool physical = home != segments.end();
    if (!physical) home = inside(&ElfSegment::virtual_address);
    if (home == segments.end())
      fail(fmt::format("its entry point 0x{:08x} is in no segment; allowed: an address in the bytes of one", entry));
    if (!thumb && address % 4 != 0)
      fail(fmt::format("its entry point 0x{:08x} is no address of an ARM instruction; allowed: a multiple of 4, or an "
                       "odd address for Thumb code",
                       entry));
    const std::uint32_t at = physical ? address - home->address + home->virtual_address : address;
    const auto above = code_kinds_.upper_bound(at);
    if (above == code_kinds_.begin() || std::prev(above)->first < home->virtual_address) return;
    const char kind = std::prev(above)->second;
    if (kind == (thumb ? 'a' : 't'))
      fail(fmt::format("its entry point 0x{:08x} selects {} state, but the code there is {}; allowed: an odd address "
                       "for Thumb code, an even one for ARM code",
                       entry, thumb ? "Thumb" : "ARM", thumb ? "ARM" : "Thumb"));
  }

  /// What is to be loaded, in the file's order.
  std::vector<ElfSegment> segments() const {
    std::vector<ElfSegment> out;
    std::size_t count = 0;
    if (elf_getphdrnum(elf(), &count) != 0) fail(kCut);
    for (std::size_t i = 0; i < count; ++i) {
      GElf_Phdr p{};
      if (!gelf_getphdr(elf(), static_cast<int>(i), &p)) fail(kCut);
      if (p.p_type != PT_LOAD || p.p_memsz == 0) continue;
      if (p.p_filesz > p.p_memsz)
        fail(fmt::format("segment {} is longer in file than in memory", i));
      if (p.p_offset > bytes_.size() || p.p_filesz > bytes_.size() - p.p_offset)
        fail(fmt::format("{}: segment {} ends behind the end of the file", kCut, i));
      if (p.p_paddr + p.p_memsz > (std::uint64_t{1} << 32))
        fail(fmt::format("segment {} runs over the end of the 32-bit addresses", i));
      const auto* data = reinterpret_cast<const std::uint8_t*>(bytes_.data()) + p.p_offset;
      out.push_back({static_cast<unsigned>(i),
                     static_cast<std::uint32_t>(p.p_paddr),
                     static_cast<std::uint32_t>(p.p_vaddr),
                     static_cast<std::uint32_t>(p.p_memsz),
                     {data, data + p.p_filesz}});
    }
    if (out.empty()) fail("it has no segments to load");
    refuse_overlaps(out);
    return out;
  }

  void check_attributes(Elf_Scn* section) const {
    const Elf_Data* data = elf_rawdata(section, nullptr);
    if (!data) fail(fmt::format("{}: its attributes", kCut));
    const std::string why =
        unfit_attributes({static_cast<const std::uint8_t*>(data->d_buf), data->d_size});
    if (!why.empty()) fail(fmt::format("{}; {}", why, kAllowedTarget));
  }

  void add_symbols(Elf_Scn* section, const GElf_Shdr& table, std::vector<ElfSymbol>& out) {
    Elf_Data* data = elf_getdata(section, nullptr);
    if (!data || table.sh_entsize == 0) fail(fmt::format("{}: the symbol table", kCut));
    std::string source;  // of the local symbols that follow
    for (std::size_t i = 0; i < table.sh_size / table.sh_entsize; ++i) {
      GElf_Sym s{};
      if (!gelf_getsym(data, static_cast<int>(i), &s)) fail(fmt::format("{}: symbol {}", kCut, i));
      const char* text = elf_strptr(elf(), table.sh_link, s.st_name);
      const unsigned type = GELF_ST_TYPE(s.st_info);
      if (type == STT_FILE) source = text ? one_line(text, std::string::npos) : "";
      // '$a', '$t' and '$d' mark instruction sets and data inside a section; they are not symbols.
      if (text && text[0] == '$' && text[1] != '\0' && (text[2] == '\0' || text[2] == '.') && s.st_shndx != SHN_UNDEF)
        code_kinds_[static_cast<std::uint32_t>(s.st_value)] = text[1];
      if (!text || *text == '\0' || *text == '$' || s.st_shndx == SHN_UNDEF) continue;
      if (type != STT_FUNC && type != STT_OBJECT && type != STT_NOTYPE) continue;
      const auto address = static_cast<std::uint32_t>(s.st_value);
      out.push_back({one_line(text, std::string::npos),
                     type == STT_FUNC ? address & ~1u : address,
                     static_cast<std::uint32_t>(s.st_size), type == STT_FUNC || labels_code(s),
                     type == STT_FUNC && (address & 1) != 0});
      if (GELF_ST_BIND(s.st_info) == STB_LOCAL) out.back().file = source;
    }
  }

 private:
  static constexpr const char* kCut = "the ELF file is damaged or cut short";

  [[noreturn]] void fail(const std::string& why) const {
    throw UserError(fmt::format("program '{}': {}", name_, why));
  }
  void refuse_overlaps(std::vector<ElfSegment> sorted) const {
    std::sort(sorted.begin(), sorted.end(),
              [](const auto& a, const auto& b) { return a.address < b.address; });
    for (std::size_t i = 1; i < sorted.size(); ++i)
      if (std::uint64_t{sorted[i - 1].address} + sorted[i - 1].memory_size > sorted[i].address)
        fail(fmt::format("segments {} and {} overlap in their physical addresses, {} and {}", sorted[i - 1].index,
                         sorted[i].index, range(sorted[i - 1].address, sorted[i - 1].memory_size),
                         range(sorted[i].address, sorted[i].memory_size)));
  }
  /// A symbol without a type, as of an assembler's label, in a section of code.
  bool labels_code(const GElf_Sym& s) const {
    if (GELF_ST_TYPE(s.st_info) != STT_NOTYPE || s.st_shndx >= SHN_LORESERVE) return false;
    GElf_Shdr home{};
    Elf_Scn* where = elf_getscn(elf(), s.st_shndx);
    return where && gelf_getshdr(where, &home) && (home.sh_flags & SHF_EXECINSTR) != 0;
  }

  std::string name_, bytes_;
  std::unique_ptr<Elf, ElfEnd> elf_;
  std::map<std::uint32_t, char> code_kinds_;  // 'a', 't' or 'd' from a virtual address on
};

/// Leaves `file` only where it is needed to tell symbols apart, and makes `shown` such that the two do. In the order of
/// the addresses, so that the result is deterministic.
void name_for_people(std::vector<ElfSymbol>& symbols) {
  std::map<std::string, std::vector<ElfSymbol*>> named;
  for (ElfSymbol& s : symbols) named[s.shown = demangled(s.name)].push_back(&s);
  for (auto& [shown, alike] : named) {
    std::map<std::string, std::set<std::uint32_t>> addresses;  // by the linker's name
    std::set<std::uint32_t> all;
    for (const ElfSymbol* const s : alike) addresses[s->name].insert(s->address), all.insert(s->address);
    std::map<std::pair<std::string, std::string>, std::vector<std::uint32_t>> places;  // by name and file
    for (ElfSymbol* const s : alike) {
      if (addresses.size() > 1 && all.size() > 1) s->shown += " [" + s->name + "]";
      if (addresses[s->name].size() == 1) {
        s->file.clear();
        continue;
      }
      auto& same = places[{s->name, s->file}];
      auto at = std::find(same.begin(), same.end(), s->address);
      if (at == same.end()) at = same.insert(same.end(), s->address);
      if (at != same.begin()) s->file += fmt::format("{}#{}", s->file.empty() ? "" : " ", at - same.begin() + 1);
    }
  }
}

}  // namespace

std::string demangled(const std::string& name) {
  if (!name.starts_with("_Z")) return name;
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(abi::__cxa_demangle(name.c_str(), nullptr, nullptr, &status),
                                                         &std::free);
  return status == 0 && text ? text.get() : name;
}

ElfImage ElfImage::load(const std::filesystem::path& path) {
  ElfImage image;
  image.file_ = path.string();
  ElfFile file(path);
  image.entry_ = file.entry_of_header();
  image.segments_ = file.segments();
  std::size_t section_names = 0;
  const bool named = elf_getshdrstrndx(file.elf(), &section_names) == 0;
  for (Elf_Scn* section = nullptr; (section = elf_nextscn(file.elf(), section));) {
    GElf_Shdr table{};
    if (!gelf_getshdr(section, &table)) continue;
    if ((table.sh_flags & SHF_ALLOC) != 0 && table.sh_size > 0 && named) {
      const char* text = elf_strptr(file.elf(), section_names, table.sh_name);
      if (text && *text)
        image.sections_.push_back({one_line(text, std::string::npos),
                                   static_cast<std::uint32_t>(table.sh_addr),
                                   static_cast<std::uint32_t>(table.sh_size)});
    }
    if (table.sh_type == SHT_ARM_ATTRIBUTES) file.check_attributes(section);
    if (table.sh_type == SHT_SYMTAB) file.add_symbols(section, table, image.symbols_);
  }
  file.check_entry(image.entry_, image.segments_);
  std::sort(image.symbols_.begin(), image.symbols_.end(), [](const auto& a, const auto& b) {
    // At one address a symbol with a size comes first; then by name, so that the result is
    // deterministic.
    return std::tuple(a.address, b.size, std::string_view(a.name)) <
           std::tuple(b.address, a.size, std::string_view(b.name));
  });
  name_for_people(image.symbols_);
  for (std::size_t k = 0; k < image.symbols_.size(); ++k)
    if (image.symbols_[k].function) image.functions_.push_back(k);
  return image;
}

const ElfSymbol* ElfImage::find(std::string_view name) const {
  const auto found = std::find_if(symbols_.begin(), symbols_.end(),
                                  [&](const ElfSymbol& s) { return s.name == name; });
  if (found == symbols_.end())
    for (const ElfSymbol& s : symbols_)
      if (s.text() == name) return &s;
  return found == symbols_.end() ? nullptr : &*found;
}

const ElfSymbol* ElfImage::function_at(std::uint32_t address) const {
  auto above =
      std::upper_bound(functions_.begin(), functions_.end(), address,
                       [&](std::uint32_t a, std::size_t i) { return a < symbols_[i].address; });
  const ElfSymbol* label = nullptr;
  while (above != functions_.begin()) {
    const ElfSymbol& s = symbols_[*--above];
    if (s.size != 0) {
      if (address - s.address < s.size) return &s;
      break;  // a label after the end of the last sized function extends to the next symbol
    }
    if (!label || s.address == label->address) label = &s;
  }
  if (!label) return nullptr;
  // But at most to the end of its segment.
  for (const auto& segment : segments_)
    if (address - segment.virtual_address < segment.memory_size &&
        label->address >= segment.virtual_address)
      return label;
  return nullptr;
}

std::string ElfImage::describe(std::uint32_t address) const {
  const ElfSymbol* s = function_at(address);
  if (!s) return "";
  return address == s->address ? s->text() : fmt::format("{}+0x{:x}", s->text(), address - s->address);
}

void check_fits(const ElfImage& image, std::span<const MemoryRegion> regions) {
  for (const auto& s : image.segments()) {
    const bool inside = std::any_of(regions.begin(), regions.end(), [&](const MemoryRegion& r) {
      return s.address >= r.base && std::uint64_t{s.address} + s.memory_size <= r.base + r.size;
    });
    if (inside) continue;
    std::string allowed;
    for (const auto& r : regions)
      allowed += fmt::format("{}{} {}", allowed.empty() ? "" : ", ", r.name, range(r.base, r.size));
    throw UserError(fmt::format(
        "program '{}': segment {} ({}, {} bytes) lies outside memory; "
        "allowed: {}",
        one_line(image.file()), s.index, range(s.address, s.memory_size), s.memory_size, allowed));
  }
}

}  // namespace fovea::app
