#include "sw/fovea/exec/flat_machine.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "sw/fovea/exec/exec_caches.h"
#include "sw/fovea/exec/exec_session.h"

namespace fovea::app {

void FlatMemoryPort::submit(cpu::BusAccess& a, Picoseconds at) {
  const std::uint32_t start =
      a.kind == cpu::BusAccess::Kind::kWrap8 ? a.address & ~31u : a.address;
  a.done = true;
  a.first = a.last = at;
  a.error = !holds(start, a.bytes);
  if (a.error) return;
  std::uint8_t* const memory = store_.at(start - base_);
  if (a.write)
    std::memcpy(memory, a.data, a.bytes);
  else
    std::memcpy(a.data, memory, a.bytes);
}

void FlatMemoryPort::sleep_until(Picoseconds until) {
  if (until < slice_end_) return;
  slice_end_ = until + kSlice;
  if (on_slice) on_slice();
}

Picoseconds FlatMemoryPort::wait_for_interrupt(Picoseconds) {
  throw GuestFailure("the program waits for an interrupt, and none can come");
}

bool FlatMemoryPort::debug_read(std::uint32_t pa, std::span<std::uint8_t> to) {
  if (!holds(pa, to.size())) return false;
  std::memcpy(to.data(), store_.at(pa - base_), to.size());
  return true;
}

bool FlatMemoryPort::debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) {
  if (!holds(pa, from.size())) return false;
  std::memcpy(store_.at(pa - base_), from.data(), from.size());
  return true;
}

Result run_flat(const Request& request, const cpu::CpuParams& params, const ExecMap& map,
                    Frequency core_clock) {
  std::array<std::uint8_t, INTERNAL_RAM_BYTES> internal_ram{};
  const auto tcm = std::span(internal_ram).first(map.tcm ? internal_ram.size() : 0);
  FlatMemoryPort port(map.ram_base, map.ram_size);
  cpu::Core core(params, port, tcm, DiagnosticsRef::current());
  ExecSession session(core, port, request, map);
  session.load(port.ram(), tcm);
  session.attach_tools({.params = request.params});
  session.attach(port);
  std::string limit;
  port.on_slice = [&] {
    limit = session.look(core.boundary_time());
    if (request.stop.load() || !limit.empty()) core.request_stop();
    if (session.gdb()) session.gdb()->look();
  };
  core.set_clock(core_clock, 0);
  std::string failure;
  try {
    core.reset(map.table ? preamble_entry(map) : request.program->image.entry(), 0);
    core.run();
  } catch (const GuestFailure& e) {
    failure = e.what();
  }
  if (failure.empty() && !limit.empty() && !session.over()) failure = limit + " reached";
  return session.result(failure);
}

}  // namespace fovea::app
