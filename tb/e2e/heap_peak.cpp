// A preloaded library that counts what a program has allocated: the most bytes that were allocated at one time stand in
// the file named by HEAP_PEAK when the program ends. The resident set is no measure of small growth: the kernel counts
// it in batches of pages for each processor, and what the allocator keeps depends on which threads meet in it; both are
// hundreds of kilobytes. Memory that a program maps itself is not counted. Needs glibc.
#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace {
std::atomic<std::size_t> allocated{0}, peak{0};

void* taken(void* p) {
  const std::size_t now = allocated += malloc_usable_size(p);
  std::size_t most = peak;
  while (now > most && !peak.compare_exchange_weak(most, now)) {
  }
  return p;
}

void give_back(void* p) { allocated -= malloc_usable_size(p); }

void tell() {
  const char* name = std::getenv("HEAP_PEAK");
  std::FILE* file = name ? std::fopen(name, "w") : nullptr;
  if (!file) std::abort();
  std::fprintf(file, "%zu\n", peak.load());
  if (std::fclose(file) != 0) std::abort();
}

[[gnu::constructor]] void begin() {
  if (std::atexit(tell) != 0 || std::at_quick_exit(tell) != 0) std::abort();
}
}  // namespace

extern "C" {
void* malloc(std::size_t n) { return taken(__libc_malloc(n)); }
void* calloc(std::size_t n, std::size_t size) { return taken(__libc_calloc(n, size)); }
void* memalign(std::size_t alignment, std::size_t n) { return taken(__libc_memalign(alignment, n)); }
void* aligned_alloc(std::size_t alignment, std::size_t n) { return memalign(alignment, n); }
int posix_memalign(void** p, std::size_t alignment, std::size_t n) {
  *p = memalign(alignment, n);
  return *p ? 0 : ENOMEM;
}
void* realloc(void* p, std::size_t n) {
  give_back(p);
  void* to = __libc_realloc(p, n);
  if (!to && n != 0) {
    taken(p);
    return nullptr;
  }
  return taken(to);
}
void free(void* p) {
  give_back(p);
  __libc_free(p);
}
}
