// How records become bytes: see README.md.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/trace/core/trace.h"

namespace fovea::trace {

/// Bytes that are no trace; the reader of the file says where.
struct BadTrace : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void put_number(std::string& out, std::uint64_t v);
inline std::uint64_t zigzag(std::uint64_t difference) {
  return difference << 1 ^ (0 - (difference >> 63));
}
inline std::uint64_t unzigzag(std::uint64_t v) { return v >> 1 ^ (0 - (v & 1)); }

/// Reads what put_number() wrote. @throws BadTrace at the end of the bytes
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes = {})
      : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}
  bool empty() const { return at_ == end_; }
  std::uint8_t byte() {
    if (at_ == end_) ended();
    return *at_++;
  }
  [[gnu::always_inline]] std::uint64_t number() {
    const std::uint8_t v = byte();
    return v < 0x80 ? v : number_after(v);
  }

 private:
  [[gnu::noinline]] std::uint64_t number_after(std::uint64_t v) {
    v &= 0x7F;
    for (unsigned shift = 7; shift < 64; shift += 7) {
      const std::uint64_t b = byte();
      v |= (b & 0x7F) << shift;
      if (b < 0x80) return v;
    }
    throw BadTrace("a number is too long");
  }
  [[noreturn]] static void ended() { throw BadTrace("a record is cut off"); }
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

/// What both sides remember from one record to the next of a stream.
struct CodeState {
  struct Kind {
    std::uint32_t address = 0;
    std::uint8_t bytes = 0, priority = 0;
    bool locked = false;
  };
  std::array<std::array<Kind, 3>, kMasterCount> kinds{};  // by master; read, write, aside
  Kind& kind_of(const Record& r) { return kinds[index(r.master)][r.kind == trace::Kind::kAside ? 2 : r.write]; }
  Master master = Master::kArmI;
  bool aside = false;
  TransferRequest transfer;
  std::uint8_t burst = 0, transfer_priority = 0;
  Picoseconds at = 0;
  std::uint64_t interrupt = 0;
  std::array<std::uint64_t, kMasterCount> completion{};  // by stream
  std::uint64_t& event(std::uint8_t source) {
    return source == kInterrupt ? interrupt : completion[source];
  }
};

void encode(const Record& record, CodeState& state, std::string& out);
/// `version` is the file's: in 1, each `when` is an interrupt; `room` exists from 3 on, what concerns transfers
/// from 4 on.
/// @throws BadTrace
void decode(ByteReader& in, CodeState& state, Record& record, unsigned version);

}  // namespace fovea::trace
