// The packets of GDB's remote protocol and their effect on the target.
#include <fmt/format.h>

#include <algorithm>

#include "sw/fovea/debug/gdb_server.h"

namespace fovea::app {
namespace {

/// Error numbers: EFAULT for memory, EINVAL for an invalid packet.
constexpr const char* kNoMemory = "E0e";
constexpr const char* kBadPacket = "E16";
constexpr const char* kOk = "OK";
constexpr std::size_t kOutputBytes = 1000;

bool has_word(std::string_view list, std::string_view word) {
  while (!list.empty())
    if (take_until(list, ';') == word) return true;
  return false;
}

/// Reads "ADDRESS,LENGTH" from the front of `text`, up to `end`.
bool range(std::string_view& text, char end, std::uint32_t& address, std::uint32_t& bytes) {
  std::string_view both = take_until(text, end);
  const auto a = hex_number(take_until(both, ','));
  const auto n = hex_number(both);
  if (!a || !n) return false;
  address = *a;
  bytes = *n;
  return true;
}

}  // namespace

void GdbProtocol::begin(const GdbStop& stop) {
  stop_ = stop;
  no_ack_ = software_reason_ = hardware_reason_ = false;
}

std::string GdbProtocol::stop_reply() const {
  using R = GdbStop::Reason;
  const auto watch = [this](const char* word) {
    return fmt::format("T05{}:{:x};thread:1;", word, stop_.address);
  };
  switch (stop_.reason) {
    case R::kRequest: return "T02thread:1;";
    case R::kSoftware: return software_reason_ ? "T05swbreak:;thread:1;" : "T05thread:1;";
    case R::kHardware: return hardware_reason_ ? "T05hwbreak:;thread:1;" : "T05thread:1;";
    case R::kWrite: return watch("watch");
    case R::kRead: return watch("rwatch");
    case R::kAccess: return watch("awatch");
    case R::kFailed: return "T06thread:1;";
    default: return "T05thread:1;";
  }
}

std::string GdbProtocol::console(std::string_view text) {
  return "O" + to_hex({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

GdbProtocol::Answer GdbProtocol::handle(std::string_view packet) {
  Answer a;
  if (packet.empty()) {
    a.payload = "";
    return a;
  }
  const std::string_view rest = packet.substr(1);
  switch (packet[0]) {
    case '?': a.payload = stop_reply(); break;
    case 'g': a.payload = read_all(); break;
    case 'G': a.payload = write_all(rest); break;
    case 'p': a.payload = one_register(rest); break;
    case 'P': a.payload = set_register(rest); break;
    case 'm': a.payload = read_memory(rest); break;
    case 'M': a.payload = write_memory(rest, false); break;
    case 'X': a.payload = write_memory(rest, true); break;
    case 'Z': a.payload = point(rest, true); break;
    case 'z': a.payload = point(rest, false); break;
    case 'H': a.payload = kOk; break;
    case 'T': a.payload = hex_number(rest) == 1u ? kOk : kBadPacket; break;
    case 'c':
    case 'C':
    case 's':
    case 'S':
      a.resume = resume(packet);
      if (!a.resume) a.payload = kBadPacket;
      break;
    case 'D':
      target_.clear_all_points();
      a.payload = kOk;
      a.detached = true;
      a.resume = GdbResume{};
      break;
    case 'k': a.resume = GdbResume{.kind = GdbResume::Kind::kKill}; break;
    case 'v': return v_packet(packet);
    case 'Q':
      if (packet == "QStartNoAckMode") no_ack_ = true;
      a.payload = packet == "QStartNoAckMode" ? kOk : "";
      break;
    case 'q':
      if (packet.starts_with("qRcmd,")) return command(packet.substr(6));
      a.payload = query(packet);
      break;
    default: a.payload = "";  // unknown packets are answered with an empty one
  }
  return a;
}

/// A command of the user, whose answer is text for the console.
GdbProtocol::Answer GdbProtocol::command(std::string_view hex) {
  Answer a;
  const auto command = from_hex(hex);
  if (!command) {
    a.payload = kBadPacket;
    return a;
  }
  const std::string text = target_.monitor({command->begin(), command->end()});
  for (std::size_t i = 0; i < text.size(); i += kOutputBytes)
    a.output.push_back(console(std::string_view(text).substr(i, kOutputBytes)));
  a.payload = kOk;
  return a;
}

GdbProtocol::Answer GdbProtocol::v_packet(std::string_view packet) {
  Answer a;
  if (packet == "vCont?") {
    a.payload = "vCont;c;C;s;S;r;t";
  } else if (packet.starts_with("vCont;")) {
    // There is only one thread, so the first action applies to it.
    std::string_view rest = packet.substr(6);
    std::string_view action = take_until(rest, ';');
    action = take_until(action, ':');
    if (action.starts_with('r')) {
      std::string_view limits = action.substr(1);
      const auto from = hex_number(take_until(limits, ','));
      const auto to = hex_number(limits);
      if (from && to) a.resume = GdbResume{GdbResume::Kind::kStep, *from, *to};
    } else if (!action.empty() && (action[0] == 's' || action[0] == 'S')) {
      a.resume = GdbResume{.kind = GdbResume::Kind::kStep};
    } else if (!action.empty() && (action[0] == 'c' || action[0] == 'C')) {
      a.resume = GdbResume{};
    } else if (action == "t") {
      a.payload = kOk;
    }
    if (!a.resume && !a.payload) a.payload = kBadPacket;
  } else if (packet.starts_with("vKill")) {
    a.payload = kOk;
    a.resume = GdbResume{.kind = GdbResume::Kind::kKill};
  } else {
    a.payload = "";
  }
  return a;
}

/// c, C, s or S with an optional address; signals are ignored, as bare-metal programs have none.
std::optional<GdbResume> GdbProtocol::resume(std::string_view packet) {
  std::string_view rest = packet.substr(1);
  if (packet[0] == 'C' || packet[0] == 'S') take_until(rest, ';');
  if (!rest.empty()) {
    const auto pc = hex_number(rest);
    if (!pc || !target_.write_register(15, *pc)) return std::nullopt;
  }
  GdbResume r;
  if (packet[0] == 's' || packet[0] == 'S') r.kind = GdbResume::Kind::kStep;
  return r;
}

std::string GdbProtocol::query(std::string_view packet) {
  if (packet.starts_with("qSupported")) {
    const std::string_view features =
        packet.size() > 11 ? packet.substr(11) : std::string_view();
    software_reason_ = has_word(features, "swbreak+");
    hardware_reason_ = has_word(features, "hwbreak+");
    return fmt::format("PacketSize={:x};qXfer:features:read+;qXfer:memory-map:read+;"
                       "QStartNoAckMode+;vContSupported+;swbreak+;hwbreak+",
                       kGdbPacketBytes);
  }
  if (packet.starts_with("qXfer:")) return transfer(packet.substr(6));
  if (packet == "qC") return "QC1";
  if (packet == "qfThreadInfo") return "m1";
  if (packet == "qsThreadInfo") return "l";
  if (packet.starts_with("qAttached")) return "1";
  if (packet.starts_with("qSymbol")) return kOk;
  return "";
}

std::string GdbProtocol::transfer(std::string_view arguments) {
  const std::string_view object = take_until(arguments, ':');
  const std::string_view operation = take_until(arguments, ':');
  const std::string_view annex = take_until(arguments, ':');
  std::uint32_t offset = 0, bytes = 0;
  if (operation != "read" || !range(arguments, ';', offset, bytes)) return kBadPacket;
  std::string text;
  if (object == "features" && annex == "target.xml")
    text = target_.target_xml();
  else if (object == "memory-map" && annex.empty())
    text = target_.memory_map_xml();
  else
    return object == "features" || object == "memory-map" ? "E00" : "";
  if (offset > text.size()) return kBadPacket;
  // Half of a packet leaves room for escapes.
  const std::size_t n = std::min<std::size_t>(bytes, kGdbPacketBytes / 2 - 1);
  const bool last = text.size() - offset <= n;
  return (last ? "l" : "m") + text.substr(offset, n);
}

std::string GdbProtocol::read_all() const {
  std::string out;
  for (const unsigned r : target_.registers()) {
    const auto v = target_.read_register(r);
    out += v ? to_hex(*v) : "xxxxxxxx";
  }
  return out;
}

/// Writes to read-only registers are ignored.
std::string GdbProtocol::write_all(std::string_view hex) {
  const auto registers = target_.registers();
  if (hex.size() != 8 * registers.size()) return kBadPacket;
  for (std::size_t i = 0; i < registers.size(); ++i)
    if (!word_from_hex(hex.substr(8 * i, 8))) return kBadPacket;
  for (std::size_t i = 0; i < registers.size(); ++i) {
    const std::uint32_t value = *word_from_hex(hex.substr(8 * i, 8));
    if (target_.read_register(registers[i]) != value) target_.write_register(registers[i], value);
  }
  return kOk;
}

std::string GdbProtocol::one_register(std::string_view number) const {
  const auto n = hex_number(number);
  if (!n) return kBadPacket;
  const auto v = target_.read_register(*n);
  return v ? to_hex(*v) : kBadPacket;
}

std::string GdbProtocol::set_register(std::string_view arguments) {
  const auto n = hex_number(take_until(arguments, '='));
  const auto v = word_from_hex(arguments);
  return n && v && target_.write_register(*n, *v) ? kOk : kBadPacket;
}

/// Returns as many bytes as can be read from the start on.
std::string GdbProtocol::read_memory(std::string_view arguments) {
  std::uint32_t address = 0, bytes = 0;
  if (!range(arguments, ';', address, bytes)) return kBadPacket;
  std::vector<std::uint8_t> data(std::min<std::size_t>(bytes, kGdbPacketBytes / 2));
  if (target_.read_memory(address, data)) return to_hex(data);
  std::size_t n = 0;
  while (n < data.size() && target_.read_memory(address + static_cast<std::uint32_t>(n),
                                                std::span(data).subspan(n, 1)))
    ++n;
  return n ? to_hex(std::span<const std::uint8_t>(data).first(n)) : kNoMemory;
}

std::string GdbProtocol::write_memory(std::string_view arguments, bool binary) {
  std::uint32_t address = 0, bytes = 0;
  if (!range(arguments, ':', address, bytes)) return kBadPacket;
  if (binary) {
    if (arguments.size() != bytes) return kBadPacket;
    const auto* p = reinterpret_cast<const std::uint8_t*>(arguments.data());
    return target_.write_memory(address, {p, bytes}) ? kOk : kNoMemory;
  }
  const auto data = from_hex(arguments);
  if (!data || data->size() != bytes) return kBadPacket;
  return target_.write_memory(address, *data) ? kOk : kNoMemory;
}

std::string GdbProtocol::point(std::string_view arguments, bool set) {
  const auto kind = hex_number(take_until(arguments, ','));
  std::uint32_t address = 0, bytes = 0;
  if (!kind || !range(arguments, ';', address, bytes)) return kBadPacket;
  if (*kind > static_cast<unsigned>(GdbTarget::Point::kAccess)) return "";
  const auto k = static_cast<GdbTarget::Point>(*kind);
  return (set ? target_.set_point(k, address, bytes) : target_.clear_point(k, address, bytes))
             ? kOk
             : kBadPacket;
}

}  // namespace fovea::app
