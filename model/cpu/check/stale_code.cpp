#include "model/cpu/check/stale_code.h"

#include <bit>
#include <utility>

namespace fovea::cpu {
namespace {
constexpr std::uint32_t kInLine = Cache::kLineBytes - 1;
constexpr unsigned kLooks = 4096;  // boundaries between two searches for lines that were replaced
}  // namespace

StaleCode::StaleCode(Core& core, std::function<void(const Hazard&)> report)
    : core_(core), report_(std::move(report)) {}

void StaleCode::requested(std::uint32_t line_pa, Picoseconds at) {
  requested_[line_pa] = at;
  last_ = line_pa;
  if (changed_.erase(line_pa) && changed_.empty()) watching_ = {};
}

bool StaleCode::held(std::uint32_t line_pa) const {
  if (line_pa == last_) return true;
  const Cache& lines = core_.view().fetch.icache();
  for (unsigned n = 0; n < lines.lines(); ++n)
    if (lines.line(n).tag != 1 && lines.line(n).pa == line_pa) return true;
  return false;
}

void StaleCode::written(Master master, std::uint32_t line_pa, std::uint32_t bytes, Picoseconds at) {
  const auto read = requested_.find(line_pa);
  if (read == requested_.end() || !held(line_pa)) return;
  Changed& c = changed_[line_pa];
  c = {c.bytes | bytes, master, at, read->second};
  if (!watching_) watching_ = core_.observe_boundaries(*this);
}

void StaleCode::at_boundary() {
  if (++boundaries_ % kLooks == 0) drop_replaced();
  const FetchUnit& fetch = core_.view().fetch;
  const std::uint32_t pc = core_.reg(15);
  if (!fetch.cached()) return;
  const int line = fetch.icache().find(fetch.modified(pc));
  if (line < 0) return;
  const std::uint32_t pa = fetch.icache().line(static_cast<unsigned>(line)).pa;
  const auto it = changed_.find(pa);
  if (it == changed_.end()) return;
  const bool thumb = core_.cpsr() & 0x20u;
  const std::uint32_t hit = it->second.bytes & (thumb ? 3u : 15u) << (pc & kInLine);
  if (!hit) return;
  report_({HazardKind::kStaleFetch, it->second.master, pc, pa + static_cast<std::uint32_t>(std::countr_zero(hit)),
           it->second.at, core_.boundary_time(), it->second.filled});
}

/// Observers are not told that a line is replaced; without this the core would be watched for ever.
void StaleCode::drop_replaced() {
  std::erase_if(changed_, [this](const auto& entry) { return !held(entry.first); });
  if (changed_.empty()) watching_ = {};
}

}  // namespace fovea::cpu
