// A fake target for GDB protocol and server: four registers, 256 bytes from 0x1000 on.
#pragma once
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "sw/fovea/debug/gdb_server.h"

namespace fovea::app::test {

struct FakeGdbTarget : GdbTarget {
  std::vector<unsigned> numbers = {0, 1, 15, 25};
  std::map<unsigned, std::uint32_t> values = {{0, 0x11223344}, {1, 1}, {15, 0x8000}, {25, 0xD3}};
  std::vector<std::uint8_t> memory = std::vector<std::uint8_t>(256);
  std::vector<std::string> points;
  std::string asked;
  std::span<const unsigned> registers() const override { return numbers; }
  std::optional<std::uint32_t> read_register(unsigned n) const override {
    const auto found = values.find(n);
    return found == values.end() ? std::nullopt : std::optional(found->second);
  }
  bool write_register(unsigned n, std::uint32_t v) override {
    if (!values.contains(n) || n == 25) return false;
    values[n] = v;
    return true;
  }
  bool inside(std::uint32_t a, std::size_t n) const {
    return a >= 0x1000 && a - 0x1000 + n <= memory.size();
  }
  bool read_memory(std::uint32_t a, std::span<std::uint8_t> to) override {
    if (!inside(a, to.size())) return false;
    std::copy_n(memory.begin() + (a - 0x1000), to.size(), to.begin());
    return true;
  }
  bool write_memory(std::uint32_t a, std::span<const std::uint8_t> from) override {
    if (!inside(a, from.size())) return false;
    std::copy(from.begin(), from.end(), memory.begin() + (a - 0x1000));
    return true;
  }
  bool set_point(Point k, std::uint32_t a, std::uint32_t n) override {
    points.push_back(std::to_string(static_cast<int>(k)) + ":" + std::to_string(a) + ":" +
                     std::to_string(n));
    return true;
  }
  bool clear_point(Point, std::uint32_t, std::uint32_t) override {
    if (!points.empty()) points.pop_back();
    return true;
  }
  void clear_all_points() override { points.clear(); }
  std::string target_xml() const override { return std::string(10'000, 't') + "}#$*end"; }
  std::string memory_map_xml() const override { return "map"; }
  std::string monitor(const std::string& command) override {
    asked = command;
    return std::string(2500, 'm');
  }
};

}  // namespace fovea::app::test
