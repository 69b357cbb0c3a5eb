/* A remap method: how one frame is corrected, and the form of the look-up table that it reads. */
#ifndef FOVEA_FIRMWARE_METHOD_H
#define FOVEA_FIRMWARE_METHOD_H

#include <stdint.h>

#include "arena.h"
#include "model/contract/param_page.h"

/** The table of one view. Source and result have the same pitch. */
typedef struct remap_table {
  uint32_t width, height; /* of the result, pixels; width a multiple of 4, height even */
  uint32_t source_width, source_height;
  uint32_t pitch_bytes;   /* of source and result; a multiple of 32 */
  const uint32_t *lut;    /* width / 2 * height byte offsets from the start of the source, row by row;
                             source_height * pitch_bytes is that of the black word. Once there is an
                             `encoded` form, perhaps only the first row. */
  const lens_view_t *view; /* what `lut` is made of */
  int has_engine;          /* the chip has the remap engine */
  int in_turn;             /* other tables need memory of the same arena */
  const void *encoded;    /* the method's own form of the table; a null pointer if it reads `lut` */
  uint32_t encoded_bytes; /* number of bytes of tables that are read for each frame */
} remap_table_t;

/* Why methods that know one size alone refuse a table. */
#define REMAP_TWO_SIZES "camera and display have different sizes"
static inline int remap_two_sizes(const remap_table_t *table) {
  return table->source_width != table->width || table->source_height != table->height;
}

typedef struct remap_method {
  const char *name; /* for messages: the word of the parameter page */
  /** Derives `encoded` from `lut`, in memory from `arena`. What was taken is lost after a refusal.
   * Several tables may be prepared one after the other, each as if it was the only one; what a
   * method keeps elsewhere (internal RAM, registers) belongs to one of them.
   * @return a null pointer, or the reason why this method does not fit the lens or the picture */
  const char *(*prepare)(remap_table_t *table, arena_t *arena);
  /** Corrects one frame with any of the tables that were prepared. The caller has invalidated the
   * D-cache for the source, and cleans it for the result afterwards. */
  void (*run)(const remap_table_t *table, const void *in, void *out);
} remap_method_t;

/* The methods of the rows of PARAM_KERNELS: method_KERNEL_PLAIN and so on, each defined in a source of this folder.
 * One that is moved by another, as that of `fastest`, is not there. */
#define REMAP_METHOD(kernel, ...) extern const remap_method_t method_##kernel;
PARAM_KERNELS(REMAP_METHOD)
#undef REMAP_METHOD

#endif
