/* First stage: what a boot loader does before DDR2 may be touched. */
#ifndef FOVEA_FIRMWARE_BOOT_H
#define FOVEA_FIRMWARE_BOOT_H

#include <stdint.h>

/** Clock presets in the order of DIP switches 12 to 14. */
enum clock_preset {
  CLOCK_297_243,
  CLOCK_297_270,
  CLOCK_270_216,
  CLOCK_216_172,
  CLOCK_432_340,
  CLOCK_PRESET_COUNT
};

/** Runs in internal RAM: interrupts masked, modules enabled, UART0, switches, PLLs, DDR2. */
void boot_init(void);

/** Preset that the switches select; an unused code means 297/243. */
enum clock_preset boot_clock_preset(uint32_t dip);

/** Word for VPSS_CLK_CTRL: which PLL gives the encoder's 27 MHz in this preset. */
uint32_t boot_vpss_clk_ctrl(enum clock_preset preset);

/** Prints the cause and stops; called by the exception entries. */
void fatal_exception(uint32_t kind, uint32_t pc) __attribute__((noreturn));

/** Sleeps for good with interrupts masked. */
void stop(void) __attribute__((noreturn));

#endif
