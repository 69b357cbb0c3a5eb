#include "psc.h"

#include "../mmio.h"
#include "../regs.h"

void psc_transition(uint32_t module, uint32_t state) {
  while ((mmio_read32(PSC_PTSTAT) & 1u) != 0) {
  }
  if ((mmio_read32(PSC_MDSTAT(module)) & PSC_STATE_MASK) == state) return;
  mmio_modify32(PSC_MDCTL(module), PSC_STATE_MASK, state);
  mmio_write32(PSC_PTCMD, 1u);
  while ((mmio_read32(PSC_PTSTAT) & 1u) != 0) {
  }
  while ((mmio_read32(PSC_MDSTAT(module)) & PSC_STATE_MASK) != state) {
  }
}
