/* Finds parts of a captured frame that were not written to memory, although no register tells of an overflow. Before a
 * buffer is filled, each unit of it gets a mark that no camera can send; a mark that is still there afterwards is in a
 * unit that was lost. No hardware access, so that it can be tested on the host. */
#ifndef FOVEA_FIRMWARE_CAPTURE_CHECK_H
#define FOVEA_FIRMWARE_CAPTURE_CHECK_H

#include <stdint.h>

/* The smallest burst that the capture may lose: its registers count in units of so many bytes. */
#define CAPTURE_UNIT_BYTES 32u
/* Bytes 00 and FF, which ITU-R BT.656 keeps for timing codes. */
#define CAPTURE_MARK 0x00FF00FFu

/** Marks the units of `rows` rows, of which each begins with `row_bytes` bytes of picture, a multiple of 4.
 * @param pitch_bytes from row to row, a multiple of CAPTURE_UNIT_BYTES */
void capture_check_mark(uint8_t *frame, uint32_t row_bytes, uint32_t pitch_bytes, uint32_t rows);

/** Number of units in which the mark is still there. */
uint32_t capture_check_lost(const uint8_t *frame, uint32_t row_bytes, uint32_t pitch_bytes, uint32_t rows);

#endif
