/* The remap in tiles that the EDMA brings into internal RAM, and of which it takes a part of the results
 * away: README.md, "The staged remap". */
#include "../drivers/cp15.h"
#include "../drivers/edma.h"
#include "../mmio.h"
#include "../regs.h"
#include "internal_ram.h"
#include "method.h"
#include "staged.h"
#include "sw/remap/tiles.h"

/* A bank of the internal RAM from its start on: what moves, then patterns from the start and the window from
 * the end of the rest. */
typedef struct bank_head {
  tile_stream_t stream;
  uint32_t results[TILE_ROWS * STAGED_RAM_BYTES / 4u];
  uint32_t drained; /* 0 while results of this bank are waited for */
  uint32_t one;     /* what the EDMA copies to `drained` */
  uint32_t unused[6];
} bank_head_t;

_Static_assert(sizeof(tile_stream_t) == 544, "the size that tiles.h gives");
_Static_assert(sizeof(bank_head_t) % 64u == 0, "patterns and window begin at multiples of 64");

/* Everything of a table that the method needs; patterns, streams and windows follow. */
typedef struct staged_table {
  tile_table_t tiles;
  const tile_pattern_t *patterns;
  const tile_stream_t *streams;
  const tile_window_t *windows;
} staged_table_t;

/* What each channel does. Those of a bank b are at the name's number + b. */
enum {
  CHANNEL_STREAM = 0,   /* codes of a tile; the last word is its number */
  CHANNEL_PATTERNS = 2, /* patterns of a strip */
  CHANNEL_DRAINED = 4,  /* sets `drained` */
  CODE_LAST = 6,        /* the last results of a frame are in memory */
  SET_WINDOW = 64,      /* of quick channels 0 and 1: triggered by a write of the source's address */
  SET_RESULTS = 66,     /* of quick channels 2 and 3: triggered by a write of the destination's address */
  QUEUE_IN = 1,
  QUEUE_OUT = 2,
};

#define EDMA_EARLY (1u << 11) /* a set's code is reported as soon as its last request is submitted */

/* Looks at a word of internal RAM before the EDMA is given up. */
#define MOST_LOOKS 1000000u

static bank_head_t *bank_head(uint32_t b) {
  return (bank_head_t *)(b == 0 ? RAM_BANK0_BASE : RAM_BANK1_BASE);
}

static void post(uint32_t address, uint32_t value) { mmio_write32(posted_address(address), value); }

static const char *prepare(remap_table_t *table, arena_t *arena) {
  static tile_work_t work;
  staged_table_t *staged = arena_take(arena, sizeof *staged, 32);
  if (staged == NULL) return "no memory";
  tile_table_t *tiles = &staged->tiles;
  *tiles = (tile_table_t){.lut = table->lut,
                          .width = table->width,
                          .height = table->height,
                          .pitch_bytes = table->pitch_bytes};
  /* Codes are addresses of 16 bits: those of the instruction side, which data can be read at as well. */
  for (uint32_t b = 0; b < TILE_BANKS; ++b) {
    const uint32_t start = internal_ram_offset(bank_head(b) + 1);
    const uint32_t room = RAM_BANK0_END - RAM_BANK0_BASE - sizeof(bank_head_t);
    tiles->bank[b] = (tile_bank_t){start, start + room};
  }
  const uint32_t count = tiles_count(table->width, table->height, table->pitch_bytes);
  tile_window_t *windows = arena_take(arena, count * sizeof *windows, 32);
  if (windows == NULL) return "no memory";
  const char *refusal = tiles_layout(tiles, windows);
  if (refusal != NULL) return refusal;
  const uint32_t pattern_bytes = tiles->strips * tiles->patterns_max * sizeof(tile_pattern_t);
  tile_pattern_t *patterns = arena_take(arena, pattern_bytes, 64);
  tile_stream_t *streams = arena_take(arena, tiles->tiles * sizeof *streams, 64);
  if (patterns == NULL || streams == NULL) return "no memory";
  refusal = tiles_encode(tiles, windows, patterns, streams, &work);
  if (refusal != NULL) return refusal;
  staged->patterns = patterns;
  staged->streams = streams;
  staged->windows = windows;
  table->encoded = staged;
  table->encoded_bytes =
      tiles->tiles * sizeof *streams +
      TILE_BANKS * tiles->strips * tiles->patterns * sizeof(tile_pattern_t);
  edma_init();
  dcache_clean_all(); /* the EDMA reads patterns and streams from memory */
  return NULL;
}

/* Writes all sets: other methods may have used them. */
static void open_channels(const staged_table_t *staged, const uint8_t *out) {
  (void)out;
  const tile_table_t *tiles = &staged->tiles;
  const uint32_t pitch = tiles->pitch_bytes;
  for (uint32_t b = 0; b < TILE_BANKS; ++b) {
    bank_head_t *head = bank_head(b);
    head->stream.number = 0;
    head->drained = head->one = 1;
    edma_map(CHANNEL_STREAM + b, QUEUE_IN);
    edma_map(CHANNEL_PATTERNS + b, QUEUE_IN);
    edma_map(CHANNEL_DRAINED + b, QUEUE_OUT);
    edma_write_set(CHANNEL_STREAM + b,
                   &(edma_set_t){.options = EDMA_AB_SYNC,
                                 .source = (uint32_t)(staged->streams + b),
                                 .counts = EDMA_PAIR(sizeof(tile_stream_t), 1),
                                 .destination = (uint32_t)&head->stream,
                                 .link = EDMA_NO_LINK,
                                 .frame_steps = EDMA_PAIR(TILE_BANKS * sizeof(tile_stream_t), 0),
                                 .frames = (tiles->tiles + 1u - b) / TILE_BANKS});
    edma_write_set(
        CHANNEL_PATTERNS + b,
        &(edma_set_t){.options = EDMA_AB_SYNC,
                      .source = (uint32_t)staged->patterns,
                      .counts = EDMA_PAIR(tiles->patterns * sizeof(tile_pattern_t), 1),
                      .destination = (uint32_t)(head + 1),
                      .link = EDMA_NO_LINK,
                      .frame_steps = EDMA_PAIR(tiles->patterns_max * sizeof(tile_pattern_t), 0),
                      .frames = tiles->strips});
    edma_write_set(CHANNEL_DRAINED + b, &(edma_set_t){.options = EDMA_AB_SYNC | EDMA_STATIC,
                                                      .source = (uint32_t)&head->one,
                                                      .counts = EDMA_PAIR(4, 1),
                                                      .destination = (uint32_t)&head->drained,
                                                      .link = EDMA_NO_LINK,
                                                      .frames = 1});
    edma_write_set(SET_WINDOW + b,
                   &(edma_set_t){.options = EDMA_AB_SYNC | EDMA_STATIC | EDMA_EARLY | EDMA_CHAIN |
                                            EDMA_CODE(CHANNEL_STREAM + b),
                                 .destination = INTERNAL_RAM_DATA_BASE + tiles->window_base[b],
                                 .array_steps = EDMA_PAIR(pitch, tiles->window_pitch),
                                 .link = EDMA_NO_LINK,
                                 .frames = 1});
    edma_write_set(SET_RESULTS + b,
                   &(edma_set_t){.options = EDMA_AB_SYNC | EDMA_STATIC | EDMA_EARLY | EDMA_CHAIN |
                                            EDMA_CODE(CHANNEL_DRAINED + b),
                                 .source = (uint32_t)head->results,
                                 .counts = EDMA_PAIR(STAGED_RAM_BYTES, TILE_ROWS),
                                 .array_steps = EDMA_PAIR(STAGED_RAM_BYTES, pitch),
                                 .link = EDMA_NO_LINK,
                                 .frames = 1});
    edma_open_quick(b, SET_WINDOW + b, 1, QUEUE_IN);
    edma_open_quick(2 + b, SET_RESULTS + b, 3, QUEUE_OUT);
  }
  edma_clear(CODE_LAST);
}

/* Has a tile's patterns (if it is the first of its strip in this bank), window and stream brought into bank
 * b. The stream is chained to the window: its last word arrives last. */
static void request(uint32_t b, const tile_window_t *window, uint32_t in) {
  if (window->source & 1u) post(EDMA_S0_ESR, 1u << (CHANNEL_PATTERNS + b));
  post(EDMA_PARAM_A_B_CNT(SET_WINDOW + b), window->counts);
  post(EDMA_PARAM_SRC(SET_WINDOW + b), in + (window->source & ~1u));
}

static int wait_for(const volatile uint32_t *word, uint32_t value) {
  for (uint32_t looks = 0; looks < MOST_LOOKS; ++looks)
    if (*word == value) return 1;
  return 0;
}

static void run(const remap_table_t *table, const void *in, void *out) {
  const staged_table_t *staged = table->encoded;
  const tile_table_t *tiles = &staged->tiles;
  const uint32_t step = tiles->pitch_bytes - (TILE_ROW_BYTES - STAGED_RAM_BYTES);
  dcache_invalidate_range(out, tiles->height * tiles->pitch_bytes);
  open_channels(staged, out);
  for (uint32_t b = 0; b < TILE_BANKS; ++b)
    request(b, &(tile_window_t){staged->windows[b].source | 1u, staged->windows[b].counts},
            (uint32_t)in);
  for (uint32_t n = 0; n < tiles->tiles; ++n) {
    const uint32_t b = n % TILE_BANKS;
    bank_head_t *head = bank_head(b);
    const tile_stream_t *stream = &head->stream;
    if (!wait_for(&head->stream.number, n + 1u) || !wait_for(&head->drained, 1)) break;
    uint8_t *to = (uint8_t *)out + stream->destination;
    staged_tile(to + STAGED_RAM_BYTES - step, stream->code, head->results, step);
    head->drained = 0;
    if (n + 1u == tiles->tiles)
      post(EDMA_PARAM_OPT(SET_RESULTS + b),
           EDMA_AB_SYNC | EDMA_STATIC | EDMA_INTERRUPT | EDMA_CODE(CODE_LAST));
    post(EDMA_PARAM_DST(SET_RESULTS + b), (uint32_t)to);
    if (stream->next.counts != 0) request(b, &stream->next, (uint32_t)in);
  }
  write_buffer_drain();
  (void)edma_wait(CODE_LAST, MOST_LOOKS);
  edma_close_quick();
}

const remap_method_t method_staged = {"staged by EDMA", prepare, run};
