// Moves its data to RAM, reports that, and exits with 42 if the heap begins after the data.
    .section .vectors, "ax"
    .global _start
_start:
    ldr r0, =data_in_flash
    ldr r1, =data_start
    ldr r2, =data_end
move:
    ldr r3, [r0], #4
    str r3, [r1], #4
    cmp r1, r2
    blo move
    ldr r1, =text
    mov r0, #4              // SYS_WRITE0
    svc 0x123456
    ldr r4, =heap
    ldr r5, =pointer
    str r4, [r5]
    mov r1, r5
    mov r0, #0x16           // SYS_HEAPINFO
    svc 0x123456
    ldr r0, [r4]
    ldr r1, =end_of_data
    cmp r0, r1
    mov r2, #42
    movlo r2, #1
    ldr r1, =status
    str r2, [r1, #4]
    mov r0, #0x20           // SYS_EXIT_EXTENDED
    svc 0x123456
    .data
text: .asciz "from flash\n"
    .align 2
status: .word 0x20026, 0
pointer: .word 0
    .bss
    .align 2
heap: .space 16
