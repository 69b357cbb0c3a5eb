#include "tvp5146_inputs.h"

/* Registers of the TVP5146 (TI SLES084C). */
#define REG_INPUT_SELECT 0x00
#define REG_VIDEO_STANDARD 0x02
#define REG_CLEAR_LOST_LOCK 0x39
#define REG_STATUS1 0x3A
#define REG_STATUS2 0x3B
#define REG_DETECTED 0x3F

#define STATUS1_LOCKED 0x06u /* horizontal and vertical; with a monochrome camera there is no colour lock */
#define STATUS1_LOST 0x10u
#define STATUS2_SIGNAL 0x80u

i2c_result_t tvp5146_autoswitch(void) {
  return i2c_write_register(TVP5146_ADDRESS, REG_VIDEO_STANDARD, 0);
}

i2c_result_t tvp5146_select(uint8_t input) {
  return i2c_write_register(TVP5146_ADDRESS, REG_INPUT_SELECT, input);
}

i2c_result_t tvp5146_look(tvp5146_state_t *state) {
  uint8_t status = 0, second = STATUS2_SIGNAL, standard = 0;
  i2c_result_t result = i2c_read_register(TVP5146_ADDRESS, REG_STATUS1, &status);
  const int locked = (status & STATUS1_LOCKED) == STATUS1_LOCKED;
  /* A lock implies a signal, and without a lock there is no standard. */
  if (result == I2C_OK && locked)
    result = i2c_read_register(TVP5146_ADDRESS, REG_DETECTED, &standard);
  else if (result == I2C_OK)
    result = i2c_read_register(TVP5146_ADDRESS, REG_STATUS2, &second);
  *state = (tvp5146_state_t){.signal = (second & STATUS2_SIGNAL) != 0,
                             .locked = locked,
                             .lost = (status & STATUS1_LOST) != 0,
                             .standard = standard};
  return result;
}

i2c_result_t tvp5146_clear_lost(void) {
  return i2c_write_register(TVP5146_ADDRESS, REG_CLEAR_LOST_LOCK, 1);
}
