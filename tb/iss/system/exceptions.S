@ Each exception from each mode, in ARM and Thumb state, with the masks open and closed: LR, SPSR,
@ CPSR and the banks, by the low vectors without the MMU and by the high ones with it.
#include "case.inc"

@ Into the mode with these I, F and condition flags, from anywhere; in Thumb state for thumb = 1.
.macro go_to mode, masks, flags, thumb
  .if \thumb
  svc #0x53
  msr cpsr_c, #(0x13 | \masks)
  msr cpsr_f, #\flags
  adr r11, 1f + 1
  bx r11
  .thumb
1:
  svc #(0x40 | \mode)
  .else
  svc #0x53
  msr cpsr_c, #(0x13 | \masks)
  msr cpsr_f, #\flags
  svc #(0x40 | \mode)
  .endif
.endm

@ Back to ARM state from either.
.macro to_arm thumb
  .if \thumb
  .balign 4
  bx pc
  nop
  .arm
  .endif
.endm

@ With a line raised: the mode's first instruction is interrupted.
.macro interrupt line, code, mode, flags, thumb
  svc #0x53
  msr cpsr_c, #0xd3
  msr cpsr_f, #\flags
  ldr r10, =kVic
  mov r9, #\line
  str r9, [r10, #0x18]
  .if \thumb
  adr r11, 1f + 1
  bx r11
  .thumb
1:
  .endif
  svc #(\code | (\mode & 15))
  nop
  nop
  to_arm \thumb
.endm

.macro from_mode mode, thumb
  .irp masks, 0x00, 0x40, 0x80, 0xc0
  .irp flags, 0x00000000, 0xf8000000
  go_to \mode, \masks, \flags, \thumb
  svc #0x12
  .if \thumb
  .inst.n 0xde00
  .inst.n 0xb800
  .else
  .inst 0xe7f000f0
  .inst 0xee000110
  .endif
  bkpt #0x3c
  mov r8, r13
  .if \thumb
  movs r0, #0x70
  lsls r0, r0, #24
  ldr r0, [r0, #4]
  .else
  ldr r0, =0x70000000
  strb r0, [r0, #7]
  .endif
  to_arm \thumb
  @ Into a page that is not there: once in ARM state and once in Thumb state.
  .irp bit, 0, 2
  go_to \mode, \masks, \flags, 0
  ldr r0, =resume
  ldr r1, =4f
  str r1, [r0]
  ldr r0, =0x70000010 + \bit + \bit / 2
  bx r0
4:
  .endr
  .endr
  .endr
  .irp flags, 0x00000000, 0xf8000000
  interrupt 1, 0x60, \mode, \flags, \thumb
  interrupt 1, 0x70, \mode, \flags, \thumb
  interrupt 2, 0x60, \mode, \flags, \thumb
  interrupt 2, 0xb0, \mode, \flags, \thumb
  @ Both: FIQ goes first; IRQ waits, and is lowered by the handler of the first.
  interrupt 3, 0x60, \mode, \flags, \thumb
  .endr
  svc #0x53
  msr cpsr_c, #0xd3
  svc #0x80
  b 5f
  .ltorg
5:
.endm

.macro from_all_modes name
  .irp thumb, 0, 1
  .irp mode, 0x10, 0x11, 0x12, 0x13, 0x17, 0x1b, 0x1f
  case "\name, mode \mode, Thumb \thumb"
  from_mode \mode, \thumb
  .endr
  .endr
.endm

  .text
  .global program
program:
  bl mmu_on
  msr cpsr_f, #0
  mov r0, #1
  mov r1, #2
  mov r2, #3
  mov r3, #4
  mov r4, #5
  mov r5, #6
  mov r6, #7
  mov r7, #8
  from_all_modes "low vectors"
  svc #0x53
  msr cpsr_c, #0xd3
  mrc p15, 0, r0, c1, c0, 0
  orr r0, r0, #0x2000
  mcr p15, 0, r0, c1, c0, 0
  from_all_modes "high vectors"
  b finish
  .ltorg
