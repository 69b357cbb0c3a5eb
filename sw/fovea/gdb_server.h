// GDB's remote protocol towards one debugger, over a loopback TCP port.
#pragma once
#include <atomic>
#include <cstdint>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/gdb_packet.h"

namespace fovea::app {

/// What the debugger looks at; used only while the target stands still.
class GdbTarget {
 public:
  enum class Point : std::uint8_t { kSoftware, kHardware, kWrite, kRead, kAccess };  // Z0 .. Z4
  virtual ~GdbTarget() = default;
  /// Numbers are those of target_xml().
  virtual std::span<const unsigned> registers() const = 0;
  virtual std::optional<std::uint32_t> read_register(unsigned number) const = 0;
  virtual bool write_register(unsigned number, std::uint32_t value) = 0;
  virtual bool read_memory(std::uint32_t address, std::span<std::uint8_t> to) = 0;
  virtual bool write_memory(std::uint32_t address, std::span<const std::uint8_t> from) = 0;
  virtual bool set_point(Point kind, std::uint32_t address, std::uint32_t bytes) = 0;
  virtual bool clear_point(Point kind, std::uint32_t address, std::uint32_t bytes) = 0;
  virtual void clear_all_points() = 0;
  virtual std::string target_xml() const = 0;
  virtual std::string memory_map_xml() const = 0;
  /// Answer to `monitor COMMAND`, with line ends.
  virtual std::string monitor(const std::string& command) = 0;
};

/// Why the target stands still.
struct GdbStop {
  enum class Reason : std::uint8_t {
    kRequest,
    kStep,
    kSoftware,
    kHardware,
    kWrite,
    kRead,
    kAccess,
    kFailed,
    kOther
  };
  Reason reason = Reason::kRequest;
  std::uint32_t address = 0;  ///< of a watchpoint
  std::string note = {};      ///< for the debugger's console, with a line end
};

/// How the target is to go on.
struct GdbResume {
  enum class Kind : std::uint8_t { kContinue, kStep, kKill } kind = Kind::kContinue;
  std::uint32_t from = 0, to = 0;  ///< kStep: until the pc leaves [from, to)
};

/// The protocol without the socket: one packet in, at most one answer out.
class GdbProtocol {
 public:
  explicit GdbProtocol(GdbTarget& target) : target_(target) {}
  /// A connection begins, with the target standing still for this reason.
  void begin(const GdbStop& stop);
  void stopped(const GdbStop& stop) { stop_ = stop; }

  struct Answer {
    std::optional<std::string> payload;  ///< unframed
    std::vector<std::string> output;     ///< packets with console text, sent before it
    std::optional<GdbResume> resume;     ///< the target goes on; its stop is reported later
    bool detached = false;               ///< the debugger leaves after this answer
  };
  Answer handle(std::string_view packet);
  std::string stop_reply() const;
  /// A packet that puts text on the debugger's console.
  static std::string console(std::string_view text);
  bool no_ack() const { return no_ack_; }

 private:
  std::string query(std::string_view packet);
  std::string transfer(std::string_view arguments);
  std::string read_all() const;
  std::string write_all(std::string_view hex);
  std::string one_register(std::string_view number) const;
  std::string set_register(std::string_view arguments);
  std::string read_memory(std::string_view arguments);
  std::string write_memory(std::string_view arguments, bool binary);
  std::string point(std::string_view arguments, bool set);
  std::optional<GdbResume> resume(std::string_view packet);
  Answer v_packet(std::string_view packet);

  GdbTarget& target_;
  GdbStop stop_;
  bool no_ack_ = false, software_reason_ = false, hardware_reason_ = false;
};

/// One debugger at a time; another one may attach when it has left. Whoever does not begin as GDB's
/// protocol does is cut off unheard: a web page can make a browser send packets to this port, but
/// only behind the words of HTTP.
class GdbServer {
 public:
  /// Listens on 127.0.0.1; port 0 takes a free one. @throws UserError
  GdbServer(std::uint16_t port, GdbTarget& target, const std::atomic<bool>& stop);
  ~GdbServer();
  GdbServer(const GdbServer&) = delete;
  GdbServer& operator=(const GdbServer&) = delete;
  std::uint16_t port() const { return port_; }

  /// The target stands still: answers the debugger, or waits for one, until the target is to go on.
  /// The process's stop flag ends it with kKill.
  GdbResume serve(const GdbStop& stop);
  /// The target runs: true if it is to stop, since the debugger asks for it or a new one attaches.
  /// Never waits.
  bool wants_halt();
  /// A debugger is there.
  bool attached() const { return socket_ >= 0 && !silent_; }
  /// The target has ended, with this status or by a signal.
  void exited(int status, bool by_signal = false);

 private:
  enum class Io { kNothing, kSome, kClosed };
  bool connect(int timeout_ms);
  Io receive(int timeout_ms);
  void attend_others();
  void send(std::string_view payload);
  void drop();

  GdbProtocol protocol_;
  GdbTarget& target_;
  const std::atomic<bool>& stop_;
  GdbFramer framer_;
  int listener_ = -1, socket_ = -1;
  bool silent_ = false;  // whoever is connected has not said anything yet
  std::uint16_t port_ = 0;
  std::string last_sent_;
  bool running_ = false;  // the debugger waits for a stop reply
};

/// ":1234" or "1234". @throws UserError
std::uint16_t parse_gdb_port(const std::string& text);

}  // namespace fovea::app
