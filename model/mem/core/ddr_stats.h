// What the DDR controller counts. Hit, miss and conflict classify a request when its first column
// access is prepared: its row was open, its bank was closed, another row was open.
#pragma once
#include "model/common/stats.h"

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
  Counter power_downs{*this, "power_downs", "1", "entries into power-down"};
  Counter self_refreshes{*this, "self_refreshes", "1", "entries into self-refresh"};
  using Value = StatBase::Value;
  DdrStats() : StatGroup("ddr") {}
};

}  // namespace fovea::mem
