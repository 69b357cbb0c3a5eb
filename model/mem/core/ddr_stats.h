// What the DDR controller counts. Hit, miss and conflict classify a request when its first column
// access is prepared: its row was open, its bank was closed, another row was open.
#pragma once
#include <array>
#include <memory>
#include <string>

#include "model/common/masters.h"
#include "model/common/stats.h"
#include "model/common/units.h"

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
  Counter refreshes{*this, "refreshes", "1", "REF commands"};
  using Value = StatBase::Value;
  DdrStats() : StatGroup("ddr") {}
};

/// Latency of one master's reads: request on its port to first beat at its port.
struct DdrLatencyStats : StatGroup {
  Histogram histogram;
  static double seconds(std::uint64_t ps) { return static_cast<double>(ps) * 1e-12; }
  Formula mean{*this, "mean", "s", "mean read latency, port to first beat",
               [this] { return StatBase::Value(histogram.mean() * 1e-12); }};
  Formula p50{*this, "p50", "s", "median read latency",
              [this] { return StatBase::Value(seconds(histogram.quantile(0.50))); }};
  Formula p95{*this, "p95", "s", "95th percentile of read latency",
              [this] { return StatBase::Value(seconds(histogram.quantile(0.95))); }};
  Formula p99{*this, "p99", "s", "99th percentile of read latency",
              [this] { return StatBase::Value(seconds(histogram.quantile(0.99))); }};
  Formula max{*this, "max", "s", "largest read latency",
              [this] { return StatBase::Value(seconds(histogram.max())); }};
  explicit DdrLatencyStats(Master m)
      : StatGroup("ddr." + std::string(kMasterNames[index(m)]) + ".latency") {}

 protected:
  void on_reset() override { histogram.reset(); }
};

}  // namespace fovea::mem
