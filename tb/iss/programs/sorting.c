// qsort and bsearch of structs by several keys, setjmp and longjmp through frames and out of a
// comparison, and calls through pointers.
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

typedef struct {
  char name[9];
  int16_t rank;
  double weight;
  uint64_t key;
  struct {
    unsigned kind : 3, flags : 11;
    signed bias : 7;
  } packed;
} item;

static uint32_t seed = 99;
static uint32_t next(void) { return seed = seed * 1664525u + 1013904223u; }

static int by_name(const void *a, const void *b) {
  const item *x = a, *y = b;
  const int c = strcmp(x->name, y->name);
  return c ? c : x->rank - y->rank;
}
static int by_weight(const void *a, const void *b) {
  const item *x = a, *y = b;
  return (x->weight > y->weight) - (x->weight < y->weight);
}
static int by_key(const void *a, const void *b) {
  const item *x = a, *y = b;
  return (x->key > y->key) - (x->key < y->key);
}
static int by_bits(const void *a, const void *b) {
  const item *x = a, *y = b;
  if (x->packed.kind != y->packed.kind) return (int)x->packed.kind - (int)y->packed.kind;
  if (x->packed.bias != y->packed.bias) return x->packed.bias - y->packed.bias;
  return by_key(a, b);
}
static jmp_buf out;
static unsigned compared;
static int gives_up(const void *a, const void *b) {
  if (++compared == 300) longjmp(out, (int)compared);
  return by_key(a, b);
}

static item items[160];

static void show(const char *what) {
  uint32_t h = 2166136261u;
  for (unsigned k = 0; k < 160; ++k) {
    const item *i = items + k;
    h = (h ^ (uint32_t)i->key ^ (uint32_t)i->rank) * 16777619u;
    if (k % 20 == 0)
      say("%s %d %ld %08lx %u %d; ", i->name, i->rank, (long)(i->weight * 1000),
          (unsigned long)(i->key >> 32), i->packed.flags, i->packed.bias);
  }
  say("\n%s %08lx\n", what, (unsigned long)h);
}

static int deep(int n, jmp_buf where, double carried) {
  volatile int local = n * 3;
  if (n == 0) longjmp(where, (int)carried);
  const int r = deep(n - 1, where, carried + n * 0.5);
  return r + local;
}

int main(void) {
  static int (*const kOrders[])(const void *, const void *) = {by_name, by_weight, by_key, by_bits};
  static const char *const kNames[] = {"name", "weight", "key", "bits"};
  for (unsigned k = 0; k < 160; ++k) {
    item *i = items + k;
    for (unsigned c = 0; c < 8; ++c) i->name[c] = (char)('a' + (next() >> 24) % (c ? 26 : 4));
    i->rank = (int16_t)(next() >> 16);
    i->weight = (double)(int32_t)next() / 65536.0;
    i->key = (uint64_t)next() << 32 | next();
    i->packed.kind = next() >> 29;
    i->packed.flags = next() >> 21;
    i->packed.bias = (int)(next() >> 25) - 64;
  }
  for (unsigned o = 0; o < 4; ++o) {
    qsort(items, 160, sizeof *items, kOrders[o]);
    show(kNames[o]);
    for (unsigned k = 1; k < 160; ++k)
      if (kOrders[o](items + k - 1, items + k) > 0) say("not sorted at %u\n", k);
    const item *found = bsearch(items + 77, items, 160, sizeof *items, kOrders[o]);
    say("%d\n", (int)(found - items));
  }
  qsort(items, 160, sizeof *items, by_name);
  const int left = setjmp(out);
  if (left == 0) qsort(items, 160, sizeof *items, gives_up);
  say("left after %d comparisons\n", left);
  for (volatile int round = 0; round < 5; ++round) {
    jmp_buf where;
    volatile int kept = round * 11;
    const int got = setjmp(where);
    if (got == 0) deep(10 + round, where, round);
    say("round %d kept %d got %d\n", round, kept, got);
  }
  return 0;
}
