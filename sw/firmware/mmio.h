/* The only access to device registers. In host tests, the test defines these two functions as a
 * recorder, so that drivers can be checked access by access. */
#ifndef FOVEA_FIRMWARE_MMIO_H
#define FOVEA_FIRMWARE_MMIO_H

#include <stdint.h>

#ifdef FOVEA_HOST_TEST
#ifdef __cplusplus
extern "C" {
#endif
uint32_t mmio_read32(uint32_t address);
void mmio_write32(uint32_t address, uint32_t value);
#ifdef __cplusplus
}
#endif
#else
static inline uint32_t mmio_read32(uint32_t address) { return *(volatile uint32_t *)address; }

static inline void mmio_write32(uint32_t address, uint32_t value) {
  *(volatile uint32_t *)address = value;
}
#endif

static inline void mmio_modify32(uint32_t address, uint32_t clear, uint32_t set) {
  mmio_write32(address, (mmio_read32(address) & ~clear) | set);
}

#endif
