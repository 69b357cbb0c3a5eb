// Synthetic traffic on a port of the crossbar, to load the memory in experiments.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <queue>
#include <string>
#include <systemc>
#include <vector>

#include "model/common/block.h"
#include "model/common/burst_master.h"
#include "model/common/param.h"

namespace fovea::bus {

struct LoadParams : ParamGroup {
  using U = IntParam::Unit;
  EnumParam port{*this, "port", "load",
                 ports(),
                 "bus port of the load: one of its own (load), or that of a master that is not used "
                 "otherwise; an EDMA port reads and writes on separate sides",
                 Origin::kChoice, ""};
  IntParam outstanding{*this, "outstanding", U::kCount, 0, 0, 16,
                       "bursts the load keeps under way; 0: no load", Origin::kChoice, ""};
  IntParam bytes{*this, "bytes", U::kBytes, 64, 4, 64, "size of a burst", Origin::kChoice, ""};
  IntParam gap{*this, "gap", U::kTime, 0, 0, kPsPerMs,
               "pause from the completion of a burst to the one that takes its place",
               Origin::kChoice, ""};
  IntParam priority{*this, "priority", U::kCount, 7, 0, 7,
                    "priority on port load, 0 highest; other ports have the chip's registers",
                    Origin::kChoice, ""};
  EnumParam pattern{*this, "pattern", "sequential", {"sequential", "random"},
                    "addresses: a walk through its region, or random rows (conflicts)",
                    Origin::kChoice, ""};
  EnumParam kind{*this, "kind", "read", {"read", "write", "mixed", "copy"},
                 "direction of the bursts; copy: each is read in the lower half of the region and "
                 "written to the upper as soon as it is there",
                 Origin::kChoice, ""};
  IntParam start{*this, "start", U::kTime, 0, 0, 3600 * kPsPerSecond,
                 "when the load begins; a load on the SDRAM waits until 10 us after software has "
                 "initialised that",
                 Origin::kChoice, ""};
  IntParam end{*this, "end", U::kTime, 0, 0, 3600 * kPsPerSecond,
               "from when on no further burst begins; 0s: never", Origin::kChoice, ""};
  EnumParam memory{*this, "memory", "sdram", {"sdram", "internal_ram"},
                   "where its region lies", Origin::kChoice, ""};
  IntParam base{*this, "base", U::kBytes, 32u << 20, 0, 255u << 20,
                "offset of its region in that memory", Origin::kChoice, ""};
  IntParam size{*this, "size", U::kBytes, 8u << 20, 4096, 128u << 20, "size of its region",
                Origin::kChoice, ""};
  explicit LoadParams(std::string prefix) : ParamGroup(std::move(prefix)) {
    for (ParamBase* p : params())
      if (p != &outstanding)
        p->matters_only(outstanding.key() + " above 0", {&outstanding}, [this] { return active(); });
  }
  bool active() const { return outstanding() > 0; }
  bool copies() const { return kind.is("copy"); }
  /// Names of the ports that a load may use (MasterInfo::load_allowed), its own first.
  static std::vector<std::string> ports();
  /// Where its reads and its writes go out.
  Master reader() const;
  Master writer() const;
  bool reads() const { return !kind.is("write"); }
  bool writes() const { return !kind.is("read"); }
};

/// Keeps a number of bursts under way; a copy is one from its read to its write's acknowledgement. On a
/// port for both directions a copy's write goes out 1 ps after its data are there: at that very instant
/// another copy may begin, and the order on the port would be that of the kernel's processes. On
/// the SDRAM it pauses while that is not initialised and 10 us longer, since boot loaders write
/// registers and reset the controller after they have locked its timing. A burst refused with a bus
/// error is tried again after 10 us.
class LoadGenerator : public sc_core::sc_module, public Block {
 public:
  SC_HAS_PROCESS(LoadGenerator);
  LoadGenerator(sc_core::sc_module_name name, const LoadParams& params);

  sc_core::sc_in<bool> sdram_initialised{"sdram_initialised"};

 private:
  BurstMaster& writes() { return other_side_ ? *other_side_ : reads_; }
  void fill();
  void sdram_changed();
  void issue();
  void done(const BurstMaster::Completion& c);
  std::uint64_t region() const { return params_.copies() ? params_.size() / 2 : params_.size(); }

  const LoadParams& params_;
  BurstMaster reads_;
  std::unique_ptr<BurstMaster> other_side_;
  Picoseconds pause_;
  /// The write of a copy on a port for both directions, of which the read has completed.
  struct Copied {
    Picoseconds since;
    std::uint32_t address;
    std::vector<std::uint8_t> data;
  };
  std::deque<Copied> copies_;  // in the order of their reads
  /// When each burst that is not under way may go out. What completes in an instant does so in any
  /// order, before or after fill(): a place must not depend on the others.
  std::priority_queue<Picoseconds, std::vector<Picoseconds>, std::greater<>> ready_;
  Picoseconds usable_from_ = 0;  // its memory; kNever: not known
  std::uint64_t serial_ = 0, state_ = 1;
  std::array<std::uint8_t, kMaxBurstBytes> data_{};
  Timer wake_;
};

}  // namespace fovea::bus
