/* Memory that is taken once, at the start, and never given back. */
#ifndef FOVEA_FIRMWARE_ARENA_H
#define FOVEA_FIRMWARE_ARENA_H

#include <stddef.h>
#include <stdint.h>

typedef struct arena {
  uintptr_t next, end; /* addresses */
} arena_t;

/** Memory of `bytes` bytes at a multiple of `alignment` (a power of two), not cleared. Returns a null
 * pointer if there is not enough left; nothing is taken then. */
static inline void *arena_take(arena_t *arena, size_t bytes, size_t alignment) {
  const uintptr_t start = (arena->next + alignment - 1) & ~(uintptr_t)(alignment - 1);
  if (start < arena->next || start > arena->end || bytes > arena->end - start) return NULL;
  arena->next = start + bytes;
  return (void *)start;
}

/** The same from the end, so that it can be given back while what was taken from the start stays. */
static inline void *arena_take_end(arena_t *arena, size_t bytes, size_t alignment) {
  const uintptr_t start = (arena->end - bytes) & ~(uintptr_t)(alignment - 1);
  if (bytes > arena->end - arena->next || start < arena->next) return NULL;
  arena->end = start;
  return (void *)start;
}

#endif
