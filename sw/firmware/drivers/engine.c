#include "engine.h"

#include "../mmio.h"
#include "../regs.h"

#define IDENTITY 0x52454D31u
#define ALL_EVENTS 0x7Fu
#define POLLS 1000000u /* until what is under way has come in after an abort */

int engine_init(void) {
  if (mmio_read32(ENGINE_ID) != IDENTITY) return 0;
  mmio_write32(ENGINE_ENABLES, 0);
  mmio_write32(ENGINE_CTRL, ENGINE_CTRL_ABORT);
  uint32_t polls = POLLS;
  while ((mmio_read32(ENGINE_STATUS) & ENGINE_STATUS_BUSY) != 0)
    if (--polls == 0) return 0;
  mmio_write32(ENGINE_EVENTS, ALL_EVENTS);
  mmio_write32(ENGINE_ENABLES, ALL_EVENTS);
  mmio_write32(ENGINE_CTRL, ENGINE_CTRL_ENABLE);
  return 1;
}

void engine_submit(const remap_engine_job_t *job, uint32_t tag) {
  const uint32_t *word = (const uint32_t *)job;
  for (uint32_t address = ENGINE_MODE; address <= ENGINE_C(2); address += 4u)
    mmio_write32(address, *word++);
  mmio_write32(ENGINE_SUBMIT, tag & ENGINE_SUBMIT_TAG);
}

uint32_t engine_take_events(void) {
  uint32_t all = 0, events;
  while ((events = mmio_read32(ENGINE_EVENTS)) != 0) {
    mmio_write32(ENGINE_EVENTS, events);
    all |= events;
  }
  return all;
}

uint32_t engine_ended(void) { return mmio_read32(ENGINE_ENDED) >> 16; }
