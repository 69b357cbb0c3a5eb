// The framing of GDB's remote protocol: $payload#checksum, acknowledgements, the interrupt byte.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fovea::app {

/// Largest payload that is accepted, and announced to GDB.
inline constexpr std::size_t kGdbPacketBytes = 0x4000;

/// Takes bytes in any pieces and gives them back as events. Whatever arrives, it ends in an event or is
/// dropped: bytes between packets, packets that are too long or whose checksum is wrong.
class GdbFramer {
 public:
  struct Event {
    enum class Kind { kPacket, kAck, kNak, kInterrupt, kBroken } kind;
    std::string payload;  ///< kPacket: unescaped
  };
  void feed(std::string_view bytes) { input_ += bytes; }
  std::optional<Event> next();
  /// Forgets what has arrived (a new connection).
  void clear() { *this = GdbFramer(); }

 private:
  enum class State { kIdle, kPayload, kSkip, kSum1, kSum2 } state_ = State::kIdle;
  std::string input_, payload_;
  std::size_t at_ = 0;
  std::uint8_t sum_ = 0;
  int first_digit_ = 0;
  bool broken_ = false, escaped_ = false;
};

/// `$payload#checksum` with what must be escaped.
std::string gdb_frame(std::string_view payload);

std::string to_hex(std::span<const std::uint8_t> bytes);
/// Register values travel as they lie in memory.
std::string to_hex(std::uint32_t word);
/// All of `text` as bytes; nothing if it is no even number of hex digits.
std::optional<std::vector<std::uint8_t>> from_hex(std::string_view text);
std::optional<std::uint32_t> word_from_hex(std::string_view text);
/// A hexadecimal number, most significant digit first; at most 32 bits.
std::optional<std::uint32_t> hex_number(std::string_view text);

/// Takes the front of `text` up to `end` (or all of it) away; `end` itself goes too.
std::string_view take_until(std::string_view& text, char end);

}  // namespace fovea::app
