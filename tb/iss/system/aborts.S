@ Data aborts of every load and store in every addressing form: the base, the registers, the status
@ and the address; what a store of several words has written; alignment faults.
#include "case.inc"

.macro three op, rd:vararg
  try \op \rd, [r1]
  try \op \rd, [r1, #4]
  try \op \rd, [r1, #-4]
  try \op \rd, [r1, #4]!
  try \op \rd, [r1, #-8]!
  try \op \rd, [r1], #4
  try \op \rd, [r1], #-4
  try \op \rd, [r1, r2]
  try \op \rd, [r1, -r2]
  try \op \rd, [r1, r2]!
  try \op \rd, [r1, -r2]!
  try \op \rd, [r1], r2
  try \op \rd, [r1], -r2
.endm

.macro shifted op
  .irp shift, "lsl #1", "lsr #1", "asr #1", "ror #31", "rrx"
  try \op r3, [r1, r2, \shift]
  try \op r3, [r1, -r2, \shift]!
  try \op r3, [r1, r2, \shift]!
  try \op r3, [r1], r2, \shift
  try \op r3, [r1], -r2, \shift
  .endr
  try \op r3, [r1, #0xf0c]
  try \op r3, [r1, #-0xf0c]!
  try \op r1, [r1, #4]
.endm

.macro as_user op
  try \op\()t r3, [r1]
  try \op\()t r3, [r1], #4
  try \op\()t r3, [r1], #-4
  try \op\()t r3, [r1], r2
  try \op\()t r3, [r1], -r2, lsl #1
.endm

.macro forms
  three ldr, r3
  three ldrb, r3
  three ldrh, r3
  three ldrsh, r3
  three ldrsb, r3
  three str, r3
  three strb, r3
  three strh, r3
  three ldrd, r4, r5
  three strd, r4, r5
  .irp op, ldr, ldrb, str, strb
  shifted \op
  as_user \op
  .endr
  .irp kind, ia, ib, da, db
  try ldm\kind r1, {r3}
  try ldm\kind r1!, {r3, r4, r8}
  try ldm\kind r1, {r1, r5, r12, lr}
  try ldm\kind r1!, {r0, r7, pc}
  try stm\kind r1, {r3}
  try stm\kind r1!, {r3, r4, r8}
  try stm\kind r1!, {r1, r5, r12, lr}
  try stm\kind r1!, {r0, r7, pc}
  .endr
  try swp r3, r4, [r1]
  try swpb r3, r4, [r1]
  try swp r4, r4, [r1]
  try ldrne r3, [r1], #4
  try ldreq r3, [r1], #4
  try ldr pc, [r1], #4
.endm

@ The transfers of several words that the mode may make of the user's registers.
.macro user_registers
  .irp kind, ia, ib, da, db
  try ldm\kind r1, {r3, r4, r13}^
  try ldm\kind r1, {r13, r14}^
  try ldm\kind r1, {r0, r14, pc}^
  try ldm\kind r1!, {r0, r14, pc}^
  try stm\kind r1, {r8, r13}^
  try stm\kind r1, {r13, r14}^
  .endr
.endm

.macro thumb_forms
  .irp op, ldr, str, ldrb, strb, ldrh, strh
  try \op r3, [r1]
  try \op r3, [r1, #4]
  try \op r3, [r1, r2]
  .endr
  try ldrsb r3, [r1, r2]
  try ldrsh r3, [r1, r2]
  try ldmia r1!, {r3, r4, r5}
  try ldmia r1, {r0, r1}
  try stmia r1!, {r3, r4, r5}
  mov r0, r13
  mov r14, r0
  bl fill_registers
  mov r9, r13
  mov r13, r1
  ldr r3, [sp, #8]
  str r3, [sp, #12]
  push {r0, r3}
  push {r0, lr}
  pop {r0, r3}
  pop {r4, pc}
  svc #0x91
  mov r13, r9
.endm

@ The three places at which nothing may be read or written: no section, no page, no right.
.macro everywhere name, text:vararg
  .irp place, 0x70000100, 0x40001100, 0x40002100
  case "\name at \place"
  put base, \place
  \text
  b 6f
  .ltorg
6:
  .endr
.endm

.macro in_mode number, text:vararg
  svc #\number
  \text
  b 5f
  .ltorg
5:
  svc #0x53
.endm

.macro in_thumb number
  svc #\number
  adr r11, 4f + 1
  bx r11
  .thumb
  .balign 4
4:
  thumb_forms
  .balign 4
  bx pc
  nop
  .arm
  svc #0x53
.endm

@ `before` words in the page that is there, the others in the one behind.
.macro crossing op, from, list:vararg
  bl fill_registers
  ldr r1, =\from
  \op r1!, \list
  crossing_without_write_back \op, \from, \list
.endm
.macro crossing_without_write_back op, from, list:vararg
  bl fill_registers
  ldr r1, =\from
  \op r1, \list
  bl fill_registers
  svc #0x92
  ldr r8, =0x40000fe0
  ldmia r8, {r0-r7}
  svc #0x93
  mov r0, #0
  mov r1, #0
  mov r2, #0
  mov r3, #0
  stmia r8!, {r0-r3}
  stmia r8!, {r0-r3}
.endm

.macro crossings op
  .irp before, 0, 1, 2, 3, 4
  crossing \op\()ia, (0x40001000 - 4 * \before), {r3-r6, r12}
  crossing \op\()ib, (0x40001000 - 4 * \before - 4), {r3-r6, r12}
  crossing \op\()da, (0x40001000 + 4 * (5 - \before) - 4), {r3-r6, r12}
  crossing \op\()db, (0x40001000 + 4 * (5 - \before)), {r3-r6, r12}
  b 5f
  .ltorg
5:
  .endr
  crossing_without_write_back \op\()ia, 0x40000ff8, {r0, r1, r2, r3}
  crossing_without_write_back \op\()db, 0x40001008, {r0, r2, r3, lr}
.endm

@ Addresses that are no multiple of the size, with the A bit set.
.macro odd
  .irp bits, 1, 2, 3
  .irp op, ldr, str, ldrh, strh, ldrsh, ldrb, strb, ldrsb
  try \op r3, [r1, #\bits]
  try \op r3, [r1, #\bits]!
  try \op r3, [r1], #\bits
  .endr
  .irp op, ldrt, strt
  bl fill_registers
  add r1, r1, #\bits
  \op r3, [r1], #4
  svc #0x91
  .endr
  .irp op, "ldmia r1!, {r3, r4}", "stmia r1!, {r3, r4}", "ldmdb r1, {r3}", \
           "swp r3, r4, [r1]", "swpb r3, r4, [r1]"
  bl fill_registers
  add r1, r1, #\bits
  \op
  svc #0x91
  .endr
  .endr
  b 5f
  .ltorg
5:
.endm

  .text
  .global program
program:
  bl map
  everywhere "supervisor", in_mode 0x53, forms
  everywhere "fiq", in_mode 0x51, forms
  everywhere "user", in_mode 0x50, forms
  everywhere "supervisor, user bank", in_mode 0x53, user_registers
  everywhere "fiq, user bank", in_mode 0x51, user_registers
  everywhere "irq, user bank", in_mode 0x52, user_registers
  everywhere "Thumb, supervisor", in_thumb 0x53
  everywhere "Thumb, user", in_thumb 0x50
  case "stores across a page's end"
  crossings stm
  case "loads across a page's end"
  crossings ldm
  mrc p15, 0, r0, c1, c0, 0
  orr r0, r0, #2
  mcr p15, 0, r0, c1, c0, 0
  everywhere "misaligned", odd
  case "misaligned in a page that is there"
  put base, 0x40000100
  odd
  b finish
  .ltorg
