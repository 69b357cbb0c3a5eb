#include "uart_queue.h"

#include "../mmio.h"
#include "../regs.h"
#include "cp15.h"
#include "intc.h"
#include "uart.h"

#define FIFO_BYTES 16u
#define IER_RECEIVED 1u
#define IER_EMPTY 2u
#define IIR_NONE 1u
#define LSR_DR 1u
#define LSR_OE 2u /* the receiver had no room; reading clears it */

static struct {
  char send[UART_QUEUE_SEND], receive[UART_QUEUE_RECEIVE];
  uint32_t send_first, send_count, receive_first, receive_count;
  int lost;    /* a received character found no room */
  int running;
} queue;

void uart_queue_start(void) {
  queue.running = 1;
  intc_enable(IRQ_UART0, 5);
  mmio_write32(UART0_IER, IER_RECEIVED);
}

static void refill(void) {
  if ((mmio_read32(UART0_LSR) & LSR_THRE) != 0)
    for (unsigned n = 0; n < FIFO_BYTES && queue.send_count != 0; ++n) {
      mmio_write32(UART0_THR, (uint8_t)queue.send[queue.send_first]);
      queue.send_first = (queue.send_first + 1u) % UART_QUEUE_SEND;
      --queue.send_count;
    }
  mmio_write32(UART0_IER, queue.send_count != 0 ? IER_RECEIVED | IER_EMPTY : IER_RECEIVED);
}

static void take_received(void) {
  for (;;) {
    const uint32_t status = mmio_read32(UART0_LSR);
    if ((status & LSR_OE) != 0) queue.lost = 1;
    if ((status & LSR_DR) == 0) return;
    char c = (char)mmio_read32(UART0_RBR_THR);
    if (queue.receive_count == UART_QUEUE_RECEIVE) {
      queue.lost = 1;
      continue;
    }
    if (queue.lost) c = '?';
    queue.lost = 0;
    queue.receive[(queue.receive_first + queue.receive_count++) % UART_QUEUE_RECEIVE] = c;
  }
}

/* The controller latches edges of the UART's level, so nothing may be left pending. */
void uart_queue_interrupt(void) {
  while ((mmio_read32(UART0_IIR_FCR) & IIR_NONE) == 0) {
    take_received();
    refill();
  }
}

static void put(char c) {
  for (;;) {
    const uint32_t cpsr = irq_mask();
    if (queue.send_count < UART_QUEUE_SEND) {
      queue.send[(queue.send_first + queue.send_count++) % UART_QUEUE_SEND] = c;
      if (queue.send_count == 1u) mmio_write32(UART0_IER, IER_RECEIVED | IER_EMPTY);
      irq_restore(cpsr);
      return;
    }
    irq_restore(cpsr);
    wait_for_interrupt();
  }
}

void uart_queue_puts(const char *text) {
  if (!queue.running) {
    uart_puts(text);
    return;
  }
  for (; *text != '\0'; ++text) {
    if (*text == '\n') put('\r');
    put(*text);
  }
}

void uart_queue_put_uint(uint32_t value) {
  char digits[11];
  unsigned at = sizeof digits - 1u;
  digits[at] = '\0';
  do digits[--at] = (char)('0' + value % 10u);
  while ((value /= 10u) != 0);
  uart_queue_puts(&digits[at]);
}

void uart_queue_put_int(int32_t value) {
  if (value < 0) uart_queue_puts("-");
  uart_queue_put_uint(value < 0 ? 0u - (uint32_t)value : (uint32_t)value);
}

uint32_t uart_queue_room(void) {
  const uint32_t cpsr = irq_mask();
  const uint32_t room = UART_QUEUE_SEND - queue.send_count;
  irq_restore(cpsr);
  return room;
}

int uart_queue_read(char *c) {
  const uint32_t cpsr = irq_mask();
  const int is_one = queue.receive_count != 0;
  if (is_one) {
    *c = queue.receive[queue.receive_first];
    queue.receive_first = (queue.receive_first + 1u) % UART_QUEUE_RECEIVE;
    --queue.receive_count;
  }
  irq_restore(cpsr);
  return is_one;
}

void uart_queue_stop(void) {
  const uint32_t cpsr = irq_mask();
  if (queue.running) mmio_write32(UART0_IER, 0);
  queue.running = 0;
  for (; queue.send_count != 0; --queue.send_count) {
    uart_putc(queue.send[queue.send_first]);
    queue.send_first = (queue.send_first + 1u) % UART_QUEUE_SEND;
  }
  irq_restore(cpsr);
}
