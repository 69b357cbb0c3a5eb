/* First stage of the boot: everything that has to be done before DDR2 may be accessed. */
#ifndef FOVEA_FIRMWARE_BOOT_H
#define FOVEA_FIRMWARE_BOOT_H

#include <stdint.h>

#include "model/contract/param_page.h"

/** Runs in internal RAM. Masks interrupts, enables modules and UART0, checks the parameter page, starts PLLs and
 * DDR2 as the page says. A page that is not right is refused with a sentence on the UART and PHASE_FAILED, before any
 * clock was changed; DDR2 must not be touched then, and the caller stops. */
param_page_result_t boot_init(const param_page_t *page);

/** Sleeps for ever with interrupts masked. */
void stop(void) __attribute__((noreturn));

#endif
