/* What the firmware programs in the DM365's registers. Addresses, fields, power gates and interrupts are in
 * registers.h, which is printed from the model's declarations. Here are values of fields, bits of registers
 * that the model declares without fields, registers by number, and shorter names. Sources: TI's register
 * header (CSL) and boot loader for the DM36x and the public Linux drivers of each block. */
#ifndef FOVEA_FIRMWARE_REGS_H
#define FOVEA_FIRMWARE_REGS_H

#include "registers.h"

/* System module */
#define SYS_PINMUX(n) SYSTEM_PINMUX(n)
#define SYS_VDAC_CONFIG SYSTEM_VDAC_CONFIG
#define SYS_MSTPRI0 SYSTEM_MSTPRI0
#define SYS_VPSS_CLK_CTRL SYSTEM_VPSS_CLK_CTRL
#define SYS_PERI_CLK_CTRL SYSTEM_PERI_CLK_CTRL
#define SYS_VTPIOCR SYSTEM_VTPIOCR
#define SYS_PLL0_CONFIG SYSTEM_PLL0_CONFIG
#define SYS_PLL1_CONFIG SYSTEM_PLL1_CONFIG

#define MSTPRI0_ARM 0u   /* lowest bits of fields of three bits */
#define MSTPRI0_IMCOP 16u
#define PLL_CONFIG_LOCK 0x07000000u
#define VTPIOCR_PWRDN SYSTEM_VTPIOCR_PWRDN
#define VTPIOCR_LOCK SYSTEM_VTPIOCR_LOCK
#define VTPIOCR_CLRZ SYSTEM_VTPIOCR_CLRZ
#define VTPIOCR_IOPWRDN SYSTEM_VTPIOCR_IOPWRDN
#define VTPIOCR_READY SYSTEM_VTPIOCR_READY

/* PLL controllers: both have the same registers; the offsets are from PLLC1 or PLLC2. */
#define PLLC1 PLL1_REGISTERS
#define PLLC2 PLL2_REGISTERS
#define PLLC_OFFSET(name) (PLL1_##name - PLL1_REGISTERS)
#define PLLC_PLLCTL PLLC_OFFSET(PLLCTL)
#define PLLC_SECCTL PLLC_OFFSET(SECCTL)
#define PLLC_PLLM PLLC_OFFSET(PLLM)
#define PLLC_PREDIV PLLC_OFFSET(PREDIV)
#define PLLC_POSTDIV PLLC_OFFSET(POSTDIV)
#define PLLC_PLLCMD PLLC_OFFSET(PLLCMD)
#define PLLC_PLLSTAT PLLC_OFFSET(PLLSTAT)
/* Dividers 1 to 3 and 4 to 9 are in two separate groups. */
#define PLLC_PLLDIV(n) \
  ((n) <= 3u ? PLLC_OFFSET(PLLDIV1) + 4u * ((n)-1u) : PLLC_OFFSET(PLLDIV4) + 4u * ((n)-4u))

#define PLLCTL_PLLEN PLL1_PLLCTL_PLLEN
#define PLLCTL_PLLPWRDN PLL1_PLLCTL_PLLPWRDN
#define PLLCTL_PLLRST PLL1_PLLCTL_PLLRST
#define PLLCTL_PLLENSRC PLL1_PLLCTL_PLLENSRC
#define PLLCTL_CLKMODE PLL1_PLLCTL_CLKMODE
#define PLLCMD_GOSET 1u
#define PLLSTAT_GOSTAT PLL1_PLLSTAT_GOSTAT
#define PLL_DIV_ENABLE 0x8000u

/* PSC (power and sleep controller): states of a module */
#define PSC_STATE_MASK 0x1Fu
#define PSC_SYNC_RESET 1u
#define PSC_ENABLE 3u
#define LPSC_VPSSMSTR LPSC_VPSS
#define LPSC_TPCC LPSC_EDMA

/* Interrupts */
#define IRQ_VPSSINT0 IRQ_VPSS_VPSSINT0
#define IRQ_VPSSINT1 IRQ_VPSS_VPSSINT1
#define IRQ_VPSSINT8 IRQ_VPSS_VPSSINT8
#define IRQ_TINT0_34 IRQ_TIMER0_TINT34

/* UART0: a 16550 with registers at a pitch of one word */
#define UART0_THR UART0_RBR_THR
#define UART0_FCR UART0_IIR_FCR
#define LSR_THRE (1u << 5)
#define LSR_TEMT (1u << 6)

/* GPIO: one group of registers for 32 pins */
#define GPIO_GROUP_BYTES (GPIO_DIR23 - GPIO_DIR01)
#define GPIO_DIR(bank) (GPIO_DIR01 + GPIO_GROUP_BYTES * (bank))
#define GPIO_OUT(bank) (GPIO_OUT_DATA01 + GPIO_GROUP_BYTES * (bank))
#define GPIO_IN(bank) (GPIO_IN_DATA01 + GPIO_GROUP_BYTES * (bank))

/* I2C */
#define ICSTR_AL (1u << 0)
#define ICSTR_NACK (1u << 1)
#define ICSTR_ARDY (1u << 2)
#define ICSTR_ICRRDY (1u << 3)
#define ICSTR_ICXRDY (1u << 4)
#define ICSTR_SCD (1u << 5)
#define ICSTR_BB (1u << 12)
#define ICMDR_IRS I2C_ICMDR_IRS
#define ICMDR_TRX I2C_ICMDR_TRX
#define ICMDR_MST I2C_ICMDR_MST
#define ICMDR_STP I2C_ICMDR_STP
#define ICMDR_STT I2C_ICMDR_STT
#define ICMDR_FREE I2C_ICMDR_FREE

/* ISP5 (top level of the VPSS) */
#define ISP5_PCCR VPSS_PCCR
#define ISP5_BCR VPSS_BCR
#define BCR_READ_PRIORITY 2u /* lowest bits of fields of three bits */
#define BCR_WRITE_PRIORITY 5u
#define ISP5_INTSTAT VPSS_INTSTAT
#define ISP5_INTSEL1 VPSS_INTSEL1
#define ISP5_INTSEL2 VPSS_INTSEL2
#define ISP5_INTSEL3 VPSS_INTSEL3
#define ISP5_EVTSEL VPSS_EVTSEL
#define VPSS_CLKCTL VPSS_VPSS_CLK_CTRL
#define PCCR_BL VPSS_PCCR_BL
#define PCCR_ISIF VPSS_PCCR_ISIF
#define PCCR_IPIPEIF VPSS_PCCR_IPIPEIF
#define PCCR_SYNC VPSS_PCCR_SYNC
#define VPSS_CLKCTL_VPBE VPSS_VPSS_CLK_CTRL_VPBE_CLK
/* Clock selector, written as Linux does for 525 and 625 lines. */
#define VPSS_CLKCTL_VENC_SEL VPSS_VPSS_CLK_CTRL_VENC_CLK_SEL
#define ISP5_SOURCE_ISIF_INT0 0u
#define ISP5_SOURCE_VENC 21u

/* ISIF (capture) */
#define SYNCEN_VDHDEN ISIF_SYNCEN_VDHDEN
#define SYNCEN_WEN ISIF_SYNCEN_WEN
#define MODESET_FIELD_STATUS ISIF_MODESET_MDFS
#define MODESET_INPUT_YC8 (2u << 12)
#define MODESET_INTERLACED ISIF_MODESET_CCDMD
#define MODESET_VD_NEGATIVE ISIF_MODESET_VDPOL
#define CCDCFG_PACK8 2u
#define CCDCFG_YC_IN_SWAP ISIF_CCDCFG_YCINSWP
#define CCDCFG_Y8POS ISIF_CCDCFG_Y8POS /* with YC_IN_SWAP: byte order Cb Y Cr Y in memory (UYVY) */
#define SDOFST_WEAVE 0x249u /* each LOFTS is +2 lines, so the fields of a frame interleave */

/* OSD (display windows) */
#define VIDWINMD_ACT0 OSD_VIDWINMD_ACT0
#define VIDWINMD_VFF0 OSD_VIDWINMD_VFF0
#define OFST_FIXED (1u << 12)

/* VENC (video encoder) */
#define VMOD_VENC VENC_VMOD_VENC
#define VMOD_VIE VENC_VMOD_VIE
#define VMOD_TVTYP_PAL (1u << 6)
#define VSTAT_FIDST VENC_VSTAT_FIDST

#endif
