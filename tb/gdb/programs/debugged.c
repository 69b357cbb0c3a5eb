/* Something to stop in: calls, a watched variable, a value to patch, an endless wait to interrupt. */
#include <stdio.h>
#include <string.h>

volatile int watched, limit = 5, waiting, released;

__attribute__((noinline)) int leaf(int n) {
  int result = n * 3 + 1;
  __asm__ volatile("");
  return result;
}

__attribute__((noinline)) int branch(int n) {
  int sum = 0;
  for (int i = 0; i < n; ++i) sum += leaf(i);
  return sum;
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "wait") == 0) {
    puts("waiting");
    fflush(stdout);
    while (!released) ++waiting;
  }
  const int sum = branch(limit);
  watched = sum;
  watched += 100;
  printf("sum %d watched %d limit %d\n", sum, watched, limit);
  return sum & 0x7F;
}
