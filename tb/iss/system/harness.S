@ Vectors, handlers and the end of a bare-metal program that runs here and on QEMU's versatilepb.
@ Every exception leaves a record in the log and goes on; finish writes the log by semihosting.
@
@ A record: kind | vectors << 4 | SWI number << 8, lr, cpsr, spsr, dfsr, ifsr, far, r0-r7, and the
@ interrupted mode's r8-r14. A bank dump: kDump, sys r8-r14, fiq r8-r14 and spsr, then r13, r14 and
@ spsr of irq, svc, abt, und.
@
@ SWI numbers: 0x50 + m goes on in mode 0x10 + m; 0x60 + m with I and F clear; 0x70 + m with I
@ clear; 0xB0 + m with F clear (0xAB is semihosting); 0x80 dumps the banks; 0x90 names a case (r0);
@ others only record.
  .syntax unified
  .arm
  .set kLog, 0x01000000
  .set kVic, 0x10140000
  .set kDump, 0x80
  .set kAdpExit, 0x20026

  .section .vectors, "ax"
  .global _start, resume, options, log_at, finish, high_vectors, slots, stack_top
_start:
  .rept 8
  ldr pc, [pc, #24]
  .endr
  .word boot, low_1, low_2, low_3, low_4, low_5, low_6, low_7
options:
  .word 0  @ bit 0: I-cache on, bit 1: D-cache; the host may set them

.macro stub set, kind, code
\set\()_\kind:
  str r0, slots
  mov r0, #\code
  b taken
.endm
  .irp kind, 1, 2, 3, 4, 5, 6, 7
  stub low, \kind, \kind
  stub high, \kind, (\kind + 0x10)
  .endr

taken:
  str r0, slot_kind
  ldr r0, =slots + 4
  stmia r0, {r1-r7}
  mov r7, lr
  mrs r6, spsr
  mrs r5, cpsr
  ldr r2, slot_kind
  and r3, r2, #15
  cmp r3, #2
  bne 1f
  tst r6, #0x20
  ldrhne r3, [r7, #-2]
  ldreq r3, [r7, #-4]
  bicne r3, r3, #0xff00
  biceq r3, r3, #0xff000000
  orr r2, r2, r3, lsl #8
1:
  ldr r4, =log_at
  ldr r1, [r4]
  stmia r1!, {r2, r7}
  stmia r1!, {r5, r6}
  mrc p15, 0, r0, c5, c0, 0
  mrc p15, 0, r3, c5, c0, 1
  stmia r1!, {r0, r3}
  mrc p15, 0, r0, c6, c0, 0
  str r0, [r1], #4
  ldr r0, =slots
  .rept 8
  ldr r3, [r0], #4
  str r3, [r1], #4
  .endr
  and r3, r6, #31
  cmp r3, #0x10
  moveq r3, #0x1f
  orr r3, r3, #0xc0
  msr cpsr_c, r3
  stmia r1!, {r8-r14}
  msr cpsr_c, r5
  @ BKPT, a prefetch abort without an address to resume at, and SWI 0x80 dump the banks.
  and r0, r2, #15
  ldr r3, =resume
  ldr r3, [r3]
  cmp r0, #3
  cmpeq r3, #0
  lsrne r0, r2, #8
  cmpne r0, #0x80
  bleq dump_banks
  str r1, [r4]

  and r0, r2, #15
  cmp r0, #2
  beq software
  bhi aborted
  b elsewhere  @ undefined: behind the instruction, or where `resume` says
aborted:
  cmp r0, #6
  bhs interrupted
  cmp r0, #4
  subeq r7, r7, #4
  tst r6, #0x20
  subne r7, r7, #2
elsewhere:
  cmp r3, #0
  beq back
  bic r7, r3, #1
  bic r6, r6, #0x20
  tst r3, #1
  orrne r6, r6, #0x20
  ldr r3, =resume
  mov r0, #0
  str r0, [r3]
  b back
interrupted:
  sub r7, r7, #4
  ldr r0, =kVic
  mvn r3, #0
  str r3, [r0, #0x1c]
  b back
software:
  lsr r3, r2, #12
  and r0, r2, #0xf00
  cmp r3, #0x6
  biceq r6, r6, #0xc0
  cmp r3, #0x7
  biceq r6, r6, #0x80
  cmp r3, #0xb
  biceq r6, r6, #0x40
  cmpne r3, #0x5
  cmpne r3, #0x6
  cmpne r3, #0x7
  biceq r6, r6, #0x0f
  orreq r6, r6, #0x10
  orreq r6, r6, r0, lsr #8
back:
  msr spsr_cxsf, r6
  mov lr, r7
  ldr r0, =slots
  ldmia r0, {r0-r7}
  movs pc, lr

@ Modes change here: the way back is in r0.
dump_banks:
  mov r0, #kDump
  str r0, [r1], #4
  mov r0, lr
  msr cpsr_c, #0xdf
  stmia r1!, {r8-r14}
  msr cpsr_c, #0xd1
  stmia r1!, {r8-r14}
  mrs r3, spsr
  str r3, [r1], #4
  .irp mode, 0xd2, 0xd3, 0xd7, 0xdb
  msr cpsr_c, #\mode
  mrs r3, spsr
  stmia r1!, {r13, r14}
  str r3, [r1], #4
  .endr
  msr cpsr_c, r5
  ldr r3, =resume
  ldr r3, [r3]
  mov pc, r0
  .ltorg

@ Data of the handlers in a page of its own, near enough for an address relative to the pc.
  .balign 1024
slots:
  .space 32
slot_kind:
  .word 0
resume:
  .word 0  @ where the next abort or undefined instruction goes on; bit 0: in Thumb state
log_at:
  .word kLog

  .balign 4096
high_vectors:
  .rept 8
  ldr pc, [pc, #24]
  .endr
  .word 0, high_1, high_2, high_3, high_4, high_5, high_6, high_7
  .balign 4096

  .text
boot:
  .irp mode, 0xd1, 0xd2, 0xd7, 0xdb, 0xdf, 0xd3
  msr cpsr_c, #\mode
  mov r8, #0
  mov r9, #0
  mov r10, #0
  mov r11, #0
  mov r12, #0
  mov r13, #\mode
  mov r14, #\mode << 8
  .if \mode != 0xdf
  msr spsr_cxsf, r13
  .endif
  .endr
  ldr r0, =kVic
  mov r1, #3
  str r1, [r0, #0x10]  @ lines 0 and 1 enabled,
  mov r1, #2
  str r1, [r0, #0x0c]  @ line 1 is FIQ
  ldr sp, =stack_top
  mov r0, #0
  mov r1, #0
  bl program
finish:
  msr cpsr_c, #0xd3
  mov r0, #1
  ldr r1, =open_what
  svc #0x123456
  ldr r1, =write_what
  ldr r2, =log_at
  ldr r2, [r2]
  ldr r3, =kLog
  sub r2, r2, r3
  stmia r1, {r0, r3}
  str r2, [r1, #8]
  mov r0, #5
  svc #0x123456
  mov r0, #0x18
  ldr r1, =kAdpExit
  svc #0x123456
  b .
  .ltorg

  .data
open_what:
  .word terminal, 4, 3  @ for writing
write_what:
  .space 12
terminal:
  .asciz ":tt"
  .bss
  .balign 8
  .space 16384
stack_top:
