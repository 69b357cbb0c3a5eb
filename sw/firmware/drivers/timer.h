/* TIMER0 at 24 MHz (AUXCLK). TIM12 is a free-running 32-bit counter, which wraps after 179 s; TIM34
 * is used for alarms. */
#ifndef FOVEA_FIRMWARE_TIMER_H
#define FOVEA_FIRMWARE_TIMER_H

#include <stdint.h>

#define TIMER_TICKS_PER_MS 24000u

void timer_start(void);
uint32_t timer_ticks(void);

/** Requests one interrupt of TIM34 in `ticks` (not 0) from now. */
void timer_alarm(uint32_t ticks);

#endif
