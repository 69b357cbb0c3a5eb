#include <fmt/format.h>

#include <algorithm>

#include "sw/fovea/replay/replay_path.h"
#include "sw/fovea/results/figures.h"

namespace fovea::app {

std::vector<StatRow> ReplayPath::stats() {
  std::vector<StatRow> rows;
  collect(ddr().stats, rows);
  const double seconds = static_cast<double>(duration()) * 1e-12;
  rows.push_back({"replay.time", seconds, "s",
                  "from the trace's start to the last completion or, if that is later, the SDRAM's last data"});
  rows.push_back({"replay.requests", requests_, "1", "requests played"});
  rows.push_back({"replay.left_out", left_out_, "1",
                  "requests and transfers of the trace that were not played: the recorded window was over, or the core "
                  "had done all that it did in it"});
  rows.push_back({"replay.ram_waits", waited_in_ram() + ram_.waited_of_bursts(), "cycles",
                  "core clocks for which bursts waited in internal RAM for the core; by a trace without the core's "
                  "accesses to it as in the recorded run"});
  if (seconds > 0) {
    rows.push_back({"replay.bandwidth", static_cast<double>(bytes_) / seconds, "B/s",
                    "bytes moved / replay.time"});
    add_ddr_shares(rows,
                   {ddr().busy_clocks(), ddr().stats.queued_clocks.count(),
                    seconds * ddr().ddr_clock().frequency().hertz()},
                   "replay.time");
  }
  for (const std::string& label : labels()) {
    std::uint64_t read = 0, write = 0, transactions = 0, recorded = 0;
    const MasterState* one = nullptr;
    for (const MasterState& m : masters_) {
      if (m.label != label) continue;
      const bool keeps = trace::keeps_times(info_, static_cast<Master>(&m - masters_.data()));
      read += m.read_bytes;
      write += m.write_bytes;
      transactions += m.transactions;
      recorded += keeps ? m.transactions : m.at_recorded_time;
      one = &m;
    }
    const std::string bus = "bus." + label + ".";
    rows.push_back({bus + "read_bytes", read, "B", "bytes that " + label + " read"});
    rows.push_back({bus + "write_bytes", write, "B", "bytes that " + label + " wrote"});
    rows.push_back({bus + "transactions", transactions, "1", "requests of " + label});
    rows.push_back({bus + "at_recorded_time", recorded, "1",
                    "of these, those that the trace lets go at the time at which they were recorded, whatever the "
                    "memory does, and all of a master whose start the trace does not know; of a video port the pixels' "
                    "clock says when"});
    collect(*one->latency, rows);
    if (memory_only_) continue;  // only the crossbar knows of all waits
    add_wait_rows(label, &MasterWaits::read, "read", rows);
    add_wait_rows(label, &MasterWaits::write, "write", rows);
  }
  return rows;
}

/// As bus::WaitStats names them, with the trace's labels. Ports that the trace does not name served
/// nobody.
void ReplayPath::add_wait_rows(const std::string& label, Waits MasterWaits::*direction,
                               const char* name, std::vector<StatRow>& rows) const {
  Waits sum;
  for (std::size_t m = 0; m < kMasterCount; ++m)
    if (masters_[m].label == label)
      for (std::size_t c = 0; c < kCulprits; ++c)
        sum.ps[c] += (memory_.crossbar().waits[m].*direction).ps[c] + (ddr().waits()[m].*direction).ps[c];
  const auto add = [&](std::string_view culprit, std::uint64_t ps) {
    rows.push_back({fmt::format("ddr.{}.wait.{}.{}", label, name, culprit),
                    static_cast<double>(ps) * 1e-12, "s",
                    culprit == "own" ? fmt::format("total time that {}'s {}s waited behind its own "
                                                   "earlier requests", label, name)
                                     : fmt::format("total time of {}'s {}s by what they waited for: {}",
                                                   label, name, culprit)});
  };
  for (std::size_t c = kMasterCount; c < kCulprits; ++c)
    add(culprit_name(static_cast<Culprit>(c)), sum.ps[c]);
  for (const std::string& other : labels()) {
    std::uint64_t ps = 0;
    for (std::size_t m = 0; m < kMasterCount; ++m)
      if (masters_[m].label == other) ps += sum.ps[m];
    add(other == label ? "own" : other, ps);
  }
}

std::vector<LatencyRow> ReplayPath::latency_rows() const {
  std::vector<LatencyRow> rows;
  for (const std::string& label : labels())
    for (const MasterState& m : masters_)
      if (m.label == label) {
        add_latency_rows(rows, label, *m.latency);
        break;
      }
  return rows;
}

std::vector<SlowestRow> ReplayPath::slowest_rows() const {
  std::vector<SlowestRow> rows;
  for (const std::string& label : labels())
    for (const MasterState& m : masters_)
      if (m.label == label) {
        add_slowest_rows(rows, label, *m.latency, [this](Master of) { return masters_[index(of)].label; });
        break;
      }
  return rows;
}

std::vector<TimelineRow> ReplayPath::timeline() const {
  const std::vector<std::string> names = labels();
  const bus::Timeline& from = memory_.timeline();
  std::vector<TimelineRow> rows;
  const auto list = [&](Picoseconds start, Picoseconds end, const bus::Timeline::Row& bytes) {
    TimelineRow& row = rows.emplace_back();
    row.start = start;
    row.end = end;
    row.read_bytes.resize(names.size());
    row.write_bytes.resize(names.size());
    for (std::size_t m = 0; m < kMasterCount; ++m) {
      const auto name = std::find(names.begin(), names.end(), masters_[m].label);
      if (name == names.end()) continue;
      const auto column = static_cast<std::size_t>(name - names.begin());
      row.read_bytes[column] += bytes.read[m];
      row.write_bytes[column] += bytes.write[m];
    }
  };
  from.list_until(end(), list, true);
  return rows;
}

}  // namespace fovea::app
