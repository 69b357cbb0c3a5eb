// printf and scanf conversions, flags, widths and precisions; conversions between numbers and text.
#include <errno.h>
#include <float.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>

#include "support.h"

#pragma GCC diagnostic ignored "-Wformat"
#pragma GCC diagnostic ignored "-Wformat-zero-length"

int main(void) {
  static const int kInts[] = {0, 1, -1, 42, -12345, INT_MAX, INT_MIN};
  static const long long kLongs[] = {0, -1, 1234567890123456789LL, LLONG_MAX, LLONG_MIN};
  static const double kDoubles[] = {
      0.0,     -0.0,           1.0, -1.5,     0.1, 123456.789, 1e-10,    -9.9e22,  DBL_MAX,
      DBL_MIN, 4.9406565e-324, 0.5, 999999.5, 2.5, 1e15,       INFINITY, -INFINITY};
  static const char *const kIntFormats[] = {
      "[%d]",     "[%5d]",    "[%-8d]",  "[%08d]", "[%+d]",  "[% d]", "[%.4d]",
      "[%10.6d]", "[%i]",     "[%u]",    "[%x]",   "[%X]",   "[%#x]", "[%#o]",
      "[%o]",     "[%-#12x]", "[%+.0d]", "[%hd]",  "[%hhd]", "[%hu]", "[%hhx]"};
  static const char *const kDoubleFormats[] = {
      "[%f]",    "[%.0f]",   "[%10.3f]", "[%-12.2f]", "[%+e]",     "[%.0e]",
      "[%#.0e]", "[%12.4E]", "[%g]",     "[%.3g]",    "[%#g]",     "[%G]",
      "[%.17g]", "[%a]",     "[%.2a]",   "[%A]",      "[%020.5f]", "[% f]"};
  char line[400];
  for (unsigned f = 0; f < sizeof kIntFormats / sizeof *kIntFormats; ++f) {
    for (unsigned k = 0; k < sizeof kInts / sizeof *kInts; ++k) {
      const int n = snprintf(line, sizeof line, kIntFormats[f], kInts[k]);
      say("%d%s ", n, line);
    }
    say("\n");
  }
  for (unsigned k = 0; k < sizeof kLongs / sizeof *kLongs; ++k)
    say("%lld|%llu|%llx|%#llo|%+25lld|%-25lld|%025lld|%ld|%jd|%zu|%td\n", kLongs[k], kLongs[k],
        kLongs[k], kLongs[k], kLongs[k], kLongs[k], kLongs[k], (long)kLongs[k], (intmax_t)kLongs[k],
        (size_t)kLongs[k], (ptrdiff_t)kLongs[k]);
  for (unsigned f = 0; f < sizeof kDoubleFormats / sizeof *kDoubleFormats; ++f) {
    for (unsigned k = 0; k < sizeof kDoubles / sizeof *kDoubles; ++k) {
      const int n = snprintf(line, sizeof line, kDoubleFormats[f], kDoubles[k]);
      say("%d", n);
      say("%.200s ", line);
    }
    say("\n");
  }
  say("%s|%10s|%-10s|%.2s|%10.1s|%c|%5c|%-5c|%%|%p|%*d|%-*d|%.*f\n", "text", "text", "text", "text",
      "text", 'x', 'y', 'z', (void *)0x1234, 7, 42, 7, 42, 3, 2.0 / 3);
  int so_far = -1;
  say("%s%n and %d\n", "counted", &so_far, 1);
  say("%d\n", so_far);
  for (unsigned room = 0; room < 12; ++room) {
    memset(line, '#', 16);
    line[16] = 0;
    const int n = snprintf(line, room, "%d-%s", 12345, "cut");
    say("%u %d %s\n", room, n, line + (room == 0));
  }
  int a = 0, b = 0, n;
  unsigned u = 0;
  double d = 0;
  float e = 0;
  char word[16] = "", set[16] = "";
  long long l = 0;
  n = sscanf("  -17 0x1f 077 3.25e2 word:abc123 99999999999 7.5",
             "%d %i %o %lf %[a-z]:%15s %lld %f", &a, &b, &u, &d, set, word, &l, &e);
  say("%d: %d %d %u %g %s %s %lld %g\n", n, a, b, u, d, set, word, l, (double)e);
  static const char *const kTexts[] = {"0",       "-0x1p-3",     "1e400",
                                       "-1e-400", "nan",         "inf",
                                       "12abc",   " 2147483648", "-9223372036854775809",
                                       "0777",    "zz",          ""};
  for (unsigned k = 0; k < sizeof kTexts / sizeof *kTexts; ++k) {
    char *end;
    errno = 0;
    const double v = strtod(kTexts[k], &end);
    const int e1 = errno, at1 = (int)(end - kTexts[k]);
    errno = 0;
    const long w = strtol(kTexts[k], &end, 0);
    const int e2 = errno, at2 = (int)(end - kTexts[k]);
    errno = 0;
    const unsigned long long x = strtoull(kTexts[k], &end, 36);
    say("'%s' %g %d %d, %ld %d %d, %llu %d %d\n", kTexts[k], v, at1, e1, w, at2, e2, x,
        (int)(end - kTexts[k]), errno);
  }
  static char text[] = "one,two;;three four";
  for (char *t = strtok(text, ",; "); t; t = strtok(NULL, ",; ")) say("<%s>", t);
  say("\n%d %d %s\n", (int)strspn("aabbc", "ab"), (int)strcspn("hello", "l"),
      strrchr("a/b/c", '/'));
  const div_t q = div(-17, 5);
  const lldiv_t r = lldiv(-1234567890123LL, 1000);
  say("%d %d %lld %lld %d %ld\n", q.quot, q.rem, r.quot, r.rem, abs(-3), labs(-4));
  return 0;
}
