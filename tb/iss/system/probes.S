@ Accesses that the C programs make in user or in supervisor mode.
#include "case.inc"

.macro function name
  .global \name
  .type \name, %function
\name:
.endm

  .text
@ Registers that a program's compiler fills as it likes, and the flags, are 0 in the log.
.macro quiet first
  .irp r, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12
  .if \r >= \first
  mov r\r, #0
  .endif
  .endr
  msr cpsr_f, #0
.endm

@ begin(name), note(a, b, c, d)
function begin
  push {r4-r12, lr}
  quiet 1
  svc #0x90
  pop {r4-r12, pc}
function note
  push {r4-r12, lr}
  quiet 4
  svc #0x91
  pop {r4-r12, pc}

@ probe(fragment, va, user)
function probe
  push {r4-r12, lr}
  mov r3, r0
  quiet 4
  mov r12, r3
  ldr r0, =0x600df00d
  ldr r3, =0x33333333
  ldr r4, =0x44444444
  ldr r5, =0x55555555
  cmp r2, #0
  svcne #0x50
  blx r12
  svc #0x53
  pop {r4-r12, pc}
  .ltorg

.macro access name, text:vararg
function \name
  \text
  bx lr
.endm
  access read_word, ldr r0, [r1]
  access read_byte, ldrb r0, [r1]
  access read_half, ldrh r0, [r1]
  access write_word, str r3, [r1]
  access write_byte, strb r3, [r1]
  access write_half, strh r3, [r1]
  access read_double, ldrd r4, r5, [r1]
  access write_double, strd r4, r5, [r1]
  access read_many, ldmia r1, {r3, r4, r5}
  access write_many, stmia r1, {r3, r4, r5}
  access swap_word, swp r0, r3, [r1]
  access swap_byte, swpb r0, r3, [r1]
  access read_word_as_user, ldrt r0, [r1]
  access write_word_as_user, strt r3, [r1]
  access read_byte_as_user, ldrbt r0, [r1]
  access write_byte_as_user, strbt r3, [r1]
  access touch_nothing, nop

@ To va and back: `bx lr` lies there, or the abort's handler goes on at 1.
.macro run name, bit
function \name
  mov r6, lr
  ldr r2, =resume
  ldr r0, =1f
  str r0, [r2]
  orr r1, r1, #\bit
  mov r0, #0
  blx r1
  mov r0, #1
1:
  mov r3, #0
  str r3, [r2]
  bx r6
.endm
  run run_there, 0
  run run_thumb_there, 1

@ Known values in r0-r12; r1 is *base, r2 is 8.
function fill_registers
  ldr r12, =register_values
  ldr r0, =base
  ldr r1, [r0]
  str r1, [r12, #4]
  ldmia r12, {r0-r12}
  bx lr
  .ltorg
  .data
  .global base
base:
  .word 0
register_values:
  .word 0x10203040, 0, 8
  .irp k, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12
  .word 0x10000000 + 0x01010101 * \k
  .endr
