// What the reference controller says about its run when it is over.
#include <algorithm>

#include "tb/dram/reference_controller.h"

namespace fovea::dram {
/// JESD209: half of the array is without the bank's upper address bit, a quarter without both, and
/// below that the row's uppermost bits are 0 as well.
unsigned ReferenceController::losses(std::uint32_t address) const {
  const unsigned bank_bits = log2_of(config().banks);
  const unsigned row_bits = log2_of(limits_.size) - bank_bits - config().page_log2;
  const auto bit = [](std::uint32_t n, unsigned place) { return (n >> place & 1u) != 0; };
  unsigned n = 0;
  for (const unsigned kept : losses_)
    n += (kept >= 1 && bit(bank_of(address), bank_bits - 1)) ||
         (kept >= 2 && bit(bank_of(address), bank_bits - 2)) ||
         (kept >= 3 && bit(row_of(address), row_bits - 1)) ||
         (kept >= 4 && bit(row_of(address), row_bits - 2));
  return n;
}

std::array<std::uint64_t, 5> ReferenceController::residency(Picoseconds at) const {
  const std::uint64_t now = ddr_.edge_after(at);
  using Span = std::pair<std::uint64_t, std::uint64_t>;
  std::vector<Span> open;  // rows
  std::array<std::uint64_t, 8> act{};
  std::uint32_t rows = 0;  // banks with one
  const auto close = [&](unsigned bank, std::uint64_t clock) {
    if (rows >> bank & 1u) open.emplace_back(act[bank], clock);
    rows &= ~(1u << bank);
  };
  std::array<std::uint64_t, 5> out{};
  const Given* sleep = nullptr;
  const auto wake = [&](std::uint64_t clock) {
    if (!sleep || clock <= sleep->clock) return;
    const std::uint64_t n = clock - sleep->clock;
    if (sleep->kind == Kind::kPde && rows) out[1] += n;
    out[sleep->kind == Kind::kPde ? 2 : 3] += n;
    // Of this sleep, the spans from a stop of the clock to its start or the end.
    for (std::size_t i = 0; i < clock_changes_.size(); ++i) {
      const auto [stands, from] = clock_changes_[i];
      if (!stands || from < sleep->clock || from >= clock) continue;
      std::uint64_t to = clock;
      if (i + 1 < clock_changes_.size()) to = std::min(to, clock_changes_[i + 1].second);
      out[4] += to - from;
    }
  };
  for (const Given& g : commands) {
    if (g.kind == Kind::kAct) act[g.bank] = g.clock, rows |= 1u << g.bank;
    if (g.kind == Kind::kPre) close(g.bank, g.clock);
    if (g.kind == Kind::kRda || g.kind == Kind::kWra) close(g.bank, g.closes);
    for (unsigned b = 0; b < 8 && g.kind == Kind::kPreAll; ++b) close(b, g.clock);
    if (g.kind == Kind::kPde || g.kind == Kind::kSre) sleep = &g;
    if (g.kind == Kind::kPdx || g.kind == Kind::kSrx) wake(g.clock), sleep = nullptr;
  }
  wake(now);
  for (unsigned b = 0; b < 8; ++b) close(b, std::max(now, act[b]));
  std::sort(open.begin(), open.end());
  std::uint64_t counted = 0;  // up to here
  for (const auto& [from, to] : open) {
    const std::uint64_t first = std::max(from, counted), end = std::min(to, now);
    if (end > first) out[0] += end - first;
    counted = std::max(counted, end);
  }
  return out;
}

std::uint64_t ReferenceController::count(Kind kind) const {
  return static_cast<std::uint64_t>(std::count_if(commands.begin(), commands.end(),
                                                  [&](const Given& g) { return g.kind == kind; }));
}

}  // namespace fovea::dram
