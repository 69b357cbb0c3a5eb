@ Banks, MSR and MRS with every field mask, LDM and STM of the user's registers, exception returns.
#include "returns.inc"

@ r0 without the bits that ARMv5 reserves.
.macro reserve
  bic r0, r0, #0x07f00000
  bic r0, r0, #0x000ff000
  bic r0, r0, #0x00000f00
.endm

@ All banks by pattern \seed.
.macro set_banks seed
  .irp mode, 0xd1, 0xd2, 0xd3, 0xd7, 0xdb, 0xdf
  msr cpsr_c, #\mode
  mov r13, #\mode
  add r13, r13, #\seed
  mvn r14, r13
  .if \mode == 0xd1 || \mode == 0xdf
  add r8, r13, #0x01000000
  add r9, r13, #0x02000000
  add r10, r13, #0x03000000
  add r11, r13, #0x04000000
  add r12, r13, #0x05000000
  .endif
  .if \mode != 0xdf
  mov r0, #(0xf8000000 & ((\seed * \mode) << 12))
  orr r0, r0, #(\mode & 0xdf)
  msr spsr_cxsf, r0
  .endif
  .endr
.endm

.macro masks_of psr, value
  .irp fields, c, x, s, f, cx, cs, cf, xs, xf, sf, cxs, cxf, csf, xsf, cxsf
  ldr r1, =\value
  msr \psr\()_\fields, r1
  mrs r0, \psr
  reserve
  svc #0x91
  .endr
  .irp fields, f, c, cf
  .ifc \psr, cpsr
  msr cpsr_\fields, #0xd3
  .else
  msr \psr\()_\fields, #0x60000000
  .endif
  mrs r0, \psr
  reserve
  svc #0x91
  .endr
  b 5f
  .ltorg
5:
.endm

@ MSR to the CPSR with a control field must stay in a mode that exists.
.macro status_of mode
  svc #(0x40 | \mode)
  masks_of cpsr, (0xa8000000 | 0xc0 | \mode)
  svc #(0x40 | \mode)
  masks_of cpsr, (0x50000000 | \mode)
  svc #(0x40 | \mode)
  .if \mode != 0x10 && \mode != 0x1f
  masks_of spsr, 0xf80000df
  masks_of spsr, 0x00000010
  masks_of spsr, 0xa800007b
  .endif
  svc #0x53
.endm

@ User mode cannot change the control field: not the mode, not the masks.
.macro status_of_user
  svc #0x50
  .irp value, 0xf80000d3, 0x000000d3, 0xf800001f, 0xa8000010, 0x500000f7
  masks_of cpsr, \value
  .endr
  svc #0x53
.endm

@ LDM and STM with ^ and without the pc act on the user's registers.
.macro user_bank mode
  case "user bank from mode \mode"
  set_banks \mode
  svc #(0x40 | \mode)
  ldr r1, =memory
  .irp list, "{r0, r8-r14}", "{r13}", "{r14}", "{r8, r12, r14}", "{r2, r3, r13}"
  stmia r1, \list ^
  stmia r1, \list ^
  ldmia r1, {r2-r7}
  svc #0x91
  stmdb r1, \list ^
  stmib r1, \list ^
  stmda r1, \list ^
  .endr
  ldr r1, =words
  .irp list, "{r0, r8-r14}", "{r13}", "{r2, r14}", "{r8, r12, r14}", "{r2, r3, r13}"
  add r1, r1, #4
  ldmia r1, \list ^
  nop
  svc #0x80
  ldmdb r1, \list ^
  nop
  svc #0x80
  bkpt #1
  ldmib r1, \list ^
  nop
  ldmda r1, \list ^
  nop
  svc #0x80
  .endr
  @ The base has the same number as a register of the list: the user's goes out and comes in.
  .irp base, r13, r14
  ldr \base, =memory
  stmdb \base, {\base}^
  stmia \base, {\base}^
  stmib \base, {r2, r13, r14}^
  ldr r1, =memory
  sub r1, r1, #4
  ldmia r1, {r2-r7}
  svc #0x91
  ldr \base, =words
  ldmia \base, {\base}^
  nop
  svc #0x80
  ldmib \base, {r2, r13, r14}^
  nop
  svc #0x80
  bkpt #1
  .endr
  svc #0x53
  b 5f
  .ltorg
5:
.endm

  .text
  .global program
program:
  bl mmu_on
  bl fill_registers
  msr cpsr_f, #0
  @ MSR in each mode, seen from each mode.
  .irp seed, 0x100, 0x4200
  case "banks \seed"
  set_banks \seed
  svc #0x80
  .irp mode, 0x10, 0x11, 0x12, 0x13, 0x17, 0x1b, 0x1f
  svc #(0x40 | \mode)
  svc #0x80
  bkpt #0
  .inst 0xe7f000f0
  .endr
  svc #0x53
  .endr
  .irp mode, 0x11, 0x12, 0x13, 0x17, 0x1b, 0x1f
  case "status registers in mode \mode"
  status_of \mode
  .endr
  case "status register in user mode"
  status_of_user
  .irp mode, 0x11, 0x12, 0x13, 0x17, 0x1b
  user_bank \mode
  .endr
  from_exception_modes "movs pc, lr", movs_pc
  from_exception_modes "subs pc, lr", subs_pc
  from_exception_modes "movs pc with a shift", shifted_pc
  from_exception_modes "ldmia with pc and ^", ldm_pc
  from_exception_modes "ldmdb with pc and ^", ldmdb_pc
  from_exception_modes "ldmib with pc and ^", ldmib_pc
  from_exception_modes "ldmda with pc and ^", ldmda_pc
  b finish
  .ltorg

  .data
  .space 64
memory:
  .space 64
words:
  .irp k, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19
  .word 0xabc00000 + 0x1111 * \k
  .endr
