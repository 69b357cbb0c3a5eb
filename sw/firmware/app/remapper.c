#include "remapper.h"

#include "../drivers/uart.h"
#include "model/contract/param_page.h"

/* For each kernel of the page its method and the kernel to try if the lens does not allow it. The
 * last one of such a chain fits every lens and refers to itself. */
typedef struct choice {
  const remap_method_t *method; /* a null pointer: not in this firmware, or no method at all */
  uint8_t otherwise;            /* enum param_kernel */
} choice_t;

static const choice_t kChoices[] = {
    [KERNEL_PLAIN] = {&method_plain, KERNEL_PLAIN},
    [KERNEL_LDM] = {&method_ldm, KERNEL_LDM},
    [KERNEL_STRIPS] = {&method_strips, KERNEL_STRIPS},
    [KERNEL_OFFSETS] = {&method_offsets, KERNEL_STRIPS},
    [KERNEL_DELTAS] = {&method_deltas, KERNEL_OFFSETS},
    [KERNEL_CODES] = {&method_codes, KERNEL_DELTAS},
    [KERNEL_STAGED] = {&method_staged, KERNEL_CODES},
    [KERNEL_GATHER] = {&method_gather, KERNEL_CODES},
    [KERNEL_RUNS] = {&method_runs, KERNEL_CODES},
    [KERNEL_COPY] = {&method_copy, KERNEL_CODES},
    [KERNEL_FASTEST] = {NULL, KERNEL_STAGED},
    [KERNEL_ENGINE] = {&method_engine, KERNEL_STAGED},
    [KERNEL_ENGINE_GRID] = {&method_engine_grid, KERNEL_STAGED},
    [KERNEL_ENGINE_RADIAL] = {&method_engine_radial, KERNEL_STAGED},
};

enum { kChoiceCount = sizeof kChoices / sizeof *kChoices };

static void report(const char *name, const char *refusal) {
  uart_puts("kernel ");
  uart_puts(name);
  uart_puts(": ");
  uart_puts(refusal);
  uart_puts("\n");
}

const remap_method_t *remapper_prepare(uint32_t kernel, remap_table_t *table, arena_t *arena) {
  if (kernel >= kChoiceCount || (kChoices[kernel].method == NULL && kernel != KERNEL_FASTEST))
    report("of the page", "not in this firmware");
  if (kernel >= kChoiceCount) kernel = KERNEL_FASTEST;
  for (;; kernel = kChoices[kernel].otherwise) {
    const remap_method_t *method = kChoices[kernel].method;
    if (method == NULL) continue;
    table->encoded = NULL;
    const char *refusal = method->prepare(table, arena);
    if (refusal == NULL) return method;
    report(method->name, refusal);
  }
}
