#include "remap.h"

void remap_plain(uint32_t *restrict out, const void *in, const uint32_t *restrict lut,
                 uint32_t pairs) {
  const char *base = in;
  const uint32_t *end = lut + pairs;
  while (lut != end) *out++ = *(const uint32_t *)(base + *lut++);
}
