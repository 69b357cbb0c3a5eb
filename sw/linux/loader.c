/* Boot loader of Linux for the DM365 EVM: clocks and DDR2, the power domains that TI's boot loader leaves
 * on, and the tagged list (Documentation/arm/booting.rst). */
#include "sw/firmware/boot/boot.h"
#include "sw/firmware/boot/loader.h"
#include "sw/firmware/drivers/psc.h"
#include "sw/firmware/regs.h"

#ifndef COMMAND_LINE
#define COMMAND_LINE "console=ttyS0,115200n8 earlyprintk"
#endif
#ifndef MEMORY_BYTES
#define MEMORY_BYTES 0x08000000u
#endif

#define MACH_DAVINCI_DM365_EVM 1939u
#define TAGS 0x80000100u
#define KERNEL PROGRAM_BASE
#define ATAG_CORE 0x54410001u
#define ATAG_MEM 0x54410002u
#define ATAG_CMDLINE 0x54410009u

struct start_state start_state __attribute__((section(".data")));

static const char kCommandLine[] = COMMAND_LINE;

static void write_tags(void) {
  volatile uint32_t *tag = (volatile uint32_t *)TAGS;
  *tag++ = 2;
  *tag++ = ATAG_CORE;
  *tag++ = 4;
  *tag++ = ATAG_MEM;
  *tag++ = MEMORY_BYTES;
  *tag++ = DDR_BASE;
  *tag++ = 2 + (sizeof kCommandLine + 3) / 4;
  *tag++ = ATAG_CMDLINE;
  for (uint32_t i = 0; i < (sizeof kCommandLine + 3) / 4; ++i) {
    uint32_t word = 0;
    for (uint32_t k = 0; k < 4 && 4 * i + k < sizeof kCommandLine; ++k)
      word |= (uint32_t)(uint8_t)kCommandLine[4 * i + k] << (8 * k);
    *tag++ = word;
  }
  *tag++ = 0;
  *tag++ = 0;
}

uint32_t loader_main(struct start_state *state) {
  if (boot_init((const param_page_t *)PARAM_PAGE_BASE) != PARAM_PAGE_OK) return 1;
  /* Modules 0 to 28 but the SDRAM controller's; the peripherals from 38 on, the video and the clock of
   * the DAC. */
  for (uint32_t module = 0; module <= 51; ++module) {
    const int wanted = module <= 28 || (module >= 38 && module <= 47) || module >= 50;
    if (wanted && module != LPSC_DDR) psc_transition(module, PSC_ENABLE);
  }
  write_tags();
  state->r0 = 0;
  state->r1 = MACH_DAVINCI_DM365_EVM;
  state->r2 = TAGS;
  state->sp = 0;
  state->entry = KERNEL;
  return 0;
}
