// Values that travel on sc_signals between blocks.
#pragma once
#include <cstdint>
#include <string>
#include <systemc>

#include "model/common/units.h"

namespace fovea {

/// sc_signal<Frequency> wants a tracer; a frequency is no waveform.
inline void sc_trace(sc_core::sc_trace_file*, const Frequency&, const std::string&) {}

/// A clock is a port that carries its frequency, not its edges: blocks number the edges themselves
/// (clock.h) and restart when the value changes.
using ClockIn = sc_core::sc_in<Frequency>;
using ClockSignal = sc_core::sc_signal<Frequency>;

/// One I2C target device on the board. Called by the controller in kernel time.
class I2cTargetIf : public virtual sc_core::sc_interface {
 public:
  virtual bool i2c_start(std::uint8_t address7, bool read) = 0;  ///< true: acknowledged
  virtual bool i2c_write(std::uint8_t byte) = 0;                 ///< true: acknowledged
  virtual std::uint8_t i2c_read() = 0;
  virtual void i2c_stop() = 0;
};

}  // namespace fovea
