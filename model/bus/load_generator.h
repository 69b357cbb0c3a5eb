// Synthetic traffic on a crossbar port of its own, to load the memory in experiments.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <systemc>

#include "model/common/burst_master.h"
#include "model/common/param.h"

namespace fovea::bus {

struct LoadParams : ParamGroup {
  using U = IntParam::Unit;
  IntParam outstanding{*this, "outstanding", U::kCount, 0, 0, 16,
                       "bursts the load keeps under way; 0: no load", Origin::kChoice, ""};
  IntParam bytes{*this, "bytes", U::kBytes, 64, 4, 64, "size of a burst", Origin::kChoice, ""};
  IntParam gap{*this, "gap", U::kTime, 0, 0, kPsPerMs, "pause from a completion to the next burst",
               Origin::kChoice, ""};
  IntParam priority{*this, "priority", U::kCount, 7, 0, 7, "priority of the load, 0 highest",
                    Origin::kChoice, ""};
  EnumParam pattern{*this, "pattern", "sequential", {"sequential", "random"},
                    "addresses: a walk through its region, or random rows (conflicts)",
                    Origin::kChoice, ""};
  EnumParam kind{*this, "kind", "read", {"read", "write", "mixed"}, "direction of the bursts",
                 Origin::kChoice, ""};
  IntParam start{*this, "start", U::kTime, 0, 0, 3600 * kPsPerSecond, "when the load begins",
                 Origin::kChoice, ""};
  IntParam base{*this, "base", U::kBytes, 32u << 20, 0, 255u << 20,
                "offset of its region in the SDRAM", Origin::kChoice, ""};
  IntParam size{*this, "size", U::kBytes, 8u << 20, 4096, 128u << 20, "size of its region",
                Origin::kChoice, ""};
  LoadParams() : ParamGroup("load") {}
};

/// Keeps a number of bursts under way. A burst refused with a bus error (the SDRAM is not up yet)
/// is tried again after 10 us.
class LoadGenerator : public sc_core::sc_module {
 public:
  BurstMaster memory;
  SC_HAS_PROCESS(LoadGenerator);
  LoadGenerator(sc_core::sc_module_name name, const LoadParams& params)
      : sc_module(name), memory("memory", Master::kLoad, 16), params_(params),
        pause_(params.gap()) {
    memory.on_done = [this](const BurstMaster::Completion& c) {
      wake_.notify(ps_time(c.error ? 10 * kPsPerUs : pause_));
    };
    SC_METHOD(fill);
    sensitive << wake_;
    dont_initialize();
    if (params.outstanding() > 0) {
      // Not at power-up itself: the clocks get their first values in that instant.
      wake_.notify(ps_time(std::max<Picoseconds>(params.start(), kPsPerNs)));
    }
  }

 private:
  void fill() {
    while (memory.outstanding() < params_.outstanding()) {
      const std::uint64_t n = serial_++;
      const std::uint64_t slots = params_.size() / params_.bytes();
      // A fixed generator: the same load in every run.
      state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
      const std::uint64_t slot =
          params_.pattern.is("random") ? (state_ >> 33) % slots : n % slots;
      const auto address = static_cast<std::uint32_t>(0x8000'0000u + params_.base() +
                                                      slot * params_.bytes());
      const bool write = params_.kind.is("write") || (params_.kind.is("mixed") && n % 2 == 1);
      if (write)
        memory.write(address, {data_.data(), static_cast<std::size_t>(params_.bytes())});
      else
        memory.read(address, static_cast<unsigned>(params_.bytes()));
    }
  }

  const LoadParams& params_;
  Picoseconds pause_;
  std::uint64_t serial_ = 0, state_ = 1;
  std::array<std::uint8_t, kMaxBurstBytes> data_{};
  sc_core::sc_event wake_;
};

}  // namespace fovea::bus
