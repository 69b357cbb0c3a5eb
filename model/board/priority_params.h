// The priority of each master that a register of the chip holds one for, as the firmware programs
// it.
#pragma once
#include <deque>
#include <string>
#include <string_view>

#include "model/common/masters.h"
#include "model/common/param.h"
#include "model/contract/words.h"

namespace fovea::board {

/// The name by which a key and the parameter page call the register's master or masters.
constexpr std::string_view priority_name(const MasterInfo& m) {
  return m.priority == PrioritySource::kArm ? "arm" : m.statistics;
}
/// Whether this row is the first one of its register.
constexpr bool first_of_priority(const MasterInfo& m) {
  if (m.priority == PrioritySource::kParameter) return false;
  for (const MasterInfo& other : kMasters.rows)
    if (priority_name(other) == priority_name(m)) return other.id == m.id;
  return false;
}
// The parameter page knows these masters and no others.
static_assert([] {
  std::size_t n = 0;
  for (const MasterInfo& m : kMasters.rows) {
    if (!first_of_priority(m)) continue;
    ++n;
    if (contract::code_of(contract::kMasterWords, priority_name(m)) >= PRIORITY_COUNT) return false;
  }
  return n == contract::kMasterWords.size();
}());

struct PriorityParams : ParamGroup {
  static constexpr const char* kOfReset = "reset";
  std::deque<EnumParam> of;  ///< one for each register, named as the masters are
  PriorityParams() : ParamGroup("priority") {
    for (const MasterInfo& m : kMasters.rows)
      if (first_of_priority(m))
        of.emplace_back(*this, std::string(priority_name(m)), kOfReset,
                        std::vector<std::string>{kOfReset, "0", "1", "2", "3", "4", "5", "6", "7"},
                        "priority on the crossbar that the firmware writes into " + where(m) +
                            ", 0 highest; reset: it writes nothing",
                        Origin::kChoice, "");
  }

 private:
  static std::string where(const MasterInfo& m) {
    std::string text(priority_register(m.priority));
    if (m.priority == PrioritySource::kQueue) text += ".Q" + std::to_string(m.unit);
    if (m.priority == PrioritySource::kArm) text += ", for both ports of the core";
    return text;
  }
};

}  // namespace fovea::board
