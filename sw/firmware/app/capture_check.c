#include "capture_check.h"

/* The mark is the first word of a unit: that one is picture in each unit that has any. */
void capture_check_mark(uint8_t *frame, uint32_t row_bytes, uint32_t pitch_bytes, uint32_t rows) {
  for (; rows != 0; --rows, frame += pitch_bytes)
    for (uint32_t at = 0; at < row_bytes; at += CAPTURE_UNIT_BYTES) *(uint32_t *)(frame + at) = CAPTURE_MARK;
}

uint32_t capture_check_lost(const uint8_t *frame, uint32_t row_bytes, uint32_t pitch_bytes, uint32_t rows) {
  uint32_t lost = 0;
  for (; rows != 0; --rows, frame += pitch_bytes)
    for (uint32_t at = 0; at < row_bytes; at += CAPTURE_UNIT_BYTES)
      lost += *(const uint32_t *)(frame + at) == CAPTURE_MARK;
  return lost;
}
