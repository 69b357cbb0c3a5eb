// Names of functions in DWARF debug information, as a demangler writes them.
#pragma once
#include <elfutils/libdw.h>

#include <string>
#include <unordered_map>

namespace fovea::app {

/// The names of functions as people write them: of C the plain name, of C++ `A::step(int)`. A function without a
/// linkage name, which C++ gives to those of one file alone, gets its name from the scopes and the types of its
/// parameters; a `typedef` counts as what it stands for.
class DieNames {
 public:
  /// @param die a function, or an inlined copy of one
  const std::string& of(Dwarf_Die* die);

 private:
  std::unordered_map<Dwarf_Off, std::string> known_;
};

/// Name for the linker if there is one, otherwise the plain name.
std::string linkage_or_name(Dwarf_Die* die);

}  // namespace fovea::app
