#include "composition.h"

#include "../boot/boot.h"
#include "../drivers/gpio.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "../kernels/remap.h"
#include "composition_engine.h"
#include "fail.h"
#include "model/contract/view_page.h"
#include "progress.h"
#include "state.h"
#include "sw/lens/view_lut.h"

/* In strips, rows read lines of the sources that are still in the D-cache from the row above. */
#define STRIP_PAIRS 72u

/* Neighbouring pairs of a row that come from one camera. */
typedef struct run {
  uint32_t out;   /* byte offset in the result */
  uint32_t first; /* entry of the table */
  uint16_t camera, pairs;
} run_t;

static struct {
  const config_t *config;
  view_page_t page; /* a copy in cached memory */
  uint32_t pairs, rows;
  run_t *run;
  uint32_t runs;
  uint32_t first_run[VIEW_CAMERAS]; /* of each camera; its number of runs: it has none */
  remap_loop_t *loop;
  int by_engine;
} view;

uint32_t composition_sources(void) { return view.page.source == VIEW_QUAD ? 1u : VIEW_CAMERAS; }

int composition_by_device(void) { return view.by_engine; }

static void map_of(view_map_t *map, const lens_t *lens, uint32_t camera) {
  const uint32_t width = view.config->width, height = view.config->height;
  const uint32_t right = camera % 2u, below = camera / 2u;
  *map = (view_map_t){.lens = lens, .pitch_bytes = view.config->pitch_bytes};
  if (view.page.source == VIEW_QUAD)
    map->place = (view_place_t){1, right * width / 2u, below * height / 2u};
  if (view.page.view == VIEW_FOUR_WAY) {
    view_map_half(map, lens, right * width / 2u, below * height / 2u);
    return;
  }
  for (int i = 0; i < 9; ++i) map->m[i] = view.page.ground[camera][i];
}

static uint32_t spans_of(uint32_t row, view_span_t spans[VIEW_SPANS_MAX]) {
  if (view.page.view == VIEW_FOUR_WAY) return view_four_way_row(view.pairs, view.rows, row, spans);
  return view_birds_eye_row(&view.page.car, view.config->views[0].pair_method == PAIR_CENTRE, view.pairs,
                            row, spans);
}

static void build_part(uint32_t camera) {
  static fast_lut_t fast;
  lens_t lens, wide;
  view_map_t map;
  const lens_result_t result =
      lens_init(&lens, &view.config->views[camera], view.config->width, view.config->height);
  if (result != LENS_OK) fail("lens", lens_result_text(result));
  map_of(&map, &lens, camera);
  if (view.config->table_builder == BUILDER_FIXED) {
    const fast_lut_result_t fixed = view_map_fixed_point(&map, &fast, &wide);
    if (fixed != FAST_LUT_OK) {
      uart_puts("LUT: not in fixed point: ");
      uart_puts(fast_lut_result_text(fixed));
      uart_puts("\n");
    }
  }
  for (uint32_t v = 0; v < view.rows; ++v) {
    view_span_t spans[VIEW_SPANS_MAX];
    const uint32_t count = spans_of(v, spans);
    uint32_t first = 0;
    for (uint32_t n = 0; n < count; first = spans[n++].end)
      if (spans[n].camera == camera)
        view_map_row(&map, v, first, spans[n].end, lut + v * view.pairs + first);
  }
}

static void build_black(void) {
  const uint32_t black = lens_black_offset(view.config->height, view.config->pitch_bytes);
  for (uint32_t v = 0; v < view.rows; ++v) {
    view_span_t spans[VIEW_SPANS_MAX];
    const uint32_t count = spans_of(v, spans);
    uint32_t first = 0;
    for (uint32_t n = 0; n < count; first = spans[n++].end)
      for (uint32_t i = first; spans[n].camera == VIEW_NO_CAMERA && i < spans[n].end; ++i)
        lut[v * view.pairs + i] = black;
  }
}

static void add_run(arena_t *arena, uint32_t v, uint32_t first, uint32_t end, uint32_t camera) {
  run_t *run = arena_take(arena, sizeof *run, 4);
  if (run == NULL) fail("view", "no memory left"); /* firmware.ld rules it out */
  if (view.runs == 0) view.run = run;
  if (camera < VIEW_CAMERAS && view.first_run[camera] == ~0u) view.first_run[camera] = view.runs;
  *run = (run_t){v * view.config->pitch_bytes + first * 4u, v * view.pairs + first, (uint16_t)camera,
                 (uint16_t)(end - first)};
  ++view.runs;
}

/* The runs in the order of the copying: strip by strip. */
static void list_runs(arena_t *arena, uint32_t strip_pairs) {
  for (uint32_t left = 0; left < view.pairs; left += strip_pairs) {
    const uint32_t right = left + strip_pairs < view.pairs ? left + strip_pairs : view.pairs;
    for (uint32_t v = 0; v < view.rows; ++v) {
      view_span_t spans[VIEW_SPANS_MAX];
      const uint32_t count = spans_of(v, spans);
      uint32_t first = 0;
      for (uint32_t n = 0; n < count; first = spans[n++].end) {
        const uint32_t from = first > left ? first : left;
        const uint32_t to = spans[n].end < right ? spans[n].end : right;
        if (from < to) add_run(arena, v, from, to, spans[n].camera);
      }
    }
  }
}

static int engine_takes_it(arena_t *arena) {
  const engine_view_t shape = {.config = view.config, .quad = view.page.source == VIEW_QUAD, .spans = spans_of};
  const char *refusal = engine_view_build(&shape, arena);
  if (refusal == NULL) return 1;
  uart_puts("kernel engine: ");
  uart_puts(refusal);
  uart_puts("\n");
  return 0;
}

/* A view has no tables but the look-up table. */
static void choose_kernel(arena_t *arena) {
  uint32_t kernel = view.config->kernel;
  if (kernel == KERNEL_ENGINE) {
    arena_t rest = *arena; /* the runs of a row are listed all the same, for composition_sum() */
    list_runs(&rest, view.pairs);
    view.by_engine = engine_takes_it(&rest);
    if (view.by_engine) return;
    view.runs = 0;
    for (uint32_t n = 0; n < VIEW_CAMERAS; ++n) view.first_run[n] = ~0u;
    kernel = KERNEL_STRIPS;
  }
  const int strips = kernel != KERNEL_PLAIN && kernel != KERNEL_LDM;
  view.loop = kernel == KERNEL_PLAIN ? remap_plain : remap_ldm;
  if (strips && kernel != KERNEL_STRIPS && kernel != KERNEL_FASTEST)
    uart_puts("kernel of the page: a composed view follows the look-up table itself\n");
  list_runs(arena, strips ? STRIP_PAIRS : view.pairs);
  uart_puts("kernel: ");
  uart_puts(kernel == KERNEL_PLAIN ? "plain" : kernel == KERNEL_LDM ? "ldm" : "strips");
  uart_puts(", ");
  uart_put_uint(view.runs);
  uart_puts(" runs\n");
}

void composition_build(const config_t *config, arena_t *arena) {
  view.config = config;
  view.page = *(const view_page_t *)VIEW_PAGE_BASE;
  const char *fault = view_page_fault(&view.page);
  if (fault != NULL) fail("view page", fault);
  if (config->cameras != VIEW_CAMERAS) fail("view page", "a composed view needs four cameras");
  view.pairs = config->width / 2u;
  view.rows = config->height;
  uart_puts(view.page.view == VIEW_FOUR_WAY ? "view: four-way" : "view: bird's-eye");
  uart_puts(view.page.source == VIEW_QUAD ? ", quarters of one input\n" : ", four inputs\n");
  phase_mark(PHASE_LUT, 0);
  const uint32_t start = timer_ticks();
  for (uint32_t camera = 0; camera < VIEW_CAMERAS; ++camera) {
    view.first_run[camera] = ~0u;
    build_part(camera);
    progress_made();
  }
  build_black();
  fw_state.lut_time_ticks = timer_ticks() - start;
  phase_mark(PHASE_IDLE, 0);
  fw_state.lut_entries = lens_lut_entries(config->width, config->height);
  fw_state.tables = 1;
  fw_state.table_address[0] = (uint32_t)lut;
  uart_puts("LUT: ");
  uart_put_uint(fw_state.lut_entries);
  uart_puts(" entries in ");
  uart_put_uint(fw_state.lut_time_ticks / TIMER_TICKS_PER_MS);
  uart_puts(" ms\n");
  choose_kernel(arena);
}

/* With a quad processor all parts come from one frame. */
static const uint8_t *source_of(const uint8_t *const sources[], uint32_t camera) {
  if (camera == VIEW_NO_CAMERA) return NULL;
  return sources[view.page.source == VIEW_QUAD ? 0 : camera];
}

void composition_run(const uint8_t *const sources[], uint8_t *out) {
  if (view.by_engine) {
    engine_view_run(sources, out);
    return;
  }
  for (uint32_t n = 0; n < view.runs; ++n) {
    const run_t *run = &view.run[n];
    const uint8_t *in = source_of(sources, run->camera);
    uint32_t *to = (uint32_t *)(out + run->out);
    if (in != NULL)
      view.loop(to, in, lut + run->first, run->pairs);
    else
      for (uint32_t i = 0; i < run->pairs; ++i) to[i] = LENS_BLACK_WORD;
  }
}

uint32_t composition_sum(const uint8_t *const sources[]) {
  uint32_t sum = 0;
  for (uint32_t camera = 0; camera < VIEW_CAMERAS; ++camera) {
    const uint8_t *in = source_of(sources, camera);
    if (in == NULL || view.first_run[camera] == ~0u) continue;
    const run_t *run = &view.run[view.first_run[camera]];
    for (uint32_t i = 0; i < run->pairs; ++i)
      sum = sum * 31u + *(const volatile uint32_t *)(in + lut[run->first + i]);
  }
  return sum;
}
