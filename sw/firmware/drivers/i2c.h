/* I2C master with polling, at 100 kHz; at 400 kHz if compiled with I2C_FAST. */
#ifndef FOVEA_FIRMWARE_I2C_H
#define FOVEA_FIRMWARE_I2C_H

#include <stdint.h>

typedef enum i2c_result { I2C_OK = 0, I2C_NACK, I2C_TIMEOUT } i2c_result_t;

void i2c_init(void);

/** Writes one register of a device: START, address, sub-address, value, STOP. */
__attribute__((warn_unused_result)) i2c_result_t i2c_write_register(uint32_t device,
                                                                    uint8_t sub_address,
                                                                    uint8_t value);

/** Reads a device register with two transfers (sub-address, then data). */
__attribute__((warn_unused_result)) i2c_result_t i2c_read_register(uint32_t device,
                                                                   uint8_t sub_address,
                                                                   uint8_t *value);

#endif
