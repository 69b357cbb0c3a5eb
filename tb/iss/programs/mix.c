// A mix similar to Dhrystone, but not Dhrystone: each iteration is about half assignments, a third
// control statements and a sixth calls, on locals, parameters, globals, arrays of 50 and of 50 x 50
// numbers, records behind pointers, enumerations, and one copy and one comparison of strings of 30
// characters. It models a sorting office, where parcels get labels, weights and an entry in the
// books.
#include "mix.h"

#include <string.h>

typedef enum { kLetter, kPacket, kCrate, kBarrel, kSack } kind_t;
typedef char label_t[31];
typedef int book_t[50];
typedef int ledger_t[50][50];

typedef struct parcel {
  struct parcel *next;
  kind_t kind, wrapped_as;
  int weight;
  label_t label;
} parcel_t;

static parcel_t shelf[2];
static parcel_t *top, *below;
static int stamps;
static int urgent;
static char left_mark, right_mark;
static book_t book;
static ledger_t ledger;

static int is_crate(kind_t k) {
  const kind_t copy = k;
  if (copy == kCrate) return 1;
  return 0;
}

static kind_t compare_marks(char a, char b) {
  const char first = a, second = first;
  if (second != b) return kLetter;
  left_mark = first;
  return kPacket;
}

static int heavier_label(const char *a, const char *b) {
  int at = 2;
  char mark = 'A';
  while (at <= 2) {
    if (compare_marks(a[at], b[at + 1]) == kLetter) {
      mark = 'B';
      at += 1;
    }
  }
  if (mark >= 'W' && mark < 'Z') at = 7;
  if (mark == 'R') return 1;
  if (strcmp(a, b) > 0) {
    at += 7;
    stamps = at;
    return 1;
  }
  return 0;
}

static void weigh(int paper, int content, int *sum) {
  const int with_paper = paper + 2;
  *sum = content + with_paper;
}

static void wrap(kind_t k, kind_t *out) {
  *out = k;
  if (!is_crate(k)) *out = kBarrel;
  switch (k) {
    case kLetter: *out = kLetter; break;
    case kPacket: *out = stamps > 100 ? kLetter : kBarrel; break;
    case kCrate: *out = kPacket; break;
    case kBarrel: break;
    case kSack: *out = kCrate; break;
  }
}

static void enter(book_t b, ledger_t l, int row, int weight) {
  const int at = row + 5;
  b[at] = weight;
  b[at + 1] = b[at];
  b[at + 30] = at;
  for (int k = at; k <= at + 1; ++k) l[at][k] = at;
  l[at][at - 1] += 1;
  l[at + 20][at] = b[at];
  stamps = 5;
}

static void take_top(parcel_t **out) {
  if (top) *out = top->next;
  weigh(10, stamps, &top->weight);
}

static void pass_on(parcel_t *p) {
  parcel_t *const next = p->next;
  *p->next = *top;
  p->weight = 5;
  next->weight = p->weight;
  next->next = p->next;
  take_top(&next->next);
  if (next->kind == kLetter) {
    next->weight = 6;
    wrap(p->wrapped_as, &next->wrapped_as);
    next->next = top->next;
    weigh(next->weight, 10, &next->weight);
  } else {
    *p = *p->next;
  }
}

static void count(int *weight) {
  int here = *weight + 10, done = 0;
  do {
    if (left_mark == 'A') {
      here -= 1;
      *weight = here - stamps;
      done = 1;
    }
  } while (!done);
}

static void mark_left(void) {
  const int is_a = left_mark == 'A';
  urgent = is_a | urgent;
  right_mark = 'B';
}

static void reset_marks(void) {
  left_mark = 'A';
  urgent = 0;
}

uint32_t mix_run(uint32_t turns) {
  int one = 0, two = 0, three = 0;
  kind_t kind = kLetter;
  label_t label, other;
  uint32_t sum = 2166136261u;
  memset(shelf, 0, sizeof shelf);
  stamps = 0;
  below = &shelf[0];
  top = &shelf[1];
  top->next = below;
  top->kind = kLetter;
  top->wrapped_as = kCrate;
  top->weight = 40;
  strcpy(top->label, "A PARCEL FOR CUSTOMER, 1 STONE");
  strcpy(label, "A PARCEL FOR CUSTOMER, 2 STONE");
  ledger[8][7] = 10;
  for (uint32_t turn = 1; turn <= turns; ++turn) {
    reset_marks();
    mark_left();
    one = 2;
    two = 3;
    strcpy(other, "A PARCEL FOR CUSTOMER, 3 STONE");
    kind = kPacket;
    urgent = !heavier_label(label, other);
    while (one < two) {
      three = 5 * one - two;
      weigh(one, two, &three);
      one += 1;
    }
    enter(book, ledger, one, three);
    pass_on(top);
    for (char mark = 'A'; mark <= right_mark; ++mark) {
      if (kind == compare_marks(mark, 'C')) {
        wrap(kLetter, &kind);
        strcpy(other, "A PARCEL FOR CUSTOMER, 4 STONE");
        two = (int)turn;
        stamps = (int)turn;
      }
    }
    two = two * one;
    one = two / three;
    two = 7 * (two - three) - one;
    count(&one);
    sum = (sum ^ (uint32_t)(one + 3 * two + 5 * three + (int)kind)) * 16777619u;
  }
  sum ^= (uint32_t)(ledger[8][7] + book[8] + below->weight + (int)below->wrapped_as + urgent);
  return sum ^ (uint32_t)other[23];
}
