// Exception vectors for tests: each exception leaves a record in internal RAM, and the program
// continues.
#pragma once
#include <string>
#include <vector>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {

/// One exception as its handler saw it.
struct Taken {
  std::uint32_t kind;  ///< number of the vector, 1 (undefined) to 7 (FIQ)
  std::uint32_t lr, spsr, cpsr, dfsr, far, ifsr;
};

/// Beginning of a program at 0 or, with high vectors, at the vectors; the test appends code from
/// `start:` on. Records are stored from 0x5000 on. After a prefetch abort the program continues at
/// r12, after the others behind the instruction. IRQ and FIQ handlers first execute `svc #4`, so
/// that the test can lower the line.
inline const std::string kVectors = R"(
  b start
  b undefined
  b software
  b prefetch
  b data
  nop
  b interrupt
  b fast
.macro record kind
  ldr sp, =0x4fe0
  stmia sp, {r0-r2}
  ldr r0, =0x5000
  ldr r1, [r0, #-4]
  add r0, r0, r1
  add r1, r1, #32
  ldr r2, =0x5000
  str r1, [r2, #-4]
  mov r1, #\kind
  str r1, [r0]
  str lr, [r0, #4]
  mrs r1, spsr
  str r1, [r0, #8]
  mrs r1, cpsr
  str r1, [r0, #12]
  mrc p15, 0, r1, c5, c0, 0
  str r1, [r0, #16]
  mrc p15, 0, r1, c6, c0, 0
  str r1, [r0, #20]
  mrc p15, 0, r1, c5, c0, 1
  str r1, [r0, #24]
  ldmia sp, {r0-r2}
.endm
undefined:
  record 1
  movs pc, lr
software:
  record 2
  movs pc, lr
prefetch:
  record 3
  movs pc, r12
data:
  record 4
  subs pc, lr, #4
interrupt:
  record 6
  svc #4
  subs pc, lr, #4
fast:
  record 7
  svc #5
  subs pc, lr, #4
  .ltorg
start:
)";

template <class M>
std::vector<Taken> taken(const M& m) {
  std::vector<Taken> out;
  for (std::uint32_t at = 0; at < m.tcm_word(0x4ffc); at += 32) {
    const auto w = [&](unsigned k) { return m.tcm_word(0x5000 + at + 4 * k); };
    out.push_back({w(0), w(1), w(2), w(3), w(4), w(5), w(6)});
  }
  return out;
}

}  // namespace fovea::cpu::test
