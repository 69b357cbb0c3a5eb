// Where a block lies on the chip: one row for each. Everything else about it is in its own file.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "model/bus/config_bus.h"
#include "model/common/bus_target.h"
#include "model/common/param.h"
#include "model/cpu/core/stalls.h"
#include "model/memsys/memory_system.h"

namespace fovea::soc {

/// Clocks that a row can name.
enum class BlockClock { kNone, kEdma, kAux, kUart1, kVenc };

/// An input of the interrupt controller. Where ARM_INTMUX gives the input two sources
/// (periph/interrupt_mux.h) the block is the first of them, or else the second.
struct Irq {
  unsigned input = 0;
  bool second = false;
  Irq(unsigned n, bool is_second = false) : input(n), second(is_second) {}
};

/// Registers, clock, power gate and interrupts of a block. Interrupts are in the order in which the
/// block declares its outputs.
struct Where {
  std::string name;   ///< in experiments, logs and debuggers, such as "timer0"
  std::string title;  ///< for people
  std::uint32_t base = 0, size = 0;
  bus::ConfigBus::Speed speed = bus::ConfigBus::Speed::kFast;
  BlockClock clock = BlockClock::kNone;
  std::optional<unsigned> lpsc = {};  ///< number of its power and sleep controller; none: always on
  std::vector<Irq> irqs = {};
  /// Whose interrupts these are in the statistics of the core's sleep. Those of the video subsystem go by
  /// the source that is routed to each (interrupt_sources.cpp).
  cpu::WakeEvent wakes = cpu::WakeEvent::kOther;
  /// Only some of its registers are modelled; an access to another one is a bus error.
  bool partly = false;
};

/// The parameter groups of placed blocks, one for each type. Blocks of one type share theirs.
class BlockParams {
 public:
  explicit BlockParams(ParamTree& tree) : tree_(tree) {}
  /// Made at the first call.
  template <class Group>
  Group& get() {
    auto& group = groups_[typeid(Group)];
    if (!group) {
      group = std::make_shared<Group>();
      tree_.add(static_cast<Group&>(*std::static_pointer_cast<Group>(group)));
    }
    return *std::static_pointer_cast<Group>(group);
  }
  template <class Group>
  const Group& get() const {
    return *std::static_pointer_cast<Group>(groups_.at(typeid(Group)));
  }

 private:
  ParamTree& tree_;
  std::map<std::type_index, std::shared_ptr<void>> groups_;
};

/// What a block may ask for when it is made.
struct Surroundings {
  const BlockParams& params;
  memsys::MemorySystem& memory;
};

/// A row of the table of blocks.
struct Placement : Where {
  /// Declares the parameters that the block has as `T::Params`.
  std::function<void(BlockParams&)> declare;
  std::function<std::unique_ptr<BusTarget>(const Surroundings&)> make;
  /// Empty: the chip always has the block.
  std::function<bool(const BlockParams&)> present = {};
  std::string absent = {};  ///< why it is not there then, such as "key 'engine' is none"
};

/// Makes a T from its name, `args`, its `T::Params` if it has parameters, and the memory system if its
/// constructor takes that.
template <class T, class... Args>
std::unique_ptr<BusTarget> make_block(const std::string& name, const Surroundings& with,
                                      const Args&... args) {
  if constexpr (requires { typename T::Params; }) {
    using Params = typename T::Params;
    const Params& params = with.params.get<Params>();
    if constexpr (std::is_constructible_v<T, const char*, const Args&..., const Params&,
                                          memsys::MemorySystem&>)
      return std::make_unique<T>(name.c_str(), args..., params, with.memory);
    else
      return std::make_unique<T>(name.c_str(), args..., params);
  } else {
    return std::make_unique<T>(name.c_str(), args...);
  }
}

/// Places a block of type T (see make_block). References are passed by std::cref.
template <class T, class... Args>
Placement place(Where where, Args... args) {
  Placement row{std::move(where), {}, {}, {}, {}};
  row.declare = [](BlockParams& params) {
    if constexpr (requires { typename T::Params; }) params.get<typename T::Params>();
  };
  row.make = [name = row.name, args = std::tuple(args...)](const Surroundings& with) {
    return std::apply([&](const auto&... a) { return make_block<T>(name, with, a...); }, args);
  };
  return row;
}

/// A block that is there only with some values of its parameters; `absent`: why it is not, otherwise.
template <class Params>
Placement only_if(bool (Params::*condition)() const, std::string absent, Placement row) {
  row.present = [condition](const BlockParams& params) { return (params.get<Params>().*condition)(); };
  row.absent = std::move(absent);
  return row;
}

using Placements = std::vector<Placement>;

/// The rows whose blocks are there, with these values of the parameters; or those whose are not.
inline Placements rows_present(const Placements& rows, const BlockParams& params, bool present = true) {
  Placements out;
  for (const Placement& row : rows)
    if ((!row.present || row.present(params)) == present) out.push_back(row);
  return out;
}

/// The blocks of the chip.
const Placements& dm365_blocks();
/// Those of its rows that have these names, for a machine with a part of the chip.
inline Placements blocks_named(const std::vector<std::string>& names) {
  Placements out;
  for (const std::string& name : names)
    for (const Placement& row : dm365_blocks())
      if (row.name == name) out.push_back(row);
  FOVEA_CHECK(out.size() == names.size(), "a name without a row");
  return out;
}
/// What the configuration bus needs to know of the rows.
inline std::vector<bus::ConfigBus::BlockSpec> bus_blocks(const Placements& rows) {
  std::vector<bus::ConfigBus::BlockSpec> out;
  for (const Placement& row : rows) out.push_back({row.name, row.base, row.size, row.speed});
  return out;
}

/// What the rows of a chip have made, in their order.
class PlacedBlocks {
 public:
  PlacedBlocks(Placements rows, const BlockParams& params, memsys::MemorySystem& memory)
      : rows_(std::move(rows)) {
    for (const Placement& row : rows_) blocks_.push_back(row.make({params, memory}));
  }
  std::size_t size() const { return rows_.size(); }
  const Placement& row(std::size_t i) const { return rows_[i]; }
  BusTarget& block(std::size_t i) const { return *blocks_[i]; }
  /// The block of that name, which is a T.
  template <class T>
  T& get(const std::string& name) const {
    for (std::size_t i = 0; i < rows_.size(); ++i)
      if (rows_[i].name == name) {
        auto* const block = dynamic_cast<T*>(blocks_[i].get());
        FOVEA_CHECK(block, "block of another type: " + name);
        return *block;
      }
    FOVEA_CHECK(false, "no block named " + name);
  }

 private:
  Placements rows_;
  std::vector<std::unique_ptr<BusTarget>> blocks_;
};

}  // namespace fovea::soc
