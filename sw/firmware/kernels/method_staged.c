/* The remap in tiles that the EDMA brings into internal RAM, and of which it takes a part of the
 * results away: README.md, "The staged remap". */
#include "../app/fail.h"
#include "../drivers/cp15.h"
#include "../drivers/edma.h"
#include "../mmio.h"
#include "../regs.h"
#include "internal_ram.h"
#include "loop_ram.h"
#include "method.h"
#include "staged.h"
#include "sw/remap/tiles.h"

/* The internal RAM. Each bank begins with results; patterns follow, and at the end of BANK_BYTES is
 * the window. What else there is lies behind them in bank 1, which is larger. */
#define BANK_BYTES (RAM_BANK0_END - RAM_BANK0_BASE)
#define RESULT_BYTES (TILE_ROWS / 2u * TILE_ROW_BYTES)
typedef struct inbox {
  tile_stream_t stream;
  uint32_t one;     /* what the EDMA copies to the other two */
  volatile uint32_t arrived; /* 1: the second part of the window is there */
  volatile uint32_t drained; /* 1: the results have been read */
  uint32_t unused[13];
} inbox_t;
#define INBOX ((inbox_t *)(RAM_BANK1_BASE + BANK_BYTES))

_Static_assert(sizeof(tile_stream_t) == 576, "the size that tiles.h gives");
_Static_assert(sizeof(inbox_t) % 64u == 0 && RESULT_BYTES % 64u == 0, "bursts of 64 bytes");
_Static_assert(RAM_BANK1_BASE + BANK_BYTES + TILE_BANKS * sizeof(inbox_t) <= RAM_BANK1_END,
               "bank 1 is full");

/* Everything of a table that the method needs; patterns, streams and windows follow. */
typedef struct staged_table {
  tile_table_t tiles;
  const tile_pattern_t *patterns;
  const tile_stream_t *streams;
  const tile_window_t *windows;
  const remap_black_run_t *black;
} staged_table_t;

/* What each channel does. Those of a bank b are at the name's number + b. */
enum {
  CHANNEL_STREAM = 0,   /* codes of a tile; the last word is its number */
  CHANNEL_PATTERNS = 2, /* patterns of a strip */
  CHANNEL_ARRIVED = 4,  /* sets `arrived` */
  CHANNEL_DRAINED = 6,  /* sets `drained` */
  CODE_LAST = 8,        /* the last results of a frame are in memory */
  /* Of the quick channels 0 to 5, triggered by a write of the destination's address: */
  SET_PART0 = 64,
  SET_PART1 = 66,
  SET_RESULTS = 68,
  QUEUE_PART0 = 1, /* bursts of 64 bytes */
  QUEUE_PART1 = 0,
  QUEUE_RESULTS = 2,
};

#define DESTINATION_WORD 3u
#define EDMA_EARLY \
  (1u << 11) /* a set's code is reported as soon as its last request is submitted */

/* Looks at a word of internal RAM before the EDMA is given up. */
#define MOST_LOOKS 1000000u

static uint32_t bank_base(uint32_t b) { return b == 0 ? RAM_BANK0_BASE : RAM_BANK1_BASE; }

/* The EDMA works on memory that this program reads and writes: no access moves across a post or a wait. */
static void keep_order(void) { __asm__ volatile("" : : : "memory"); }

static void post(uint32_t address, uint32_t value) {
  keep_order();
  mmio_write32(posted_address(address), value);
}

static const char *prepare(remap_table_t *table, arena_t *arena) {
  static tile_work_t work;
  staged_table_t *staged = arena_take(arena, sizeof *staged, 32);
  if (staged == NULL) return kRemapNoMemory;
  tile_table_t *tiles = &staged->tiles;
  *tiles =
      (tile_table_t){.picture = {table->width / 2u, table->height, table->pitch_bytes, table->lut,
                                 table->source_height}};
  /* Codes are addresses of 16 bits: those of the instruction side, which data can be read at as
   * well. */
  for (uint32_t b = 0; b < TILE_BANKS; ++b) {
    const uint32_t start = internal_ram_offset((const void *)bank_base(b));
    tiles->bank[b] = (tile_bank_t){start + RESULT_BYTES, start + BANK_BYTES};
  }
  tiles->place_offset = INTERNAL_RAM_DATA_BASE;
  const uint32_t count = tiles_count(&tiles->picture);
  tile_window_t *windows = arena_take(arena, count * sizeof *windows, 32);
  if (windows == NULL) return kRemapNoMemory;
  const char *refusal = tiles_layout(tiles, windows);
  if (refusal != NULL) return refusal;
  const uint32_t pattern_bytes = tiles->strips * tiles->patterns_max * sizeof(tile_pattern_t);
  tile_pattern_t *patterns = arena_take(arena, pattern_bytes, 64);
  tile_stream_t *streams = arena_take(arena, tiles->tiles * sizeof *streams, 64);
  if (patterns == NULL || streams == NULL) return kRemapNoMemory;
  refusal = tiles_encode(tiles, windows, patterns, streams, &work);
  if (refusal != NULL) return refusal;
  remap_memory_t rest = {(uint8_t *)arena->next, 0, arena->end - arena->next};
  staged->black = remap_list_black(&tiles->picture, tiles->black, &rest);
  if (staged->black == NULL) return kRemapNoMemory;
  (void)arena_take(arena, rest.used, 1);
  staged->patterns = patterns;
  staged->streams = streams;
  staged->windows = windows;
  table->encoded = staged;
  table->encoded_bytes = tiles->tiles * sizeof *streams +
                         TILE_BANKS * tiles->strips * tiles->patterns * sizeof(tile_pattern_t);
  edma_init();
  dcache_clean_all(); /* the EDMA reads patterns and streams from memory */
  return NULL;
}

/* A set that copies a word. */
static edma_set_t copy_word(const uint32_t *from, const volatile uint32_t *to) {
  return (edma_set_t){.options = EDMA_AB_SYNC | EDMA_STATIC,
                      .source = (uint32_t)from,
                      .counts = EDMA_PAIR(4, 1),
                      .destination = (uint32_t)to,
                      .link = EDMA_NO_LINK,
                      .frames = 1};
}

/* A set whose addresses and counts are written for each request. Another channel follows at once in
 * the same queue: its transfer begins when this one's reads have been issued, and ends after it. */
static edma_set_t followed_by(uint32_t channel, uint32_t source_pitch, uint32_t destination_pitch) {
  return (edma_set_t){
      .options = EDMA_AB_SYNC | EDMA_STATIC | EDMA_EARLY | EDMA_CHAIN | EDMA_CODE(channel),
      .array_steps = EDMA_PAIR(source_pitch, destination_pitch),
      .link = EDMA_NO_LINK,
      .frames = 1};
}

/* Writes all sets of a bank: other methods, or another table, may have used them. */
static void open_bank(const staged_table_t *staged, uint32_t b) {
  const tile_table_t *tiles = &staged->tiles;
  inbox_t *inbox = &INBOX[b];
  inbox->stream.number = 0;
  inbox->one = inbox->arrived = inbox->drained = 1;
  edma_map(CHANNEL_STREAM + b, QUEUE_PART0);
  edma_map(CHANNEL_PATTERNS + b, QUEUE_PART1);
  edma_map(CHANNEL_ARRIVED + b, QUEUE_PART1);
  edma_map(CHANNEL_DRAINED + b, QUEUE_RESULTS);
  edma_set_t set = {.options = EDMA_AB_SYNC,
                    .source = (uint32_t)(staged->streams + b),
                    .counts = EDMA_PAIR(sizeof(tile_stream_t), 1),
                    .destination = (uint32_t)&inbox->stream,
                    .link = EDMA_NO_LINK,
                    .frame_steps = EDMA_PAIR(TILE_BANKS * sizeof(tile_stream_t), 0),
                    .frames = (tiles->tiles + 1u - b) / TILE_BANKS};
  edma_write_set(CHANNEL_STREAM + b, &set);
  set.source = (uint32_t)staged->patterns;
  set.counts = EDMA_PAIR(tiles->patterns * sizeof(tile_pattern_t), 1);
  set.destination = bank_base(b) + RESULT_BYTES;
  set.frame_steps = EDMA_PAIR(tiles->patterns_max * sizeof(tile_pattern_t), 0);
  set.frames = tiles->strips;
  edma_write_set(CHANNEL_PATTERNS + b, &set);
  set = copy_word(&inbox->one, &inbox->arrived);
  edma_write_set(CHANNEL_ARRIVED + b, &set);
  set = copy_word(&inbox->one, &inbox->drained);
  edma_write_set(CHANNEL_DRAINED + b, &set);
  set = followed_by(CHANNEL_STREAM + b, tiles->picture.pitch_bytes, tiles->window_pitch);
  edma_write_set(SET_PART0 + b, &set);
  set = followed_by(CHANNEL_ARRIVED + b, tiles->picture.pitch_bytes, tiles->window_pitch);
  edma_write_set(SET_PART1 + b, &set);
  set = followed_by(CHANNEL_DRAINED + b, TILE_ROW_BYTES, 2u * tiles->picture.pitch_bytes);
  set.source = bank_base(b);
  set.counts = EDMA_PAIR(TILE_ROW_BYTES, TILE_ROWS / 2u);
  edma_write_set(SET_RESULTS + b, &set);
  edma_open_quick(b, SET_PART0 + b, DESTINATION_WORD, QUEUE_PART0);
  edma_open_quick(2 + b, SET_PART1 + b, DESTINATION_WORD, QUEUE_PART1);
  edma_open_quick(4 + b, SET_RESULTS + b, DESTINATION_WORD, QUEUE_RESULTS);
}

static void copy_part(uint32_t set, const tile_part_t *part, uint32_t in) {
  post(EDMA_PARAM_SRC(set), in + part->source);
  post(EDMA_PARAM_A_B_CNT(set), part->counts);
  post(EDMA_PARAM_DST(set), part->place);
}

/* Has a tile's patterns, window and stream brought into bank b. */
static void request(uint32_t b, const tile_part_t part[TILE_PARTS], int patterns, uint32_t in) {
  if (patterns) post(EDMA_S0_ESR, 1u << (CHANNEL_PATTERNS + b));
  INBOX[b].arrived = 0;
  copy_part(SET_PART1 + b, &part[1], in);
  copy_part(SET_PART0 + b, &part[0], in);
}

static int wait_for(const volatile uint32_t *word, uint32_t value) {
  uint32_t looks = 0;
  while (*word != value && looks < MOST_LOOKS) ++looks;
  keep_order();
  return looks < MOST_LOOKS;
}

/* Computes all tiles. Returns 0 if the EDMA did not bring one, or did not take its results away. */
static int run_tiles(const staged_table_t *staged, uint32_t in, uint8_t *out) {
  const tile_table_t *tiles = &staged->tiles;
  const uint32_t step = 2u * tiles->picture.pitch_bytes - TILE_ROW_BYTES;
  for (uint32_t b = 0; b < TILE_BANKS; ++b) request(b, staged->windows[b].part, 1, in);
  for (uint32_t n = 0; n < tiles->tiles; ++n) {
    const uint32_t b = n % TILE_BANKS;
    inbox_t *inbox = &INBOX[b];
    const tile_stream_t *stream = &inbox->stream;
    if (!wait_for(&stream->number, n + 1u) || !wait_for(&inbox->arrived, 1) ||
        !wait_for(&inbox->drained, 1))
      return 0;
    uint8_t *to = out + stream->destination;
    staged_tile(to - step, stream->code, (uint32_t *)bank_base(b), step);
    inbox->drained = 0;
    if (n + 1u == tiles->tiles)
      post(EDMA_PARAM_OPT(SET_RESULTS + b),
           EDMA_AB_SYNC | EDMA_STATIC | EDMA_INTERRUPT | EDMA_CODE(CODE_LAST));
    post(EDMA_PARAM_DST(SET_RESULTS + b), (uint32_t)to + tiles->picture.pitch_bytes);
    if (n + TILE_BANKS < tiles->tiles) request(b, stream->next, (int)stream->next_patterns, in);
  }
  write_buffer_drain();
  return edma_wait(CODE_LAST, MOST_LOOKS);
}

static void run(const remap_table_t *table, const void *in, void *out) {
  const staged_table_t *staged = table->encoded;
  /* No line of the result may be in the D-cache: the EDMA writes a part of it to memory. Nor may
   * one of the source stay there: code that reads it afterwards needs what memory holds. */
  dcache_invalidate_range(out, table->height * table->pitch_bytes);
  edma_clear(CODE_LAST);
  for (uint32_t b = 0; b < TILE_BANKS; ++b) open_bank(staged, b);
  if (!run_tiles(staged, (uint32_t)in, out)) fail("EDMA", "a transfer did not end");
  if (edma_errors() != 0) fail("EDMA", "an error register is not 0");
  edma_close_quick();
  if (staged->tiles.black != 0) remap_black(out, staged->black);
}

const remap_method_t method_KERNEL_STAGED = {"staged", prepare, run};
