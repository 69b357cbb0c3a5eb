// A core with flat memory from address 0 on that runs the programs of system/ like QEMU's
// versatilepb (RAM, two lines of the interrupt controller, semihosting).
#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/cpu/core/core.h"
#include "tb/iss/assembler.h"
#include "tb/iss/flat_port.h"

namespace fovea::cpu::test {

/// A FlatPort with the PL190 at 0x10140000: line 0 is IRQ, line 1 is FIQ, both raised by software.
class SystemPort : public FlatPort {
 public:
  static constexpr std::uint32_t kVic = 0x1014'0000;
  Core* core = nullptr;
  std::function<void(BusAccess&)> before, after;  ///< called for each access, used to plant defects

  using FlatPort::FlatPort;
  void submit(BusAccess& a, Picoseconds t) override {
    if (before) before(a);
    if ((a.address & ~0xFFFu) != kVic) {
      FlatPort::submit(a, t);
      if (after && a.done) after(a);
      return;
    }
    a.done = true;
    a.error = false;
    a.first = a.last = t + write_latency;
    if (!a.write) {
      std::memset(a.data, 0, sizeof a.data);
      return;
    }
    std::uint32_t v = 0;
    std::memcpy(&v, a.data, 4);
    switch (a.address & 0xFFFu) {
      case 0x0C:
        select_ = v;
        break;
      case 0x10:
        enable_ |= v;
        break;
      case 0x18:
        raised_ |= v;
        break;
      case 0x1C:
        raised_ &= ~v;
        break;
      default:
        throw std::logic_error("no such register of the interrupt controller");
    }
    core->set_irq(raised_ & enable_ & ~select_, a.last);
    core->set_fiq(raised_ & enable_ & select_, a.last);
  }

 private:
  std::uint32_t raised_ = 0, enable_ = 0, select_ = 0;
};

enum class Caches : std::uint32_t { kNone, kI, kD, kBoth };
inline constexpr const char* kCacheNames[] = {"no caches", "I-cache", "D-cache", "both caches"};

class SystemMachine {
 public:
  static constexpr std::size_t kBytes = 32u << 20;
  static constexpr std::uint32_t kPrelude = 0x01F0'0000, kOptions = 0x40;
  struct Params : CpuParams {
    Params() {
      ParamSet set;
      set.add(*this);
    }
  } params;
  SystemPort port{0, kBytes};
  std::vector<std::uint8_t> tcm = std::vector<std::uint8_t>(32 * 1024);
  Core core;
  std::string output;
  int exit_status = -1;

  SystemMachine() : core(params, port, tcm, {}) {
    port.core = &core;
    port.attach(&core);
    core.set_clock(Frequency(250'000'000), 0);
    handling_ = core.handle_swi([this](Core& c, std::uint32_t n) { return semihosting(c, n); });
  }
  void load(std::uint32_t address, const std::vector<std::uint8_t>& bytes) {
    if (!port.mapped(address, static_cast<unsigned>(bytes.size())))
      throw std::runtime_error("the image is larger than the memory");
    std::memcpy(port.at(address), bytes.data(), bytes.size());
  }
  /// Runs the program at 0, with internal RAM disabled, until it exits. @return its output
  const std::string& run(Caches caches) {
    static const Program prelude = assemble(
        " mov r0, #0x18\n mcr p15, 0, r0, c9, c1, 1\n orr r0, r0, #0x10000\n"
        " mcr p15, 0, r0, c9, c1, 0\n mov pc, #0\n",
        kPrelude);
    load(kPrelude, prelude.bytes);
    port.set_word(kOptions, static_cast<std::uint32_t>(caches));
    port.schedule(2'000 * kPsPerMs, [] { throw std::runtime_error("the program does not end"); });
    core.reset(kPrelude, 0);
    core.run();
    return output;
  }
  std::uint8_t byte(std::uint32_t a) {
    std::uint8_t b = 0;
    return core.peek(a, b) ? b : *port.at(a);
  }

 private:
  /// SYS_OPEN, SYS_WRITE, SYS_EXIT. @return false for an ordinary SWI
  bool semihosting(Core& c, std::uint32_t number) {
    if (number != 0x123456) return false;
    const auto word = [&](std::uint32_t at) {
      std::uint32_t v = 0;
      for (unsigned k = 0; k < 4; ++k) v |= std::uint32_t{byte(at + k)} << (8 * k);
      return v;
    };
    switch (c.reg(0)) {
      case 0x01:
        c.set_reg(0, 1);
        break;
      case 0x05: {
        const std::uint32_t from = word(c.reg(1) + 4), bytes = word(c.reg(1) + 8);
        for (std::uint32_t k = 0; k < bytes; ++k) output += static_cast<char>(byte(from + k));
        c.set_reg(0, 0);
        break;
      }
      case 0x18:
        exit_status = c.reg(1) == 0x20026 ? 0 : 1;
        c.request_stop();
        break;
      default:
        throw std::runtime_error("no such semihosting operation");
    }
    return true;
  }

  Subscription handling_;
};

}  // namespace fovea::cpu::test
