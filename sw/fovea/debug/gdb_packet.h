// Framing of GDB's remote protocol: $payload#checksum, acknowledgements, the interrupt byte.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::app {

/// Largest accepted payload in bytes, as reported to GDB.
inline constexpr std::size_t kGdbPacketBytes = 0x4000;

/// Splits a stream of bytes into events. Everything else is dropped: bytes between packets, packets
/// that are too long or have a wrong checksum.
class GdbFramer {
 public:
  struct Event {
    enum class Kind { kPacket, kAck, kNak, kInterrupt, kBroken } kind;
    std::string payload;  ///< kPacket: the unescaped payload
  };
  void feed(std::string_view bytes) { input_ += bytes; }
  std::optional<Event> next();
  /// Discards everything received (for a new connection).
  void clear() { *this = GdbFramer(); }

 private:
  enum class State { kIdle, kPayload, kSkip, kSum1, kSum2 } state_ = State::kIdle;
  std::string input_, payload_;
  std::size_t at_ = 0;
  std::uint8_t sum_ = 0;
  int first_digit_ = 0;
  bool broken_ = false, escaped_ = false;
  void start_packet();
  /// A character between '$' and '#'; a payload that is too long is skipped to its end.
  void take_payload(char c);
};

/// `$payload#checksum`, with characters escaped as necessary.
std::string gdb_frame(std::string_view payload);

std::string to_hex(std::span<const std::uint8_t> bytes);
/// Register values are sent in the byte order of memory.
std::string to_hex(std::uint32_t word);
/// All of `text` as bytes; empty if it is not an even number of hexadecimal digits.
std::optional<std::vector<std::uint8_t>> from_hex(std::string_view text);
std::optional<std::uint32_t> word_from_hex(std::string_view text);
/// A hexadecimal number of at most 32 bits, most significant digit first.
std::optional<std::uint32_t> hex_number(std::string_view text);

/// Removes the front of `text` up to and including `end` (or all of it), and returns it without
/// `end`.
std::string_view take_until(std::string_view& text, char end);

}  // namespace fovea::app
