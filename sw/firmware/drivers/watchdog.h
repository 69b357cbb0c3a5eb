/* The watchdog: TIMER2, counting 24 MHz (AUXCLK). Once started it cannot be stopped; a reset of the chip stops it. The
 * order of accesses is that of the public Linux driver (davinci_wdt.c). */
#ifndef FOVEA_FIRMWARE_WATCHDOG_H
#define FOVEA_FIRMWARE_WATCHDOG_H

#include <stdint.h>

#define WATCHDOG_TICKS_PER_US 24u

/** The chip is reset unless watchdog_serve() is called within each `microseconds` (not 0) from now on. */
void watchdog_start(uint32_t microseconds);

/** Starts the period anew. With interrupts masked, if a handler or what it calls serves the watchdog too: of the two
 * keys, one must follow the other. */
void watchdog_serve(void);

/** Whether the chip starts after a reset by the watchdog, or by TIMER2's pin, which looks the same. */
int watchdog_has_reset(void);

#endif
