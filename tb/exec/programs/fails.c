/* Programs that fail, selected by the first argument. */
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv) {
  const char *how = argc > 1 ? argv[1] : "";
  printf("%s\n", how);
  fflush(stdout);
  if (strcmp(how, "load") == 0) return *(volatile int *)0x50000000;
  if (strcmp(how, "jump") == 0) ((void (*)(void))0x50000000)();
  void (*volatile nothing)(void) = 0;
  if (strcmp(how, "null") == 0) nothing();
  if (strcmp(how, "sleep") == 0) __asm__ volatile("mcr p15, 0, %0, c7, c0, 4" ::"r"(0));
  if (strcmp(how, "loop") == 0)
    for (;;) __asm__ volatile("");
  if (strcmp(how, "talk") == 0)
    for (;;) printf("talk\n");
  if (strcmp(how, "ask") == 0) return getchar() == EOF ? 5 : 6;
  if (strcmp(how, "file") == 0) return fopen("../up", "w") || fopen("/tmp/up", "w") ? 1 : 7;
  if (strcmp(how, "tmpnam") == 0) {
    char name[L_tmpnam];
    for (int i = 0; i < 3; ++i)
      if (fopen(tmpnam(name), "w")) return 1;
    return 7;
  }
  return 0;
}
