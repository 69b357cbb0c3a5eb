/* TIMER0 counting up at 24 MHz (AUXCLK), 32 bit, wraps after 179 s. */
#ifndef FOVEA_FIRMWARE_TIMER_H
#define FOVEA_FIRMWARE_TIMER_H

#include <stdint.h>

#define TIMER_TICKS_PER_MS 24000u

void timer_start(void);
uint32_t timer_ticks(void);

#endif
