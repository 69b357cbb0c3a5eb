#include "display.h"

#include "../mmio.h"
#include "../regs.h"
#include "model/contract/memory_map.h"

/* Left and top edge of the active picture, as in Linux's board-dm365-evm.c. TI's Linux 2.6.32 adds
 * two lines for 625/50 on this chip, to keep bitmap window 0 from shaking (davinci_platform.c). No
 * bitmap window is used here, and with two more lines the top two lines of each field would show
 * the background if 0x16 is the first active line, as assumed in vpss.base_py_625. */
#define BASEPX_525 0x79u
#define BASEPY_525 0x10u
#define BASEPX_625 0x7Eu
#define BASEPY_625 0x16u
#define VDAC_CONFIG_SD 0x081141CFu

display_result_t display_start(const display_mode_t *m) {
  const uint32_t raster_height = m->is_625 ? 576u : 486u;
  if (m->width == 0 || m->height == 0 || m->left + m->width > 720u ||
      m->top + m->height > raster_height || m->height % 2 != 0 || m->top % 2 != 0 ||
      m->pitch_bytes % 32u != 0 || m->pitch_bytes / 32u > 0x1FFu)
    return DISPLAY_BAD_MODE;
  mmio_write32(VENC_VMOD, 0);
  mmio_write32(SYS_VDAC_CONFIG, VDAC_CONFIG_SD);
  mmio_write32(VENC_CLKCTL, 1);
  mmio_write32(VENC_VIDCTL, 0);
  mmio_write32(VENC_OSDCLK0, 1);
  mmio_write32(VENC_OSDCLK1, 2);

  mmio_write32(OSD_MODE, 0);
  mmio_write32(OSD_VIDWINMD, 0);
  mmio_write32(OSD_OSDWIN0MD, 0);
  mmio_write32(OSD_OSDWIN1MD, 0);
  mmio_write32(OSD_RECTCUR, 0);
  mmio_write32(OSD_BASEPX, m->is_625 ? BASEPX_625 : BASEPX_525);
  mmio_write32(OSD_BASEPY, m->is_625 ? BASEPY_625 : BASEPY_525);
  mmio_write32(OSD_VIDWIN0XP, m->left);
  mmio_write32(OSD_VIDWIN0YP, m->top / 2u); /* vertical positions and sizes are in lines of a field */
  mmio_write32(OSD_VIDWIN0XL, m->width);
  mmio_write32(OSD_VIDWIN0YL, m->height / 2u);

  mmio_write32(VENC_VMOD, VMOD_VENC | VMOD_VIE | (m->is_625 ? VMOD_TVTYP_PAL : 0u));
  return DISPLAY_OK;
}

display_result_t display_set_address(uint32_t address, uint32_t pitch_bytes) {
  if (address % 32u != 0 || address < DDR_BASE) return DISPLAY_BAD_ADDRESS;
  const uint32_t units = (address - DDR_BASE) / 32u;
  mmio_write32(OSD_VIDWIN0OFST, OFST_FIXED | ((units >> 23) & 0xFu) << 9 | pitch_bytes / 32u);
  mmio_write32(OSD_VIDWINADH, (units >> 16) & 0x7Fu);
  mmio_write32(OSD_VIDWIN0ADL, units & 0xFFFFu);
  return DISPLAY_OK;
}

void display_enable_window(void) { mmio_write32(OSD_VIDWINMD, VIDWINMD_ACT0 | VIDWINMD_VFF0); }

int display_second_field(void) { return (mmio_read32(VENC_VSTAT) & VSTAT_FIDST) != 0; }

int display_take_late(void) {
  const uint32_t flags = mmio_read32(OSD_MISCCTL);
  if ((flags & OSD_MISCCTL_DMANG) == 0) return 0;
  mmio_write32(OSD_MISCCTL, flags); /* writing 1 clears it */
  return 1;
}
