#include "sw/fovea/program/die_names.h"

#include <dwarf.h>
#include <fmt/format.h>

#include <cstdlib>

#include "sw/fovea/program/elf_image.h"

namespace fovea::app {
namespace {

std::string attribute_text(Dwarf_Die* die, unsigned attribute) {
  Dwarf_Attribute a;
  const char* const t = dwarf_formstring(dwarf_attr_integrate(die, attribute, &a));
  return t ? t : "";
}

bool follow_reference(Dwarf_Die* die, unsigned attribute, Dwarf_Die* to) {
  Dwarf_Attribute a;
  return dwarf_formref_die(dwarf_attr(die, attribute, &a), to) != nullptr;
}

bool has_attribute(Dwarf_Die* die, unsigned attribute) { return dwarf_hasattr_integrate(die, attribute) != 0; }

/// C++ tells functions of one name apart by the types of their parameters.
bool is_cplusplus(Dwarf_Die* die) {
  Dwarf_Die unit;
  if (!dwarf_diecu(die, &unit, nullptr, nullptr)) return false;
  const int language = dwarf_srclang(&unit);
  for (const int known : {DW_LANG_C_plus_plus, DW_LANG_C_plus_plus_03, DW_LANG_C_plus_plus_11, DW_LANG_C_plus_plus_14})
    if (language == known) return true;
  return false;
}

/// Types that refer to each other without end are damage.
constexpr int kDeepest = 16;

std::string scope_text(Dwarf_Die* die, int depth);

std::string type_text(Dwarf_Die* holder, int depth = 0) {
  Dwarf_Attribute a;
  Dwarf_Die type;
  if (depth > kDeepest) return "...";
  if (!dwarf_formref_die(dwarf_attr_integrate(holder, DW_AT_type, &a), &type)) return "void";
  const auto inner = [&] { return type_text(&type, depth + 1); };
  switch (dwarf_tag(&type)) {
    case DW_TAG_pointer_type:
      return inner() + "*";
    case DW_TAG_reference_type:
      return inner() + "&";
    case DW_TAG_rvalue_reference_type:
      return inner() + "&&";
    case DW_TAG_const_type:
      return inner() + " const";
    case DW_TAG_volatile_type:
      return inner() + " volatile";
    case DW_TAG_typedef:
      return inner();
    case DW_TAG_array_type:
      return inner() + " []";
    case DW_TAG_subroutine_type:
      return inner() + " ()";
    default:
      break;
  }
  const std::string name = attribute_text(&type, DW_AT_name);
  return scope_text(&type, depth + 1) + (name.empty() ? "{unnamed type}" : name);
}

std::string parameter_text(Dwarf_Die* function, int depth) {
  std::string out;
  Dwarf_Die child;
  if (dwarf_child(function, &child) == 0) do {
      const int tag = dwarf_tag(&child);
      if (tag == DW_TAG_unspecified_parameters) out += out.empty() ? "..." : ", ...";
      if (tag != DW_TAG_formal_parameter || has_attribute(&child, DW_AT_artificial)) continue;
      // A constant parameter is no other type of function.
      std::string type = type_text(&child, depth + 1);
      for (constexpr std::string_view kConst = " const"; type.ends_with(kConst);)
        type.resize(type.size() - kConst.size());
      out += (out.empty() ? "" : ", ") + type;
    } while (dwarf_siblingof(&child, &child) == 0);
  return "(" + out + ")";
}

/// Of a function that does not change its object.
bool keeps_object(Dwarf_Die* function) {
  Dwarf_Attribute a;
  Dwarf_Die object;
  if (!dwarf_formref_die(dwarf_attr_integrate(function, DW_AT_object_pointer, &a), &object)) return false;
  const std::string type = type_text(&object);
  return type.ends_with(" const*") || type.ends_with(" const* const");
}

/// Parameters of the call operator if the class is a lambda's.
std::string lambda_parameters(Dwarf_Die* type, int depth) {
  if (dwarf_tag(type) != DW_TAG_structure_type || !attribute_text(type, DW_AT_name).empty()) return "";
  Dwarf_Die child;
  if (dwarf_child(type, &child) == 0) do {
      if (dwarf_tag(&child) == DW_TAG_subprogram && attribute_text(&child, DW_AT_name) == "operator()")
        return parameter_text(&child, depth);
    } while (dwarf_siblingof(&child, &child) == 0);
  return "";
}

/// Lambdas of a scope with equal parameters are numbered from 1.
std::string lambda_text(Dwarf_Die* type, Dwarf_Die* scope, const std::string& of, int depth) {
  unsigned number = 1;
  Dwarf_Die child;
  if (dwarf_child(scope, &child) == 0) do {
      if (dwarf_dieoffset(&child) == dwarf_dieoffset(type)) break;
      if (lambda_parameters(&child, depth) == of) ++number;
    } while (dwarf_siblingof(&child, &child) == 0);
  return fmt::format("{{lambda{}#{}}}", of, number);
}

/// The function where it is defined first, and declared in its class.
Dwarf_Die first_declaration(Dwarf_Die die) {
  Dwarf_Die to;
  for (int k = 0; k < kDeepest && follow_reference(&die, DW_AT_abstract_origin, &to); ++k) die = to;
  if (follow_reference(&die, DW_AT_specification, &to)) die = to;
  return die;
}

std::string function_text(Dwarf_Die* die, int depth) {
  const std::string name = attribute_text(die, DW_AT_name);
  if (!is_cplusplus(die) || name == "main") return name;
  if (const std::string linkage = attribute_text(die, DW_AT_linkage_name); !linkage.empty()) {
    const std::string plain = demangled(linkage);
    return plain == linkage && linkage.starts_with("_Z") ? name : plain;
  }
  Dwarf_Die declared = first_declaration(*die);
  // extern "C": neither scopes nor types are in its name.
  if (dwarf_hasattr(&declared, DW_AT_external) && !has_attribute(&declared, DW_AT_declaration) &&
      !has_attribute(&declared, DW_AT_object_pointer))
    return name;
  return scope_text(&declared, depth + 1) + name + parameter_text(&declared, depth) +
         (keeps_object(&declared) ? " const" : "");
}

/// "A::", "(anonymous namespace)::B::", "main::{lambda(int)#1}::"
std::string scope_text(Dwarf_Die* die, int depth) {
  if (depth > kDeepest) return "";
  Dwarf_Die* around = nullptr;
  const int count = dwarf_getscopes_die(die, &around);
  std::string out;
  for (int k = 1; k < count; ++k) {  // the first one is the DIE itself
    std::string name = attribute_text(&around[k], DW_AT_name);
    const int tag = dwarf_tag(&around[k]);
    if (tag == DW_TAG_compile_unit) break;
    if (tag == DW_TAG_subprogram) {
      out.insert(0, function_text(&around[k], depth + 1) + "::");
      break;  // has its own scopes
    }
    if (tag == DW_TAG_namespace && name.empty()) name = "(anonymous namespace)";
    if (name.empty() && k + 1 < count)
      if (const std::string of = lambda_parameters(&around[k], depth); !of.empty())
        name = lambda_text(&around[k], &around[k + 1], of, depth);
    if (!name.empty()) out.insert(0, name + "::");
  }
  std::free(around);
  return out;
}

}  // namespace

std::string linkage_or_name(Dwarf_Die* die) {
  const std::string linkage = attribute_text(die, DW_AT_linkage_name);
  return linkage.empty() ? attribute_text(die, DW_AT_name) : linkage;
}

const std::string& DieNames::of(Dwarf_Die* die) {
  const auto [place, added] = known_.try_emplace(dwarf_dieoffset(die));
  if (added) place->second = function_text(die, 0);
  return place->second;
}

}  // namespace fovea::app
