@ Starts at power-up in internal RAM, sets up UART0 and obeys what is typed:
@ q ends by semihosting with status 0, x with status 5; h branches to itself, w waits for an interrupt;
@ i does the same as h with interrupts enabled; a loads from an address where nothing is;
@ everything else is sent back.
    .syntax unified
    .arm
    .equ UART0, 0x01C20000
    .equ PSC, 0x01C41000
    .equ AINTC, 0x01C48000

    .section .text
    .global _start
_start:
    b reset
    .rept 7
    .word 0xE7F000F0
    .endr

    .type reset, %function
reset:
    ldr r0, =PSC
    mov r1, #3
    str r1, [r0, #0xA4C]             @ MDCTL19: UART0 on
    mov r1, #1
    str r1, [r0, #0x120]             @ PTCMD
1:  ldr r1, [r0, #0x128]             @ PTSTAT
    tst r1, #1
    bne 1b
    ldr r4, =UART0
    mov r1, #13                      @ 115200 baud from 24 MHz
    str r1, [r4, #0x20]
    mov r1, #0
    str r1, [r4, #0x24]
    mov r1, #1                       @ FIFOs
    str r1, [r4, #0x08]
    mov r1, #3                       @ 8N1
    str r1, [r4, #0x0C]
    ldr r1, =0x6001
    str r1, [r4, #0x30]
    adr r5, ready
2:  ldrb r0, [r5], #1
    cmp r0, #0
    beq obey
    bl send
    b 2b

    .type obey, %function
obey:
    ldr r1, [r4, #0x14]              @ LSR
    tst r1, #1
    beq obey
    ldr r0, [r4]
    cmp r0, #'q'
    beq quit
    cmp r0, #'x'
    beq fail
    cmp r0, #'h'
    beq halt
    cmp r0, #'i'
    beq idle
    cmp r0, #'w'
    beq sleep
    cmp r0, #'a'
    beq abort
    bl send
    b obey

    .type send, %function
send:
    ldr r1, [r4, #0x14]
    tst r1, #0x20
    beq send
    str r0, [r4]
    bx lr

    .type quit, %function
quit:
    ldr r1, [r4, #0x14]
    tst r1, #0x40                    @ until the last byte has left
    beq quit
    mov r0, #0x18
    ldr r1, =0x20026
    svc 0x123456
    .type fail, %function
fail:
    mov r0, #0x20                    @ extended: with a status
    adr r1, five
    svc 0x123456
    .type halt, %function
halt:
    b .
    .type idle, %function
idle:
    ldr r1, =AINTC
    mov r0, #1
    str r0, [r1, #0x18]              @ EINT0: one source that never comes
    msr cpsr_c, #0x13
    b .
    .type sleep, %function
sleep:
    mov r0, #0
    mcr p15, 0, r0, c7, c0, 4
    b sleep
    .type abort, %function
abort:
    mov r0, #0x50000000
    ldr r0, [r0]
    b obey
    .align 2
five: .word 0x20026, 5
ready: .asciz "ready\r\n"
