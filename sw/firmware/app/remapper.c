#include "remapper.h"

#include "../drivers/uart.h"
#include "model/contract/param_page.h"
#include "say.h"

/* For each kernel of the page its method and the kernel to try if the lens or the chip does not allow it. */
typedef struct choice {
  const remap_method_t *method; /* a null pointer: not in this firmware, or no method at all */
  uint8_t otherwise;            /* enum param_kernel */
} choice_t;

static const choice_t kChoices[] = {
    [KERNEL_PLAIN] = {&method_plain, KERNEL_PLAIN_OTHERWISE},
    [KERNEL_LDM] = {&method_ldm, KERNEL_LDM_OTHERWISE},
    [KERNEL_STRIPS] = {&method_strips, KERNEL_STRIPS_OTHERWISE},
    [KERNEL_OFFSETS] = {&method_offsets, KERNEL_OFFSETS_OTHERWISE},
    [KERNEL_DELTAS] = {&method_deltas, KERNEL_DELTAS_OTHERWISE},
    [KERNEL_CODES] = {&method_codes, KERNEL_CODES_OTHERWISE},
    [KERNEL_STAGED] = {&method_staged, KERNEL_STAGED_OTHERWISE},
    [KERNEL_GATHER] = {&method_gather, KERNEL_GATHER_OTHERWISE},
    [KERNEL_RUNS] = {&method_runs, KERNEL_RUNS_OTHERWISE},
    [KERNEL_COPY] = {&method_copy, KERNEL_COPY_OTHERWISE},
    [KERNEL_FASTEST] = {NULL, KERNEL_FASTEST_OTHERWISE},
    [KERNEL_ENGINE] = {&method_engine, KERNEL_ENGINE_OTHERWISE},
    [KERNEL_ENGINE_GRID] = {&method_engine_grid, KERNEL_ENGINE_GRID_OTHERWISE},
    [KERNEL_ENGINE_RADIAL] = {&method_engine_radial, KERNEL_ENGINE_RADIAL_OTHERWISE},
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
