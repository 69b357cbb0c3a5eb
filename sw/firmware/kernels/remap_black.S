/* void copy_lines(void *to, const void *from, uint32_t bytes)
 * void remap_black(uint32_t *out, const remap_black_run_t *runs) */
#define BLACK_WORD 0x10801080 /* LENS_BLACK_WORD of sw/lens/lens.h */

    .syntax unified
    .arm
    .section .text.copy_lines, "ax", %progbits
    .global copy_lines
    .type copy_lines, %function
copy_lines:
    stmfd sp!, {r4-r10, lr}
    cmp r2, #0
    beq 2f
1:  ldmia r1!, {r3-r10}
    subs r2, r2, #32
    stmia r0!, {r3-r10}
    bhi 1b
2:  ldmfd sp!, {r4-r10, pc}
    .size copy_lines, . - copy_lines

    .section .text.remap_black, "ax", %progbits
    .global remap_black
    .type remap_black, %function
/* r2, r4-r10 black words, r3 words left, r12 run: words to skip, words to write << 16 */
remap_black:
    stmfd sp!, {r4-r10, lr}
    ldr r2, =BLACK_WORD
    mov r4, r2
    mov r5, r2
    mov r6, r2
    mov r7, r2
    mov r8, r2
    mov r9, r2
    mov r10, r2
1:  ldr r12, [r1], #4
    teq r12, #0
    beq 4f
    mov r3, r12, lsl #16
    add r0, r0, r3, lsr #14
    mov r3, r12, lsr #16
2:  subs r3, r3, #8
    stmiahs r0!, {r2, r4-r10}
    bhs 2b
    tst r3, #4                   /* 8 less than what is left: the same lowest three bits */
    stmiane r0!, {r4-r7}
    tst r3, #2
    stmiane r0!, {r4-r5}
    tst r3, #1
    strne r4, [r0], #4
    b 1b
4:  ldmfd sp!, {r4-r10, pc}
    .ltorg
    .size remap_black, . - remap_black
