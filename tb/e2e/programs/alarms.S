/* Two alarms of TIMER0's upper half, from reset, clocks as they are there. Pins 64..67 show 1 and 3 when
   an alarm was started, 2 and 4 when its interrupt has come. The second takes SECOND - FIRST longer. */
#include "pins.inc"
    .syntax unified
    .arm
    .equ FIRST, 200
    .equ SECOND, 260
    .global _start
_start:
    b reset
    nop
    nop
    nop
    nop
    nop
    b interrupt
    nop

reset:
    open_pins
    ldr r5, =0x01C48000              /* AINTC */
    mov r0, #2                       /* EINT1: source 33, TINT34 of TIMER0 */
    str r0, [r5, #0x1c]
    ldr r6, =0x01C21400              /* TIMER0 */
    mov r7, #0                       /* alarms so far */
    ldr r8, =FIRST
    b alarm

/* Interrupts stay masked until the sled; each alarm runs the same instructions. */
alarm:
    mov r0, #0
    str r0, [r6, #0x20]              /* TCR: off */
    str r0, [r6, #0x14]              /* TIM34 */
    str r8, [r6, #0x1c]              /* PRD34 */
    mov r0, #6
    str r0, [r6, #0x24]              /* TGCR: unchained, TIM34 out of reset */
    mov r0, #0x00400000
    str r0, [r6, #0x20]              /* TCR: once */
    add r0, r7, r7
    add r0, r0, #1
    str r0, [r4, #4]
    msr cpsr_c, #0x5f                /* IRQ open */
    .rept 600
    mov r0, r0                       /* one clock each: the interrupt comes to the clock */
    .endr
stop:
    b stop                           /* nothing came */

interrupt:
    add r7, r7, #1
    add r0, r7, r7
    str r0, [r4, #4]
    mov r0, #2
    str r0, [r5, #0x0c]              /* IRQ1: acknowledge */
    ldr r8, =SECOND
    cmp r7, #2
    bne alarm
    b stop
    .ltorg
