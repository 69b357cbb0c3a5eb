/* An endless loop from reset on, with all blocks of the chip idle. */
    .syntax unified
    .arm
    .global _start
_start:
    b _start
