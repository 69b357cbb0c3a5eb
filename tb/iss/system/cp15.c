// CP15 and other coprocessors: values read back, undefined accesses, and accesses forbidden in user
// mode.
#include "support.h"

#define READ(op1, n, m, op2)                                                                      \
  do {                                                                                            \
    uint32_t v = 0xDEADBEEF;                                                                      \
    __asm__ volatile("mrc p15, " #op1 ", %0, c" #n ", c" #m ", " #op2 : "+r"(v)::"lr", "memory"); \
    note(v, 0, 0, 0);                                                                             \
  } while (0)
#define WRITE(op1, n, m, op2, value) \
  __asm__ volatile("mcr p15, " #op1 ", %0, c" #n ", c" #m ", " #op2 ::"r"(value) : "lr", "memory")

#define READ_THEN(op1, n, m, op2, mask)                                                           \
  do {                                                                                            \
    uint32_t v;                                                                                   \
    __asm__ volatile("mrc p15, " #op1 ", %0, c" #n ", c" #m ", " #op2 : "=r"(v)::"lr", "memory"); \
    note(v &(mask), 0, 0, 0);                                                                     \
  } while (0)

fragment user_reads_id, user_reads_control, user_writes_domains, user_drains, user_invalidates,
    user_reads_far, user_waits, user_moves_flags;
extern const uint32_t odd_words[], odd_words_end[];

/// Runs one instruction in supervisor or user mode; it does not touch the banks.
void run_word(uint32_t word, int user);

void program(void) {
  mmu_on();
  begin("identity");
  READ(0, 0, 0, 0);
  READ(0, 0, 0, 3);
  READ(0, 0, 0, 7);
  begin("cache type");
  READ(0, 0, 0, 1);
  begin("TCM status");
  READ(0, 0, 0, 2);
  begin("control");
  const uint32_t control_now = control();
  READ_THEN(0, 1, 0, 0, 0x0000E383u);
  for (unsigned bit = 0; bit < 16; ++bit) {
    // B, S, R, RR and L4; M, C, I and V would move what runs here, A is in aborts.S.
    if (!(0xC380u >> bit & 1)) continue;
    if (bit == 7) continue;
    set_control(control_now | 1u << bit);
    READ_THEN(0, 1, 0, 0, 0x0000E383u);
    set_control(control_now);
    READ_THEN(0, 1, 0, 0, 0x0000E383u);
  }
  begin("table base and domains");
  READ(0, 2, 0, 0);
  for (uint32_t v = 0x55555555u; v; v <<= 2) {
    set_domains(v | 1u);
    READ(0, 3, 0, 0);
  }
  set_domains(1);
  begin("status and address");
  for (uint32_t k = 0; k < 8; ++k) {
    const uint32_t fsr = (k * 0x25u) & 0xFFu, far = k * 0x12345679u;
    WRITE(0, 5, 0, 0, fsr);
    WRITE(0, 5, 0, 1, fsr ^ 0xFFu);
    WRITE(0, 6, 0, 0, far);
    READ(0, 5, 0, 0);
    READ(0, 5, 0, 1);
    READ(0, 6, 0, 0);
  }
  clear_status();
  begin("process and context");
  READ(0, 13, 0, 0);
  WRITE(0, 13, 0, 1, 0x12345678u);
  READ(0, 13, 0, 1);
  begin("cache operations");
  const uint32_t va = kTestPa;
  WRITE(0, 7, 5, 0, 0);
  WRITE(0, 7, 5, 1, va);
  WRITE(0, 7, 6, 1, va);
  WRITE(0, 7, 10, 1, va);
  WRITE(0, 7, 10, 4, 0);
  WRITE(0, 7, 14, 1, va);
  WRITE(0, 8, 7, 0, 0);
  WRITE(0, 8, 5, 0, 0);
  WRITE(0, 8, 6, 0, 0);
  WRITE(0, 8, 7, 1, va);
  WRITE(0, 8, 5, 1, va);
  WRITE(0, 8, 6, 1, va);
  begin("to the flags");
  for (uint32_t k = 0; k < 4; ++k) {
    uint32_t flags;
    WRITE(0, 6, 0, 0, k * 0x5A000000u + 0x90000000u);
    __asm__ volatile("mrc p15, 0, r15, c6, c0, 0\n mrs %0, cpsr" : "=r"(flags)::"cc", "memory");
    note(flags & 0xF80000FFu, 0, 0, 0);
  }
  clear_status();
  for (const uint32_t *w = odd_words; w != odd_words_end; ++w)
    for (int user = 0; user < 2; ++user) {
      begin(name3(user ? "in user mode" : "privileged", *w, 0, 0));
      run_word(*w, user);
    }
}
