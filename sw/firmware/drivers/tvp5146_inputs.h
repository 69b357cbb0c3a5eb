/* Several cameras on the inputs of the TVP5146. */
#ifndef FOVEA_FIRMWARE_TVP5146_INPUTS_H
#define FOVEA_FIRMWARE_TVP5146_INPUTS_H

#include "tvp5146.h"

#define TVP5146_NTSC 1u
#define TVP5146_PAL 2u

typedef struct tvp5146_state {
  int signal;        /* there is a signal on the input */
  int locked;        /* to line and field syncs */
  int lost;          /* a lock was lost since tvp5146_clear_lost() */
  uint32_t standard; /* if locked: TVP5146_NTSC, TVP5146_PAL or another code of register 3F */
} tvp5146_state_t;

/** Lets the decoder find the standard by itself. */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_autoswitch(void);

/** Selects an input (a code of register 00). Another one than before has to be locked to anew. */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_select(uint8_t input);

/** Reads the state, two registers: about 0.25 ms at 400 kHz. */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_look(tvp5146_state_t *state);

__attribute__((warn_unused_result)) i2c_result_t tvp5146_clear_lost(void);

#endif
