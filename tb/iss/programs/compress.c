// A byte-wise LZ coder and decoder over pseudo-random text, and a hash of the results.
#include <stdint.h>
#include <string.h>

#include "support.h"

static uint8_t text[6000], packed[13000], again[6000];
static uint16_t head[1024];

static unsigned pack(const uint8_t *in, unsigned n, uint8_t *out) {
  unsigned o = 0, i = 0;
  memset(head, 0xFF, sizeof head);
  while (i < n) {
    unsigned best = 0, where = 0;
    if (i + 3 < n) {
      const unsigned h = ((in[i] << 6) ^ (in[i + 1] << 3) ^ in[i + 2]) & 1023;
      if (head[h] != 0xFFFF) {
        const unsigned c = head[h];
        while (best < 255 && i + best < n && in[c + best] == in[i + best]) ++best;
        where = i - c;
      }
      head[h] = (uint16_t)i;
    }
    if (best >= 4) {
      out[o++] = 1; out[o++] = (uint8_t)best; out[o++] = (uint8_t)where; out[o++] = (uint8_t)(where >> 8);
      i += best;
    } else {
      out[o++] = 0; out[o++] = in[i++];
    }
  }
  return o;
}
static unsigned unpack(const uint8_t *in, unsigned n, uint8_t *out) {
  unsigned o = 0, i = 0;
  while (i < n) {
    if (in[i++]) {
      const unsigned len = in[i], where = in[i + 1] | in[i + 2] << 8;
      i += 3;
      for (unsigned k = 0; k < len; ++k, ++o) out[o] = out[o - where];
    } else {
      out[o++] = in[i++];
    }
  }
  return o;
}
static uint32_t hash(const uint8_t *p, unsigned n) {
  uint32_t h = 2166136261u;
  for (unsigned i = 0; i < n; ++i) h = (h ^ p[i]) * 16777619u;
  return h;
}

int main(void) {
  uint32_t s = 7;
  for (int round = 0; round < 3; ++round) {
    for (unsigned i = 0; i < sizeof text; ++i) {
      s = s * 1103515245u + 12345u;
      text[i] = (uint8_t)("abcdefgh tuvw"[(s >> 20) % (unsigned)(3 + 5 * round)]);
    }
    const unsigned n = pack(text, sizeof text, packed), m = unpack(packed, n, again);
    say("%u %u %08lx %08lx %d\n", n, m, (unsigned long)hash(packed, n),
        (unsigned long)hash(again, m), memcmp(text, again, sizeof text));
  }
  return 0;
}
