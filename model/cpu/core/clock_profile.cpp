#include "model/cpu/core/clock_profile.h"

#include <algorithm>
#include <tuple>

#include "model/common/check.h"
#include "model/cpu/core/bus_port.h"

namespace fovea::cpu {
namespace {

/// B and BL, but for a branch to another function (Ops::branch_away).
bool conditional_branch(const Instruction& i) {
  return (i.op == Op::kB || i.op == Op::kBl) && !(i.flags & kAway);
}

/// The flow always leaves after these if their condition is met.
bool leaves(const Instruction& i) {
  switch (i.op) {
    case Op::kBxReg: case Op::kBlxReg: case Op::kThumbBlSuffix: return true;
    case Op::kLdm: return i.imm & 0x8000u;
    case Op::kB: return true;  // to another function
    default: return false;
  }
}

}  // namespace

unsigned issue_clocks(const Instruction& i) {
  const bool set = i.flags & kSetFlags;
  if (is_data_processing(i.op)) return i.operand == Operand::kShiftReg ? 2 : 1;
  switch (i.op) {
    case Op::kMul: case Op::kMla: return set ? 4 : 2;
    case Op::kUmull: case Op::kUmlal: case Op::kSmull: case Op::kSmlal: return set ? 5 : 3;
    case Op::kLdm:
      if (i.imm & 0x8000u) return i.amount + 4u;
      return i.amount == 1 ? 2 : i.amount;
    case Op::kStm: return i.amount == 1 ? 2 : i.amount;
    case Op::kB: case Op::kBl: case Op::kBxReg: case Op::kBlxReg: case Op::kThumbBlSuffix:
      return 3;
    case Op::kLdr: case Op::kLdrb: case Op::kLdrh: case Op::kLdrsb: case Op::kLdrsh:
    case Op::kStr: case Op::kStrb: case Op::kStrh:
      return i.operand == Operand::kShiftImm ? 1u + i.rs : 1u;
    default: return 1;  // CLZ, first half of a Thumb BL
  }
}

void ClockProfile::enter(std::size_t section) {
  section_ = section;
  if (section >= sections_.size()) sections_.resize(section + 1);
  found_cells_.fill({});
  found_shares_.fill({});
}

ClockProfile::Cell& ClockProfile::cell(std::uint32_t pc) {
  FoundCell& f = found_cells_[pc / 2 % kFound];
  if (!f.cell || f.pc != pc) f = {pc, &sections_[section_].cells[pc]};
  return *f.cell;
}

ClockProfile::Shares& ClockProfile::shares(Cause cause, std::size_t region) {
  const std::uint64_t key = stall_key(pc_, cause, region);
  FoundShares& f = found_shares_[(pc_ / 2 + index(cause) * 64 + region * 16) % kFound];
  if (!f.shares || f.key != key) f = {key, &sections_[section_].stalls[key]};
  return *f.shares;
}

void ClockProfile::issued(std::uint32_t pc, std::uint64_t clocks, std::uint64_t instructions) {
  if (clocks == 0 && instructions == 0) return;
  Cell& c = cell(pc);
  c.issue += clocks;
  c.instructions += instructions;
}

void ClockProfile::stalled(Cause cause, std::size_t region, std::size_t culprit,
                           std::uint64_t clocks) {
  if (cause == Cause::kInterlock)
    cell(pc_).interlock += clocks;
  else
    StallTable::add(shares(cause, region).data(), culprit, clocks);
}

void ClockProfile::stalled(Cause cause, std::size_t region, const BusAccess& access,
                           std::uint64_t clocks, std::uint64_t span, std::uint64_t own) {
  StallTable::split(shares(cause, region).data(), clocks, access.parts, span, own);
}

void ClockProfile::slept(WakeEvent by, std::uint64_t clocks) {
  Cell& c = cell(pc_);
  (given_away_ ? c.wait : c.idle)[static_cast<std::size_t>(by)] += clocks;
}

void ClockProfile::collect(DecodedLine& line) {
  const bool thumb = line.records[1].at == 2;
  const unsigned count = thumb ? 16 : 8;
  // Taken branches within the line.
  for (unsigned k = 0; k < count; ++k) {
    const Instruction& i = line.records[k];
    if (i.body && conditional_branch(i) && i.imm < 32)
      line.tallies[i.imm / 2].flow += line.tally(i).special;
  }
  std::uint32_t executed = 0;
  for (unsigned k = 0; k < count; ++k) {
    const Instruction& i = line.records[k];
    const Tally t = line.tally(i);
    executed += t.flow;
    // A record that waited may have been executed on its own after that.
    if (executed == 0 && t.special == 0 && t.waited == 0) continue;
    FOVEA_CHECK(i.body && executed < 1u << 31 && t.special <= executed,
                "tallies of a line do not balance");
    const std::uint64_t special = t.special, usual = executed - t.special;
    Cell& c = cell(line.va + i.at);
    c.instructions += executed;
    c.interlock += t.waited;
    if (conditional_branch(i)) {
      c.issue += 3 * special + usual;
      executed -= t.special;
    } else {
      c.issue += special + (usual ? usual * issue_clocks(i) : 0);
      if (leaves(i)) executed = t.special;
    }
  }
  line.tallies = {};
}

std::vector<ProfileRow> ClockProfile::rows(std::size_t section) const {
  std::vector<ProfileRow> out;
  if (section >= sections_.size()) return out;
  const auto add = [&](std::uint32_t address, std::size_t cause, std::size_t region,
                       std::size_t culprit, std::uint64_t clocks, std::uint64_t instructions) {
    if (clocks || instructions)
      out.push_back({address, static_cast<std::uint8_t>(cause), static_cast<std::uint8_t>(region),
                     static_cast<std::uint8_t>(culprit), clocks, instructions});
  };
  for (const auto& [address, c] : sections_[section].cells) {
    add(address, ProfileRow::kIssue, 0, 0, c.issue, c.instructions);
    for (std::size_t k = 0; k < kWakeEvents; ++k)
      add(address, ProfileRow::kIdle + k, 0, 0, c.idle[k], 0);
    for (std::size_t k = 0; k < kWakeEvents; ++k)
      add(address, ProfileRow::kWait + k, 0, 0, c.wait[k], 0);
    add(address, ProfileRow::kStall + index(Cause::kInterlock), RegionMap::kNone, kCore, c.interlock,
        0);
  }
  for (const auto& [key, s] : sections_[section].stalls)
    for (std::size_t k = 0; k < kStallCulprits; ++k)
      add(static_cast<std::uint32_t>(key >> 16), ProfileRow::kStall + (key >> 8 & 0xFFu),
          key & 0xFFu, k, StallTable::whole(s.data(), k), 0);
  std::sort(out.begin(), out.end(), [](const ProfileRow& a, const ProfileRow& b) {
    return std::tie(a.address, a.cause, a.region, a.culprit) <
           std::tie(b.address, b.cause, b.region, b.culprit);
  });
  return out;
}

std::uint64_t ClockProfile::clocks(std::size_t section) const {
  std::uint64_t sum = 0;
  for (const ProfileRow& r : rows(section)) sum += r.clocks;
  return sum;
}

}  // namespace fovea::cpu
