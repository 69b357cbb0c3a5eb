#include "isif.h"

#include "../mmio.h"
#include "../regs.h"

isif_result_t isif_configure(const isif_window_t *w) {
  if (w->width == 0 || w->height == 0 || w->width % 2 != 0 || w->height % 2 != 0 ||
      w->top % 2 != 0 || w->pitch_bytes % 32u != 0 || w->pitch_bytes < w->width * 2u)
    return ISIF_BAD_WINDOW;
  mmio_write32(ISIF_SYNCEN, 0);
  mmio_write32(ISIF_REC656IF, 3); /* embedded syncs, with error correction */
  mmio_write32(ISIF_MODESET, MODESET_INPUT_YC8 | MODESET_VD_NEGATIVE | (w->progressive ? 0u : MODESET_INTERLACED));
  mmio_write32(ISIF_CCDCFG, CCDCFG_PACK8 | CCDCFG_YC_IN_SWAP | CCDCFG_Y8POS);
  mmio_write32(ISIF_CULH, 0xFFFF);
  mmio_write32(ISIF_CULV, 0xFF);
  mmio_write32(ISIF_SPH, w->left * 2u);
  mmio_write32(ISIF_LNH, w->width * 2u - 1u);
  mmio_write32(ISIF_SLV0, isif_first_line(w));
  mmio_write32(ISIF_SLV1, isif_first_line(w));
  mmio_write32(ISIF_LNV, isif_field_lines(w) - 1u);
  mmio_write32(ISIF_VDINT0, isif_end_of_field_line(w));
  mmio_write32(ISIF_HSIZE, w->pitch_bytes / 32u);
  mmio_write32(ISIF_SDOFST, w->progressive ? 0u : SDOFST_WEAVE); /* 0: each line behind the one before */
  return ISIF_OK;
}

isif_result_t isif_set_address(uint32_t address) {
  if (address % 32u != 0) return ISIF_BAD_ADDRESS;
  mmio_write32(ISIF_CADU, (address >> 21) & 0x7FFu);
  mmio_write32(ISIF_CADL, (address >> 5) & 0xFFFFu);
  return ISIF_OK;
}

void isif_watch(void) { mmio_write32(ISIF_SYNCEN, SYNCEN_VDHDEN); }

void isif_capture(void) { mmio_write32(ISIF_SYNCEN, SYNCEN_VDHDEN | SYNCEN_WEN); }

int isif_second_field(void) { return (mmio_read32(ISIF_MODESET) & MODESET_FIELD_STATUS) != 0; }
