// Shared functions of the C programs in this folder: tables, probes and the log.
#pragma once
#include <stdint.h>

enum { kTestVa = 0x40000000, kTestPa = 0x00500000, kTables = 0x00400000 };

/// Starts a case with this name in the log.
void begin(const char *name);
/// Logs a record with these words as r0 to r3.
void note(uint32_t a, uint32_t b, uint32_t c, uint32_t d);
/// Formats a name, which stays allocated.
const char *name3(const char *head, uint32_t a, uint32_t b, uint32_t c);

/// Identity map, domain 0 as client, everything else absent; caches as selected by `options`.
void mmu_on(void);
uint32_t *level1(uint32_t va);
/// Makes new contents of the tables effective: caches are cleaned and invalidated, the TLB is
/// invalidated.
void refresh(void);
uint32_t cached(void);  ///< C and B bits of test pages: 0, or write-back if caches are on

typedef void fragment(void);
/// Runs a fragment with r1 = va in user or supervisor mode, and returns what it leaves in r0.
uint32_t probe(fragment *what, uint32_t va, int user);
fragment read_word, read_byte, read_half, write_word, write_byte, write_half, run_there,
    run_thumb_there, read_double, write_double, read_many, write_many, swap_word, swap_byte,
    read_word_as_user, write_word_as_user, read_byte_as_user, write_byte_as_user, touch_nothing;

uint32_t control(void);
void set_control(uint32_t v);
void set_domains(uint32_t v);
void set_pid(uint32_t v);
void set_table(uint32_t v);
void clear_status(void);  ///< sets DFSR, IFSR and FAR to 0
void drop_entry(uint32_t va);
