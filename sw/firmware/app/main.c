/* The fish-eye correction: builds the table at the start, then captures, remaps and displays
 * frames. */
#include "../boot/boot.h"
#include "../drivers/cp15.h"
#include "../drivers/gpio.h"
#include "../drivers/intc.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "config.h"
#include "fail.h"
#include "overlay.h"
#include "pipeline.h"
#include "program.h"
#ifdef TIME_DIVISION
#include "progress.h"
#endif
#include "state.h"
#include "sw/lens/lens.h"

static config_t config;

static void print_config(void) {
  static const char *const kMappings[] = {"none",      "rectilinear",   "linear", "orthographic",
                                          "equisolid", "stereographic", "table"};
  uart_puts("picture ");
  uart_put_uint(config.width);
  uart_puts("x");
  uart_put_uint(config.height);
  if (config.digital) {
    uart_puts(" of a digital camera with ");
    uart_put_uint(config.source_width);
    uart_puts("x");
    uart_put_uint(config.source_height);
  }
  uart_puts(config.is_625 ? " in 625/50, " : " in 525/60, ");
  uart_puts(kMappings[config.view.mapping <= LENS_TABLE ? config.view.mapping : 0]);
  uart_puts(config.serial ? ", serial flow" : ", double buffering");
  if (config.repeats > 1) {
    uart_puts(", ");
    uart_put_uint(config.repeats);
    uart_puts(" remaps for each frame");
  }
  program_print(&config);
  uart_puts("\n");
}

static void init_frames(uint32_t in_count) {
  const uint32_t rows = config.height > config.source_height ? config.height : config.source_height;
  frame_stride = (lens_black_offset(rows, config.pitch_bytes) + CACHE_LINE_BYTES + 4095u) & ~4095u;
  if (in_count * frame_stride > sizeof frame_in) fail("look-up tables", "no memory for a frame of each");
  for (uint32_t n = 0; n < in_count; ++n) {
    uint8_t *black =
        frame_in + n * frame_stride + lens_black_offset(config.source_height, config.pitch_bytes);
    for (uint32_t i = 0; i < CACHE_LINE_BYTES; i += 4) *(uint32_t *)(black + i) = LENS_BLACK_WORD;
  }
}

int main(void) {
  timer_start();
  intc_init();
  uart_puts("Fovea firmware\n");
  const uint32_t dip = dip_read();
  fw_state.dip = dip;
  const config_result_t result = config_read(&config, dip, (const param_page_t *)PARAM_PAGE_BASE);
  if (result != CONFIG_OK) fail("configuration", config_result_text(result));
  print_config();
#ifdef TIME_DIVISION
  progress_start(config.watchdog_us);
#endif
  pipeline_prepare(&config);
  overlay_start(config.overlay, config.self_patch, config.pitch_bytes);

  const uint32_t in_count = program_in_count(&config);
  init_frames(in_count);
  /* Of frames with a longer pitch there is room for three: shown, next, and written. */
  const uint32_t room = sizeof frame_out / frame_stride;
  const uint32_t out_count = config.serial ? 2u : OUT_COUNT < room ? OUT_COUNT : room;
  program_build(&config);
  dcache_clean_all();
  fw_state.version = FW_STATE_VERSION;
  fw_state.width = config.width;
  fw_state.height = config.height;
  fw_state.pitch_bytes = config.pitch_bytes;
  fw_state.in_count = in_count;
  fw_state.out_count = out_count;
  fw_state.magic = FW_STATE_MAGIC;
  uart_puts("running\n");
  uart_drain();
  pipeline_start(&config, in_count, out_count);
  program_started(&config);

  for (;;) {
    uint8_t *out;
    uint32_t sequence;
    program_work();
    /* Checked with interrupts masked: an interrupt that comes after the check still ends the sleep,
     * and is handled when interrupts are unmasked. */
    const uint32_t cpsr = irq_mask();
    const int work = pipeline_take(&out, &sequence);
    if (!work) {
      phase_mark(PHASE_IDLE, pipeline_last_sequence());
      wait_for_interrupt();
    }
    irq_restore(cpsr);
    if (work) program_frame(out, sequence);
  }
}
