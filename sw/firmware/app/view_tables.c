#include "view_tables.h"

#include "../drivers/cp15.h"
#include "../drivers/timer.h"
#include "fail.h"
#include "pipeline_turns.h"
#include "program.h"
#include "progress.h"
#include "state.h"

/* A look-up table, and memory for the form of it that the kernel reads. */
typedef struct slot {
  uint32_t *lut;
  arena_t arena;
} slot_t;

static struct {
  slot_t slot[TABLES_MAX + 1u];
  uint8_t used_by[TABLES_MAX]; /* the slot of each view */
  uint32_t spare, slots;
  volatile int building;
  int in_frame;                /* the tail corrects frames */
} tables;

static struct view build(uint32_t slot, const lens_view_t *view) {
  struct view out = {.table = view_table(tables.slot[slot].lut, view)};
  arena_t arena = tables.slot[slot].arena; /* a copy: the slot is used again as a whole */
  view_build_lut(view, tables.slot[slot].lut, !tables.building);
  view_prepare_method(&out, &arena);
  return out;
}

/* The look-up tables first, then what is left in equal parts. */
static void divide(uint32_t views) {
  extern uint8_t __arena_start[], __arena_end[];
  arena_t arena = {(uintptr_t)__arena_start, (uintptr_t)__arena_end};
  tables.slots = 0;
  while (tables.slots < views + 1u) {
    uint32_t *entries = tables.slots == 0 ? lut : arena_take(&arena, sizeof lut, 4096);
    if (entries == NULL) break;
    tables.slot[tables.slots++].lut = entries;
  }
  if (tables.slots < views) fail("look-up tables", "no memory left"); /* firmware.ld rules it out */
  const uintptr_t part = (arena.end - arena.next) / tables.slots & ~(uintptr_t)63;
  for (uint32_t n = 0; n < tables.slots; ++n) {
    const uintptr_t start = ((arena.next + 63u) & ~(uintptr_t)63) + n * part;
    tables.slot[n].arena = (arena_t){start, start + part < arena.end ? start + part : arena.end};
  }
}

void view_tables_build(struct view *views, const config_t *config) {
  const uint32_t count = config->tables;
  divide(count);
  for (uint32_t k = 0; k < count; ++k) {
    views[k] = build(k, &config->views[k]);
    progress_made();
    tables.used_by[k] = (uint8_t)k;
    fw_state.table_address[k] = (uint32_t)(uintptr_t)views[k].table.lut;
  }
  tables.spare = count;
  fw_state.tables = count;
}

int view_tables_rebuild(struct view *views, uint32_t k, const lens_view_t *view) {
  if (tables.slots == fw_state.tables) return 0;
  tables.building = 1;
  const struct view built = build(tables.spare, view);
  dcache_clean_all();
  const uint32_t cpsr = irq_mask();
  views[k] = built;
  const uint32_t freed = tables.used_by[k];
  tables.used_by[k] = (uint8_t)tables.spare;
  tables.spare = freed;
  fw_state.table_address[k] = (uint32_t)(uintptr_t)built.table.lut;
  tables.building = 0;
  irq_restore(cpsr);
  return 1;
}

int background_frame_due(void) {
  return tables.building && !tables.in_frame && pipeline_frame_waits();
}

/* Called by the tail of the interrupt handler, in the mode and on the stack of the build, with interrupts masked. */
void background_frames(void);
void background_frames(void) {
  tables.in_frame = 1;
  const uint32_t start = timer_ticks(), other = view_other_ticks;
  while (correct_next_frame()) {
  }
  view_other_ticks = other + timer_ticks() - start; /* interrupts among it are not counted twice */
  tables.in_frame = 0;
}
