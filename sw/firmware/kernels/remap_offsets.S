/* void remap_offsets(uint32_t *out, const void *rows, loop_ram_t *ram)
 *
 * r0 out, r1 base of the row, r2 table, lr the loop's variables. 24 clocks for 8 pairs. */
#include "strip_rows.inc"

    .syntax unified
    .arm
    .section .text.remap_offsets, "ax", %progbits
    .balign 32
    .global remap_offsets
    .type remap_offsets, %function
remap_offsets:
    enter_strip row_end=3f, group_bytes=68

1:  ldr r1, [r2], #4
    ldr r3, [lr, #LOOP_BASE]
    nop
    add r1, r1, r3
    enter_row
    .rept REMAP_GROUPS_MAX
    ldrh r4, [r2], #2
    ldrh r5, [r2], #2
    ldrh r6, [r2], #2
    ldrh r7, [r2], #2
    ldrh r8, [r2], #2
    ldrh r9, [r2], #2
    ldrh r10, [r2], #2
    ldrh r11, [r2], #2
    ldr r4, [r1, r4]
    ldr r5, [r1, r5]
    ldr r6, [r1, r6]
    ldr r7, [r1, r7]
    ldr r8, [r1, r8]
    ldr r9, [r1, r9]
    ldr r10, [r1, r10]
    ldr r11, [r1, r11]
    stmia r0!, {r4-r11}
    .endr
3:  end_row 1b
    .size remap_offsets, . - remap_offsets
