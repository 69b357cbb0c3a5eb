/* The remap engine moves the pixels: the core hands over a job for each frame and sleeps until the
 * engine's interrupt. Three methods, by what the engine reads to know the positions: the look-up table
 * itself, a coarse grid, or a function of the radius. The last two are not exactly the table. */
#include <stddef.h>

#include "../drivers/cp15.h"
#include "engine_jobs.h"
#include "method.h"

/* What all three need. */
static remap_engine_job_t *begin(const remap_table_t *table, arena_t *arena, const char **refusal) {
  *refusal = "the chip has no remap engine";
  if (!table->has_engine) return NULL;
  *refusal = REMAP_TWO_SIZES;
  if (remap_two_sizes(table)) return NULL;
  if (!engine_jobs_open()) return NULL;
  *refusal = "no memory";
  return arena_take(arena, sizeof(remap_engine_job_t), CACHE_LINE_BYTES);
}

static const char *finish(remap_table_t *table, remap_engine_job_t *job, const uint32_t *map) {
  const uint32_t bytes = 4u * job->map_words;
  job->map_base = (uint32_t)map;
  dcache_clean_range(map, (bytes + CACHE_LINE_BYTES - 1u) & ~(CACHE_LINE_BYTES - 1u));
  table->encoded = job;
  table->encoded_bytes = bytes;
  return NULL;
}

static const char *prepare_table(remap_table_t *table, arena_t *arena) {
  const char *refusal;
  remap_engine_job_t *job = begin(table, arena, &refusal);
  if (job == NULL) return refusal;
  *job = remap_engine_table(table->width, table->height, table->pitch_bytes);
  return finish(table, job, table->lut);
}

typedef const char *make_map_t(const lens_t *lens, uint32_t pitch_bytes, remap_engine_job_t *job,
                               uint32_t *map);

static const char *prepare_lens(remap_table_t *table, arena_t *arena, uint32_t words,
                                make_map_t *make) {
  const char *refusal;
  remap_engine_job_t *job = begin(table, arena, &refusal);
  if (job == NULL) return refusal;
  uint32_t *map = arena_take(arena, 4u * words, REMAP_ENGINE_MAP_ALIGNMENT);
  if (map == NULL) return "no memory";
  lens_t lens;
  if (lens_init(&lens, table->view, table->width, table->height) != LENS_OK) return "no lens";
  refusal = make(&lens, table->pitch_bytes, job, map);
  return refusal != NULL ? refusal : finish(table, job, map);
}

static const char *prepare_grid(remap_table_t *table, arena_t *arena) {
  return prepare_lens(table, arena, remap_engine_grid_words(table->width, table->height),
                      remap_engine_grid);
}

static const char *prepare_radial(remap_table_t *table, arena_t *arena) {
  return prepare_lens(table, arena, REMAP_ENGINE_RADIAL_WORDS_MAX, remap_engine_radial);
}

static void run(const remap_table_t *table, const void *in, void *out) {
  remap_engine_job_t job = *(const remap_engine_job_t *)table->encoded;
  job.src_base = (uint32_t)in;
  job.dst_base = (uint32_t)out;
  /* The core may still have lines of an earlier result, which it has drawn on. */
  dcache_invalidate_range(out, table->height * table->pitch_bytes);
  engine_jobs_add(&job);
  engine_jobs_wait();
}

const remap_method_t method_KERNEL_ENGINE = {"engine", prepare_table, run};
const remap_method_t method_KERNEL_ENGINE_GRID = {"engine_grid", prepare_grid, run};
const remap_method_t method_KERNEL_ENGINE_RADIAL = {"engine_radial", prepare_radial, run};
