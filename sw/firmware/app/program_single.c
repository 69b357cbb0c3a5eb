/* One camera: its table, or up to four that take turns so that no remap finds warm what the one before
 * has read. */
#include <stddef.h>

#include "../drivers/uart.h"
#include "pipeline.h"
#include "program.h"
#include "state.h"
#include "view.h"

static const config_t *config;
static struct {
  lens_view_t lens;
  struct view view;
} views[TABLES_MAX];

void program_print(const config_t *c) {
  if (c->tables <= 1) return;
  uart_puts(", ");
  uart_put_uint(c->tables);
  uart_puts(" tables in turn");
}

uint32_t program_in_count(const config_t *c) { return c->serial ? 1u : c->sources + 2u; }

/* Table k is that of the page's view, moved by k steps. */
void program_build(const config_t *used) {
  extern uint8_t __arena_start[], __arena_end[];
  arena_t arena = {(uintptr_t)__arena_start, (uintptr_t)__arena_end};
  config = used;
  view_configure(config);
  for (uint32_t k = 0; k < config->tables; ++k) {
    uint32_t *entries = k == 0 ? lut : arena_take(&arena, sizeof lut, 4096);
    if (entries == NULL) fail("look-up tables", "no memory left"); /* firmware.ld rules it out */
    lens_view_t *lens = &views[k].lens;
    *lens = config->view;
    lens->shift_x += PARAM_TABLE_STEP_PX * k;
    view_build_lut(lens, entries, 1);
    views[k].view.table = view_table(entries, lens);
    fw_state.table_address[k] = (uint32_t)entries;
  }
  fw_state.tables = config->tables;
  for (uint32_t k = 0; k < config->tables; ++k) view_prepare_method(&views[k].view, &arena);
}

void program_started(const config_t *c) { (void)c; }

void program_work(void) {}

/* Tables and sources take turns, so that no remap finds in the caches or in open rows of the SDRAM
 * what the one before has read. The last remap, whose result is shown, reads the newest frame. */
void program_frame(uint8_t *out, uint32_t sequence) {
  for (uint32_t left = config->repeats; left-- != 0;)
    view_correct(&views[fw_state.remapped % config->tables].view,
                 pipeline_source(left % config->sources), out, sequence);
  pipeline_done();
}
