@ Entry of a program that runs on Linux' EABI: write and exit only.
  .syntax unified
  .arm
  .global _start, _exit, host_write
  .type _start, %function
  .type _exit, %function
  .type host_write, %function
_start:
  ldr sp, =stack_top
  bl run_program
_exit:
  mov r7, #1
  svc #0
host_write:
  push {r7, lr}
  mov r2, r1
  mov r1, r0
  mov r0, #1
  mov r7, #4
  svc #0
  pop {r7, pc}
  .ltorg
  .bss
  .balign 8
  .space 65536
stack_top:
