// The fast context switch extension: addresses below 32 MB are moved by the process number, for
// accesses, fetches, vectors, faults and fault addresses.
#include "support.h"

/// Empties the caches and sets the process number without a memory access in between.
void switch_process(uint32_t pid);

enum { kLow = 0x01C00000, kMegabyte = 0x100000 };

static void accesses(void) {
  static const uint32_t kAt[] = {
      kLow,        kLow + kMegabyte,   kLow + 2 * kMegabyte, kTestVa, kLow + 3 * kMegabyte,
      0x04C00000u, kTestVa + kMegabyte};
  static fragment *const kSome[] = {read_word, write_byte, run_there, write_many,
                                    read_word_as_user};
  for (unsigned n = 0; n < sizeof kAt / sizeof *kAt; ++n)
    for (int user = 0; user < 2; ++user)
      for (unsigned k = 0; k < sizeof kSome / sizeof *kSome; ++k)
        note(probe(kSome[k],
                   kAt[n] + (kSome[k] == run_there    ? 0x100
                             : kSome[k] == write_byte ? 9
                                                      : 64),
                   user),
             n, k, (uint32_t)user);
}

void program(void) {
  mmu_on();
  // bx lr, in the test page and where process 0 finds memory without a page of its own.
  for (unsigned k = 0; k < 4; ++k) {
    ((volatile uint32_t *)kTestPa)[0x40 + k] = 0xE12FFF1Eu;
    *(volatile uint32_t *)(kLow + 0x100u + k * kMegabyte) = 0xE12FFF1Eu;
  }
  *(volatile uint32_t *)0x00C00100u = 0xE12FFF1Eu;  // process 2 sees it at 0x04C00100
  for (uint32_t pid = 1; pid < 4; ++pid) {
    // Each process finds the program where it was, and pages of its own at kLow.
    const uint32_t base = pid << 25;
    for (uint32_t s = 0; s < 28; ++s) *level1(base + (s << 20)) = *level1(s << 20);
    *level1(base + kLow) = kTestPa | 3u << 10 | 0x12u | cached();
    *level1(base + kLow + kMegabyte) = kTestPa | (pid & 3u) << 10 | 0x12u | cached();
    *level1(base + kLow + 2 * kMegabyte) = 0;
    *level1(base + kLow + 3 * kMegabyte) = kTestPa | 3u << 10 | 2u << 5 | 0x12u | cached();
  }
  *level1(kTestVa) = kTestPa | 1u << 10 | 0x12u;
  refresh();
  for (uint32_t round = 0; round < 5; ++round) {
    const uint32_t pid = round & 3;
    begin(name3("process", pid, round, 0));
    switch_process(pid << 25);
    accesses();
    switch_process(0);
  }
}
