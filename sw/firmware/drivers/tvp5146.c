#include "tvp5146.h"

#include "timer.h"

/* Registers of the TVP5146 (TI SLES084C). */
#define REG_INPUT_SELECT 0x00
#define REG_VIDEO_STANDARD 0x02
#define REG_OPERATION_MODE 0x03
#define REG_FORMATTER1 0x33
#define REG_FORMATTER2 0x34
#define REG_STATUS1 0x3A
#define REG_ID_MSB 0x80
#define REG_ID_LSB 0x81

/* Horizontal and vertical lock. With a monochrome camera there is no colour lock. */
#define STATUS1_LOCKED 0x06u

i2c_result_t tvp5146_start(int is_625, uint32_t *id) {
  static const struct {
    uint8_t sub_address, value;
  } kSetup[] = {
      {REG_INPUT_SELECT, 0x05},   /* composite video on VI_2_B, as on TI's evaluation module */
      {REG_FORMATTER1, 0x00},     /* 4:2:2 with embedded syncs */
      {REG_OPERATION_MODE, 0x00}, /* run */
      {REG_FORMATTER2, 0x11},     /* enable data and clock pins */
  };
  uint8_t msb = 0, lsb = 0;
  i2c_result_t result = i2c_read_register(TVP5146_ADDRESS, REG_ID_MSB, &msb);
  if (result == I2C_OK) result = i2c_read_register(TVP5146_ADDRESS, REG_ID_LSB, &lsb);
  *id = (uint32_t)msb << 8 | lsb;
  if (result == I2C_OK)
    result = i2c_write_register(TVP5146_ADDRESS, REG_VIDEO_STANDARD, is_625 ? 2 : 1);
  for (unsigned i = 0; i < sizeof kSetup / sizeof *kSetup && result == I2C_OK; ++i)
    result = i2c_write_register(TVP5146_ADDRESS, kSetup[i].sub_address, kSetup[i].value);
  return result;
}

i2c_result_t tvp5146_wait_lock(uint32_t timeout_ticks, void (*pause)(void)) {
  const uint32_t start = timer_ticks();
  for (;;) {
    uint8_t status = 0;
    const i2c_result_t result = i2c_read_register(TVP5146_ADDRESS, REG_STATUS1, &status);
    if (result != I2C_OK) return result;
    if ((status & STATUS1_LOCKED) == STATUS1_LOCKED) return I2C_OK;
    if (timer_ticks() - start >= timeout_ticks) return I2C_TIMEOUT;
    pause();
  }
}
