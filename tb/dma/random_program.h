// Random programs for the EDMA: register writes, events, and the order of the controller's steps.
#pragma once
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace fovea::dma {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  unsigned below(unsigned n) { return static_cast<unsigned>(engine_() % n); }
  int between(int low, int high) {
    return low + static_cast<int>(below(static_cast<unsigned>(high - low + 1)));
  }
  bool percent(unsigned p) { return below(100) < p; }
  template <class T>
  const T& of(const std::vector<T>& v) {
    return v[below(static_cast<unsigned>(v.size()))];
  }

 private:
  std::mt19937_64 engine_;
};

struct Action {
  enum Kind { kWrite, kFill, kEvent, kQueue, kServe, kTransfer } kind;
  std::uint32_t where = 0;  // offset, set, channel, delay of the turn, transfer controller
  std::uint32_t value = 0;
  std::array<std::uint32_t, 8> words{};
  std::string text() const;
};

/// Memory has three zones, told by address bits 31:28: 8 is only read, A only written. Zone 9 is
/// both if `staged`; each request is then transferred before the next one is served, so that what a
/// request reads doesn't depend on the time of the one before.
struct Program {
  bool staged = false;
  std::vector<Action> setup, actions;
};

Program random_program(std::uint64_t seed);

}  // namespace fovea::dma
