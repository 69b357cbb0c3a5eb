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

/** Asks the decoder to keep the number of lines that it has counted in the frame before, for tvp5146_line_count(). */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_keep_line_count(void);

/** Reads the number that was asked for: about 0.25 ms at 400 kHz, up to 1 ms if the decoder takes its time.
 * @param expected the number of lines of a whole frame
 * @param more so many lines more than that, from -128 to 127; unchanged without a result
 * @return I2C_TIMEOUT if the decoder has not got it by then */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_line_count(uint32_t expected, int32_t *more);

#endif
