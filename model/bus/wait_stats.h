// What each master's SDRAM requests waited for, from the tables of those who made them wait.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/common/stats.h"
#include "model/common/waits.h"

namespace fovea::bus {

/// `ddr.<master>.wait.<read|write>.<culprit>`: sums over the requests of the window. All culprits of a
/// direction together are the time from issue to first beat (read) or acknowledgement (write).
class WaitStats final : public StatGroup {
 public:
  /// `tables`: the parts, to be added; they outlive this. A transfer controller's two sides, named by
  /// either, are one.
  WaitStats(Master m, std::vector<WaitTable*> tables)
      : StatGroup("ddr." + std::string(stat_name(m)) + ".wait"),
        master_(m),
        tables_(std::move(tables)) {
    add("read.", &MasterWaits::read);
    add("write.", &MasterWaits::write);
  }
  /// True for each side of a transfer controller.
  bool is_of(Master m) const { return same(m); }
  std::uint64_t total(Waits MasterWaits::*direction, Culprit c) const {
    std::uint64_t t = 0;
    for (const WaitTable* w : tables_)
      for (std::size_t i = 0; i < kMasterCount; ++i)
        if (same(static_cast<Master>(i))) t += ((*w)[i].*direction).ps[index(c)];
    return t;
  }

 private:
  struct Named {
    Culprit culprit;
    const char* sentence;
  };
  static constexpr Named kNamed[] = {
      {Culprit::kBridge, "spent between port and crossbar, both ways"},
      {Culprit::kService, "spent on their own way through crossbar and controller"},
      {Culprit::kRowMiss, "waited for the rows of closed banks to be opened"},
      {Culprit::kRowConflict, "waited for another row to be closed and theirs to be opened"},
      {Culprit::kTurnaround, "waited for the data bus to turn between reads and writes"},
      {Culprit::kRefresh, "waited for a refresh"},
      {Culprit::kPowerDown, "waited for the memory to wake up"},
  };

  void add(const std::string& prefix, Waits MasterWaits::*direction) {
    const auto entry = [&](const std::string& name, std::vector<Culprit> culprits,
                           const std::string& sentence) {
      formulas_.push_back(std::make_unique<Formula>(
          *this, prefix + name, "s",
          "total time that " + std::string(stat_name(master_)) + "'s " +
              prefix.substr(0, prefix.size() - 1) + "s " + sentence,
          [this, direction, culprits] {
            std::uint64_t t = 0;
            for (const Culprit c : culprits) t += total(direction, c);
            return StatBase::Value(static_cast<double>(t) * 1e-12);
          }));
    };
    for (const Named& n : kNamed)
      entry(std::string(culprit_name(n.culprit)), {n.culprit}, n.sentence);
    for (std::size_t i = 0; i < kStatCount; ++i) {
      std::vector<Culprit> ports;
      for (const MasterInfo& m : kMasters.rows)
        if (stat_index(m.id) == i) ports.push_back(culprit(m.id));
      if (i == stat_index(master_))
        entry("own", ports, "waited behind its own earlier requests");
      else
        entry(std::string(kStatNames[i]), ports,
              "waited while " + std::string(kStatNames[i]) + " was served");
    }
  }
  bool same(Master m) const { return stat_index(m) == stat_index(master_); }
  void on_reset() override {
    for (WaitTable* w : tables_)
      for (std::size_t i = 0; i < kMasterCount; ++i)
        if (same(static_cast<Master>(i))) (*w)[i] = {};
  }

  Master master_;
  std::vector<WaitTable*> tables_;
  std::vector<std::unique_ptr<Formula>> formulas_;
};

}  // namespace fovea::bus
