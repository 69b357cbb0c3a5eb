/* void remap_ldm(uint32_t *out, const void *in, const uint32_t *lut, uint32_t pairs)
 *
 * r0 out, r1 in, r2 lut, r3 pairs left. Each loaded register is used at least three instructions
 * later, so that no load waits for its result as long as the data are in the cache. */
    .syntax unified
    .arm
    .section .text.remap_ldm, "ax", %progbits
    .balign 32
    .global remap_ldm
    .type remap_ldm, %function
remap_ldm:
    stmfd sp!, {r4-r11, lr}
    subs r3, r3, #8
    blo 2f
1:  ldmia r2!, {r4-r11}
    ldr r4, [r1, r4]
    ldr r5, [r1, r5]
    ldr r6, [r1, r6]
    ldr r7, [r1, r7]
    ldr r8, [r1, r8]
    ldr r9, [r1, r9]
    ldr r10, [r1, r10]
    ldr r11, [r1, r11]
    subs r3, r3, #8
    stmia r0!, {r4-r11}
    bhs 1b
2:  adds r3, r3, #8
    beq 4f
3:  ldr r4, [r2], #4
    subs r3, r3, #1
    ldr r4, [r1, r4]
    str r4, [r0], #4
    bne 3b
4:  ldmfd sp!, {r4-r11, pc}
    .size remap_ldm, . - remap_ldm
