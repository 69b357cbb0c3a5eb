/* One camera: its table, or up to four that take turns so that no remap finds warm what the one before
 * has read. */
#include <stddef.h>

#include "../drivers/cp15.h"
#include "../drivers/uart.h"
#include "../kernels/engine_jobs.h"
#include "fail.h"
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

/* Memory of the look-up tables behind `lut`: the first one lowest, so that it can be given up first. */
static void take_tables(uint32_t *entries[], arena_t *arena) {
  entries[0] = lut;
  for (uint32_t k = config->tables; k-- > 1;) {
    entries[k] = arena_take_end(arena, sizeof lut, 4096);
    if (entries[k] == NULL) fail("look-up tables", "no memory left"); /* firmware.ld rules it out */
  }
}

/* If less is left than the next form needs, look-up tables whose own form is there are given up, except
 * for the first row, which shows whether a frame is torn. Only forms as large as a look-up table come to
 * that (firmware.ld), and methods with such a form do not read the look-up table any more. */
static void make_room(uint32_t prepared, uint32_t *entries[], size_t needed, arena_t *arena) {
  for (uint32_t k = 1; k < prepared && arena->end - arena->next < needed; ++k) {
    if ((uintptr_t)entries[k] != arena->end) continue; /* is given up already */
    struct view *view = &views[k].view;
    const size_t row = config->width / 2u * sizeof(uint32_t);
    uint32_t *first_row = arena_take(arena, row, CACHE_LINE_BYTES);
    if (first_row == NULL || view->table.encoded == NULL) return;
    for (uint32_t i = 0; i < config->width / 2u; ++i) first_row[i] = entries[k][i];
    view->table.lut = first_row;
    fw_state.table_address[k] = 0;
    arena->end = (uintptr_t)entries[k + 1u];
  }
}

/* Table k is that of the page's view, moved by k steps. */
void program_build(const config_t *used) {
  extern uint8_t __arena_start[], __arena_end[];
  arena_t arena = {(uintptr_t)__arena_start, (uintptr_t)__arena_end};
  config = used;
  view_configure(config);
  uint32_t *entries[TABLES_MAX];
  take_tables(entries, &arena);
  for (uint32_t k = 0; k < config->tables; ++k) {
    lens_view_t *lens = &views[k].lens;
    *lens = config->view;
    lens->shift_x += PARAM_TABLE_STEP_PX * k;
    view_build_lut(lens, entries[k], 1);
    views[k].view.table = view_table(entries[k], lens);
    views[k].view.table.in_turn = config->tables > 1;
    fw_state.table_address[k] = (uint32_t)entries[k];
  }
  fw_state.tables = config->tables;
  size_t form = 0; /* memory of the last one; the tables are alike, so the next one needs about as much */
  for (uint32_t k = 0; k < config->tables; ++k) {
    make_room(k, entries, form + form / 8u, &arena);
    const uintptr_t before = arena.next;
    view_prepare_method(&views[k].view, &arena);
    form = arena.next - before;
  }
}

void program_started(const config_t *c) { (void)c; }

void program_work(void) {}

/* Tables and sources take turns, so that no remap finds in the caches or in open rows of the SDRAM
 * what the one before has read. The last remap, whose result is shown, reads the newest frame. */
void program_frame(uint8_t *out, uint32_t sequence) {
  for (uint32_t left = config->repeats; left-- != 0;)
    view_correct(&views[fw_state.remapped % config->tables].view,
                 pipeline_source(left % config->sources), out, sequence);
  pipeline_done(!engine_jobs_failed());
}
