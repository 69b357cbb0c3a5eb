// Whole random programs, and the rows of the table that none of them contains.
#include "tb/iss/random_code.h"

#include <algorithm>

#include "tb/iss/random_generator.h"

namespace fovea::cpu::test {
namespace {

constexpr Excuse kExcuses[] = {{"mrs spsr", "user mode has no SPSR"},
                               {"msr spsr reg", "user mode has no SPSR"},
                               {"msr spsr imm", "user mode has no SPSR"},
                               {"ldm user", "privileged"},
                               {"ldm return", "privileged"},
                               {"stm user", "privileged"},
                               {"svc", "calls the operating system"},
                               {"bkpt", "calls the operating system"},
                               {"udf", "calls the operating system"},
                               {"t svc", "calls the operating system"},
                               {"t bkpt", "calls the operating system"},
                               {"t udf", "calls the operating system"},
                               {"mcr", "CP15 is privileged"},
                               {"mrc", "CP15 is privileged"},
                               {"mcrr", "undefined: no such coprocessor"},
                               {"mrrc", "undefined: no such coprocessor"},
                               {"cdp", "undefined: no such coprocessor"},
                               {"ldc pre", "undefined: no such coprocessor"},
                               {"ldc post", "undefined: no such coprocessor"},
                               {"ldc option", "undefined: no such coprocessor"},
                               {"stc pre", "undefined: no such coprocessor"},
                               {"stc post", "undefined: no such coprocessor"},
                               {"stc option", "undefined: no such coprocessor"},
                               {"cdp2", "undefined: no such coprocessor"},
                               {"ldc2 pre", "undefined: no such coprocessor"},
                               {"ldc2 post", "undefined: no such coprocessor"},
                               {"ldc2 option", "undefined: no such coprocessor"},
                               {"stc2 pre", "undefined: no such coprocessor"},
                               {"stc2 post", "undefined: no such coprocessor"},
                               {"stc2 option", "undefined: no such coprocessor"},
                               {"mcr2", "undefined: no such coprocessor"},
                               {"mrc2", "undefined: no such coprocessor"}};

}  // namespace

Generator::Generator(std::uint64_t seed, unsigned sequences, unsigned length)
    : random_(seed), length_(length) {
  program.counts.resize(isa_rows().size());
  // Entry; tables; results; code on pages of its own.
  tables_ = kMemory + 64;
  results_ = tables_ + sequences * 64;
  const std::uint32_t code = (results_ + sequences * kSequenceBytes + 4095) / 4096 * 4096;
  put(kAlways | 0x0A000000u | ((code - kMemory - 8) >> 2), 4);
  while (here() < results_) put(0, 4);
  while (here() < code) put(value(), 4);
  for (unsigned k = 0; k < sequences; ++k) sequence(k);
  finish(sequences);
}

/// Rows of a state in random order, again and again.
int Generator::next_row(bool thumb_state) {
  auto& deck = decks_[thumb_state];
  if (deck.empty()) {
    for (int row = 0; row < static_cast<int>(isa_rows().size()); ++row)
      if (row_at(row).thumb() == thumb_state && !excused(row)) deck.push_back(row);
    for (std::size_t k = deck.size(); k > 1; --k)
      std::swap(deck[k - 1], deck[r(static_cast<std::uint32_t>(k))]);
  }
  const int row = deck.back();
  deck.pop_back();
  return row;
}

void Generator::sequence(unsigned k) {
  const bool is_thumb = k % 3 == 2;
  const std::uint32_t table = tables_ + 64 * k, out = results_ + kSequenceBytes * k;
  program.begin.push_back(here());
  for (unsigned n = 0; n < 15; ++n) patch(table + 4 * n, n == 14 ? r(32) << 27 : value());
  arm_constant(kSp, table);
  arm(kAlways | 0x059D0038u);  // ldr r0, [sp, #56]
  arm(kAlways | 0x0128F000u);  // msr cpsr_f, r0
  arm(kAlways | 0x089D5FFFu);  // ldmia sp, {r0-r12, lr}
  arm_constant(kSp, out + kLeftBytes);
  if (is_thumb) {
    arm_to_thumb();
    for (unsigned n = 0; n < length_; ++n) thumb_step(next_row(true));
    thumb_to_arm();
  } else {
    for (unsigned n = 0; n < length_; ++n) arm_step(next_row(false));
  }
  arm_constant(kSp, out);
  arm(kAlways | 0x08AD5FFFu);  // stmia sp!, {r0-r12, lr}
  arm(kAlways | 0x010F0000u);  // mrs r0, cpsr
  arm(kAlways | 0x020004FFu);  // and r0, r0, #0xFF000000
  arm(kAlways | 0x058D0000u);  // str r0, [sp]
  program.end.push_back(here());
}

void Generator::finish(unsigned sequences) {
  skip([&] {  // its effect is not compared
    arm_constant(1, results_);
    arm_constant(2, sequences * kSequenceBytes);
  });
  for (const std::uint32_t w : {0xE3A00001u, 0xE3A07004u, 0xEF000000u,   // write
                                0xE3A00000u, 0xE3A07001u, 0xEF000000u})  // exit
    put(w, 4);
  for (unsigned k = 0; k < 256; ++k) put(value(), 4);  // within reach of literal loads
}

std::span<const Excuse> excuses() { return kExcuses; }

bool excused(int row) {
  return std::any_of(std::begin(kExcuses), std::end(kExcuses),
                     [row](const Excuse& e) { return std::string(e.row) == row_at(row).name; });
}

RandomProgram generate(std::uint64_t seed, unsigned sequences, unsigned length) {
  return Generator(seed, sequences, length).program;
}

std::vector<std::uint8_t> as_elf(const std::vector<std::uint8_t>& image, std::uint32_t base) {
  constexpr std::uint32_t kOffset = 4096;  // offset and address agree within a page
  std::vector<std::uint8_t> out(kOffset + image.size());
  const auto put = [&out](unsigned at, std::uint32_t v, unsigned bytes) {
    std::memcpy(out.data() + at, &v, bytes);
  };
  const std::uint8_t ident[] = {0x7F, 'E', 'L', 'F', 1, 1, 1};
  std::memcpy(out.data(), ident, sizeof ident);
  put(16, 2, 2);   // executable
  put(18, 40, 2);  // ARM
  put(20, 1, 4);
  put(24, base, 4);          // entry
  put(28, 52, 4);            // program headers
  put(36, 0x0500'0000u, 4);  // EABI 5
  put(40, 52, 2);
  put(42, 32, 2);
  put(44, 1, 2);
  const auto size = static_cast<std::uint32_t>(image.size());
  const std::uint32_t header[] = {1, kOffset, base, base, size, size, 7, 4096};
  std::memcpy(out.data() + 52, header, sizeof header);
  std::copy(image.begin(), image.end(), out.begin() + kOffset);
  return out;
}

}  // namespace fovea::cpu::test
