#include "sw/fovea/replay_path.h"

namespace fovea::app {

std::vector<StatRow> ReplayPath::stats() {
  std::vector<StatRow> rows;
  collect(ddr_.stats, rows);
  const double seconds = static_cast<double>(duration()) * 1e-12;
  rows.push_back({"replay.time", seconds, "s", "from the trace's start to the last completion"});
  rows.push_back({"replay.requests", requests_, "1", "requests played"});
  if (seconds > 0) {
    rows.push_back({"replay.bandwidth", static_cast<double>(bytes_) / seconds, "B/s",
                    "bytes moved / replay.time"});
    const double clocks = seconds * ddr_.ddr_clock().frequency().hertz();
    rows.push_back({"ddr.utilisation", static_cast<double>(ddr_.busy_clocks()) / clocks, "ratio",
                    "share of replay.time in which the SDRAM's data bus moves data"});
  }
  for (const MasterState& m : masters_) {
    if (m.label.empty()) continue;
    const std::string bus = "bus." + m.label + ".";
    rows.push_back({bus + "read_bytes", m.read_bytes, "B", "bytes read by this master"});
    rows.push_back({bus + "write_bytes", m.write_bytes, "B", "bytes written by this master"});
    rows.push_back({bus + "transactions", m.transactions, "1", "requests of this master"});
    collect(*m.latency, rows);
  }
  return rows;
}

}  // namespace fovea::app
