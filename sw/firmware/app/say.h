/* Messages of the files that are in several programs: in those for several cameras they wait in a queue. Include after
 * uart.h. */
#ifndef FOVEA_FIRMWARE_SAY_H
#define FOVEA_FIRMWARE_SAY_H

#ifdef TIME_DIVISION
#include "../drivers/uart_queue.h"
#define uart_puts(text) uart_queue_puts(text)
#define uart_put_uint(value) uart_queue_put_uint(value)
#endif

#endif
