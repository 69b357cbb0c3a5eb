#include "boot.h"

#include "../drivers/gpio.h"
#include "../drivers/psc.h"
#include "../drivers/uart.h"
#include "../mmio.h"
#include "../regs.h"

#ifdef BOOT_QUIET /* for a loader whose program uses the UART alone */
#define uart_puts(text) ((void)(text))
#define uart_put_uint(value) ((void)(value))
#define uart_drain() ((void)0)
#endif

/* ARM clock from PLL2 SYSCLK2, DDR clock from PLL1 SYSCLK7. */
#define PERI_CLK_CTRL_VALUE 0x243F04FCu

static void wait_loop(uint32_t count) {
  while (count-- != 0) __asm__ volatile("nop");
}

/* The order of writes is that of TI's boot loader for the DM36x. */
static void pll_init(uint32_t base, uint32_t lock_register, const param_pll_t *setting,
                     uint32_t divider_count) {
  const uint32_t pllctl = base + PLLC_PLLCTL;
  mmio_modify32(pllctl, PLLCTL_PLLPWRDN, 0);
  mmio_modify32(pllctl, PLLCTL_CLKMODE, 0);
  mmio_modify32(pllctl, PLLCTL_PLLENSRC, 0);
  mmio_modify32(pllctl, PLLCTL_PLLEN, 0);
  wait_loop(150);
  mmio_modify32(pllctl, 0, PLLCTL_PLLRST);
  wait_loop(300);
  mmio_modify32(pllctl, PLLCTL_PLLRST, 0);

  mmio_write32(base + PLLC_PLLM, setting->multiplier);
  mmio_write32(base + PLLC_PREDIV, PLL_DIV_ENABLE | setting->pre_divider);
  /* Initialisation sequence of TENABLE, TENABLEDIV and TINITZ as in TI's boot loader. */
  mmio_write32(base + PLLC_SECCTL, 0x00470000u);
  mmio_write32(base + PLLC_SECCTL, 0x00460000u);
  mmio_write32(base + PLLC_SECCTL, 0x00400000u);
  mmio_write32(base + PLLC_SECCTL, 0x00410000u);
  mmio_write32(base + PLLC_POSTDIV, PLL_DIV_ENABLE | setting->post_divider);
  for (uint32_t n = 1; n <= divider_count; ++n)
    mmio_write32(base + PLLC_PLLDIV(n), PLL_DIV_ENABLE | setting->dividers[n - 1]);
  wait_loop(300);
  mmio_write32(base + PLLC_PLLCMD, PLLCMD_GOSET);
  wait_loop(300);
  while ((mmio_read32(base + PLLC_PLLSTAT) & PLLSTAT_GOSTAT) != 0) {
  }
  while ((mmio_read32(lock_register) & PLL_CONFIG_LOCK) != PLL_CONFIG_LOCK) {
  }
  mmio_modify32(pllctl, 0, PLLCTL_PLLEN);
}

static void ddr_init(const param_clocks_t *clocks) {
  psc_transition(LPSC_DDR, PSC_ENABLE);
  mmio_modify32(SYS_VTPIOCR, VTPIOCR_IOPWRDN | VTPIOCR_CLRZ | VTPIOCR_LOCK | VTPIOCR_PWRDN, 0);
  mmio_modify32(SYS_VTPIOCR, 0, VTPIOCR_CLRZ);
  while ((mmio_read32(SYS_VTPIOCR) & VTPIOCR_READY) == 0) {
  }
  mmio_modify32(SYS_VTPIOCR, 0, VTPIOCR_LOCK);
  mmio_modify32(SYS_VTPIOCR, 0, VTPIOCR_IOPWRDN | VTPIOCR_PWRDN);
  wait_loop(150);
  psc_transition(LPSC_DDR, PSC_SYNC_RESET);
  psc_transition(LPSC_DDR, PSC_ENABLE);

  mmio_write32(DDR_DDRPHYCR, 0xC5u);
  mmio_write32(DDR_SDBCR, 0x00534832u);
  mmio_write32(DDR_SDBCR, 0x0053C832u); /* TIMUNLOCK */
  mmio_write32(DDR_SDTIMR, clocks->sdtimr);
  mmio_write32(DDR_SDTIMR2, clocks->sdtimr2);
  mmio_write32(DDR_SDBCR, 0x00534832u);
  mmio_write32(DDR_PBBPR, 0xFEu);
  mmio_write32(DDR_SDBCR, 0x00D34A32u); /* BOOTUNLOCK, CL 5 */
  mmio_write32(DDR_SDBCR, 0x00534A32u);
  mmio_write32(DDR_SDRCR, clocks->sdrcr);
  psc_transition(LPSC_DDR, PSC_SYNC_RESET);
  psc_transition(LPSC_DDR, PSC_ENABLE);
}

param_page_result_t boot_init(const param_page_t *page) {
  mmio_write32(AINTC_INTCTL, 4);
  mmio_write32(AINTC_EABASE, 0);
  mmio_write32(AINTC_EINT0, 0);
  mmio_write32(AINTC_EINT1, 0);
  mmio_write32(AINTC_FIQ0, 0xFFFFFFFFu);
  mmio_write32(AINTC_FIQ1, 0xFFFFFFFFu);
  mmio_write32(AINTC_IRQ0, 0xFFFFFFFFu);
  mmio_write32(AINTC_IRQ1, 0xFFFFFFFFu);

  psc_transition(LPSC_GPIO, PSC_ENABLE);
  psc_transition(LPSC_UART0, PSC_ENABLE);
  psc_transition(LPSC_TIMER0, PSC_ENABLE);
  psc_transition(LPSC_I2C, PSC_ENABLE);
  psc_transition(LPSC_VPSSMSTR, PSC_ENABLE);

  /* Pin functions as in TI's boot loader: video input, video output, UART0 and I2C. */
  mmio_write32(SYS_PINMUX(0), 0x00FD0000u);
  mmio_write32(SYS_PINMUX(1), 0x00145555u);
  mmio_write32(SYS_PINMUX(3), 0x01580000u);

  phase_pins_init();
  phase_mark(PHASE_BOOT, 0);
  const param_page_result_t result = param_page_check(page);
  uart_init(result == PARAM_PAGE_OK ? page->console.divisor : UART_DIVISOR_115200);
  if (result != PARAM_PAGE_OK) {
    phase_mark(PHASE_FAILED, 0);
    uart_puts("failed: parameter page: ");
    uart_puts(param_page_text(result));
    uart_puts("\n");
    uart_drain();
    return result;
  }
  const param_clocks_t *clocks = &page->clocks;
  uart_puts("boot: clocks ");
  uart_put_uint(clocks->core_khz);
  uart_puts("/");
  uart_put_uint(clocks->ddr_khz);
  uart_puts(" kHz\n");
  uart_drain();

  pll_init(PLLC1, SYS_PLL0_CONFIG, &clocks->pll1, 9);
  pll_init(PLLC2, SYS_PLL1_CONFIG, &clocks->pll2, 5);
  wait_loop(4100);
  mmio_write32(SYS_PERI_CLK_CTRL, PERI_CLK_CTRL_VALUE);
  ddr_init(clocks);
  uart_puts("boot: DDR2 up\n");
  return PARAM_PAGE_OK;
}
