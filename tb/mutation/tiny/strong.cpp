#include "strong.h"

constexpr int kEvery = 4;             // no mutant: constants are data
static_assert(kEvery + 0 == 4);

bool leap(int year) {
  if (year % 100 == 0) return year % 400 == 0;
  return year % kEvery == 0;
}

int even_sum(int n) {
  int sum = 0;
  for (int i = 0; i < n; ++i) {
    if (i % 2 == 0) sum += i;
  }
  return sum;
}
