// Register accesses as transactions of AXI4-Lite, one at a time. Knows neither SystemC nor Verilator.
#pragma once
#include <cstdint>

#include "model/engine/rtl/axi_wires.h"

namespace fovea::rtl {

/// The master of a register port. A write hands over address and data together; either may be taken
/// first.
class AxiLite {
 public:
  /// @pre idle(). `strobes`: bytes of the word at `address` that are written
  void write(std::uint32_t address, std::uint32_t data, unsigned strobes) {
    state_ = State::kWrite;
    address_ = address;
    data_ = data;
    strobes_ = strobes;
    address_taken_ = data_taken_ = false;
  }
  void read(std::uint32_t address) {
    state_ = State::kRead;
    address_ = address;
    address_taken_ = false;
  }
  bool idle() const { return state_ == State::kIdle; }
  /// Of the access that ended last.
  bool error() const { return response_ & 2u; }
  std::uint32_t data() const { return data_; }
  void reset() { state_ = State::kIdle; }

  /// What the master drives before a clock edge.
  void drive(LiteWires& wires) const {
    wires.aw.valid = state_ == State::kWrite && !address_taken_;
    wires.w.valid = state_ == State::kWrite && !data_taken_;
    wires.ar.valid = state_ == State::kRead && !address_taken_;
    wires.aw.address = wires.ar.address = address_;
    wires.w.data = data_;
    wires.w.strobes = strobes_;
    wires.b.ready = wires.r.ready = true;
  }
  /// What has happened at the edge.
  void sample(const LiteWires& wires) {
    if (wires.aw.valid && wires.aw.ready) address_taken_ = true;
    if (wires.ar.valid && wires.ar.ready) address_taken_ = true;
    if (wires.w.valid && wires.w.ready) data_taken_ = true;
    if (wires.b.valid && state_ == State::kWrite) {
      response_ = wires.b.response;
      state_ = State::kIdle;
    }
    if (wires.r.valid && state_ == State::kRead) {
      response_ = wires.r.response;
      data_ = wires.r.data;
      state_ = State::kIdle;
    }
  }

 private:
  enum class State { kIdle, kWrite, kRead };
  State state_ = State::kIdle;
  bool address_taken_ = false, data_taken_ = false;
  std::uint32_t address_ = 0, data_ = 0;
  unsigned strobes_ = 0, response_ = 0;
};

}  // namespace fovea::rtl
