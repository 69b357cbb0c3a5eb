/* The fish-eye correction: builds the table at the start, then captures, remaps and displays
 * frames. */
#include "../boot/boot.h"
#include "../drivers/cp15.h"
#include "../drivers/gpio.h"
#include "../drivers/intc.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "../kernels/engine_jobs.h"
#include "../kernels/method.h"
#include "config.h"
#include "overlay.h"
#include "pipeline.h"
#include "remapper.h"
#include "say.h"
#include "state.h"
#include "sw/lens/fast_lut.h"
#include "sw/lens/lens.h"
#ifdef COMPOSED_VIEW
#include "composition.h"
#endif
#ifdef CONSOLE
#include "choices.h"
#define SHARED
#else
#define SHARED static
#endif

static config_t config;
#ifndef COMPOSED_VIEW
#ifndef CONSOLE
struct view { /* what the remaps use in turn */
  lens_view_t lens;
  remap_table_t table;
  const remap_method_t *method;
};
#endif
static struct view views[TABLES_MAX];
#endif
static uint8_t overlay_value;

static void print_config(void) {
  static const char *const kMappings[] = {"none",      "rectilinear",   "linear", "orthographic",
                                          "equisolid", "stereographic", "table"};
  uart_puts("picture ");
  uart_put_uint(config.width);
  uart_puts("x");
  uart_put_uint(config.height);
  uart_puts(config.is_625 ? " in 625/50, " : " in 525/60, ");
  uart_puts(kMappings[config.view.mapping <= LENS_TABLE ? config.view.mapping : 0]);
  uart_puts(config.serial ? ", serial flow" : ", double buffering");
  if (config.repeats > 1) {
    uart_puts(", ");
    uart_put_uint(config.repeats);
    uart_puts(" remaps for each frame");
  }
#if defined(COMPOSED_VIEW)
  uart_puts(", ");
  uart_put_uint(config.cameras);
  uart_puts(" cameras in one picture");
#elif defined(TIME_DIVISION)
  uart_puts(", ");
  uart_put_uint(config.cameras);
  uart_puts(" cameras in turn");
#else
  if (config.tables > 1) {
    uart_puts(", ");
    uart_put_uint(config.tables);
    uart_puts(" tables in turn");
  }
#endif
  uart_puts("\n");
}

#ifdef COMPOSED_VIEW
static void build_views(void) {
  extern uint8_t __arena_start[], __arena_end[];
  arena_t arena = {(uintptr_t)__arena_start, (uintptr_t)__arena_end};
  composition_build(&config, &arena);
}
#else
/* In fixed point if the page wants that and the lens allows it. */
static void fill_lut(const lens_t *lens, uint32_t *entries) {
  static fast_lut_t fast;
  if (config.table_builder == BUILDER_FIXED) {
    const fast_lut_result_t result = fast_lut_prepare(&fast, lens);
    if (result == FAST_LUT_OK) {
      fast_lut_build(&fast, entries, config.pitch_bytes);
      return;
    }
    uart_puts("LUT: not in fixed point: ");
    uart_puts(fast_lut_result_text(result));
    uart_puts("\n");
  }
  lens_build_lut(lens, entries, config.pitch_bytes);
}

/* The pins show frames while one is built in the background. */
static void mark_build(uint32_t phase) {
#ifdef CONSOLE
  if (view_tables_busy()) return;
#endif
  phase_mark(phase, 0);
}

SHARED void build_lut(const lens_view_t *view, uint32_t *entries) {
  lens_t lens;
  const lens_result_t result = lens_init(&lens, view, config.width, config.height);
  if (result != LENS_OK) fail("lens", lens_result_text(result));
  mark_build(PHASE_LUT);
  const uint32_t start = timer_ticks();
  fill_lut(&lens, entries);
  const uint32_t ticks = timer_ticks() - start;
  fw_state.lut_time_ticks += ticks;
  mark_build(PHASE_IDLE);
  fw_state.lut_entries = lens_lut_entries(config.width, config.height);
  uart_puts("LUT: ");
  uart_put_uint(fw_state.lut_entries);
  uart_puts(" entries in ");
  uart_put_uint(ticks / TIMER_TICKS_PER_MS);
  uart_puts(" ms\n");
}

SHARED void prepare_method(struct view *view, arena_t *arena) {
  const uint32_t start = timer_ticks();
  view->method = remapper_prepare(config.kernel, &view->table, arena);
  uart_puts("kernel: ");
  uart_puts(view->method->name);
  uart_puts(", ");
  uart_put_uint(view->table.encoded_bytes);
  uart_puts(" bytes of tables");
  if (view->table.encoded != NULL) {
    uart_puts(" in ");
    uart_put_uint((timer_ticks() - start) / TIMER_TICKS_PER_MS);
    uart_puts(" ms");
  }
  uart_puts("\n");
}

/* Table k is that of the page's view, moved by k steps. */
#ifdef CONSOLE
static void build_views(void) { view_tables_build(views, &config); }
#else
static void build_views(void) {
  extern uint8_t __arena_start[], __arena_end[];
  arena_t arena = {(uintptr_t)__arena_start, (uintptr_t)__arena_end};
  for (uint32_t k = 0; k < config.tables; ++k) {
    uint32_t *entries = k == 0 ? lut : arena_take(&arena, sizeof lut, 4096);
    if (entries == NULL) fail("look-up tables", "no memory left"); /* firmware.ld rules it out */
    lens_view_t *view = &views[k].lens;
#ifdef TIME_DIVISION
    *view = config.views[k];
#else
    *view = config.view;
    view->shift_x += PARAM_TABLE_STEP_PX * k;
#endif
    build_lut(view, entries);
    views[k].table = (remap_table_t){.width = config.width,
                                     .height = config.height,
                                     .pitch_bytes = config.pitch_bytes,
                                     .lut = entries,
                                     .view = view,
                                     .has_engine = config.has_engine};
    fw_state.table_address[k] = (uint32_t)entries;
  }
  fw_state.tables = config.tables;
  for (uint32_t k = 0; k < config.tables; ++k) prepare_method(&views[k], &arena);
}
#endif
#endif

static void init_frames(uint32_t in_count) {
  frame_stride =
      (lens_black_offset(config.height, config.pitch_bytes) + CACHE_LINE_BYTES + 4095u) & ~4095u;
  for (uint32_t n = 0; n < in_count; ++n) {
    uint8_t *black =
        frame_in + n * frame_stride + lens_black_offset(config.height, config.pitch_bytes);
    for (uint32_t i = 0; i < CACHE_LINE_BYTES; i += 4) *(uint32_t *)(black + i) = LENS_BLACK_WORD;
  }
}

/* A picture that the engine has not completed is not shown. */
static void show(void) {
  if (engine_jobs_failed())
    pipeline_leave_out();
  else
    pipeline_done();
}

#ifdef COMPOSED_VIEW
/* The newest frame is in a buffer that held another one before. */
static void process(uint8_t *out, uint32_t sequence) {
  const uint8_t *const *sources = pipeline_kept();
  const uint32_t bytes = config.height * config.pitch_bytes;
  for (uint32_t left = config.repeats; left-- != 0;) {
    phase_mark(PHASE_REMAP_START, sequence);
    dcache_invalidate_range(sources[pipeline_camera()], bytes);
    const uint32_t before = composition_sum(sources);
    composition_run(sources, out);
    /* Larger frames have driven the summed lines out of the cache by now. */
    for (uint32_t n = 0; bytes < DCACHE_BYTES && n < composition_sources(); ++n)
      if (sources[n] != NULL) dcache_invalidate_range(sources[n], bytes);
    if (composition_sum(sources) != before) ++fw_state.torn;
    if (config.overlay && overlay_visible(sequence))
      overlay_draw(out, config.pitch_bytes, overlay_value);
    dcache_clean_range(out, bytes);
    write_buffer_drain();
    phase_mark(PHASE_REMAP_END, sequence);
    ++fw_state.remapped;
  }
  show();
}
#else
/* Sum of the source words of the first output row. It is the same before and after the remap unless
 * the camera has written to the frame meanwhile. */
static uint32_t first_row_sum(const remap_table_t *table, const uint8_t *in) {
  uint32_t sum = 0;
  for (uint32_t i = 0; i < config.width / 2u; ++i)
    sum = sum * 31u + *(const volatile uint32_t *)(in + table->lut[i]);
  return sum;
}

static void correct(const struct view *view, const uint8_t *in, uint8_t *out, uint32_t sequence) {
  phase_mark(PHASE_REMAP_START, sequence);
#ifndef OMIT_D_INVALIDATE
  dcache_invalidate_range(in, config.height * config.pitch_bytes);
#endif
  const uint32_t before = first_row_sum(&view->table, in);
  view->method->run(&view->table, in, out);
#ifndef OMIT_D_INVALIDATE
  /* Larger frames have driven the first row's lines out of the cache by now. */
  if (config.height * config.pitch_bytes < DCACHE_BYTES)
    dcache_invalidate_range(in, config.height * config.pitch_bytes);
#endif
  if (first_row_sum(&view->table, in) != before) ++fw_state.torn;
  if (config.overlay && overlay_visible(sequence))
    overlay_draw(out, config.pitch_bytes, overlay_value);
#ifndef OMIT_D_CLEAN
  dcache_clean_range(out, config.height * config.pitch_bytes);
#endif
  write_buffer_drain();
  phase_mark(PHASE_REMAP_END, sequence);
  ++fw_state.remapped;
}

/* Tables and sources take turns, so that no remap finds in the caches or in open rows of the SDRAM
 * what the one before has read. The last remap, whose result is shown, reads the newest frame. */
static void process(uint8_t *out, uint32_t sequence) {
#ifdef TIME_DIVISION
  for (uint32_t left = config.repeats; left-- != 0;)
    correct(&views[pipeline_camera()], pipeline_source(0), out, sequence);
#else
  for (uint32_t left = config.repeats; left-- != 0;)
    correct(&views[fw_state.remapped % config.tables], pipeline_source(left % config.sources), out,
            sequence);
#endif
  show();
}
#endif

#ifdef CONSOLE
int correct_next_frame(void) {
  uint8_t *out;
  uint32_t sequence;
  if (!pipeline_take(&out, &sequence)) return 0;
  const uint32_t cpsr = irq_mask();
  irq_unmask();
  process(out, sequence);
  irq_restore(cpsr);
  return 1;
}
#endif

#ifdef TIME_DIVISION
static void say_events(void) {
  uint32_t camera;
  const char *what;
  while (pipeline_event(&camera, &what)) {
    uart_puts("camera ");
    uart_put_uint(camera);
    uart_puts(": ");
    uart_puts(what);
    uart_puts("\n");
  }
}
#endif

int main(void) {
  timer_start();
  intc_init();
  uart_puts("Fovea firmware\n");
  const uint32_t dip = dip_read();
  fw_state.dip = dip;
  const config_result_t result = config_read(&config, dip, (const param_page_t *)PARAM_PAGE_BASE);
  if (result != CONFIG_OK) fail("configuration", config_result_text(result));
  print_config();
  pipeline_prepare(&config);

  overlay_value = OVERLAY_LUMA;
  if (config.self_patch) {
    overlay_value = (uint8_t)overlay_patch(OVERLAY_LUMA_PATCHED);
    fw_state.patched_value = overlay_value;
  }
#ifdef COMPOSED_VIEW
  const uint32_t in_count = IN_COUNT; /* one for each camera, one that waits, one that is filled */
#else
  const uint32_t in_count = config.serial ? 1u : config.sources + 2u;
#endif
  const uint32_t out_count = config.serial ? 2u : OUT_COUNT;
  init_frames(in_count);
  build_views();
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
#ifdef CONSOLE
  choices_start(&config, views);
#endif

  for (;;) {
    uint8_t *out;
    uint32_t sequence;
#ifdef TIME_DIVISION
    say_events();
#endif
#ifdef CONSOLE
    choices_work();
#endif
    /* Checked with interrupts masked: an interrupt that comes after the check still ends the sleep,
     * and is handled when interrupts are unmasked. */
    const uint32_t cpsr = irq_mask();
    const int work = pipeline_take(&out, &sequence);
    if (!work) {
      phase_mark(PHASE_IDLE, pipeline_last_sequence());
      wait_for_interrupt();
    }
    irq_restore(cpsr);
    if (work) process(out, sequence);
  }
}
