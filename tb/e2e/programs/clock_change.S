/* From reset: the core's clock is divided as FROM says, then as TO says while the core runs on. The register access
   that follows the command comes one instruction later each time. Pins 64..71 count before and after. */
#include "pins.inc"
    .syntax unified
    .arm
    .equ TIMES, 24
    .global _start
_start:
    open_pins
    ldr r5, =0x01C40900              /* PLLC1, from PLLCTL on */
    mov r1, #1
    mov r7, #0
    .set n, 0
    .rept TIMES
    ldr r0, =FROM                    /* PLLDIV2 */
    str r0, [r5, #0x1c]
    str r1, [r5, #0x38]              /* PLLCMD: GOSET */
1:  ldr r0, [r5, #0x3c]              /* PLLSTAT */
    tst r0, #1
    bne 1b
    ldr r0, =TO
    str r0, [r5, #0x1c]
    add r7, r7, #1
    str r7, [r4, #4]
    add r7, r7, #1
    str r1, [r5, #0x38]
    .rept n
    mov r0, r0
    .endr
    str r7, [r4, #4]
1:  ldr r0, [r5, #0x3c]
    tst r0, #1
    bne 1b
    .set n, n + 1
    .endr
2:  b 2b
    .ltorg
