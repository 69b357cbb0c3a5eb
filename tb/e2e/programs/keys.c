/* Shows what the board's keys change that the camera's firmware never looks at: each line on UART0 is a name
 * and what was read. It starts in internal RAM by foreign_start.S.
 */
#include <stdint.h>

#include "sw/firmware/boot/boot.h"
#include "sw/firmware/drivers/psc.h"
#include "sw/firmware/drivers/uart.h"
#include "sw/firmware/mmio.h"
#include "sw/firmware/regs.h"

volatile uint32_t aborts; /* data aborts so far */
void irq_handler(void) {}

static void show(const char *name, uint32_t value) {
  uart_puts(name);
  uart_puts(" ");
  uart_put_hex(value);
  uart_puts("\n");
}

static uint32_t read_byte(uint32_t address) {
  const uint32_t before = aborts;
  const uint32_t value = *(volatile uint8_t *)address;
  __asm__ volatile("" : : "r"(value) : "memory");
  return aborts == before ? value : 0xFFFFFFFFu;
}

/* A register of the TVP5146, polled. 0x100: no answer. */
static uint32_t read_decoder(uint8_t sub_address) {
  mmio_write32(I2C_ICMDR, 0);
  mmio_write32(I2C_ICPSC, 2);
  mmio_write32(I2C_ICCLKL, 35);
  mmio_write32(I2C_ICCLKH, 35);
  mmio_write32(I2C_ICMDR, ICMDR_IRS);
  mmio_write32(I2C_ICSAR, 0x5D);
  mmio_write32(I2C_ICSTR, ICSTR_SCD | ICSTR_ARDY | ICSTR_NACK);
  mmio_write32(I2C_ICCNT, 1);
  mmio_write32(I2C_ICDXR, sub_address);
  mmio_write32(I2C_ICMDR, ICMDR_IRS | ICMDR_MST | ICMDR_TRX | ICMDR_STT);
  for (uint32_t n = 0; (mmio_read32(I2C_ICSTR) & ICSTR_ARDY) == 0; ++n)
    if (n > 20000u) return 0x100u;
  mmio_write32(I2C_ICMDR, ICMDR_IRS | ICMDR_MST | ICMDR_STT | ICMDR_STP);
  for (uint32_t n = 0; (mmio_read32(I2C_ICSTR) & ICSTR_ICRRDY) == 0; ++n)
    if (n > 20000u) return 0x100u;
  return mmio_read32(I2C_ICDRR);
}

/* UART0's transmitter asks all the time: is it pending again once acknowledged? */
static uint32_t pending_after_acknowledge(void) {
  enum { kUart0 = 40 };
  const uint32_t bit = 1u << (kUart0 - 32);
  while ((mmio_read32(UART0_LSR) & 0x40u) == 0) { /* all is sent */
  }
  mmio_write32(UART0_IER, 2);
  mmio_write32(AINTC_IRQ1, bit);
  for (uint32_t n = 0; n < 1000u; ++n) __asm__ volatile("nop");
  const uint32_t pending = ~mmio_read32(AINTC_IRQ1) & bit; /* 0 means pending */
  mmio_write32(UART0_IER, 0);
  return pending;
}

/* A chain of eight requests of the EDMA in internal RAM, each triggered by the completion of the one before it:
 * how often can a register be read meanwhile? */
static uint32_t transfer(uint32_t tc, uint32_t option, uint32_t counts) {
  enum { kRam = 0x10000, kSet = 0x01C04000, kChain = 1 << 23, kAb = 1 << 2 };
  static const uint32_t kStatus = 0x01C10100u;
  const uint32_t words[8] = {kAb | kChain | option, kRam + 0x5004, counts,  kRam + 0x6000,
                             132u | 128u << 16,      0xFFFF,        0,       8};
  uint32_t polls = 0;
  mmio_write32(0x01C00240u, tc);
  for (uint32_t n = 0; n < 8u; ++n) mmio_write32(kSet + 4u * n, words[n]);
  mmio_write32(0x01C01010u, 1);
  while (mmio_read32(0x01C00640u) || mmio_read32(kStatus + 0x400u * tc)) ++polls;
  return polls;
}

int main(void) {
  show("RSTYPE", mmio_read32(0x01C40800u + 0xE4u));
  show("BOOTCFG", mmio_read32(0x01C40014u));
  psc_transition(0, PSC_ENABLE); /* the channel controller */
  show("QUEPRI", mmio_read32(0x01C00284u));
  psc_transition(1, PSC_ENABLE); /* transfer controllers 0 and 1 */
  psc_transition(2, PSC_ENABLE);
  show("EDMA polls, early completion", transfer(0, 1u << 11, 128u | 3u << 16));
  show("EDMA polls, short", transfer(1, 0, 16u | 1u << 16));
  show("CPLD", read_byte(0x04000000u));
  show("CPLD SWITCH", read_byte(0x04000400u));
  for (uint32_t n = 0; n < 8u; ++n) /* test and clean, as ARM DDI 0198 has it */
    __asm__ volatile("mrc p15, 0, r15, c7, c10, 3" : : : "cc", "memory");
  show("decoder 0x34", read_decoder(0x34));
  show("decoder 0x70", read_decoder(0x70));
  show("UART0 pending", pending_after_acknowledge());
  show("typed", mmio_read32(UART0_LSR) & 1u ? mmio_read32(UART0_THR) : 0x100u);
  uart_puts("finished\n");
  for (;;) {
  }
}
