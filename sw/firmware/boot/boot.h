/* First stage of the boot: everything that has to be done before DDR2 may be accessed. */
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

/** Runs in internal RAM. Masks interrupts, enables modules and UART0, reads the switches, starts
 * PLLs and DDR2. */
void boot_init(void);

/** The preset selected by the switches; unused codes mean 297/243. */
enum clock_preset boot_clock_preset(uint32_t dip);

/** Value of VPSS_CLK_CTRL: selects the PLL that provides the encoder's 27 MHz with this preset. */
uint32_t boot_vpss_clk_ctrl(enum clock_preset preset);

/** Prints the cause and stops; called by the exception entries. */
void fatal_exception(uint32_t kind, uint32_t pc) __attribute__((noreturn));

/** Sleeps for ever with interrupts masked. */
void stop(void) __attribute__((noreturn));

#endif
