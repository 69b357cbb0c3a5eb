#include "priority.h"

#include "../mmio.h"
#include "../regs.h"
#include "psc.h"

/* Each is a field of three bits. */
static const struct {
  uint32_t address, shift;
} kField[] = {
    [PRIORITY_ARM] = {SYS_MSTPRI0, MSTPRI0_ARM},
    [PRIORITY_EDMA_TC0] = {EDMA_QUEPRI, 0},
    [PRIORITY_EDMA_TC1] = {EDMA_QUEPRI, 4},
    [PRIORITY_EDMA_TC2] = {EDMA_QUEPRI, 8},
    [PRIORITY_EDMA_TC3] = {EDMA_QUEPRI, 12},
    [PRIORITY_VPFE] = {ISP5_BCR, BCR_WRITE_PRIORITY},
    [PRIORITY_VPBE] = {ISP5_BCR, BCR_READ_PRIORITY},
    [PRIORITY_IMCOP] = {SYS_MSTPRI0, MSTPRI0_IMCOP},
};

void priority_set(const uint8_t priority[PRIORITY_COUNT]) {
  for (uint32_t i = 0; i < sizeof kField / sizeof *kField; ++i) {
    if (priority[i] == PRIORITY_OF_RESET) continue;
    if (kField[i].address == EDMA_QUEPRI) psc_transition(LPSC_TPCC, PSC_ENABLE);
    mmio_modify32(kField[i].address, PRIORITY_LOWEST << kField[i].shift,
                  (uint32_t)priority[i] << kField[i].shift);
  }
}
