// What the walk over a platform leaves out.
#pragma once
#include <algorithm>
#include <set>
#include <string>
#include <systemc>
#include <vector>

#include "model/common/block.h"
#include "model/common/bus_target.h"
#include "model/common/param.h"

namespace fovea::soc {

/// One line for each block in the SystemC hierarchy, each register bank and each group of statistics
/// that exists but that the walk does not reach.
inline std::vector<std::string> unreached(const Platform& platform) {
  std::vector<std::string> out;
  std::set<const Block*> blocks;
  std::set<const RegBank*> banks;
  std::set<const StatGroup*> groups;
  for (const auto& e : platform.blocks()) blocks.insert(e.block);
  platform.each_registers([&](const std::string&, BusTarget& t) { banks.insert(&t.bank()); });
  platform.each_statistics([&](const StatGroup& g) { groups.insert(&g); });
  for (const auto& e : platform.blocks())
    groups.insert(e.block->own_windows().begin(), e.block->own_windows().end());

  std::vector<sc_core::sc_object*> todo = sc_core::sc_get_top_level_objects();
  while (!todo.empty()) {
    sc_core::sc_object* const object = todo.back();
    todo.pop_back();
    const auto& children = object->get_child_objects();
    todo.insert(todo.end(), children.begin(), children.end());
    const auto* const block = dynamic_cast<const Block*>(object);
    if (block && !blocks.contains(block)) out.push_back(std::string("block ") + object->name());
  }
  for (const RegBank* b : Census<RegBank>::alive())
    if (!banks.contains(b)) out.push_back("registers " + b->name());
  for (const StatGroup* g : Census<StatGroup>::alive())
    if (!groups.contains(g)) out.push_back("statistics " + g->prefix());
  std::sort(out.begin(), out.end());
  return out;
}

/// One line for each group of parameters that exists but that was not declared.
inline std::vector<std::string> undeclared(const ParamSet& set) {
  std::vector<std::string> out;
  for (const ParamGroup* g : Census<ParamGroup>::alive())
    for (const ParamBase* p : g->params())
      if (set.find(p->key()) != p) {
        out.push_back("parameters " + g->prefix());
        break;
      }
  return out;
}

}  // namespace fovea::soc
