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
  std::string folder = (std::filesystem::temp_directory_path() / "fovea_iss_XXXXXX").string();
  if (!::mkdtemp(folder.data())) throw std::runtime_error("no temporary folder");
  const std::string stem = folder + "/p";
  {
    std::ofstream s(stem + ".s");
    s << ".syntax unified\n.arm\n.global _start\n_start:\n" << text << "\n";
  }
  std::ostringstream at;
  at << "0x" << std::hex << base;
  Program out;
  out.base = base;
  try {
    output_of(ARM_PREFIX "as -mcpu=arm926ej-s -o " + stem + ".o " + stem + ".s");
    output_of(ARM_PREFIX "ld -Ttext=" + at.str() + " -o " + stem + ".elf " + stem + ".o");
    output_of(ARM_PREFIX "objcopy -O binary " + stem + ".elf " + stem + ".bin");
    std::istringstream names(output_of(ARM_PREFIX "nm " + stem + ".elf"));
    std::string value, kind, name;
    while (names >> value >> kind >> name)
      out.symbols[name] = static_cast<std::uint32_t>(std::stoul(value, nullptr, 16));
    out.bytes = read_file(stem + ".bin");
  } catch (...) {
    std::filesystem::remove_all(folder);
    throw;
  }
  std::filesystem::remove_all(folder);
  return out;
}

}  // namespace fovea::cpu::test
