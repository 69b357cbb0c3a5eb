// What the C programs of this folder share: tables, probes and the log.
#pragma once
#include <stdint.h>

enum { kTestVa = 0x40000000, kTestPa = 0x00500000, kTables = 0x00400000 };

/// Names the case that follows.
void begin(const char *name);
/// A record with these in r0 to r3.
void note(uint32_t a, uint32_t b, uint32_t c, uint32_t d);
/// Formatted names: the text is made once and stays.
const char *name3(const char *head, uint32_t a, uint32_t b, uint32_t c);

/// Identity map, domain 0 client, all else absent; caches as `options` says.
void mmu_on(void);
uint32_t *level1(uint32_t va);
/// Makes the tables' new content hold: caches clean and empty, TLB empty.
void refresh(void);
uint32_t cached(void);  ///< C and B bits that test pages get: 0, or write-back if caches are on

typedef void fragment(void);
/// Runs a fragment with r1 = va in user mode or in supervisor mode; what it leaves in r0 comes
/// back.
uint32_t probe(fragment *what, uint32_t va, int user);
fragment read_word, read_byte, read_half, write_word, write_byte, write_half, run_there,
    run_thumb_there, read_double, write_double, read_many, write_many, swap_word, swap_byte,
    read_word_as_user, write_word_as_user, read_byte_as_user, write_byte_as_user, touch_nothing;

uint32_t control(void);
void set_control(uint32_t v);
void set_domains(uint32_t v);
void set_pid(uint32_t v);
void set_table(uint32_t v);
void clear_status(void);  ///< DFSR, IFSR and FAR to 0
void drop_entry(uint32_t va);
