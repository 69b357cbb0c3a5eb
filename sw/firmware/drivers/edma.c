#include "edma.h"

#include "../mmio.h"
#include "../regs.h"
#include "psc.h"

/* Registers of channels and codes come in pairs, for 0 to 31 and for 32 to 63. These are the ARM's
 * region. */
#define REGION0(name) EDMA_S0_##name
#define TC_PITCH (EDMA_TC1_REGISTERS - EDMA_TC0_REGISTERS)

static uint32_t half(uint32_t n) { return n / 32u * 4u; }
static uint32_t bit(uint32_t n) { return 1u << n % 32u; }

void edma_init(void) {
  psc_transition(LPSC_TPCC, PSC_ENABLE);
  for (uint32_t tc = 0; tc < EDMA_QUEUES; ++tc) psc_transition(LPSC_EDMA_TC0 + tc, PSC_ENABLE);
  mmio_modify32(SYSTEM_MISC, 0, SYSTEM_MISC_TPTC1_BST);
  mmio_write32(EDMA_QUETCMAP, 0x3210u);
  for (uint32_t high = 0; high <= 4u; high += 4u) {
    mmio_write32(EDMA_DRAE(0) + high, 0xFFFFFFFFu);
    mmio_write32(REGION0(EECR) + high, 0xFFFFFFFFu);
    mmio_write32(REGION0(ECR) + high, 0xFFFFFFFFu);
    mmio_write32(REGION0(IECR) + high, 0xFFFFFFFFu);
    mmio_write32(REGION0(ICR) + high, 0xFFFFFFFFu);
  }
  mmio_write32(EDMA_QRAE(0), 0xFFu);
  edma_close_quick();
  for (uint32_t n = 0; n < EDMA_CHANNELS / 8u; ++n) mmio_write32(EDMA_DMAQNUM0 + 4u * n, 0);
  edma_clear_errors();
}

void edma_map(uint32_t channel, uint32_t queue) {
  const uint32_t shift = channel % 8u * 4u;
  mmio_modify32(EDMA_DMAQNUM0 + channel / 8u * 4u, 7u << shift, queue << shift);
}

void edma_write_set(uint32_t set, const edma_set_t *value) {
  mmio_write32(EDMA_PARAM_OPT(set), value->options);
  mmio_write32(EDMA_PARAM_SRC(set), value->source);
  mmio_write32(EDMA_PARAM_A_B_CNT(set), value->counts);
  mmio_write32(EDMA_PARAM_DST(set), value->destination);
  mmio_write32(EDMA_PARAM_SRC_DST_BIDX(set), value->array_steps);
  mmio_write32(EDMA_PARAM_LINK_BCNTRLD(set), value->link);
  mmio_write32(EDMA_PARAM_SRC_DST_CIDX(set), value->frame_steps);
  mmio_write32(EDMA_PARAM_CCNT(set), value->frames);
}

void edma_open_quick(uint32_t quick_channel, uint32_t set, uint32_t word, uint32_t queue) {
  const uint32_t shift = quick_channel * 4u;
  mmio_write32(EDMA_QCHMAP0 + 4u * quick_channel, set * 32u | word * 4u);
  mmio_modify32(EDMA_QDMAQNUM, 7u << shift, queue << shift);
  mmio_write32(REGION0(QEESR), 1u << quick_channel);
}

void edma_close_quick(void) {
  mmio_write32(REGION0(QEECR), 0xFFu);
  mmio_write32(REGION0(QSECR), 0xFFu);
}

void edma_start(uint32_t channel) { mmio_write32(REGION0(ESR) + half(channel), bit(channel)); }

int edma_done(uint32_t code) { return (mmio_read32(REGION0(IPR) + half(code)) & bit(code)) != 0; }

void edma_clear(uint32_t code) { mmio_write32(REGION0(ICR) + half(code), bit(code)); }

int edma_wait(uint32_t code, uint32_t polls) {
  while (polls-- != 0) {
    if (!edma_done(code)) continue;
    edma_clear(code);
    return 1;
  }
  return 0;
}

uint32_t edma_errors(void) {
  uint32_t errors = (mmio_read32(EDMA_EMR) | mmio_read32(EDMA_EMRH) | mmio_read32(EDMA_QEMR)) != 0;
  errors |= (uint32_t)(mmio_read32(EDMA_CCERR) != 0) << 1;
  for (uint32_t tc = 0; tc < EDMA_QUEUES; ++tc)
    errors |= (uint32_t)(mmio_read32(EDMA_TC0_ERRSTAT + TC_PITCH * tc) != 0) << (4u + tc);
  return errors;
}

void edma_clear_errors(void) {
  for (uint32_t high = 0; high <= 4u; high += 4u) {
    mmio_write32(EDMA_EMCR + high, 0xFFFFFFFFu);
    mmio_write32(REGION0(SECR) + high, 0xFFFFFFFFu);
  }
  mmio_write32(EDMA_QEMCR, 0xFFu);
  mmio_write32(REGION0(QSECR), 0xFFu);
  mmio_write32(EDMA_CCERRCLR, EDMA_CCERRCLR_TCCERR | EDMA_CCERRCLR_QTHRXCD);
  for (uint32_t tc = 0; tc < EDMA_QUEUES; ++tc)
    mmio_write32(EDMA_TC0_ERRCLR + TC_PITCH * tc,
                 EDMA_TC0_ERRCLR_BUSERR | EDMA_TC0_ERRCLR_TRERR | EDMA_TC0_ERRCLR_MMRAERR);
}

void edma_open_interrupt(uint32_t code) { mmio_write32(REGION0(IESR) + half(code), bit(code)); }
