// GDB's remote protocol for one debugger, on a loopback TCP port.
#pragma once
#include <atomic>
#include <cstdint>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sw/fovea/debug/gdb_packet.h"

namespace fovea::app {

/// The target as the debugger accesses it; called only while the target is stopped.
class GdbTarget {
 public:
  enum class Point : std::uint8_t { kSoftware, kHardware, kWrite, kRead, kAccess };  // Z0 .. Z4
  virtual ~GdbTarget() = default;
  /// Register numbers are those of target_xml().
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
  /// The answer to `monitor COMMAND`, with line ends.
  virtual std::string monitor(const std::string& command) = 0;
};

/// Why the target has stopped.
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
  std::uint32_t address = 0;  ///< address of a watchpoint
  std::string note = {};      ///< text for the debugger's console, with a line end
};

/// How the target is to continue.
struct GdbResume {
  enum class Kind : std::uint8_t { kContinue, kStep, kKill } kind = Kind::kContinue;
  std::uint32_t from = 0, to = 0;  ///< kStep: until the pc leaves [from, to)
};

/// The protocol without the socket: takes one packet and returns at most one answer.
class GdbProtocol {
 public:
  explicit GdbProtocol(GdbTarget& target) : target_(target) {}
  /// A connection begins while the target is stopped for this reason.
  void begin(const GdbStop& stop);
  void stopped(const GdbStop& stop) { stop_ = stop; }

  struct Answer {
    std::optional<std::string> payload;  ///< without framing
    std::vector<std::string> output;     ///< packets with console text, to be sent before the
                                         ///< answer
    std::optional<GdbResume> resume;     ///< the target continues; its next stop is reported later
    bool detached = false;               ///< the debugger detaches after this answer
  };
  Answer handle(std::string_view packet);
  std::string stop_reply() const;
  /// A packet that prints text on the debugger's console.
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
  Answer command(std::string_view hex);
  Answer v_packet(std::string_view packet);

  GdbTarget& target_;
  GdbStop stop_;
  bool no_ack_ = false, software_reason_ = false, hardware_reason_ = false;
};

/// Serves one debugger at a time; another one may attach after it has left. A client that does not
/// begin as GDB does is disconnected without an answer: a web page can make a browser send packets
/// to this port, but only after the text of an HTTP request.
class GdbServer {
 public:
  /// Listens on 127.0.0.1; port 0 selects a free one. @throws UserError
  GdbServer(std::uint16_t port, GdbTarget& target, const std::atomic<bool>& stop);
  ~GdbServer();
  GdbServer(const GdbServer&) = delete;
  GdbServer& operator=(const GdbServer&) = delete;
  std::uint16_t port() const { return port_; }

  /// To be called when the target has stopped: answers the debugger, or waits for one, until the
  /// target is to continue. Returns kKill if the process's stop flag is set.
  GdbResume serve(const GdbStop& stop);
  /// To be called while the target runs: returns true if the debugger requests a stop, or a new one
  /// attaches. Never waits.
  bool wants_halt();
  /// True while a debugger is connected.
  bool attached() const { return socket_ >= 0 && !silent_; }
  /// Reports that the target has ended, with this status or by a signal.
  void exited(int status, bool by_signal = false);

 private:
  enum class Io { kNothing, kSome, kClosed };
  bool connect(int timeout_ms);
  Io receive(int timeout_ms);
  void handle_other_clients();
  void send(std::string_view payload);
  void drop();

  GdbProtocol protocol_;
  GdbTarget& target_;
  const std::atomic<bool>& stop_;
  GdbFramer framer_;
  int listener_ = -1, socket_ = -1;
  bool silent_ = false;  // the client has not sent anything yet
  std::uint16_t port_ = 0;
  std::string last_sent_;
  bool running_ = false;  // the debugger waits for a stop reply
};

/// ":1234" or "1234". @throws UserError
std::uint16_t parse_gdb_port(const std::string& text);

}  // namespace fovea::app
