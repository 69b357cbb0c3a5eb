#include "i2c.h"

#include "../mmio.h"
#include "../regs.h"
#include "timer.h"

/* 24 MHz / (2 + 1) = 8 MHz module clock; an SCL period is (35 + 5) + (35 + 5) = 80 of its clocks:
 * 100 kHz. With I2C_FAST it is (5 + 5) + (5 + 5) = 20 of them: 400 kHz, as in Linux's
 * board-dm365-evm.c. */
#define PRESCALER 2u
#ifdef I2C_FAST
#define CLOCK_LOW 5u
#define CLOCK_HIGH 5u
#else
#define CLOCK_LOW 35u
#define CLOCK_HIGH 35u
#endif
/* A byte takes 90 us; a device may stretch the clock. */
#define TIMEOUT_TICKS (20u * TIMER_TICKS_PER_MS)

void i2c_init(void) {
  mmio_write32(I2C_ICMDR, 0);
  mmio_write32(I2C_ICPSC, PRESCALER);
  mmio_write32(I2C_ICCLKL, CLOCK_LOW);
  mmio_write32(I2C_ICCLKH, CLOCK_HIGH);
  mmio_write32(I2C_ICIMR, 0);
  mmio_write32(I2C_ICMDR, ICMDR_IRS);
}

/* Waits for a status bit. A NACK ends the wait. */
static i2c_result_t wait_status(uint32_t bit) {
  const uint32_t start = timer_ticks();
  for (;;) {
    const uint32_t status = mmio_read32(I2C_ICSTR);
    if ((status & ICSTR_NACK) != 0) return I2C_NACK;
    if ((status & bit) != 0) return I2C_OK;
    if (timer_ticks() - start > TIMEOUT_TICKS) return I2C_TIMEOUT;
  }
}

static i2c_result_t wait_bus_free(void) {
  const uint32_t start = timer_ticks();
  while ((mmio_read32(I2C_ICSTR) & ICSTR_BB) != 0)
    if (timer_ticks() - start > TIMEOUT_TICKS) return I2C_TIMEOUT;
  return I2C_OK;
}

/* After a failure: a STOP if the controller owns the bus, then a reset of the controller. */
static i2c_result_t fail(i2c_result_t result) {
  mmio_modify32(I2C_ICMDR, 0, ICMDR_STP);
  i2c_result_t ignored = wait_bus_free();
  (void)ignored;
  i2c_init();
  return result;
}

static i2c_result_t transfer_begin(uint32_t device, uint32_t bytes, uint32_t direction) {
  const i2c_result_t result = wait_bus_free();
  if (result != I2C_OK) return result;
  mmio_write32(I2C_ICSTR, ICSTR_NACK | ICSTR_ARDY | ICSTR_SCD | ICSTR_AL);
  mmio_write32(I2C_ICSAR, device);
  mmio_write32(I2C_ICCNT, bytes);
  mmio_write32(I2C_ICMDR, ICMDR_FREE | ICMDR_IRS | ICMDR_MST | direction | ICMDR_STT | ICMDR_STP);
  return I2C_OK;
}

static i2c_result_t write_bytes(uint32_t device, const uint8_t *bytes, uint32_t count) {
  i2c_result_t result = transfer_begin(device, count, ICMDR_TRX);
  for (uint32_t i = 0; i < count && result == I2C_OK; ++i) {
    result = wait_status(ICSTR_ICXRDY);
    if (result == I2C_OK) mmio_write32(I2C_ICDXR, bytes[i]);
  }
  if (result == I2C_OK) result = wait_status(ICSTR_SCD);
  return result == I2C_OK ? I2C_OK : fail(result);
}

i2c_result_t i2c_write_register(uint32_t device, uint8_t sub_address, uint8_t value) {
  const uint8_t bytes[2] = {sub_address, value};
  return write_bytes(device, bytes, 2);
}

i2c_result_t i2c_read_register(uint32_t device, uint8_t sub_address, uint8_t *value) {
  i2c_result_t result = write_bytes(device, &sub_address, 1);
  if (result != I2C_OK) return result;
  result = transfer_begin(device, 1, 0);
  if (result == I2C_OK) result = wait_status(ICSTR_ICRRDY);
  if (result == I2C_OK) *value = (uint8_t)mmio_read32(I2C_ICDRR);
  if (result == I2C_OK) result = wait_status(ICSTR_SCD);
  return result == I2C_OK ? I2C_OK : fail(result);
}
