#include "strong.h"

#include "part/../part/parity.h"  // by a path that is not the shortest

constexpr int kEvery = 4;             // no mutant: constants are data
static_assert(kEvery + 0 == 4);

bool leap(int year) {
  if (year % 100 == 0) return year % 400 == 0;
  return year % kEvery == 0;
}

int even_sum(int n) {
  int sum = 0;
  for (int i = 0; i < n; ++i) {
    if (even(i)) sum += i;
  }
  return sum;
}
