#include "weak.h"

static int count;

int clamp(int value, int low, int high) {
  if (value < low) {
    count += 1;
    return low;
  }
  if (value > high) {
    count += 1;
    return high;
  }
  return value;
}

int clamped(void) { return count; }
