#include "remapper.h"

#include "../drivers/uart.h"
#include "model/contract/param_page.h"
#include "say.h"

/* For each kernel of the page its method and the kernel to try if the lens or the chip does not allow it. */
typedef struct choice {
  const remap_method_t *method; /* a null pointer: not in this firmware, or no method at all */
  uint8_t otherwise;            /* enum param_kernel */
} choice_t;

#define CHOICE(kernel, code, word, mover, otherwise, views) \
  [kernel] = {(mover) == PARAM_BY_ANOTHER ? NULL : &method_##kernel, otherwise},
static const choice_t kChoices[] = {PARAM_KERNELS(CHOICE)};

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
