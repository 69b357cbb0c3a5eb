/* A program to debug: calls, watched variables, a value to patch, a failure, an endless wait. */
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

struct {
  int first, second, third;
} volatile pair;

/* One instruction, three variables. */
__attribute__((noinline)) void store_pair(int base) {
  register volatile void *to __asm__("r3") = &pair;
  register int a __asm__("r4") = base + 1, b __asm__("r5") = base + 2, c __asm__("r6") = base + 3;
  __asm__ volatile(".global store_here\nstore_here: stmia %0, {r4, r5, r6}"
                   :
                   : "r"(to), "r"(a), "r"(b), "r"(c)
                   : "memory");
}

__attribute__((noinline)) int load(volatile int *from) { return *from; }

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "load") == 0) return load((int *)0x50000000);
  if (argc > 1 && strcmp(argv[1], "input") == 0) {
    char line[20] = "";
    puts("waiting");
    fflush(stdout);
    printf("read %s", fgets(line, sizeof line, stdin) ? line : "nothing\n");
  }
  store_pair(10);
  store_pair(20);
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
