// What the DDR controller counts. Hit, miss and conflict classify a request when its first column
// access is prepared: its row was open, its bank was closed, another row was open.
#pragma once
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "model/common/stats.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

struct DdrStats : StatGroup {
  Counter read_bytes{*this, "read_bytes", "B", "payload bytes read, as asked for"};
  Counter write_bytes{*this, "write_bytes", "B", "payload bytes written, as asked for"};
  Counter bursts{*this, "bursts", "1", "BL8 column commands, 16 bytes of bus time each"};
  Formula bus_bytes{*this, "bus_bytes", "B", "bytes of bus time: bursts x 16",
                    [this] { return Value(bursts.count() * 16); }};
  Counter row_hits{*this, "row_hits", "1", "requests that found their row open"};
  Counter row_misses{*this, "row_misses", "1", "requests that found their bank closed"};
  Counter row_conflicts{*this, "row_conflicts", "1", "requests that found another row open"};
  Counter activates{*this, "activates", "1", "ACT commands"};
  Formula command_hit_rate{*this, "command_hit_rate", "ratio",
                           "1 - ACT commands / column commands (RD, WR): the share of column commands "
                           "that needed no row to be opened for them; below zero if rows are opened in vain",
                           [this] {
                             return bursts.count()
                                        ? 1 - static_cast<double>(activates.count()) /
                                                  static_cast<double>(bursts.count())
                                        : std::numeric_limits<double>::quiet_NaN();
                           }};
  Counter refreshes{*this, "refreshes", "1", "REF commands"};
  Maximum refresh_backlog{*this, "refresh_backlog", "1",
                          "most refreshes owed at once; JESD79-2 allows 8 to be postponed"};
  Counter overdue_rows{*this, "overdue_rows", "1", "PRE of a row that was open for T_RASMAX"};
  Counter power_downs{*this, "power_downs", "1", "entries into power-down"};
  Counter self_refreshes{*this, "self_refreshes", "1", "entries into self-refresh"};
  Counter queued_clocks{*this, "queued_clocks", "cycles", "DDR clocks with a request queued"};
  Counter row_open_clocks{*this, "row_open_clocks", "cycles",
                          "DDR clocks with a row open in any bank"};
  Counter power_down_clocks{*this, "power_down_clocks", "cycles", "DDR clocks in power-down"};
  Counter active_power_down_clocks{*this, "active_power_down_clocks", "cycles",
                                   "DDR clocks in power-down with a row open"};
  Counter self_refresh_clocks{*this, "self_refresh_clocks", "cycles",
                              "DDR clocks in self-refresh"};
  Counter clock_stop_clocks{*this, "clock_stop_clocks", "cycles",
                            "DDR clocks in self-refresh with the memory's clock stopped (MCLKSTOPEN)"};
  /// Of the requests to each bank, as above.
  struct Bank {
    std::uint64_t row_hits = 0, row_misses = 0, row_conflicts = 0;
  };
  std::array<Bank, DdrDevice::kMaxBanks> bank{};
  using Value = StatBase::Value;

  DdrStats() : StatGroup("ddr") {
    for (std::size_t i = 0; i < bank.size(); ++i) {
      const auto add = [&](const char* name, std::uint64_t Bank::*count, const char* sentence) {
        of_banks_.push_back(std::make_unique<Formula>(
            *this, "bank" + std::to_string(i) + "." + name, "1",
            sentence + (" in bank " + std::to_string(i)),
            [this, i, count] { return Value(bank[i].*count); }));
      };
      add("row_hits", &Bank::row_hits, "row hits");
      add("row_misses", &Bank::row_misses, "row misses");
      add("row_conflicts", &Bank::row_conflicts, "row conflicts");
    }
  }

 private:
  void on_reset() override { bank.fill({}); }
  std::vector<std::unique_ptr<Formula>> of_banks_;
};

}  // namespace fovea::mem
