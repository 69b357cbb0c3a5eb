// A machine with a debugger's view.
#pragma once
#include <array>
#include <cstring>
#include <span>

#include "model/cpu/core/debug.h"
#include "tb/iss/machine.h"

namespace fovea::cpu::test {

inline constexpr std::uint32_t kData = kMemory + 0x1000;

struct DebugMachine : Machine, DebugMemory {
  CoreDebug debug{core, *this};
  bool debug_read(std::uint32_t pa, std::span<std::uint8_t> to) override {
    if (!port.mapped(pa, static_cast<unsigned>(to.size()))) return false;
    std::memcpy(to.data(), port.at(pa), to.size());
    return true;
  }
  bool debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) override {
    if (!port.mapped(pa, static_cast<unsigned>(from.size()))) return false;
    std::memcpy(port.at(pa), from.data(), from.size());
    return true;
  }
  std::uint32_t get(std::uint32_t va) {
    std::array<std::uint8_t, 4> b{};
    EXPECT_TRUE(debug.read(va, b));
    std::uint32_t v;
    std::memcpy(&v, b.data(), 4);
    return v;
  }
  void put(std::uint32_t va, std::uint32_t v) {
    std::array<std::uint8_t, 4> b;
    std::memcpy(b.data(), &v, 4);
    EXPECT_TRUE(debug.write(va, b));
  }
};

}  // namespace fovea::cpu::test
