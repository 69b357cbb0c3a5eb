// Every access, privileged and as user, to every kind of page, for all values of AP, S, R and
// domain mode.
#include "support.h"

enum { kSection, kLarge, kSmall, kTiny, kKinds };

static uint32_t *const coarse = (uint32_t *)(kTables + 0x5000);
static uint32_t *const fine = (uint32_t *)(kTables + 0x6000);
static const char *const kKindNames[] = {"section", "large page", "small page", "tiny page"};

/// The page at kTestVa; quarter q of a large or small page gets (ap + q) & 3.
static void map(unsigned kind, unsigned ap) {
  const uint32_t quarters = ap | ((ap + 1) & 3) << 2 | ((ap + 2) & 3) << 4 | ((ap + 3) & 3) << 6;
  switch (kind) {
    case kSection:
      *level1(kTestVa) = kTestPa | ap << 10 | 1u << 5 | 0x12u | cached();
      break;
    case kLarge:
      for (unsigned k = 0; k < 16; ++k) coarse[k] = kTestPa | quarters << 4 | 1u | cached();
      *level1(kTestVa) = (uint32_t)coarse | 1u << 5 | 0x11u;
      break;
    case kSmall:
      coarse[0] = kTestPa | quarters << 4 | 2u | cached();
      *level1(kTestVa) = (uint32_t)coarse | 1u << 5 | 0x11u;
      break;
    default:
      fine[0] = kTestPa | ap << 4 | 3u | cached();
      *level1(kTestVa) = (uint32_t)fine | 1u << 5 | 0x13u;
      break;
  }
}

static fragment *const kAll[] = {
    read_word,          read_byte,         read_half,         write_word,  write_byte,
    write_half,         run_there,         run_thumb_there,   read_double, write_double,
    read_many,          write_many,        swap_word,         swap_byte,   read_word_as_user,
    write_word_as_user, read_byte_as_user, write_byte_as_user};

static volatile uint32_t *const plain = (uint32_t *)kTestPa;

static void fill(void) {
  for (unsigned k = 0; k < 16; ++k) {
    plain[k] = 0x01020304u * (k + 1);
    plain[64 + k] = 0xE12FFF1Eu;   // bx lr
    plain[128 + k] = 0x47704770u;  // bx lr in Thumb state, twice
  }
}

void program(void) {
  mmu_on();
  for (unsigned kind = 0; kind < kKinds; ++kind)
    for (unsigned domain = 0; domain < 4; ++domain)
      for (unsigned rs = 0; rs < 3; ++rs)  // both set is UNPREDICTABLE
        for (unsigned ap = 0; ap < 4; ++ap) {
          begin(name3(kKindNames[kind], domain, rs, ap));
          set_domains(1u | domain << 2);
          set_control((control() & ~0x300u) | rs << 8);
          map(kind, ap);
          fill();
          for (int user = 0; user < 2; ++user)
            for (unsigned k = 0; k < sizeof kAll / sizeof *kAll; ++k) {
              refresh();
              const uint32_t where = kAll[k] == run_there         ? 0x100u
                                     : kAll[k] == run_thumb_there ? 0x200u
                                                                  : 8 * k;
              const uint32_t got = probe(kAll[k], kTestVa + where, user);
              refresh();
              note(got, plain[2 * k], plain[2 * k + 1], plain[2 * k + 2]);
            }
          if (kind != kLarge && kind != kSmall) continue;
          // Quarters, one access each, through the same entry of the TLB and through fresh ones.
          for (int user = 0; user < 2; ++user)
            for (unsigned q = 0; q < 8; ++q) {
              const uint32_t at = kTestVa + (q & 3) * (kind == kLarge ? 0x4000u : 0x400u) + 0x20u;
              const uint32_t got = probe(read_byte, at + 3, user);
              note(got, probe(write_half, at + 2, user), at, q);
              if (q >= 3) refresh();
            }
        }
}
