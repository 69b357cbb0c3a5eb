#include "tb/iss/assembler.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace fovea::cpu::test {

TempFolder::TempFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "fovea_iss_XXXXXX").string();
  if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder: " + name);
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string output_of(const std::string& command) {
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot start: " + command);
  std::string out;
  char chunk[4096];
  while (const std::size_t n = std::fread(chunk, 1, sizeof chunk, pipe)) out.append(chunk, n);
  if (::pclose(pipe) != 0) throw std::runtime_error(command + "\n" + out);
  return out;
}

std::vector<std::uint8_t> read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

Program assemble(const std::string& text, std::uint32_t base) {
  const TempFolder folder;
  const std::string source = folder.quoted("p.s"), object = folder.quoted("p.o"),
                    elf = folder.quoted("p.elf"), binary = folder.quoted("p.bin");
  {
    std::ofstream s(folder.path() / "p.s");
    s << ".syntax unified\n.arm\n.global _start\n_start:\n" << text << "\n";
  }
  std::ostringstream at;
  at << "0x" << std::hex << base;
  Program out;
  out.base = base;
  // objdump, not nm: nm loads the compiler's plugin, which takes longer than all the others together.
  std::istringstream table(output_of(ARM_PREFIX "as -mcpu=arm926ej-s -o " + object + " " + source +
                                     " && " ARM_PREFIX "ld -Ttext=" + at.str() + " -o " + elf +
                                     " " + object + " && " ARM_PREFIX "objcopy -O binary " + elf +
                                     " " + binary + " && " ARM_PREFIX "objdump -t " + elf));
  for (std::string line; std::getline(table, line);) {  // VALUE FLAGS SECTION SIZE NAME
    if (line.find('\t') == std::string::npos) continue;
    const std::string name = line.substr(line.rfind(' ') + 1);
    out.symbols[name] = static_cast<std::uint32_t>(std::stoul(line, nullptr, 16));
  }
  out.bytes = read_file(folder.path() / "p.bin");
  return out;
}

}  // namespace fovea::cpu::test
