/* From reset: SLED instructions in internal RAM between two marks on the pins, twice as many between the next
   two; then with one wait state (MISC.ARM_WAITST = 0) again, and with none again. Pins count 1 to 12. */
#include "pins.inc"
    .syntax unified
    .arm
    .equ SLED, 400
    .global _start
_start:
    open_pins
    ldr r5, =0x01C40000              /* system module */
    mov r7, #0
    b 2f
    .ltorg
2:
    .macro measure times
    add r7, r7, #1
    str r7, [r4, #4]
    .rept SLED * \times
    mov r0, r0
    .endr
    add r7, r7, #1
    str r7, [r4, #4]
    .endm
    .macro both
    measure 1
    measure 2
    .endm
    both
    mov r0, #0x12
    str r0, [r5, #0x38]
    ldr r0, [r5, #0x38]
    both
    mov r0, #0x13
    str r0, [r5, #0x38]
    ldr r0, [r5, #0x38]
    both
1:  b 1b
