// slowest.csv: the slowest request of each master and direction in the window, with what passed meanwhile.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/bus/core/latency_stats.h"
#include "model/common/mem_observer.h"

namespace fovea::app {

/// A stretch of the time: `culprit` is "bridge", "service", "row_conflict" ..., a master that was served,
/// "own" or "not_known".
struct SlowestStep {
  std::string place, culprit;  ///< place: port, crossbar, controller, return
  Picoseconds from = 0, to = 0;
};

struct SlowestRow {
  std::string master, direction, port, row_state;  ///< row_state: hit, miss, conflict; empty: not known
  Picoseconds issued = 0, latency = 0;
  std::uint32_t address = 0, row = 0;
  unsigned bytes = 0, bank = 0;
  std::vector<SlowestStep> steps;
};

/// The rows of one master. @param name_of what a port is called in the figures of this command
void add_slowest_rows(std::vector<SlowestRow>& rows, const std::string& master, const bus::LatencyStats& of,
                      const std::function<std::string(Master)>& name_of);

/// A line for each step; those of one request add up to its latency.
std::string slowest_csv(std::span<const SlowestRow> rows);

/// The times of a request by what they were spent on, largest first.
std::vector<std::pair<std::string, Picoseconds>> slowest_parts(const SlowestRow& row);
/// "1.92 us at 80.153412 ms"
std::string slowest_when(const SlowestRow& row);
/// Of each master the slower of its two directions, the slowest first.
std::vector<SlowestRow> slowest_of_each(std::span<const SlowestRow> rows);

/// `--around TIME`: all requests to the SDRAM whose time, from issue to last beat, touches TIME +- 2 us, as a
/// master sees them.
class RequestsAround final : public MemObserver {
 public:
  static constexpr Picoseconds kReach = 2 * kPsPerUs;
  RequestsAround(Picoseconds at, std::function<std::string(Master)> name_of)
      : from_(at > kReach ? at - kReach : 0), to_(at + kReach), name_of_(std::move(name_of)) {}
  void submitted(const MemRequest&, bool) override {}
  void responded(const MemRequest& r) override;
  /// master,direction,port,address,bytes,issued_ns,first_ns,last_ns,priority, in the order of their issue.
  std::string csv() const;

 private:
  struct Seen {
    Picoseconds issued, first, last;
    std::uint32_t address;
    Master master;
    std::uint8_t bytes, priority;
    bool write;
  };
  Picoseconds from_, to_;
  std::function<std::string(Master)> name_of_;
  std::vector<Seen> seen_;
};

}  // namespace fovea::app
