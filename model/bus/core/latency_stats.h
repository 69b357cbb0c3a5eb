// Read latency of one master.
#pragma once
#include <string>

#include "model/common/stats.h"

namespace fovea::bus {

/// Read latency at the master's port, for the reports.
struct LatencyStats : StatGroup {
  Histogram histogram;
  Formula mean{*this, "mean", "s", "mean read latency, request to first beat at the port",
               [this] { return StatBase::Value(histogram.mean() * 1e-12); }};
  Formula p50{*this, "p50", "s", "median read latency", [this] { return quantile(0.50); }};
  Formula p95{*this, "p95", "s", "95th percentile of read latency",
              [this] { return quantile(0.95); }};
  Formula p99{*this, "p99", "s", "99th percentile of read latency",
              [this] { return quantile(0.99); }};
  Formula max{*this, "max", "s", "largest read latency",
              [this] { return StatBase::Value(static_cast<double>(histogram.max()) * 1e-12); }};
  explicit LatencyStats(const std::string& master) : StatGroup("ddr." + master + ".latency") {}

 private:
  StatBase::Value quantile(double q) const {
    return StatBase::Value(static_cast<double>(histogram.quantile(q)) * 1e-12);
  }
  void on_reset() override { histogram.reset(); }
};

}  // namespace fovea::bus
