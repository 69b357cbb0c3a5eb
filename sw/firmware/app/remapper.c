#include "remapper.h"

#include "../drivers/uart.h"
#include "model/contract/param_page.h"

/* Indexed by enum param_kernel; a null pointer: this firmware does not have it. */
static const remap_method_t *const kMethods[] = {
    [KERNEL_PLAIN] = &method_plain,
    [KERNEL_LDM] = &method_ldm,
    [KERNEL_STAGED] = &method_staged,
};

enum { kMethodCount = sizeof kMethods / sizeof *kMethods };

const remap_method_t *remapper_prepare(uint32_t kernel, remap_table_t *table, arena_t *arena) {
  const remap_method_t *method = kernel < kMethodCount ? kMethods[kernel] : NULL;
  const char *refusal = method != NULL ? method->prepare(table, arena) : "not in this firmware";
  if (refusal == NULL) return method;
  uart_puts("kernel ");
  uart_puts(method != NULL ? method->name : "of the page");
  uart_puts(": ");
  uart_puts(refusal);
  uart_puts("\n");
  table->encoded = NULL;
  (void)method_ldm.prepare(table, arena);
  return &method_ldm;
}
