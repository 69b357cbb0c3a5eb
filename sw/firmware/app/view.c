#include "view.h"

#include "../drivers/cp15.h"
#include "../drivers/gpio.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "fail.h"
#include "overlay.h"
#include "remapper.h"
#include "say.h"
#include "state.h"
#include "sw/lens/fast_lut.h"

volatile uint32_t view_other_ticks;

static const config_t *config;

void view_configure(const config_t *used) { config = used; }

remap_table_t view_table(uint32_t *entries, const lens_view_t *view) {
  return (remap_table_t){.width = config->width,
                         .height = config->height,
                         .source_width = config->source_width,
                         .source_height = config->source_height,
                         .pitch_bytes = config->pitch_bytes,
                         .lut = entries,
                         .view = view,
                         .has_engine = config->has_engine};
}

/* Time of the build that is in progress. A frame that came between the two reads would be in one of them alone. */
static uint32_t own_ticks(void) {
  const uint32_t cpsr = irq_mask();
  const uint32_t ticks = timer_ticks() - view_other_ticks;
  irq_restore(cpsr);
  return ticks;
}

/* In fixed point if the page wants that and the lens allows it. */
static void fill_lut(const lens_t *lens, uint32_t *entries) {
  static fast_lut_t fast;
  if (config->table_builder == BUILDER_FIXED) {
    const fast_lut_result_t result = fast_lut_prepare(&fast, lens);
    if (result == FAST_LUT_OK) {
      fast_lut_build(&fast, entries, config->pitch_bytes);
      return;
    }
    uart_puts("LUT: not in fixed point: ");
    uart_puts(fast_lut_result_text(result));
    uart_puts("\n");
  }
  lens_build_lut(lens, entries, config->pitch_bytes);
}

void view_build_lut(const lens_view_t *view, uint32_t *entries, int marked) {
  lens_t lens;
  const lens_result_t result =
      lens_init_sizes(&lens, view, (lens_size_t){config->source_width, config->source_height},
                      (lens_size_t){config->width, config->height});
  if (result != LENS_OK) fail("lens", lens_result_text(result));
  if (marked) phase_mark(PHASE_LUT, 0);
  const uint32_t start = own_ticks();
  fill_lut(&lens, entries);
  const uint32_t ticks = own_ticks() - start;
  if (marked) fw_state.lut_time_ticks += ticks; /* of the start */
  if (marked) phase_mark(PHASE_IDLE, 0);
  fw_state.lut_entries = lens_lut_entries(config->width, config->height);
  uart_puts("LUT: ");
  uart_put_uint(fw_state.lut_entries);
  uart_puts(" entries in ");
  uart_put_uint(ticks / TIMER_TICKS_PER_MS);
  uart_puts(" ms\n");
}

void view_prepare_method(struct view *view, arena_t *arena) {
  const uint32_t start = own_ticks();
  view->method = remapper_prepare(config->kernel, &view->table, arena);
  uart_puts("kernel: ");
  uart_puts(view->method->name);
  uart_puts(", ");
  uart_put_uint(view->table.encoded_bytes);
  uart_puts(" bytes of tables");
  if (view->table.encoded != NULL) {
    uart_puts(" in ");
    uart_put_uint((own_ticks() - start) / TIMER_TICKS_PER_MS);
    uart_puts(" ms");
  }
  uart_puts("\n");
}

/* Sum of the source words of the first output row. It is the same before and after the remap unless
 * the camera has written to the frame meanwhile. */
static uint32_t first_row_sum(const remap_table_t *table, const uint8_t *in) {
  uint32_t sum = 0;
  for (uint32_t i = 0; i < table->width / 2u; ++i)
    sum = sum * 31u + *(const volatile uint32_t *)(in + table->lut[i]);
  return sum;
}

void view_correct(const struct view *view, const uint8_t *in, uint8_t *out, uint32_t sequence) {
  const uint32_t bytes = view->table.source_height * view->table.pitch_bytes;
  (void)bytes; /* OMIT_D_INVALIDATE leaves out all its uses */
  phase_mark(PHASE_REMAP_START, sequence);
#ifndef OMIT_D_INVALIDATE
  dcache_invalidate_range(in, bytes);
#endif
  const uint32_t before = first_row_sum(&view->table, in);
  view->method->run(&view->table, in, out);
#ifndef OMIT_D_INVALIDATE
  /* Larger frames have driven the first row's lines out of the cache by now, or the method has
   * invalidated all of it. */
  if (bytes < DCACHE_BYTES) dcache_invalidate_range(in, bytes);
#endif
  if (first_row_sum(&view->table, in) != before) ++fw_state.torn;
  overlay_frame(out, sequence);
#ifndef OMIT_D_CLEAN
  dcache_clean_range(out, view->table.height * view->table.pitch_bytes);
#endif
  write_buffer_drain();
  phase_mark(PHASE_REMAP_END, sequence);
  ++fw_state.remapped;
}
