/* UART0 with polling, 8N1. */
#ifndef FOVEA_FIRMWARE_UART_H
#define FOVEA_FIRMWARE_UART_H

#include <stdint.h>

/** Divisor of 115200 Bd: 24 MHz / 16 / 13 = 115385 Bd. */
#define UART_DIVISOR_115200 13u

/** @param divisor of 24 MHz / 16 */
void uart_init(uint32_t divisor);
void uart_putc(char c);
/** Sends a string; "\n" is sent as CR LF. */
void uart_puts(const char *text);
void uart_put_hex(uint32_t value);
void uart_put_uint(uint32_t value);
/** Waits until the last stop bit was sent. */
void uart_drain(void);

#endif
