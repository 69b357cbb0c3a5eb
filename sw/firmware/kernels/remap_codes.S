/* void remap_codes(uint32_t *out, const void *rows, loop_ram_t *ram)
 *
 * r0 out, r1 source of the pair before, r2 last byte read of the table, r3 first code of the group, r12
 * its second one, lr patterns. A pattern's four offsets count from the pair before its first one; the
 * load with the last of them moves r1 there.
 *
 * 28 clocks for 8 pairs. The second pattern is loaded behind the first look-up: if that misses the
 * D-cache, the rest of its line arrives meanwhile. A code is used no sooner than two instructions after
 * its load, which a byte needs. */
#include "strip_rows.inc"

    .syntax unified
    .arm
    .section .text.remap_codes, "ax", %progbits
    .balign 32
    .global remap_codes
    .type remap_codes, %function
remap_codes:
    enter_strip row_end=3f, group_bytes=60

1:  ldrsh r12, [r2]              /* step of the row's base, in words */
    ldr r1, [lr, #LOOP_BASE]
    ldrb r3, [r2, #2]!
    add r1, r1, r12, lsl #2
    str r1, [lr, #LOOP_BASE]
    enter_row
    .rept REMAP_GROUPS_MAX
    ldrb r12, [r2, #1]!
    add r3, lr, r3, lsl #4
    ldmia r3, {r4-r7}
    add r12, lr, r12, lsl #4
    ldr r4, [r1, r4]
    ldmia r12, {r8-r11}
    ldr r5, [r1, r5]
    ldr r6, [r1, r6]
    ldr r7, [r1, r7]!
    ldr r8, [r1, r8]
    ldr r9, [r1, r9]
    ldr r10, [r1, r10]
    ldr r11, [r1, r11]!
    ldrb r3, [r2, #1]!           /* of the next group; behind the last one: ends at the next row */
    stmia r0!, {r4-r11}
    .endr
3:  end_row 1b
    .size remap_codes, . - remap_codes
