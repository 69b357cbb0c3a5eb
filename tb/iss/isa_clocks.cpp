#include "tb/iss/isa_clocks.h"

#include <map>
#include <sstream>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t kCode = 0x100, kData = 0x4000, kStack = 0x4800;
constexpr std::uint32_t kMark = 0xEF000001u, kStop = 0xEF000002u;
constexpr std::uint32_t kThumbMark = 0xDF01u, kThumbStop = 0xDF02u;

}  // namespace

/// Plain operands: no shift, no flags, addresses in internal RAM, branches to what follows.
std::uint32_t plain(int row) {
  const IsaRow& form = isa_rows()[static_cast<std::size_t>(row)];
  IsaFields f;
  f['c'] = form.thumb() ? 0 : 14;  // eq; Z is set
  f['n'] = 4;
  f['d'] = 2;
  f['e'] = 1;
  f['m'] = 5;
  f['s'] = 6;
  f['U'] = 1;
  f['i'] = form.kind.immediate == Immediate::kSigned ? ~0u : 8;
  if (std::string(form.name) == "t bl prefix" || form.op == Op::kThumbBlSuffix) f['i'] = 0;
  f['l'] = 0x3;
  f['f'] = 8;
  f['k'] = 64;
  f['p'] = form.op == Op::kMcr || form.op == Op::kMrc ? 15 : 5;
  f['C'] = 2;
  return isa_encode(row, f);
}

/// The register of plain(row) that is written last, -1: none that a following addition could read.
int last_result(int row) {
  const IsaRow& form = isa_rows()[static_cast<std::size_t>(row)];
  const std::string writes = form.kind.writes;
  if (writes.empty() || form.also || form.op == Op::kBxReg) return -1;
  if (writes == "l") return 1;
  const IsaFields f = isa_fields(row, plain(row));
  if (writes[0] == 'n') return static_cast<int>(f['n']);
  if (isa_has(row, 'e')) return static_cast<int>(f['d'] + 1);
  return f['d'] < 13 ? static_cast<int>(f['d']) : -1;
}

RowRun run_row(int row, int use) {
  const IsaRow& form = isa_rows()[static_cast<std::size_t>(row)];
  Machine m;
  const auto put = [&m](std::uint32_t at, std::uint32_t w, unsigned bytes = 4) {
    std::memcpy(m.tcm.data() + at, &w, bytes);
  };
  // Exceptions come to the same end as everything else; then the run stops.
  for (std::uint32_t vector = 4; vector < 16; vector += 4) put(vector, kMark);
  put(16, kStop);
  const bool thumb = form.thumb();
  const std::uint32_t at = 0x200, next = at + (thumb ? 2 : 4);
  const bool to_thumb =
      thumb ? form.op != Op::kThumbBlSuffix || !(form.flags & kSpsr) : form.op == Op::kBlxImm;
  const std::uint32_t target = to_thumb ? next | 1u : thumb ? at + 8 : next;
  const std::string text =
      " mrs r0, cpsr\n msr spsr_cxsf, r0\n ldr r4, =" + std::to_string(kData) +
      "\n ldr sp, =" + std::to_string(kStack) + "\n ldr r14, =" + std::to_string(target) +
      "\n mov r6, #0\n mov r2, #0\n ldr r0, =" + std::to_string(thumb ? at - 1 : at - 4) +
      "\n cmp r0, r0\n mov r5, #0\n" +
      (form.op == Op::kBxReg || form.op == Op::kBlxReg ? " mov r5, lr\n" : "") +
      " bx r0\n .ltorg\n";
  static std::map<std::string, Program> starts;
  if (!starts.contains(text)) starts[text] = assemble(text, kCode);
  m.load(starts[text]);
  for (const std::uint32_t base : {kData, kStack}) put(base + 4 * kListedRegisters, target);
  put(at - (thumb ? 2 : 4), thumb ? kThumbMark : kMark, thumb ? 2 : 4);
  put(at, plain(row), thumb ? 2 : 4);
  const auto x = static_cast<std::uint32_t>(use);
  if (use >= 0) {  // adds r7, rX, #0 or add r7, rX, rX; then the mark
    put(next, thumb ? 0x1C07u | x << 3 : 0xE0807000u | x << 16 | x, thumb ? 2 : 4);
    put(next + (thumb ? 2 : 4), thumb ? kThumbMark : kMark, thumb ? 2 : 4);
    put(next + (thumb ? 4 : 8), thumb ? kThumbStop : kStop, thumb ? 2 : 4);
  } else if (to_thumb || thumb) {
    put(next, kThumbMark, 2);
    put(next + 2, kThumbStop, 2);
    put(at + 8, kMark);
    put(at + 12, kStop);
  } else {
    put(next, kMark);
    put(next + 4, kStop);
  }
  m.run(kCode);
  return {m.between(), m.core.cpsr() & 31u};
}

/// The hand count of a row, nullptr unless there is exactly one.
const HandCount* hand_count(const std::string& name) {
  const HandCount* found = nullptr;
  for (const HandCount& h : kHandCounts) {
    std::istringstream in(h.rows);
    for (std::string one; std::getline(in >> std::ws, one, ',');)
      if (one == name) {
        if (found) return nullptr;
        found = &h;
      }
  }
  return found;
}

std::vector<std::string> wrong_clocks(int row, unsigned* uses) {
  std::vector<std::string> out;
  const IsaRow& form = isa_rows()[static_cast<std::size_t>(row)];
  const HandCount& by_hand = *hand_count(form.name);
  const auto expect = [&](std::uint64_t is, std::uint64_t should, const char* what) {
    if (is != should)
      out.push_back(std::string(form.name) + what + std::to_string(is) + ", not " +
                    std::to_string(should));
  };
  const RowRun t = run_row(row);
  expect(t.clocks, by_hand.clocks, ": clocks ");
  // Undefined instructions, and those of absent coprocessors, come to the undefined vector.
  const bool undefined = form.op == Op::kUndefined || form.op == Op::kCoprocessor;
  expect(t.mode, undefined ? 0x1Bu : form.op == Op::kBkpt ? 0x17u : 0x13u, ": mode ");
  const int use = undefined ? -1 : last_result(row);
  if (use < 0 || (form.thumb() && use > 7)) {
    expect(by_hand.wait, 0, ": counted by hand, but without a result to use: ");
    return out;
  }
  if (uses) ++*uses;
  expect(run_row(row, use).clocks, by_hand.clocks + by_hand.wait + 1, ", used: clocks ");
  return out;
}

}  // namespace fovea::cpu::test
