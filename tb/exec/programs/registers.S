/* Writes ones to reserved bits of the SDRAM controller's registers, the only registers that exec
 * has. */
  .global _start
_start:
  ldr r0, =0x20000000
  mov r1, #2
  str r1, [r0, #0x20]
  mvn r1, #0
  str r1, [r0, #0x0C]
  ldr r1, [r0, #4]
  mov r0, #0x18
  ldr r1, =0x20026
  swi 0x123456
