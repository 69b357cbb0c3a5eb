/* Prints its arguments. The last argument selects how the program ends. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void at_end(void) { puts("at the end"); }

int main(int argc, char **argv) {
  int i;
  for (i = 1; i < argc; ++i) printf("%d: '%s'\n", i, argv[i]);
  if (argc < 2) return 0;
  atexit(at_end);
  if (strcmp(argv[argc - 1], "abort") == 0) {
    fflush(stdout);
    abort();
  }
  if (strncmp(argv[argc - 1], "return=", 7) == 0) return atoi(argv[argc - 1] + 7);
  exit(atoi(argv[argc - 1]));
}
