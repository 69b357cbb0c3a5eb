// Replaces the chip's registers: records every access in order and provides the values of reads.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <ostream>
#include <vector>

struct RegisterAccess {
  char kind;  // 'r' or 'w'
  std::uint32_t address, value;
  bool operator==(const RegisterAccess&) const = default;
};

inline std::ostream& operator<<(std::ostream& out, const RegisterAccess& a) {
  return out << a.kind << std::hex << " 0x" << a.address << " = 0x" << a.value;
}

class RegisterRecorder {
 public:
  RegisterRecorder() { current() = this; }
  ~RegisterRecorder() { current() = nullptr; }
  static RegisterRecorder*& current() {
    static RegisterRecorder* recorder = nullptr;
    return recorder;
  }

  std::uint32_t read(std::uint32_t address) {
    const std::uint32_t value = on_read ? on_read(address) : values[address];
    accesses.push_back({'r', address, value});
    return value;
  }
  void write(std::uint32_t address, std::uint32_t value) {
    accesses.push_back({'w', address, value});
    values[address] = value;
    if (on_write) on_write(address, value);
  }
  std::vector<RegisterAccess> writes() const {
    std::vector<RegisterAccess> result;
    for (const RegisterAccess& a : accesses)
      if (a.kind == 'w') result.push_back(a);
    return result;
  }

  std::vector<RegisterAccess> accesses;
  std::map<std::uint32_t, std::uint32_t> values;
  std::function<std::uint32_t(std::uint32_t)> on_read;
  std::function<void(std::uint32_t, std::uint32_t)> on_write;
};
