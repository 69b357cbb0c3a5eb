/* Register sequences of drivers that this project did not write, in this program's own words: each
 * is one that a model easily gets wrong. One line on UART0 for each: its name and "ok", or what was
 * seen. The sources named are those of Linux 6.1 and of U-Boot. The last sequence resets the chip.
 */
#include <stdint.h>

#include "sw/firmware/boot/boot.h"
#include "sw/firmware/drivers/psc.h"
#include "sw/firmware/drivers/uart.h"
#include "sw/firmware/mmio.h"
#include "sw/firmware/regs.h"

volatile uint32_t aborts; /* data aborts so far */

static void verdict(const char *name, int good, uint32_t seen) {
  uart_puts(name);
  if (good) {
    uart_puts(": ok\n");
  } else {
    uart_puts(": ");
    uart_put_hex(seen);
    uart_puts("\n");
  }
}

/* A read that may fail: its value in *value; 0 if it aborted. */
static int try_read(uint32_t address, uint32_t *value) {
  const uint32_t before = aborts;
  const uint32_t got = mmio_read32(address);
  __asm__ volatile("" : : "r"(got) : "memory");
  *value = got;
  return aborts == before;
}

static uint8_t read_byte(uint32_t address) { return *(volatile uint8_t *)address; }
static void write_byte(uint32_t address, uint8_t value) { *(volatile uint8_t *)address = value; }

/* --- drivers/i2c/busses/i2c-davinci.c: i2c_davinci_xfer_msg and its handler ------------------ */

#define DECODER 0x5Du
#define OUTPUT_FORMATTER5 0x37u
#define IRQ_I2C 39u
#define ICIVR 0x01C21028u
enum { VECTOR_NACK = 2, VECTOR_ARDY = 3, VECTOR_XRDY = 5, VECTOR_SCD = 6 };

static const uint8_t *volatile to_send;
static volatile uint32_t left_to_send, transfer_ended;

void irq_handler(void) {
  for (uint32_t rounds = 0; rounds < 10; ++rounds) {
    const uint32_t vector = mmio_read32(ICIVR);
    if (vector == 0) break;
    if (vector == VECTOR_XRDY) {
      if (left_to_send != 0) {
        mmio_write32(I2C_ICDXR, *to_send++);
        --left_to_send;
      } else {
        mmio_modify32(I2C_ICIMR, ICSTR_ICXRDY, 0);
      }
    } else if (vector == VECTOR_SCD || vector == VECTOR_NACK) {
      transfer_ended = vector;
    }
  }
  mmio_write32(AINTC_IRQ1, 1u << (IRQ_I2C - 32u));
}

static void wait_for_end(void) {
  for (uint32_t n = 0; n < 200000u && transfer_ended == 0; ++n) {
  }
}

static void write_as_linux(const uint8_t *bytes, uint32_t count) {
  to_send = bytes;
  left_to_send = count;
  transfer_ended = 0;
  mmio_write32(I2C_ICSAR, DECODER);
  mmio_write32(I2C_ICCNT, count);
  uint32_t mode = ICMDR_FREE | ICMDR_IRS | ICMDR_MST | ICMDR_TRX;
  mmio_modify32(I2C_ICIMR, 0, ICSTR_ICXRDY);
  mmio_write32(I2C_ICMDR, mode);
  if (left_to_send != 0) {
    mmio_write32(I2C_ICDXR, *to_send++);
    --left_to_send;
    mode |= ICMDR_STT | ICMDR_STP;
    mmio_write32(I2C_ICMDR, mode);
  }
  wait_for_end();
}

/* The pointer without STOP, then one byte: polled. 0x100: nothing came. */
static uint32_t read_decoder(uint8_t sub_address) {
  mmio_write32(I2C_ICIMR, 0);
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

static void i2c_write_of_two_bytes(void) {
  mmio_write32(I2C_ICMDR, 0);
  mmio_write32(I2C_ICPSC, 2);
  mmio_write32(I2C_ICCLKL, 35);
  mmio_write32(I2C_ICCLKH, 35);
  mmio_write32(I2C_ICMDR, ICMDR_IRS);
  mmio_write32(I2C_ICIMR, ICSTR_AL | ICSTR_NACK | ICSTR_ARDY | ICSTR_SCD);
  mmio_write32(AINTC_EINT1, 1u << (IRQ_I2C - 32u));
  __asm__ volatile("msr cpsr_c, #0x53" : : : "memory"); /* interrupts on */
  static const uint8_t bytes[2] = {OUTPUT_FORMATTER5, 0xA5};
  write_as_linux(bytes, 2);
  __asm__ volatile("msr cpsr_c, #0xD3" : : : "memory");
  mmio_write32(AINTC_EINT1, 0);
  const uint32_t got = read_decoder(OUTPUT_FORMATTER5);
  verdict("i2c write of two bytes", transfer_ended == VECTOR_SCD && got == 0xA5u,
          transfer_ended << 16 | got);
}

/* --- drivers/clk/clk-gate.c on PREDIV, as clk/davinci/pll.c registers it --------------------- */

static uint32_t ticks_of_a_loop(void) {
  const uint32_t from = mmio_read32(TIMER0_TIM34);
  for (uint32_t n = 0; n < 2000u; ++n) __asm__ volatile("nop");
  return mmio_read32(TIMER0_TIM34) - from;
}

static void prediv_written_back(void) {
  mmio_write32(TIMER0_TCR, 0);
  mmio_write32(TIMER0_TGCR, 6); /* upper half alone, out of reset */
  mmio_write32(TIMER0_PRD34, 0xFFFFFFFFu);
  mmio_write32(TIMER0_TCR, 2u << 22);
  const uint32_t before = ticks_of_a_loop();
  mmio_modify32(PLLC1 + PLLC_PREDIV, 0, PLL_DIV_ENABLE);
  mmio_modify32(PLLC2 + PLLC_PREDIV, 0, PLL_DIV_ENABLE);
  const uint32_t after = ticks_of_a_loop();
  const uint32_t locked =
      mmio_read32(SYS_PLL0_CONFIG) & mmio_read32(SYS_PLL1_CONFIG) & PLL_CONFIG_LOCK;
  const uint32_t difference = after > before ? after - before : before - after;
  verdict("prediv written back", locked == PLL_CONFIG_LOCK && difference <= 1u,
          locked | before << 12 | after);
}

/* --- U-Boot board/davinci/common/misc.c, common/memsize.c: get_ram_size ---------------------- */

#define SDRAM 0x80000000u

static uint32_t sized_by_wrap(uint32_t most) {
  volatile uint32_t *const base = (volatile uint32_t *)SDRAM;
  for (uint32_t words = most / 8u; words != 0; words >>= 1) base[words] = ~words;
  base[0] = 0;
  for (uint32_t words = 1; words < most / 4u; words <<= 1)
    if (base[words] != ~words) return words * 4u;
  return most;
}

static void memory_size(void) {
  const uint32_t before = aborts;
  const uint32_t size = sized_by_wrap(256u << 20);
  verdict("memory size", size == 128u << 20 && aborts == before, size | (aborts - before));
}

/* --- a page of a Linux program at virtual 0x10000, and internal RAM at another address ------- */

#define PAGE_TABLE (SDRAM + 0x4000u)
#define SECOND_LEVEL (SDRAM + 0x8000u)
#define USER_PAGE (SDRAM + 0x100000u)
#define RAM_SECTION 0x00300000u /* a virtual megabyte that shows the first physical one */
#define SECTION 0xC12u          /* any access, domain 0, uncached */
#define PAGE 0xFF2u             /* small page, any access, uncached */

static void user_page(void) {
  volatile uint32_t *const table = (volatile uint32_t *)PAGE_TABLE;
  volatile uint32_t *const pages = (volatile uint32_t *)SECOND_LEVEL;
  for (uint32_t n = 0; n < 4096u; ++n) table[n] = n << 20 | SECTION;
  for (uint32_t n = 0; n < 256u; ++n) pages[n] = n << 12 | PAGE;
  pages[0x10] = USER_PAGE | PAGE;
  table[0] = SECOND_LEVEL | 0x11u;
  table[RAM_SECTION >> 20] = SECTION;
  volatile uint32_t *const page = (volatile uint32_t *)USER_PAGE;
  page[0] = 0x600DF00Du;
  page[4] = 0xE3A0002Au; /* mov r0, #42 */
  page[5] = 0xE12FFF1Eu; /* bx lr */
  const uint32_t vector = *(volatile uint32_t *)4;
  __asm__ volatile(
      "mcr p15, 0, %0, c2, c0, 0\n\tmcr p15, 0, %1, c3, c0, 0\n\tmcr p15, 0, %2, c8, c7, 0\n\t"
      "mrc p15, 0, r12, c1, c0, 0\n\torr r12, r12, #1\n\tmcr p15, 0, r12, c1, c0, 0\n\tnop\n\tnop"
      :
      : "r"(PAGE_TABLE), "r"(1), "r"(0)
      : "r12", "memory");
  const uint32_t loaded = *(volatile uint32_t *)0x10000;
  const uint32_t ram = *(volatile uint32_t *)(RAM_SECTION + 4u);
  const uint32_t called = loaded == 0x600DF00Du ? ((uint32_t(*)(void))0x10010)() : 0;
  __asm__ volatile(
      "mrc p15, 0, r12, c1, c0, 0\n\tbic r12, r12, #1\n\tmcr p15, 0, r12, c1, c0, 0\n\tnop\n\tnop"
      :
      :
      : "r12", "memory");
  verdict("user page at 0x10000", called == 42u, loaded);
  verdict("internal RAM elsewhere", ram == vector, ram);
}

/* --- what is not there: drivers/dma/ti/edma.c reads CCCFG first; mach-davinci/board-dm365-evm.c
 * the CPLD's switches before anything else, then sets MUX and RESETS ------------------------------
 */

#define EDMA_CCCFG 0x01C00004u
#define EDMA_QUEPRI 0x01C00284u
#define EMAC_TXIDVER 0x01D07000u
#define CPLD 0x04000000u

static void absent_blocks(void) {
  uint32_t value;
  psc_transition(0, PSC_ENABLE); /* EDMA */
  verdict("edma CCCFG reads", try_read(EDMA_CCCFG, &value) && value == 0x00234445u, value);
  verdict("edma QUEPRI reads", try_read(EDMA_QUEPRI, &value) && value == 0x7777u, value);
  verdict("emac aborts", !try_read(EMAC_TXIDVER, &value), value);
}

static void evm_cpld(void) {
  const uint32_t before = aborts;
  const uint32_t switches = read_byte(CPLD + 0x400u);
  write_byte(CPLD + 0x18u, 0x85); /* key pad, TVP5146 */
  write_byte(CPLD + 0x1018u, 0x04);
  write_byte(CPLD + 0x10u, 0x7E);
  const int kept = read_byte(CPLD + 0x18u) == 0x85 && read_byte(CPLD + 0x1018u) == 0x04 &&
                   read_byte(CPLD + 0x10u) == 0x7E;
  verdict("cpld", switches == 0x20u && read_byte(CPLD + 0x418u) == 0x11 && kept && aborts == before,
          switches | (aborts - before) << 16);
}

/* --- drivers/watchdog/davinci_wdt.c: davinci_wdt_restart ---------------------------------------
 */

#define WDT 0x01C21C00u

__attribute__((noinline)) static void restart_as_linux(void) {
  mmio_write32(WDT + 0x20u, 0);    /* TCR: off */
  mmio_write32(WDT + 0x24u, 0x8u); /* TGCR: watchdog, in reset */
  mmio_write32(WDT + 0x24u, 0xBu); /* out of reset */
  mmio_write32(WDT + 0x10u, 0);
  mmio_write32(WDT + 0x14u, 0);
  mmio_write32(WDT + 0x18u, 0);
  mmio_write32(WDT + 0x1Cu, 0);
  mmio_write32(WDT + 0x28u, 0xA5C64000u); /* pre-active */
  mmio_write32(WDT + 0x28u, 0xDA7E4000u); /* active */
  mmio_write32(WDT + 0x28u, 0x00004000u); /* a wrong key: reset at once */
}

int main(void) {
  i2c_write_of_two_bytes();
  prediv_written_back();
  absent_blocks();
  evm_cpld();
  memory_size();
  user_page();
  uart_puts("restarting\n");
  uart_drain();
  restart_as_linux();
  uart_puts("still here\n");
  return 0;
}
