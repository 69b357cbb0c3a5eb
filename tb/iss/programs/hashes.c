// SHA-256 and CRC-32 (by table and bit by bit) of texts of all lengths, and published results.
#include <stdint.h>
#include <string.h>

#include "support.h"

typedef struct {
  uint32_t state[8];
  uint64_t bits;
  uint8_t block[64];
  unsigned fill;
} sha256;

static uint32_t constants[64], initial[8];

static uint32_t rotate(uint32_t v, unsigned n) { return v >> n | v << (32 - n); }

/// The first 32 bits of the fractional part of the r-th root of p, by bisection in integers.
static uint32_t root_fraction(uint32_t p, unsigned r) {
  // x = 2^32 * root, which lies below 2^37 for the 64 primes.
  uint64_t low = 0, high = (uint64_t)1 << 37;
  while (high - low > 1) {
    const uint64_t x = (low + high) / 2;
    // Is x^r at least p * 2^(32 r)?
    uint32_t limbs[5] = {1, 0, 0, 0, 0};
    const uint32_t parts[2] = {(uint32_t)x, (uint32_t)(x >> 32)};
    for (unsigned k = 0; k < r; ++k) {
      uint32_t next[7] = {0};
      for (unsigned i = 0; i <= k + 1; ++i) {
        uint64_t carry = 0;
        for (unsigned j = 0; j < 2; ++j) {
          const uint64_t t = (uint64_t)limbs[i] * parts[j] + next[i + j] + carry;
          next[i + j] = (uint32_t)t;
          carry = t >> 32;
        }
        next[i + 2] += (uint32_t)carry;
      }
      memcpy(limbs, next, sizeof limbs);
    }
    int above = limbs[r] >= p;
    for (unsigned i = r + 1; i < 5; ++i) above |= limbs[i] != 0;
    if (above)
      high = x;
    else
      low = x;
  }
  return (uint32_t)low;
}

static void block(sha256 *s) {
  uint32_t w[64], v[8];
  for (unsigned k = 0; k < 16; ++k)
    w[k] = (uint32_t)s->block[4 * k] << 24 | (uint32_t)s->block[4 * k + 1] << 16 |
           (uint32_t)s->block[4 * k + 2] << 8 | s->block[4 * k + 3];
  for (unsigned k = 16; k < 64; ++k) {
    const uint32_t a = w[k - 15], b = w[k - 2];
    w[k] = w[k - 16] + (rotate(a, 7) ^ rotate(a, 18) ^ a >> 3) + w[k - 7] +
           (rotate(b, 17) ^ rotate(b, 19) ^ b >> 10);
  }
  memcpy(v, s->state, sizeof v);
  for (unsigned k = 0; k < 64; ++k) {
    const uint32_t e = v[4], a = v[0];
    const uint32_t t = v[7] + (rotate(e, 6) ^ rotate(e, 11) ^ rotate(e, 25)) +
                       ((e & v[5]) ^ (~e & v[6])) + constants[k] + w[k];
    const uint32_t u =
        (rotate(a, 2) ^ rotate(a, 13) ^ rotate(a, 22)) + ((a & v[1]) ^ (a & v[2]) ^ (v[1] & v[2]));
    memmove(v + 1, v, 7 * sizeof *v);
    v[4] += t;
    v[0] = t + u;
  }
  for (unsigned k = 0; k < 8; ++k) s->state[k] += v[k];
}

static void add(sha256 *s, const void *data, unsigned n) {
  const uint8_t *p = data;
  s->bits += 8 * (uint64_t)n;
  while (n--) {
    s->block[s->fill++] = *p++;
    if (s->fill == 64) {
      block(s);
      s->fill = 0;
    }
  }
}

static void finish(sha256 *s) {
  const uint64_t bits = s->bits;
  uint8_t length[8];
  add(s, "\x80", 1);
  while (s->fill != 56) add(s, "", 1);
  for (unsigned k = 0; k < 8; ++k) length[k] = (uint8_t)(bits >> (56 - 8 * k));
  add(s, length, 8);
}

static void start(sha256 *s) {
  memset(s, 0, sizeof *s);
  memcpy(s->state, initial, sizeof initial);
}

static uint32_t table[256];
static uint32_t crc_by_table(const uint8_t *p, unsigned n) {
  uint32_t c = ~0u;
  while (n--) c = c >> 8 ^ table[(c ^ *p++) & 255];
  return ~c;
}
static uint32_t crc_by_bits(const uint8_t *p, unsigned n) {
  uint32_t c = ~0u;
  for (; n; --n, ++p)
    for (unsigned k = 0; k < 8; ++k) c = c >> 1 ^ (((c ^ *p >> k) & 1) ? 0xEDB88320u : 0);
  return ~c;
}

int main(void) {
  static uint8_t text[1200];
  uint32_t primes[64];
  unsigned n = 0;
  for (uint32_t p = 2; n < 64; ++p) {
    int prime = 1;
    for (uint32_t d = 2; d * d <= p; ++d) prime &= p % d != 0;
    if (prime) primes[n++] = p;
  }
  for (unsigned k = 0; k < 64; ++k) constants[k] = root_fraction(primes[k], 3);
  for (unsigned k = 0; k < 8; ++k) initial[k] = root_fraction(primes[k], 2);
  for (uint32_t k = 0; k < 256; ++k) {
    uint32_t c = k;
    for (unsigned b = 0; b < 8; ++b) c = c >> 1 ^ (c & 1 ? 0xEDB88320u : 0);
    table[k] = c;
  }
  sha256 s;
  start(&s);
  add(&s, "abc", 3);
  finish(&s);
  say("abc %08lx %s\n", (unsigned long)s.state[0], s.state[0] == 0xBA7816BFu ? "right" : "wrong");
  say("crc %08lx %s\n", (unsigned long)crc_by_table((const uint8_t *)"123456789", 9),
      crc_by_table((const uint8_t *)"123456789", 9) == 0xCBF43926u ? "right" : "wrong");
  for (unsigned k = 0; k < sizeof text; ++k) text[k] = (uint8_t)(k * k * 7 + k / 3);
  for (unsigned len = 0; len < sizeof text; len = len * 5 / 4 + 1) {
    start(&s);
    for (unsigned done = 0; done < len;) {
      const unsigned some = done + 7 + done % 60 > len ? len - done : 7 + done % 60;
      add(&s, text + done, some);
      done += some;
    }
    finish(&s);
    say("%4u ", len);
    for (unsigned k = 0; k < 8; ++k) say("%08lx", (unsigned long)s.state[k]);
    say(" %08lx %d\n", (unsigned long)crc_by_table(text, len),
        crc_by_table(text, len) == crc_by_bits(text, len));
  }
  return 0;
}
