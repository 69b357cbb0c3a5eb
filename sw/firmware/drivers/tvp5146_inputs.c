#include "tvp5146_inputs.h"

/* Registers of the TVP5146 (TI SLES084C; the last two: TI SLES140, Linux tvp514x_regs.h). */
#define REG_INPUT_SELECT 0x00
#define REG_VIDEO_STANDARD 0x02
#define REG_CLEAR_LOST_LOCK 0x39
#define REG_STATUS1 0x3A
#define REG_STATUS2 0x3B
#define REG_DETECTED 0x3F
#define REG_STATUS_REQUEST 0x97
#define REG_LINE_COUNT_LSB 0x9A

#define STATUS1_LOCKED 0x06u /* horizontal and vertical; with a monochrome camera there is no colour lock */
#define STATUS1_LOST 0x10u
#define STATUS2_SIGNAL 0x80u
#define STATUS_REQUEST_PENDING 1u
#define LOOKS_FOR_LINE_COUNT 8

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

i2c_result_t tvp5146_keep_line_count(void) {
  return i2c_write_register(TVP5146_ADDRESS, REG_STATUS_REQUEST, STATUS_REQUEST_PENDING);
}

i2c_result_t tvp5146_line_count(uint32_t expected, int32_t *more) {
  uint8_t value = STATUS_REQUEST_PENDING;
  for (unsigned looks = 0; looks < LOOKS_FOR_LINE_COUNT; ++looks) {
    i2c_result_t result = i2c_read_register(TVP5146_ADDRESS, REG_STATUS_REQUEST, &value);
    if (result == I2C_OK && (value & STATUS_REQUEST_PENDING) != 0) continue;
    /* The low part is enough: no frame that was captured lacks more than a hundred lines. */
    if (result == I2C_OK) result = i2c_read_register(TVP5146_ADDRESS, REG_LINE_COUNT_LSB, &value);
    if (result == I2C_OK) *more = (int8_t)(uint8_t)(value - expected);
    return result;
  }
  return I2C_TIMEOUT;
}
