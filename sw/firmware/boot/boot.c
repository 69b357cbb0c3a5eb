#include "boot.h"

#include "../drivers/gpio.h"
#include "../drivers/psc.h"
#include "../drivers/uart.h"
#include "../mmio.h"
#include "../regs.h"

#ifdef BOOT_QUIET /* for a loader whose program uses the UART alone */
#define uart_puts(text) ((void)(text))
#define uart_drain() ((void)0)
#endif

/* PLL settings for a 24 MHz oscillator, as in TI's boot loader for the DM36x: output = 24 MHz * 2 *
 * PLLM / (PREDIV + 1). Each divider register holds n - 1. */
struct pll_setting {
  uint16_t pllm;
  uint8_t prediv;
  uint8_t div[9];
};

struct preset_setting {
  struct pll_setting pll1, pll2;
  uint32_t sdtimr, sdtimr2, sdrcr;
  uint32_t vpss_clk_ctrl;
  const char *name;
};

/* Clocks of a time given in 0.1 ns at f MHz, rounded up, minus 1: the encoding of SDTIMR. T_RRD is
 * a quarter of tFAW (50 ns) instead of tRRD (10 ns): the controller has no field for tFAW, and with
 * T_RRD >= tFAW / 4 any five activations are far enough apart. */
#define CYCLES_MINUS_1(t, f) (((t) * (f) + 9999u) / 10000u - 1u)
#define SDTIMR_AT(f)                                                                               \
  (CYCLES_MINUS_1(1275u, f) << 25 | CYCLES_MINUS_1(200u, f) << 22 |                                \
   CYCLES_MINUS_1(200u, f) << 19 | CYCLES_MINUS_1(150u, f) << 16 | CYCLES_MINUS_1(450u, f) << 11 | \
   CYCLES_MINUS_1(650u, f) << 6 | CYCLES_MINUS_1(125u, f) << 3 | CYCLES_MINUS_1(100u, f))
/* T_RASMAX is 70 us in refresh intervals of 7.8 us, minus 1 (TI's loader overflows this field);
 * T_XP 2, T_XSNR 137.5 ns, T_XSRD 199, T_RTP 7.5 ns, T_CKE 3. */
#define SDTIMR2_AT(f) \
  (7u << 27 | 2u << 25 | (1375u * (f) / 10000u) << 16 | 199u << 8 | (75u * (f) / 10000u) << 5 | 3u)
#define SDRCR_AT(f) (78u * (f) / 10u)
#define DDR_AT(f) SDTIMR_AT(f), SDTIMR2_AT(f), SDRCR_AT(f)

/* Encoder clock of 27 MHz: from PLL1 SYSCLK6 if that can be divided to it, otherwise from PLL2
 * SYSCLK5. */
#define VENC_FROM_PLL1 0x18u
#define VENC_FROM_PLL2 0x38u

static const struct preset_setting kPresets[CLOCK_PRESET_COUNT] = {
    [CLOCK_297_243] = {{0x51, 7, {0x13, 1, 1, 3, 1, 0x11, 0, 4, 1}},
                       {0x63, 7, {0x18, 1, 1, 0x1C, 7}},
                       DDR_AT(243u),
                       VENC_FROM_PLL1,
                       "297/243"},
    [CLOCK_297_270] = {{0x2D, 3, {0x2C, 1, 1, 3, 1, 0x13, 0, 5, 1}},
                       {0x63, 7, {0x18, 1, 1, 0x1C, 7}},
                       DDR_AT(270u),
                       VENC_FROM_PLL1,
                       "297/270"},
    [CLOCK_270_216] = {{0x09, 0, {0x11, 1, 1, 3, 1, 5, 0, 3, 1}},
                       {0x2D, 7, {0x0A, 0, 0, 5, 9}},
                       DDR_AT(216u),
                       VENC_FROM_PLL2,
                       "270/216"},
    [CLOCK_216_172] = {{0x73, 15, {0x0D, 1, 1, 3, 1, 0x0C, 0, 3, 1}},
                       {0x12, 1, {0x11, 1, 1, 0x14, 0x0F}},
                       /* 172.5 MHz: times are rounded up, the refresh interval is rounded down */
                       SDTIMR_AT(173u), SDTIMR2_AT(173u), SDRCR_AT(172u),
                       VENC_FROM_PLL2,
                       "216/172"},
    [CLOCK_432_340] = {{0x55, 5, {0x1B, 1, 1, 3, 1, 8, 0, 6, 0x1B}},
                       {0x09, 0, {0x11, 0, 1, 0x14, 0x0F}},
                       DDR_AT(340u),
                       VENC_FROM_PLL2,
                       "432/340"},
};

/* ARM clock from PLL2 SYSCLK2, DDR clock from PLL1 SYSCLK7. */
#define PERI_CLK_CTRL_VALUE 0x243F04FCu

static void wait_loop(uint32_t count) {
  while (count-- != 0) __asm__ volatile("nop");
}

static void pll_init(uint32_t base, uint32_t lock_register, const struct pll_setting *setting,
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

  mmio_write32(base + PLLC_PLLM, setting->pllm);
  mmio_write32(base + PLLC_PREDIV, PLL_DIV_ENABLE | setting->prediv);
  /* Initialisation sequence of TENABLE, TENABLEDIV and TINITZ as in TI's boot loader. */
  mmio_write32(base + PLLC_SECCTL, 0x00470000u);
  mmio_write32(base + PLLC_SECCTL, 0x00460000u);
  mmio_write32(base + PLLC_SECCTL, 0x00400000u);
  mmio_write32(base + PLLC_SECCTL, 0x00410000u);
  mmio_write32(base + PLLC_POSTDIV, PLL_DIV_ENABLE);
  for (uint32_t n = 1; n <= divider_count; ++n)
    mmio_write32(base + PLLC_PLLDIV(n), PLL_DIV_ENABLE | setting->div[n - 1]);
  wait_loop(300);
  mmio_write32(base + PLLC_PLLCMD, PLLCMD_GOSET);
  wait_loop(300);
  while ((mmio_read32(base + PLLC_PLLSTAT) & PLLSTAT_GOSTAT) != 0) {
  }
  while ((mmio_read32(lock_register) & PLL_CONFIG_LOCK) != PLL_CONFIG_LOCK) {
  }
  mmio_modify32(pllctl, 0, PLLCTL_PLLEN);
}

static void ddr_init(const struct preset_setting *setting) {
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
  mmio_write32(DDR_SDTIMR, setting->sdtimr);
  mmio_write32(DDR_SDTIMR2, setting->sdtimr2);
  mmio_write32(DDR_SDBCR, 0x00534832u);
  mmio_write32(DDR_PBBPR, 0xFEu);
  mmio_write32(DDR_SDBCR, 0x00D34A32u); /* BOOTUNLOCK, CL 5 */
  mmio_write32(DDR_SDBCR, 0x00534A32u);
  mmio_write32(DDR_SDRCR, setting->sdrcr);
  psc_transition(LPSC_DDR, PSC_SYNC_RESET);
  psc_transition(LPSC_DDR, PSC_ENABLE);
}

enum clock_preset boot_clock_preset(uint32_t dip) {
  const uint32_t preset = (dip >> 12) & 7u;
  return preset < CLOCK_PRESET_COUNT ? (enum clock_preset)preset : CLOCK_297_243;
}

uint32_t boot_vpss_clk_ctrl(enum clock_preset preset) { return kPresets[preset].vpss_clk_ctrl; }

void boot_init(void) {
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
  uart_init();
  const enum clock_preset preset = boot_clock_preset(dip_read());
  const struct preset_setting *setting = &kPresets[preset];
  uart_puts("boot: clocks ");
  uart_puts(setting->name);
  uart_puts("\n");
  uart_drain();

  pll_init(PLLC1, SYS_PLL0_CONFIG, &setting->pll1, 9);
  pll_init(PLLC2, SYS_PLL1_CONFIG, &setting->pll2, 5);
  wait_loop(4100);
  mmio_write32(SYS_PERI_CLK_CTRL, PERI_CLK_CTRL_VALUE);
  ddr_init(setting);
  uart_puts("boot: DDR2 up\n");
}
