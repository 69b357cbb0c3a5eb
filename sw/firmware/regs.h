/* Addresses and bits of the DM365 registers that the firmware programs. Names and offsets as in
 * TI's register header (CSL) and boot loader for the DM36x and in the public Linux drivers of each
 * block. */
#ifndef FOVEA_FIRMWARE_REGS_H
#define FOVEA_FIRMWARE_REGS_H

/* System module */
#define SYS_PINMUX(n) (0x01C40000u + 4u * (n))
#define SYS_VDAC_CONFIG 0x01C4002Cu
#define SYS_MSTPRI0 0x01C4003Cu
#define SYS_VPSS_CLK_CTRL 0x01C40044u
#define SYS_PERI_CLK_CTRL 0x01C40048u
#define SYS_VTPIOCR 0x01C40074u
#define SYS_PLL0_CONFIG 0x01C40084u
#define SYS_PLL1_CONFIG 0x01C40088u

#define MSTPRI0_ARM 0u   /* lowest bits of fields of three bits */
#define MSTPRI0_MJCP 16u
#define PLL_CONFIG_LOCK 0x07000000u
#define VTPIOCR_PWRDN (1u << 6)
#define VTPIOCR_LOCK (1u << 7)
#define VTPIOCR_CLRZ (1u << 13)
#define VTPIOCR_IOPWRDN (1u << 14)
#define VTPIOCR_READY (1u << 15)

/* PLL controllers (register map of the chip family) */
#define PLLC1 0x01C40800u
#define PLLC2 0x01C40C00u
#define PLLC_PLLCTL 0x100u
#define PLLC_SECCTL 0x108u
#define PLLC_PLLM 0x110u
#define PLLC_PREDIV 0x114u
#define PLLC_POSTDIV 0x128u
#define PLLC_PLLCMD 0x138u
#define PLLC_PLLSTAT 0x13Cu
/* Dividers 1 to 3 and 4 to 9 are in two separate groups. */
#define PLLC_PLLDIV(n) ((n) <= 3u ? 0x118u + 4u * ((n)-1u) : 0x160u + 4u * ((n)-4u))

#define PLLCTL_PLLEN (1u << 0)
#define PLLCTL_PLLPWRDN (1u << 1)
#define PLLCTL_PLLRST (1u << 3)
#define PLLCTL_PLLENSRC (1u << 5)
#define PLLCTL_CLKMODE (1u << 8)
#define PLLCMD_GOSET 1u
#define PLLSTAT_GOSTAT 1u
#define PLL_DIV_ENABLE 0x8000u

/* PSC (power and sleep controller) */
#define PSC_PTCMD 0x01C41120u
#define PSC_PTSTAT 0x01C41128u
#define PSC_MDSTAT(n) (0x01C41800u + 4u * (n))
#define PSC_MDCTL(n) (0x01C41A00u + 4u * (n))
#define PSC_STATE_MASK 0x1Fu
#define PSC_SYNC_RESET 1u
#define PSC_ENABLE 3u

#define LPSC_TPCC 0u
#define LPSC_DDR 13u
#define LPSC_I2C 18u
#define LPSC_UART0 19u
#define LPSC_GPIO 26u
#define LPSC_TIMER0 27u
#define LPSC_VPSSMSTR 47u

/* DDR2 controller */
#define DDR_SDBCR 0x20000008u
#define DDR_SDRCR 0x2000000Cu
#define DDR_SDTIMR 0x20000010u
#define DDR_SDTIMR2 0x20000014u
#define DDR_PBBPR 0x20000020u
#define DDR_DDRPHYCR 0x200000E4u

/* EDMA3 channel controller */
#define EDMA_QUEPRI 0x01C00284u /* a field of three bits every four bits, one for each queue */

/* AINTC (interrupt controller) */
#define AINTC_FIQ0 0x01C48000u
#define AINTC_FIQ1 0x01C48004u
#define AINTC_IRQ0 0x01C48008u
#define AINTC_IRQ1 0x01C4800Cu
#define AINTC_IRQENTRY 0x01C48014u
#define AINTC_EINT0 0x01C48018u
#define AINTC_EINT1 0x01C4801Cu
#define AINTC_INTCTL 0x01C48020u
#define AINTC_EABASE 0x01C48024u
#define AINTC_INTPRI(n) (0x01C48030u + 4u * (n))

#define IRQ_VPSSINT0 0u
#define IRQ_VPSSINT8 8u
#define IRQ_TINT0_34 33u

/* TIMER0 */
#define TIMER0_TIM12 0x01C21410u
#define TIMER0_TIM34 0x01C21414u
#define TIMER0_PRD12 0x01C21418u
#define TIMER0_PRD34 0x01C2141Cu
#define TIMER0_TCR 0x01C21420u
#define TIMER0_TGCR 0x01C21424u

/* UART0: a 16550 with registers at a pitch of one word */
#define UART0_THR 0x01C20000u
#define UART0_IER 0x01C20004u
#define UART0_FCR 0x01C20008u
#define UART0_LCR 0x01C2000Cu
#define UART0_MCR 0x01C20010u
#define UART0_LSR 0x01C20014u
#define UART0_DLL 0x01C20020u
#define UART0_DLH 0x01C20024u
#define UART0_PWREMU_MGMT 0x01C20030u
#define LSR_THRE (1u << 5)
#define LSR_TEMT (1u << 6)

/* GPIO: one group of registers for 32 pins */
#define GPIO_DIR(bank) (0x01C67010u + 0x28u * (bank))
#define GPIO_OUT(bank) (0x01C67014u + 0x28u * (bank))
#define GPIO_IN(bank) (0x01C67020u + 0x28u * (bank))

/* I2C */
#define I2C_ICIMR 0x01C21004u
#define I2C_ICSTR 0x01C21008u
#define I2C_ICCLKL 0x01C2100Cu
#define I2C_ICCLKH 0x01C21010u
#define I2C_ICCNT 0x01C21014u
#define I2C_ICDRR 0x01C21018u
#define I2C_ICSAR 0x01C2101Cu
#define I2C_ICDXR 0x01C21020u
#define I2C_ICMDR 0x01C21024u
#define I2C_ICPSC 0x01C21030u
#define ICSTR_AL (1u << 0)
#define ICSTR_NACK (1u << 1)
#define ICSTR_ARDY (1u << 2)
#define ICSTR_ICRRDY (1u << 3)
#define ICSTR_ICXRDY (1u << 4)
#define ICSTR_SCD (1u << 5)
#define ICSTR_BB (1u << 12)
#define ICMDR_IRS (1u << 5)
#define ICMDR_TRX (1u << 9)
#define ICMDR_MST (1u << 10)
#define ICMDR_STP (1u << 11)
#define ICMDR_STT (1u << 13)
#define ICMDR_FREE (1u << 14)

/* ISP5 (top level of the VPSS) */
#define ISP5_PCCR 0x01C70004u
#define ISP5_BCR 0x01C70008u
#define ISP5_INTSTAT 0x01C7000Cu
#define ISP5_INTSEL1 0x01C70010u
#define ISP5_INTSEL2 0x01C70014u
#define ISP5_INTSEL3 0x01C70018u
#define ISP5_EVTSEL 0x01C7001Cu
#define VPSS_CLKCTL 0x01C70200u
#define BCR_READ_PRIORITY 2u /* lowest bits of fields of three bits */
#define BCR_WRITE_PRIORITY 5u
#define PCCR_BL (1u << 0)
#define PCCR_ISIF (1u << 1)
#define PCCR_IPIPEIF (1u << 5)
#define PCCR_SYNC (1u << 6)
#define VPSS_CLKCTL_VPBE (1u << 0)
#define VPSS_CLKCTL_VENC_SEL (1u << 2) /* clock selector, written as Linux does for 525 and 625
                                           lines */
#define ISP5_SOURCE_ISIF_INT0 0u
#define ISP5_SOURCE_VENC 21u

/* ISIF (capture) */
#define ISIF_SYNCEN 0x01C71000u
#define ISIF_MODESET 0x01C71004u
#define ISIF_SPH 0x01C71018u
#define ISIF_LNH 0x01C7101Cu
#define ISIF_SLV0 0x01C71020u
#define ISIF_SLV1 0x01C71024u
#define ISIF_LNV 0x01C71028u
#define ISIF_CULH 0x01C7102Cu
#define ISIF_CULV 0x01C71030u
#define ISIF_HSIZE 0x01C71034u
#define ISIF_SDOFST 0x01C71038u
#define ISIF_CADU 0x01C7103Cu
#define ISIF_CADL 0x01C71040u
#define ISIF_VDINT0 0x01C71070u
#define ISIF_REC656IF 0x01C71084u
#define ISIF_CCDCFG 0x01C71088u
#define SYNCEN_VDHDEN (1u << 0)
#define SYNCEN_WEN (1u << 1)
#define MODESET_FIELD_STATUS (1u << 15)
#define MODESET_INPUT_YC8 (2u << 12)
#define MODESET_INTERLACED (1u << 7)
#define MODESET_VD_NEGATIVE (1u << 2)
#define CCDCFG_PACK8 2u
#define CCDCFG_YC_IN_SWAP (1u << 4)
#define CCDCFG_Y8POS (1u << 11) /* with YC_IN_SWAP: byte order Cb Y Cr Y in memory (UYVY) */
#define SDOFST_WEAVE 0x249u     /* each LOFTS is +2 lines, so the fields of a frame interleave */

/* OSD (display windows) */
#define OSD_MODE 0x01C71C00u
#define OSD_VIDWINMD 0x01C71C04u
#define OSD_OSDWIN0MD 0x01C71C08u
#define OSD_OSDWIN1MD 0x01C71C0Cu
#define OSD_RECTCUR 0x01C71C10u
#define OSD_VIDWIN0OFST 0x01C71C18u
#define OSD_VIDWINADH 0x01C71C28u
#define OSD_VIDWIN0ADL 0x01C71C2Cu
#define OSD_BASEPX 0x01C71C40u
#define OSD_BASEPY 0x01C71C44u
#define OSD_VIDWIN0XP 0x01C71C48u
#define OSD_VIDWIN0YP 0x01C71C4Cu
#define OSD_VIDWIN0XL 0x01C71C50u
#define OSD_VIDWIN0YL 0x01C71C54u
#define VIDWINMD_ACT0 (1u << 0)
#define VIDWINMD_VFF0 (1u << 1)
#define OFST_FIXED (1u << 12)

/* VENC (video encoder) */
#define VENC_VMOD 0x01C71E00u
#define VENC_VIDCTL 0x01C71E04u
#define VENC_VSTAT 0x01C71EB8u
#define VENC_OSDCLK0 0x01C71F2Cu
#define VENC_OSDCLK1 0x01C71F30u
#define VENC_CLKCTL 0x01C71F40u
#define VMOD_VENC (1u << 0)
#define VMOD_VIE (1u << 1)
#define VMOD_TVTYP_PAL (1u << 6)
#define VSTAT_FIDST (1u << 4)

#endif
