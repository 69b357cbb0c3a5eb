/* Displays the captured frames unchanged: the drivers without table and remap. */
#include "../drivers/cp15.h"
#include "../drivers/gpio.h"
#include "../drivers/intc.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "config.h"
#include "fail.h"
#include "pipeline.h"
#include "state.h"
#include "sw/lens/lens.h"

static config_t config;

int main(void) {
  timer_start();
  intc_init();
  uart_puts("Fovea pass-through\n");
  const uint32_t dip = dip_read();
  fw_state.dip = dip;
  const config_result_t result = config_read(&config, dip, (const param_page_t *)PARAM_PAGE_BASE);
  if (result != CONFIG_OK) fail("configuration", config_result_text(result));
  if (config.source_width != config.width || config.source_height != config.height)
    fail("configuration", "camera and display must have the same size");
  config.serial = 0;
  pipeline_prepare(&config);
  frame_stride =
      (lens_black_offset(config.height, config.pitch_bytes) + CACHE_LINE_BYTES + 4095u) & ~4095u;
  fw_state.version = FW_STATE_VERSION;
  fw_state.width = config.width;
  fw_state.height = config.height;
  fw_state.pitch_bytes = config.pitch_bytes;
  fw_state.in_count = IN_COUNT;
  fw_state.magic = FW_STATE_MAGIC;
  uart_puts("running\n");
  uart_drain();
  pipeline_start(&config, IN_COUNT, 0);
  phase_mark(PHASE_IDLE, 0);
  for (;;) wait_for_interrupt();
}
