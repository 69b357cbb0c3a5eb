// Types of the signals between blocks.
#pragma once
#include <cstdint>
#include <string>
#include <systemc>

#include "model/common/units.h"

namespace fovea {

/// sc_signal requires this function. Frequencies are not written to waveform files.
inline void sc_trace(sc_core::sc_trace_file*, const Frequency&, const std::string&) {}

/// A clock port carries the frequency and no edges: each block computes the edges it needs
/// (clock.h) and restarts its clock when the frequency changes.
using ClockIn = sc_core::sc_in<Frequency>;
using ClockSignal = sc_core::sc_signal<Frequency>;

/// An I2C target device on the board. The I2C controller calls it with local time equal to kernel
/// time.
class I2cTargetIf : public virtual sc_core::sc_interface {
 public:
  virtual bool i2c_start(std::uint8_t address7, bool read) = 0;  ///< true: acknowledged
  virtual bool i2c_write(std::uint8_t byte) = 0;                 ///< true: acknowledged
  virtual std::uint8_t i2c_read() = 0;
  virtual void i2c_stop() = 0;
};

}  // namespace fovea
