/* What the methods with a table of their own have in common. */
#ifndef FOVEA_FIRMWARE_ENCODED_H
#define FOVEA_FIRMWARE_ENCODED_H

#include "method.h"
#include "sw/remap/picture.h"

/** prepare() with an encoder of sw/remap: tries the widths of strips in `widest`, which ends with
 * 0, one after the other. The memory of attempts that fail is not lost. */
const char *encoded_prepare(remap_table_t *table, arena_t *arena, remap_encode_t *encode,
                            const uint8_t *widest);

/** The address of an offset in the table's encoded form. */
static inline const void *encoded_at(const remap_table_t *table, uint32_t offset) {
  return (const uint8_t *)table->encoded + offset;
}

/** Sets the loop's variables in LOOP_RAM for a strip. @return where its first pair goes to */
uint32_t *encoded_begin(const remap_table_t *table, remap_strip_t strip, const void *base,
                        void *out);

/** Paints what is black. */
void encoded_black(const remap_table_t *table, void *out);

#endif
