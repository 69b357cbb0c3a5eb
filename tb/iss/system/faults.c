// DFSR, IFSR and FAR after faults, for each kind of descriptor, domain and access.
#include "support.h"

static uint32_t *const coarse = (uint32_t *)(kTables + 0x5000);
static uint32_t *const fine = (uint32_t *)(kTables + 0x6000);

static void accesses(uint32_t va) {
  static fragment *const kSome[] = {read_word, write_word, read_byte,  write_byte,
                                    run_there, swap_word,  write_many, run_thumb_there};
  for (int user = 0; user < 2; ++user)
    for (unsigned k = 0; k < sizeof kSome / sizeof *kSome; ++k) {
      const uint32_t odd = kSome[k] == read_byte || kSome[k] == write_byte ? 3
                           : kSome[k] == run_thumb_there                   ? 2
                                                                           : 0;
      clear_status();
      refresh();
      note(probe(kSome[k], va + odd, user), k, (uint32_t)user, 0);
    }
}

/// A case that inherits no fault.
static void named(const char *name) {
  clear_status();
  begin(name);
}

void program(void) {
  mmu_on();
  ((uint32_t *)kTestPa)[0x40] = ((uint32_t *)kTestPa)[0x41] = 0xE12FFF1Eu;  // bx lr
  ((uint32_t *)kTestPa)[0x540] = ((uint32_t *)kTestPa)[0x541] = 0xE12FFF1Eu;
  for (unsigned k = 0; k < 256; ++k) coarse[k] = 0;
  for (unsigned k = 0; k < 1024; ++k) fine[k] = 0;
  for (uint32_t domain = 1; domain < 16; domain += 7) {
    for (uint32_t mode = 0; mode < 4; ++mode) {
      set_domains(1u | mode << (2 * domain));
      for (uint32_t type = 0; type < 4; ++type)
        for (uint32_t ap = 0; ap < 4; ap += 3) {
          static const char *const kNames[] = {"no section", "coarse", "section", "fine"};
          if (type == 0 || type == 2) {
            named(name3(kNames[type], domain, mode, ap));
            *level1(kTestVa) = (type == 0 ? 0xABCDE010u : kTestPa | ap << 10 | 0x10u | cached()) |
                               domain << 5 | type;
            accesses(kTestVa + 0x100);
            continue;
          }
          for (uint32_t page = 0; page < 4; ++page) {
            static const char *const kCoarse[] = {"coarse, no page", "coarse, large",
                                                  "coarse, small", "coarse, reserved"};
            static const char *const kFine[] = {"fine, no page", "fine, large", "fine, small",
                                                "fine, tiny"};
            named(name3((type == 1 ? kCoarse : kFine)[page], domain, mode, ap));
            const uint32_t entry = kTestPa | (ap * 0x55u) << 4 | page | cached();
            // Tiny pages have one AP field.
            const uint32_t tiny = kTestPa | 0x400u | ap << 4 | page | cached();
            for (unsigned k = 0; k < 16; ++k) coarse[k] = entry;
            for (unsigned k = 0; k < 64; ++k) fine[k] = page == 3 ? tiny : entry;
            *level1(kTestVa) = (uint32_t)(type == 1 ? coarse : fine) | domain << 5 | 0x10u | type;
            accesses(kTestVa + 0x1100);
          }
        }
    }
  }
  // DACR takes effect without a word to the TLB.
  begin("domain changes");
  *level1(kTestVa) = kTestPa | 1u << 10 | 3u << 5 | 0x12u | cached();
  refresh();
  for (uint32_t k = 0; k < 16; ++k) {
    set_domains(1u | ((k * 7 >> 1) & 3u) << 6);
    note(probe(read_word, kTestVa + 4 * k, k & 1), probe(write_byte, kTestVa + 4 * k, k & 1), k, 0);
  }
  // So do S and R.
  begin("S and R change");
  *level1(kTestVa) = kTestPa | 3u << 5 | 0x12u | cached();
  set_domains(1u | 1u << 6);
  refresh();
  for (uint32_t k = 0; k < 12; ++k) {
    set_control((control() & ~0x300u) | (k % 3) << 8);
    note(probe(read_word, kTestVa + 4 * k, k & 1), probe(write_byte, kTestVa + 4 * k, k & 1), k, 0);
  }
  set_control(control() & ~0x300u);
  // Entries go one by one.
  begin("one entry dropped");
  *level1(kTestVa) = kTestPa | 3u << 10 | 3u << 5 | 0x12u;
  refresh();
  note(probe(read_word, kTestVa, 0), 0, 0, 0);
  *level1(kTestVa) = 0;
  drop_entry(kTestVa);
  note(probe(read_word, kTestVa, 0), 0, 0, 0);
}
