// plant_bugs FROM TO FILE...: copies sources of the core and plants the defects of planted.h.
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

#include "tb/iss/planted.h"
#include "tb/iss/planted_system.h"

namespace {
std::string read(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}
}  // namespace

int main(int argc, char** argv) {
  using namespace fovea::cpu::test;
  std::vector<Defect> defects(std::begin(kDefects), std::end(kDefects));
  defects.insert(defects.end(), std::begin(kTimingDefects), std::end(kTimingDefects));
  for (const SystemDefect& d : kSystemDefects)
    defects.push_back({fovea::cpu::InsnClass::kCount, d.what, d.file, d.right, d.wrong});
  for (int f = 3; f < argc; ++f) {
    std::string text = read(std::string(argv[1]) + "/" + argv[f]);
    int number = 0;
    for (const Defect& d : defects) {
      ++number;
      if (std::string(d.file) != argv[f]) continue;
      const auto at = text.find(d.right);
      if (at == std::string::npos || text.find(d.right, at + 1) != std::string::npos) {
        std::cerr << argv[f] << ": not there once: " << d.right << "\n";
        return 1;
      }
      std::string wrong = d.wrong;
      for (std::size_t p; (p = wrong.find("PLANTED")) != std::string::npos;)
        wrong.replace(p, 7, "bool(::fovea_planted == " + std::to_string(number) + ")");
      text.replace(at, std::string(d.right).size(), wrong);
    }
    text.insert(0, "extern int fovea_planted;\n");
    const std::string to = std::string(argv[2]) + "/" + argv[f];
    if (read(to) == text) continue;  // what depends on it stays as it is
    std::ofstream out(to);
    out << text;
    if (!out.flush()) return 1;
  }
  return 0;
}
