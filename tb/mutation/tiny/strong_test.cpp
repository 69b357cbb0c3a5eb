#include "strong.h"

int main() {
  const bool years = leap(2000) && leap(2400) && leap(2004) && leap(4) && !leap(1900) && !leap(2001) &&
                     !leap(2005) && !leap(1800) && !leap(2002) && !leap(100) && !leap(401) && !leap(399) &&
                     leap(396) && leap(404) && !leap(101) && !leap(99) && leap(400);
  const bool sums = even_sum(0) == 0 && even_sum(1) == 0 && even_sum(2) == 0 && even_sum(3) == 2 &&
                    even_sum(4) == 2 && even_sum(5) == 6;
  return years && sums ? 0 : 1;
}
