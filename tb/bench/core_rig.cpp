#include "tb/bench/core_rig.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace fovea::cpu {

void QuietPort::submit(BusAccess& a, Picoseconds at) {
  const std::uint32_t start = a.kind == BusAccess::Kind::kWrap8 ? a.address & ~31u : a.address;
  a.error = std::uint64_t{start} + a.bytes > memory.size();
  if (!a.error && a.write) std::memcpy(memory.data() + start, a.data, a.bytes);
  if (!a.error && !a.write) std::memcpy(a.data, memory.data() + start, a.bytes);
  a.first = at + (a.write ? kWrite : kRead);
  a.last = a.first + (a.bytes > 4 ? a.bytes / 4 - 1 : 0) * kBeat;
  a.done = true;
}

Picoseconds QuietPort::wait_for_interrupt(Picoseconds) {
  throw std::runtime_error("the program sleeps, and there is no interrupt");
}

CoreRig::CoreRig(const std::string& elf, std::uint64_t clocks) : core(params, port, tcm, {}) {
  std::ifstream file(elf, std::ios::binary);
  if (!file) throw std::runtime_error("the file cannot be read");
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  const auto word = [&bytes](std::size_t at) {
    std::uint32_t v;
    if (at + 4 > bytes.size()) throw std::runtime_error("not an ELF file, or cut short");
    std::memcpy(&v, bytes.data() + at, 4);
    return v;
  };
  if (word(0) != 0x464C457Fu) throw std::runtime_error("not an ELF file");
  const std::uint32_t headers = word(28), count = word(44) & 0xFFFFu;
  for (std::uint32_t h = headers; h < headers + 32 * count; h += 32) {
    if (word(h) != 1) continue;  // PT_LOAD
    const std::uint32_t offset = word(h + 4), to = word(h + 12), size = word(h + 16);
    if (std::uint64_t{to} + size > port.memory.size() || std::size_t{offset} + size > bytes.size())
      throw std::runtime_error("a segment lies outside memory");
    std::memcpy(port.memory.data() + to, bytes.data() + offset, size);
  }
  port.core = &core;
  if (clocks) port.limit = clocks * kClock;
  core.set_clock(Frequency(kPsPerSecond / kClock), 0);
  exit_ = core.handle_swi([](Core& c, std::uint32_t number) {
    if (number != 0x123456u) return false;
    c.request_stop();
    return true;
  });
  core.reset(word(24), 0);
}

}  // namespace fovea::cpu
