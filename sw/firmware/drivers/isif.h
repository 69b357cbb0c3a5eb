/* Capture by the ISIF, with the timing codes of BT.656: both fields of an interlaced camera are interleaved into
 * one UYVY frame; a progressive one has a field for each frame. */
#ifndef FOVEA_FIRMWARE_ISIF_H
#define FOVEA_FIRMWARE_ISIF_H

#include <stdint.h>

#include "../mmio.h"
#include "../regs.h"

typedef struct isif_window {
  uint32_t left, top;     /* pixels, lines of the frame; top even */
  uint32_t width, height; /* pixels, lines of the frame; both even */
  uint32_t pitch_bytes;   /* multiple of 32 */
  int progressive;
} isif_window_t;

/** Lines of the window in each field. */
static inline uint32_t isif_field_lines(const isif_window_t *w) {
  return w->progressive ? w->height : w->height / 2u;
}
/** The line of a field at which the window begins, counted from the first one that is not blanked. */
static inline uint32_t isif_first_line(const isif_window_t *w) {
  return (w->progressive ? w->top : w->top / 2u) + 1u;
}

typedef enum isif_result { ISIF_OK = 0, ISIF_BAD_WINDOW, ISIF_BAD_ADDRESS } isif_result_t;

/** Bytes from one line to the next: a line, rounded up to the 32-byte units of the ISIF. */
static inline uint32_t isif_pitch(uint32_t width) { return (width * 2u + 31u) & ~31u; }

/** Line of VDINT0. Public drivers use LNV, two lines before the end of the captured region, because
 * lines are counted from VD and the first captured line is SLV. Here the frame is used at once, so
 * the interrupt comes two lines after the last captured line, when its last burst has been issued.
 */
static inline uint32_t isif_end_of_field_line(const isif_window_t *w) {
  return isif_first_line(w) + isif_field_lines(w) + 1u;
}

/** Programs the window; capture stays off. Nothing is written if the window is refused. */
__attribute__((warn_unused_result)) isif_result_t isif_configure(const isif_window_t *window);

/** Sets the frame's address (32-byte aligned), which takes effect at the next VD. */
__attribute__((warn_unused_result)) isif_result_t isif_set_address(uint32_t address);

/** Synchronises only: VDINT0 comes for every field, and nothing is written to memory. */
void isif_watch(void);

/** Synchronises and captures data, from the next VD on. */
void isif_capture(void);

/** Returns 1 while the second field of a frame is received. */
int isif_second_field(void);

/** VDINT1 comes at the start of every field (SPRU629 table 4-2: lines 1 and 313, or 4 and 266), counted
 * from the first active line of the field before. The next VD comes 22 lines later, 16 with 525 lines. */
static inline void isif_mark_fields(int is_625) { mmio_write32(ISIF_VDINT1, is_625 ? 291u : 247u); }

#endif
