#include "sw/fovea/debug/gdb_packet.h"

#include <array>
#include <charconv>
#include <cstring>

namespace fovea::app {
namespace {

constexpr char kEscape = '}', kFlip = 0x20;
constexpr std::string_view kDigits = "0123456789abcdef";

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

void GdbFramer::start_packet() {
  state_ = State::kPayload;
  payload_.clear();
  sum_ = 0;
  broken_ = escaped_ = false;
}

void GdbFramer::take_payload(char c) {
  if (c == '#') {
    if (escaped_) broken_ = true;
    state_ = State::kSum1;
    return;
  }
  if (c == '$') {  // the previous packet was truncated
    start_packet();
    return;
  }
  sum_ = static_cast<std::uint8_t>(sum_ + static_cast<std::uint8_t>(c));
  if (state_ == State::kSkip) return;
  if (escaped_) {
    payload_ += static_cast<char>(c ^ kFlip);
    escaped_ = false;
  } else if (c == kEscape) {
    escaped_ = true;
  } else {
    payload_ += c;
  }
  if (payload_.size() > kGdbPacketBytes) {
    broken_ = true;
    escaped_ = false;
    payload_.clear();
    state_ = State::kSkip;
  }
}

std::optional<GdbFramer::Event> GdbFramer::next() {
  using Kind = Event::Kind;
  while (at_ < input_.size()) {
    const char c = input_[at_++];
    switch (state_) {
      case State::kIdle:
        if (c == '$') {
          start_packet();
        } else if (c == '+') {
          return Event{Kind::kAck, {}};
        } else if (c == '-') {
          return Event{Kind::kNak, {}};
        } else if (c == '\x03') {
          return Event{Kind::kInterrupt, {}};
        }
        break;
      case State::kPayload:
      case State::kSkip:
        take_payload(c);
        break;
      case State::kSum1:
        first_digit_ = digit(c);
        state_ = State::kSum2;
        break;
      case State::kSum2: {
        state_ = State::kIdle;
        const int second = digit(c);
        const bool good = !broken_ && first_digit_ >= 0 && second >= 0 &&
                          first_digit_ * 16 + second == sum_;
        if (!good) return Event{Kind::kBroken, {}};
        return Event{Kind::kPacket, std::move(payload_)};
      }
    }
  }
  input_.clear();
  at_ = 0;
  return std::nullopt;
}

std::string gdb_frame(std::string_view payload) {
  std::string out = "$";
  std::uint8_t sum = 0;
  const auto add = [&](char c) {
    out += c;
    sum = static_cast<std::uint8_t>(sum + static_cast<std::uint8_t>(c));
  };
  for (const char c : payload) {
    if (c == '$' || c == '#' || c == kEscape || c == '*') {
      add(kEscape);
      add(static_cast<char>(c ^ kFlip));
    } else {
      add(c);
    }
  }
  out += '#';
  out += kDigits[sum >> 4];
  out += kDigits[sum & 15u];
  return out;
}

std::string to_hex(std::span<const std::uint8_t> bytes) {
  std::string out;
  out.reserve(2 * bytes.size());
  for (const std::uint8_t b : bytes) {
    out += kDigits[b >> 4];
    out += kDigits[b & 15u];
  }
  return out;
}

std::string to_hex(std::uint32_t word) {
  std::array<std::uint8_t, 4> bytes;
  std::memcpy(bytes.data(), &word, 4);
  return to_hex(bytes);
}

std::optional<std::vector<std::uint8_t>> from_hex(std::string_view text) {
  if (text.size() % 2) return std::nullopt;
  std::vector<std::uint8_t> out;
  out.reserve(text.size() / 2);
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const int high = digit(text[i]), low = digit(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    out.push_back(static_cast<std::uint8_t>(high * 16 + low));
  }
  return out;
}

std::optional<std::uint32_t> word_from_hex(std::string_view text) {
  const auto bytes = from_hex(text);
  if (!bytes || bytes->size() != 4) return std::nullopt;
  std::uint32_t word;
  std::memcpy(&word, bytes->data(), 4);
  return word;
}

std::optional<std::uint32_t> hex_number(std::string_view text) {
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value, 16);
  if (error != std::errc() || stopped != end || text.empty()) return std::nullopt;
  return value;
}

std::string_view take_until(std::string_view& text, char end) {
  const std::size_t n = text.find(end);
  const std::string_view front = text.substr(0, n);
  text.remove_prefix(n == std::string_view::npos ? text.size() : n + 1);
  return front;
}

}  // namespace fovea::app
