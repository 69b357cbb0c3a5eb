#include "support.h"

/// 0x40000000: a page that is there, one that is not, and one that no mode may access.
void map(void) {
  mmu_on();
  uint32_t *coarse = (uint32_t *)(kTables + 0x5000);
  for (unsigned k = 0; k < 256; ++k) coarse[k] = 0;
  coarse[0] = kTestPa | 0xFF2u | cached();
  coarse[2] = (kTestPa + 0x2000u) | 2u | cached();
  *level1(kTestVa) = (uint32_t)coarse | 1u << 5 | 0x11u;
  set_domains(5);
  refresh();
}
