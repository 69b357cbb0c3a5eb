/* Clocks. Their values differ between machines. */
#include <stdio.h>
#include <time.h>

int main(void) {
  volatile unsigned n = 0;
  clock_t a = clock();
  while (clock() < a + CLOCKS_PER_SEC / 50) ++n;
  printf("%lu s, %lu turns\n", (unsigned long)time(NULL), (unsigned long)n);
  return 0;
}
