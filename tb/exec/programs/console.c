/* Formatted output, the three standard streams, and input line by line. */
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

int main(void) {
  char line[64];
  int lines = 0, n;
  double sum = 0, x;
  printf("%5d|%-5d|%05d|%x|%lld|%s|%c\n", 42, -42, 7, 0xBEEFu, 1234567890123LL, "text", 'c');
  printf("%.6f %g %e\n", 3.14159265358979, 1e-7, 12345.678);
  fprintf(stderr, "to the other stream\n");
  while (lines < 3 && fgets(line, sizeof line, stdin)) {
    line[strcspn(line, "\n")] = 0;
    printf("line %d: '%s' (%u)\n", ++lines, line, (unsigned)strlen(line));
  }
  for (n = 0; scanf("%lf", &x) == 1; ++n) sum += x;
  printf("%d numbers, sum %.3f, end of input %d\n", n, sum, feof(stdin) != 0);
  printf("terminal %d, clock runs %d\n", isatty(2) >= 0, clock() != (clock_t)-1);
  fputs("no newline at the end", stdout);
  return 0;
}
