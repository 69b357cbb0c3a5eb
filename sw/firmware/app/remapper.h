/* Chooses the remap method of a view. */
#ifndef FOVEA_FIRMWARE_REMAPPER_H
#define FOVEA_FIRMWARE_REMAPPER_H

#include "../kernels/method.h"

/** Prepares `table` (size, pitch and lut are set) for the method of `kernel` (enum param_kernel), or, if
 * the lens does not allow that, for the next one of the list in remapper.c, which ends with a method that
 * fits every lens. KERNEL_FASTEST begins at the head of the list. Each refusal is a line on the UART.
 * @return the method that was prepared */
const remap_method_t *remapper_prepare(uint32_t kernel, remap_table_t *table, arena_t *arena);

#endif
