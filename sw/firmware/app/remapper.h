/* Chooses the remap method of a view. */
#ifndef FOVEA_FIRMWARE_REMAPPER_H
#define FOVEA_FIRMWARE_REMAPPER_H

#include "../kernels/method.h"

/** Prepares `table` (size, pitch and lut are set) for the method of `kernel` (enum param_kernel), or, if lens or chip
 * do not allow that, for the one that its row of PARAM_KERNELS names in its place, and so on; the last one of a chain
 * fits every lens. Each refusal is a line on the UART.
 * @return the method that was prepared */
const remap_method_t *remapper_prepare(uint32_t kernel, remap_table_t *table, arena_t *arena);

#endif
