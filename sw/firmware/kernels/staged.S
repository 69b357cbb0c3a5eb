/* void staged_tile(uint8_t *out, const uint16_t *code, uint32_t *ram, uint32_t step)
 *
 * r0 out, r1 the place from which the next steps count, r2 code, r3 ram, r12 the pattern of the next
 * four pairs, lr four times the rows left; the step is on the stack.
 *
 * Eight pairs take 26 clocks if nothing waits: two patterns (8), two codes (2), eight pairs (8), their
 * store (8). All loads but that of the step read internal RAM. The stores to `out` leave through the write
 * buffer, which needs about 37 clocks for 32 bytes: three stores in a row of 134 clocks keep it busy for
 * 83 % of the time, and the core never waits for it. The other two go to internal RAM. */
    .syntax unified
    .arm
    .section .text.staged, "ax", %progbits

/* The second four of eight pairs, the code of the four pairs behind them, and the store. */
.macro finish to
    ldm r8, {r8-r11}
    ldrh r12, [r2], #2
    ldr r8, [r1, r8]
    ldr r9, [r1, r9]
    ldr r10, [r1, r10]
    ldr r11, [r1, r11]!
    stm \to!, {r4-r11}
.endm

.macro first_four
    ldr r4, [r1, r4]
    ldr r5, [r1, r5]
    ldr r6, [r1, r6]
    ldr r7, [r1, r7]!
.endm

.macro eight to
    ldm r12, {r4-r7}
    ldrh r8, [r2], #2
    first_four
    finish \to
.endm

.macro row
    ldr r9, [sp]
    ldm r12, {r4-r7}
    ldrh r1, [r2], #2
    ldrh r8, [r2], #2
    add r0, r0, r9
    first_four
    finish r3
    eight r3
    eight r0
    eight r0
    eight r0
.endm

    .balign 32
    .global staged_tile
    .type staged_tile, %function
staged_tile:
    stmfd sp!, {r3-r11, lr}
    mov lr, #6
    mov r12, r1
    mov r3, r2
    add r2, r12, #2
    ldrh r12, [r12]
1:  row
    row
    row
    row
    subs lr, lr, #1
    bne 1b
    ldmfd sp!, {r3-r11, pc}
    .size staged_tile, . - staged_tile
