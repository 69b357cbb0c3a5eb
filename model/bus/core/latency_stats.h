// Read latency of one master.
#pragma once
#include <limits>
#include <string>

#include "model/common/stats.h"

namespace fovea::bus {

/// Read latency at the master's port, for the reports. Without a read there is no figure (null).
struct LatencyStats : StatGroup {
  Histogram histogram;
  Formula mean{*this, "mean", "s", "mean latency of " + reads() + ", from the request to the first beat "
               "at the port", [this] { return value(histogram.mean()); }};
  Formula p50{*this, "p50", "s", "median latency of " + reads(), [this] { return quantile(0.50); }};
  Formula p95{*this, "p95", "s", "latency that 95 % of " + reads() + " stay within",
              [this] { return quantile(0.95); }};
  Formula p99{*this, "p99", "s", "latency that 99 % of " + reads() + " stay within",
              [this] { return quantile(0.99); }};
  Formula max{*this, "max", "s", "largest latency of " + reads(),
              [this] { return value(static_cast<double>(histogram.max())); }};
  explicit LatencyStats(const std::string& master) : StatGroup("ddr." + master + ".latency") {}

 private:
  /// "arm_d's reads"
  std::string reads() const {
    constexpr std::size_t kBefore = 4, kBehind = 8;  // "ddr." and ".latency"
    return prefix().substr(kBefore, prefix().size() - kBefore - kBehind) + "'s reads";
  }
  StatBase::Value value(double ps) const {
    return histogram.count() ? ps * 1e-12 : std::numeric_limits<double>::quiet_NaN();
  }
  StatBase::Value quantile(double q) const {
    return value(static_cast<double>(histogram.quantile(q)));
  }
  void on_reset() override { histogram.reset(); }
};

}  // namespace fovea::bus
