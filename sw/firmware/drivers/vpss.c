#include "vpss.h"

#include "../mmio.h"
#include "../regs.h"

void vpss_init(uint32_t vpss_clk_ctrl) {
  mmio_write32(SYS_VPSS_CLK_CTRL, vpss_clk_ctrl);
  mmio_modify32(VPSS_CLKCTL, 0, VPSS_CLKCTL_VPBE | VPSS_CLKCTL_VENC_SEL);
  mmio_modify32(ISP5_PCCR, 0, PCCR_BL | PCCR_ISIF | PCCR_IPIPEIF | PCCR_SYNC);
  /* The routing of the public drivers: byte n of the three registers selects the source of VPSSINT
   * n. */
  mmio_write32(ISP5_INTSEL1, 0x0B1F0100u);
  mmio_write32(ISP5_INTSEL2, 0x1F0A0F1Fu);
  mmio_write32(ISP5_INTSEL3, ISP5_SOURCE_VENC);
  mmio_write32(ISP5_INTSTAT, 0xFFFFFFFFu);
}
