/* The view page: how pictures of several cameras make one displayed picture. A loader puts it into internal RAM at
 * VIEW_PAGE_BASE, behind the parameter page (param_page.h), for programs that compose views; others do not read it.
 * Little-endian without padding; the same header is compiled for host and target. */
#ifndef FOVEA_CONTRACT_VIEW_PAGE_H
#define FOVEA_CONTRACT_VIEW_PAGE_H

#include <stddef.h>
#include <stdint.h>

#include "model/contract/param_page.h"

#ifdef __cplusplus
extern "C" {
#endif

#define VIEW_PAGE_OFFSET MAP_WORD(0x2800) /* in the place of the parameter page */
#define VIEW_PAGE_BASE (PARAM_PAGE_BASE + VIEW_PAGE_OFFSET)
#define VIEW_PAGE_MAGIC 0x56564F46u /* bytes "FOVV" */
#define VIEW_PAGE_VERSION 1u
#define VIEW_CAMERAS 4u

#define PARAM_VIEWS(X)                \
  X(VIEW_SINGLE, 0, "single")         \
  X(VIEW_FOUR_WAY, 1, "four_way")     \
  X(VIEW_BIRDS_EYE, 2, "birds_eye")
enum param_view { PARAM_VIEWS(PARAM_CONSTANT) };

/* Where the pictures of the four cameras come from. */
enum view_source_kind {
  VIEW_INPUTS = 0, /* four inputs of the decoder, in turn */
  VIEW_QUAD = 1    /* the quarters of one input: cameras 0 and 1 above, 2 and 3 below */
};

/* The cameras of a bird's-eye view. */
enum view_side { VIEW_FRONT = 0, VIEW_RIGHT = 1, VIEW_REAR = 2, VIEW_LEFT = 3 };

/* A rectangle of the displayed picture: px from the centre of its first pixel. */
typedef struct view_rectangle {
  double left, top, right, bottom;
} view_rectangle_t;

typedef struct view_page {
  uint32_t magic, version, bytes;
  uint32_t checksum; /* makes all 32-bit words of the page sum to 0 modulo 2^32 */
  uint32_t view;     /* enum param_view; not VIEW_SINGLE */
  uint32_t source;   /* enum view_source_kind */
  view_rectangle_t car; /* VIEW_BIRDS_EYE: what no camera shows; seams begin at its corners */
  /* VIEW_BIRDS_EYE: row by row a matrix from the displayed pixel (u, v, 1) to the ray of the ground point that it
   * shows, in the axes of the camera: right, down, forward. The unit of length does not matter. */
  double ground[VIEW_CAMERAS][9];
} view_page_t;

PARAM_ASSERT(sizeof(param_page_t) <= VIEW_PAGE_OFFSET);
PARAM_ASSERT(VIEW_PAGE_OFFSET + sizeof(view_page_t) <= PARAM_PAGE_BYTES);
PARAM_ASSERT(offsetof(view_page_t, car) == 24);
PARAM_ASSERT(offsetof(view_page_t, ground) == 56);
PARAM_ASSERT(sizeof(view_page_t) == 56 + 8 * 9 * VIEW_CAMERAS);

/* The words of the page whatever they are members of. */
typedef uint32_t __attribute__((may_alias)) view_page_word_t;

/** Sum of all words of the page; 0 for a sealed one. */
static inline uint32_t view_page_sum(const view_page_t *page) {
  const view_page_word_t *word = (const view_page_word_t *)page;
  uint32_t sum = 0;
  for (uint32_t i = 0; i < sizeof *page; i += 4) sum += *word++;
  return sum;
}

/** Sets magic, version, bytes and checksum. */
static inline void view_page_seal(view_page_t *page) {
  page->magic = VIEW_PAGE_MAGIC;
  page->version = VIEW_PAGE_VERSION;
  page->bytes = sizeof *page;
  page->checksum = 0;
  page->checksum = 0u - view_page_sum(page);
}

/** A null pointer, or what is wrong with the page. */
static inline const char *view_page_fault(const view_page_t *page) {
  if (page->magic != VIEW_PAGE_MAGIC) return "there is none (unknown magic)";
  if (page->version != VIEW_PAGE_VERSION) return "unknown version; this firmware reads version 1";
  if (page->bytes != sizeof *page) return "its size does not belong to its version";
  if (view_page_sum(page) != 0) return "its checksum is wrong";
  if (page->view != VIEW_FOUR_WAY && page->view != VIEW_BIRDS_EYE)
    return "unknown view; this firmware has 1 (four-way) and 2 (bird's-eye)";
  if (page->source > VIEW_QUAD) return "unknown source; this firmware has 0 (inputs) and 1 (quad)";
  return NULL;
}

#ifdef __cplusplus
}
#endif
#endif
