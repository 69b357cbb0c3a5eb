// SDRAM latencies of one master, as statistics.
#pragma once
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/bus/core/latency_histogram.h"
#include "model/common/stats.h"

namespace fovea::bus {

/// `ddr.<master>.latency.*`: reads to their first beat; with `read_last`, `write_first` and `write_last`
/// before the figure's name the others (BeatLatencies). Without a request there is no figure (null).
class LatencyStats final : public StatGroup {
 public:
  /// @param ports the master's own, which outlive this: both sides of a transfer controller are one
  LatencyStats(const std::string& master, std::vector<PortLatencies*> ports)
      : StatGroup("ddr." + master + ".latency"), ports_(std::move(ports)) {
    add("", &PortLatencies::read, &BeatLatencies::first,
        master + "'s reads, from the request to the first beat at the port");
    add("read_last.", &PortLatencies::read, &BeatLatencies::last,
        master + "'s reads, from the request to the last beat at the port");
    add("write_first.", &PortLatencies::write, &BeatLatencies::first,
        master + "'s writes, from the request until the crossbar takes the first beat");
    add("write_last.", &PortLatencies::write, &BeatLatencies::last,
        master + "'s writes, from the request to the acknowledgement at the port");
  }

  using Direction = BeatLatencies PortLatencies::*;
  using Beat = LatencyHistogram BeatLatencies::*;
  LatencyHistogram histogram(Direction direction, Beat beat) const {
    LatencyHistogram sum;
    for (const PortLatencies* p : ports_) sum.add(p->*direction.*beat);
    return sum;
  }
  LatencyHistogram read_first() const {
    return histogram(&PortLatencies::read, &BeatLatencies::first);
  }
  /// The slowest request of a direction, over the ports; among equals the one issued first. Null: there was none.
  const SlowRequest* slowest(bool write) const {
    const SlowRequest* out = nullptr;
    for (const PortLatencies* p : ports_) {
      const SlowRequest& s = write ? p->slowest_write : p->slowest_read;
      if (s.latency == 0) continue;
      if (!out || s.latency > out->latency || (s.latency == out->latency && s.issued < out->issued)) out = &s;
    }
    return out;
  }
  /// Calls f(direction, beat, histogram) with their names, for the four of them.
  template <class F>
  void each(F f) const {
    for (const auto& [name, direction] :
         {std::pair{"read", &PortLatencies::read}, std::pair{"write", &PortLatencies::write}})
      for (const auto& [beat_name, beat] : {std::pair{"first", &BeatLatencies::first},
                                            std::pair{"last", &BeatLatencies::last}})
        f(name, beat_name, histogram(direction, beat));
  }

 private:
  void add(const std::string& name, Direction direction, Beat beat, const std::string& of) {
    const auto figure = [&](const char* figure_name, const char* what, auto value) {
      formulas_.push_back(std::make_unique<Formula>(
          *this, name + figure_name, "s", what + of, [this, direction, beat, value] {
            const LatencyHistogram h = histogram(direction, beat);
            return StatBase::Value(h.count() ? static_cast<double>(value(h)) * 1e-12
                                             : std::numeric_limits<double>::quiet_NaN());
          }));
    };
    using H = LatencyHistogram;
    figure("mean", "mean latency of ", [](const H& h) { return h.mean(); });
    figure("p50", "median latency of ", [](const H& h) { return h.quantile(0.50); });
    figure("p95", "latency within which 95 % stay of ", [](const H& h) { return h.quantile(0.95); });
    figure("p99", "latency within which 99 % stay of ", [](const H& h) { return h.quantile(0.99); });
    figure("max", "largest latency of ", [](const H& h) { return h.max(); });
  }
  void on_reset() override {
    for (PortLatencies* p : ports_) *p = {};
  }

  std::vector<PortLatencies*> ports_;
  std::vector<std::unique_ptr<Formula>> formulas_;
};

}  // namespace fovea::bus
