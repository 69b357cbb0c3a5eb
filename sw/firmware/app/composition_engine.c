#include "composition_engine.h"

#include "../drivers/cp15.h"
#include "../drivers/uart.h"
#include "../kernels/engine_jobs.h"
#include "state.h"

typedef struct part_job {
  remap_engine_job_t job; /* addresses of the result are relative to the picture's */
  uint32_t camera;        /* or VIEW_NO_CAMERA */
} part_job_t;

static struct {
  const engine_view_t *view; /* while jobs are made */
  arena_t *arena;
  uint32_t camera;
  part_job_t *part;
  uint32_t parts, map_bytes, bytes; /* of a picture */
  int quad;
} engine;

static int count_part(void *context, const engine_part_t *part) {
  (void)part;
  ++*(uint32_t *)context;
  return 0;
}

/* Other than 0: no memory is left for the map. */
static int make_part(void *context, const engine_part_t *part) {
  (void)context;
  const config_t *c = engine.view->config;
  part_job_t *made = &engine.part[engine.parts++];
  made->camera = engine.camera;
  made->job = remap_engine_part(part, c->width, c->height, c->pitch_bytes);
  if (engine.camera == VIEW_NO_CAMERA) {
    remap_engine_blacken(&made->job);
    return 0;
  }
  const uint32_t bytes = made->job.map_words * 4u;
  uint32_t *map = arena_take(engine.arena, bytes, REMAP_ENGINE_MAP_ALIGNMENT);
  if (map == NULL) return 1;
  remap_engine_part_map(part, lut, c->width, map);
  made->job.map_base = (uint32_t)(uintptr_t)map;
  engine.map_bytes += bytes;
  return 0;
}

/* Of each row what belongs to the camera. With the quarters of one input that is all of it. */
static void find_spans(uint32_t camera, engine_span_t *spans) {
  const engine_view_t *view = engine.view;
  for (uint32_t v = 0; v < view->config->height; ++v) {
    view_span_t found[VIEW_SPANS_MAX];
    const uint32_t count = view->quad ? 0 : view->spans(v, found);
    spans[v] = (engine_span_t){0, (uint16_t)(view->quad ? view->config->width / 2u : 0)};
    uint32_t first = 0;
    for (uint32_t n = 0; n < count; first = found[n++].end)
      if (found[n].camera == camera) spans[v] = (engine_span_t){(uint16_t)first, (uint16_t)found[n].end};
  }
}

static const char *make_all(void) {
  static engine_span_t spans[FRAME_HEIGHT_MAX];
  const uint32_t height = engine.view->config->height;
  const uint32_t last = engine.quad ? 0 : VIEW_NO_CAMERA;
  uint32_t parts = 0;
  for (uint32_t camera = 0; camera <= last; ++camera) {
    find_spans(camera, spans);
    engine_parts_cover(spans, height, count_part, &parts);
  }
  engine.part = arena_take(engine.arena, parts * sizeof(part_job_t), CACHE_LINE_BYTES);
  if (engine.part == NULL) return "no memory";
  for (engine.camera = 0; engine.camera <= last; ++engine.camera) {
    find_spans(engine.camera, spans);
    if (engine_parts_cover(spans, height, make_part, NULL) != 0) return "no memory";
  }
  return NULL;
}

const char *engine_view_build(const engine_view_t *view, arena_t *arena) {
  if (!view->config->has_engine || !engine_jobs_open()) return "the chip has no remap engine";
  engine.view = view;
  engine.arena = arena;
  engine.quad = view->quad;
  engine.bytes = view->config->height * view->config->pitch_bytes;
  const char *refusal = make_all();
  engine.view = NULL;
  if (refusal != NULL) return refusal;
  uart_puts("kernel: engine, ");
  uart_put_uint(engine.parts);
  uart_puts(" jobs, ");
  uart_put_uint(engine.map_bytes);
  uart_puts(" bytes of tables\n");
  return NULL;
}

void engine_view_run(const uint8_t *const sources[], uint8_t *out) {
  /* The core may still have lines of an earlier result, which it has drawn on. */
  dcache_invalidate_range(out, engine.bytes);
  for (uint32_t n = 0; n < engine.parts; ++n) {
    const uint32_t camera = engine.part[n].camera;
    remap_engine_job_t job = engine.part[n].job;
    const uint8_t *in = camera == VIEW_NO_CAMERA ? NULL : sources[engine.quad ? 0 : camera];
    if (in == NULL) remap_engine_blacken(&job); /* its camera has given no frame yet */
    job.src_base = (uint32_t)(uintptr_t)in;
    job.dst_base += (uint32_t)(uintptr_t)out;
    engine_jobs_add(&job);
  }
  engine_jobs_wait();
}
