/* void remap_deltas(uint32_t *out, const void *rows, loop_ram_t *ram)
 *
 * r0 out, r1 source of the pair before, r2 table, r3 numbers of eight deltas, lr deltas, r12 mask of a
 * number times four. Every load of a pair moves r1 to it. 33 clocks for 8 pairs: three for each pair,
 * interleaved so that no load waits for the one before. */
#include "strip_rows.inc"

    .syntax unified
    .arm
    .section .text.remap_deltas, "ax", %progbits
    .balign 32
    .global remap_deltas
    .type remap_deltas, %function
remap_deltas:
    enter_strip row_end=3f, group_bytes=104
    ldr r3, [r2], #4             /* base of the first row */
    mov r12, #0x3C

1:  ldr r4, [lr, #LOOP_BASE]
    mov r1, r3
    ldr r3, [r2], #4
    add r1, r1, r4
    enter_row
    .rept REMAP_GROUPS_MAX
    and r4, r12, r3
    and r5, r12, r3, ror #4
    ldr r4, [lr, r4]
    ldr r5, [lr, r5]
    and r6, r12, r3, ror #8
    ldr r4, [r1, r4]!
    and r7, r12, r3, ror #12
    ldr r6, [lr, r6]
    ldr r5, [r1, r5]!
    ldr r7, [lr, r7]
    and r8, r12, r3, ror #16
    ldr r6, [r1, r6]!
    and r9, r12, r3, ror #20
    ldr r8, [lr, r8]
    ldr r7, [r1, r7]!
    ldr r9, [lr, r9]
    and r10, r12, r3, ror #24
    ldr r8, [r1, r8]!
    and r11, r12, r3, ror #28
    ldr r10, [lr, r10]
    ldr r9, [r1, r9]!
    ldr r11, [lr, r11]
    ldr r3, [r2], #4             /* of the next group; behind the last one: base of the next row */
    ldr r10, [r1, r10]!
    ldr r11, [r1, r11]!
    stmia r0!, {r4-r11}
    .endr
3:  end_row 1b
    .size remap_deltas, . - remap_deltas
