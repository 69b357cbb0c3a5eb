#include "sw/fovea/replay/replay_slaves.h"

#include <algorithm>

namespace fovea::app {
namespace {
std::uint64_t words(const MemRequest& r) { return ((r.address & 3u) + r.bytes + 3) / 4; }
}  // namespace

Picoseconds ReplaySlaves::serve_ram(const MemRequest& burst, const Clock& core, Picoseconds arrival) {
  const std::uint64_t begin = core.edge_after(std::max(arrival, ram_free_));
  const std::uint64_t moved = begin + edma_.ram_latency + words(burst) * edma_.ram_word_clocks;
  const std::uint32_t waits = next_wait(burst);
  waited_in_ram_ += waits;
  return ram_free_ = core.edge(moved + waits - 1);
}

Picoseconds ReplaySlaves::serve_registers(const MemRequest& request, Picoseconds word, Picoseconds arrival) {
  Picoseconds& free = registers_free_[index(request.master)];
  return free = std::max(arrival, free) + word * ((request.bytes + 3u) / 4);
}

std::uint32_t ReplaySlaves::next_wait(const MemRequest& burst) {
  auto& transfers = ram_bursts_[index(burst.master)];
  if (transfers.empty()) return 0;
  RamBursts& t = transfers.front();
  const std::uint32_t waits = t.next < t.waits.size() ? t.waits[t.next++] : 0;
  t.left -= std::min<std::uint32_t>(burst.bytes, t.left);
  if (t.left == 0) transfers.pop_front();
  return waits;
}

void ReplaySlaves::add(const Due& due) {
  const auto place = std::upper_bound(due_.begin(), due_.end(), due.at,
                                      [](Picoseconds t, const Due& other) { return t < other.at; });
  due_.insert(place, due);
  next_ = due_.front().at;
}

ReplaySlaves::Due ReplaySlaves::take() {
  const Due first = due_.front();
  due_.pop_front();
  next_ = due_.empty() ? kNever : due_.front().at;
  return first;
}

}  // namespace fovea::app
