/* UART0 by interrupts: what is to be sent waits in a queue, so that a message does not stop the program for its time
 * on the line, and what is received is kept until it is read. */
#ifndef FOVEA_FIRMWARE_UART_QUEUE_H
#define FOVEA_FIRMWARE_UART_QUEUE_H

#include <stdint.h>

#define UART_QUEUE_SEND 4096u
#define UART_QUEUE_RECEIVE 256u

/** Enables the interrupt. Before that, text is sent by polling. uart_init() must have been called. */
void uart_queue_start(void);

/** Sends a string; "\n" is sent as CR LF. Waits while there is no room. Not with interrupts masked. */
void uart_queue_puts(const char *text);
void uart_queue_put_uint(uint32_t value);
void uart_queue_put_int(int32_t value);

/** Bytes that can be sent without waiting. */
uint32_t uart_queue_room(void);

/** The oldest received character that was not read yet. @return 0 if there is none */
int uart_queue_read(char *c);

/** The interrupt handler. What is received and finds no room is lost, and the next read line is said to be damaged by
 * a '?' in its place. */
void uart_queue_interrupt(void);

/** Sends by polling what waits, and goes back to polling: for a program that is about to stop. */
void uart_queue_stop(void);

#endif
