// The system calls that newlib needs, and formatted output to host_write().
#include "support.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

int main(void);
void __libc_init_array(void);
void _init(void) {}
void *__dso_handle;
int run_program(void) {
  __libc_init_array();
  return main();
}

void say(const char *format, ...) {
  char line[256];
  va_list args;
  va_start(args, format);
  const int n = vsnprintf(line, sizeof line, format, args);
  va_end(args);
  host_write(line, (uint32_t)n);
}

void *_sbrk(ptrdiff_t n) {
  static char heap[1 << 18];
  static size_t used;
  if (n < 0 || used + (size_t)n > sizeof heap) return (void *)-1;
  void *at = heap + used;
  used += (size_t)n;
  return at;
}
int _write(int f, const char *p, int n) { (void)f; host_write(p, (uint32_t)n); return n; }
int _read(int f, char *p, int n) { (void)f; (void)p; (void)n; return 0; }
int _close(int f) { (void)f; return -1; }
int _lseek(int f, int o, int w) { (void)f; (void)o; (void)w; return 0; }
int _fstat(int f, void *s) { (void)f; (void)s; return -1; }
int _isatty(int f) { (void)f; return 1; }
int _getpid(void) { return 1; }
int _kill(int p, int s) { (void)p; (void)s; return -1; }
int getentropy(void *p, size_t n) { (void)p; (void)n; return -1; }
