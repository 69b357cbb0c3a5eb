/* Loops from reset, every block of the chip at rest. */
    .syntax unified
    .arm
    .global _start
_start:
    b _start
