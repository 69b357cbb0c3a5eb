// What a bus trace holds: requests of the masters to the SDRAM, and what releases each of them.
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "model/common/masters.h"
#include "model/common/mem_request.h"
#include "model/common/transfer_request.h"
#include "model/common/units.h"

namespace fovea::trace {

/// What a record waits for, besides a place among its master's outstanding requests and the records
/// before it in its stream.
enum class Release : std::uint8_t {
  kAt,     ///< a time: sample clock of a camera or display
  kAfter,  ///< an earlier record of its stream is done, and a gap in the stream's clock
  kWhen,   ///< an event that its master slept or waited for, and a gap after it
};

/// What kWhen waits for: an interrupt of the core, or a record of another stream.
inline constexpr std::uint8_t kInterrupt = 0xFF;

/// What a record stands for.
enum class Kind : std::uint8_t {
  kRequest,   ///< a request to the SDRAM
  kAside,     ///< a request of the core to a register
  kMark,      ///< no request: the program shows `address` on its phase pins
  kStep,      ///< no request: the program has waited for others
  kTransfer,  ///< a request to a transfer controller of the EDMA, whose bursts follow from it
};

/// Which moment of a record kWhen waits for.
enum class Point : std::uint8_t {
  kEnd,        ///< the last beat; of a transfer the acknowledgement of its last write
  kSubmitted,  ///< a transfer goes to its transfer controller
  kDelivered,  ///< the last write of a transfer has changed the internal RAM; a write aside its register
};
inline constexpr std::uint8_t kPoints = 3;

/// Accesses of the core to one bank of internal RAM, each as soon as the one before is over.
struct RamRun {
  /// Clocks of the core's own from the begin of the last access before, or from what the record's gap counts from.
  std::uint32_t skip = 0;
  std::uint32_t count = 1;
  std::uint8_t bank = 0;
  /// They are of one instruction: a burst that arrives after it has begun finds all of them done.
  bool together = false;
  friend bool operator==(const RamRun&, const RamRun&) = default;
};

struct Record {
  Release release = Release::kAt;
  Kind kind = Kind::kRequest;
  bool write = false, locked = false;
  /// kAfter, kWhen: from that record's first beat, or from the time at which a write was released,
  /// whether or not its port was free; else from its last beat.
  bool from_first = false;
  std::uint8_t bytes = 0;
  std::uint8_t critical = 0;
  std::uint8_t priority = 0;
  Master master = Master::kArmD;
  /// Start of the burst: byte offset in the SDRAM, or of kAside the address of a register. kMark: the value.
  std::uint32_t address = 0;
  std::uint32_t back = 0;       ///< kAfter, kWhen: that many records before this one; 0: none
  /// kAfter, write: its program goes on only when the write so many records before has ended, which
  /// makes room for it in a buffer; 0: there is room.
  std::uint32_t room = 0;
  std::uint64_t gap = 0;        ///< kAfter: clocks; kWhen: clocks of work before the sleep
  std::uint8_t source = kInterrupt;  ///< kWhen: that, or the number of the stream
  Point point = Point::kEnd;    ///< kWhen of a record
  std::uint64_t event = 0;      ///< kWhen: number in TraceInfo::interrupts, or of the record there
  std::uint32_t wake_gap = 0;   ///< kWhen: clocks from the event to the request
  Picoseconds at = 0;           ///< kAt
  /// kAside: what the register takes from the request's arrival on. kStep: from its clock's edge to it.
  Picoseconds service = 0;
  /// kTransfer: it leaves its queue when it is released, the queue's turn has come, and its transfer
  /// controller takes it. Addresses are the masters'. One without bytes moves nothing.
  TransferRequest transfer;
  std::uint8_t burst = 0;       ///< kTransfer: default burst size, bytes
  /// kTransfer: clocks of the core for which its bursts that read and that write internal RAM waited for the core's
  /// accesses to it, in the order of the bursts; the last ones that did not wait are left out.
  std::array<std::vector<std::uint16_t>, 2> ram_waits;
  /// kAfter, kWhen, of the core: its accesses to internal RAM in the gap. Clocks for which these waited for the EDMA
  /// are not in the gap.
  std::vector<RamRun> ram;
  /// kStep: until what it waits for has come the program looks at a word of internal RAM, so many clocks after the gap
  /// and then again and again after so many; 0: it does not.
  std::uint32_t look_after = 0, look_clocks = 0;
  std::uint8_t look_bank = 0;
  bool on_bus() const { return kind == Kind::kRequest || kind == Kind::kAside; }
  friend bool operator==(const Record&, const Record&) = default;
};

/// Furthest reference to an earlier record.
inline constexpr std::uint32_t kMaxBack = 4095;
/// Deepest window of a master; as many requests as a port of the crossbar queues.
inline constexpr unsigned kMaxWindow = 64;
/// Most runs of accesses to internal RAM that a record may have; what the core does beyond them is not in the trace.
inline constexpr std::size_t kMaxRamRuns = 4096;
/// Most banks of internal RAM.
inline constexpr unsigned kMaxRamBanks = 4;

/// One agent whose records are in program order: the core with both of its ports, a video port.
struct StreamInfo {
  Frequency clock{kPsPerSecond};
  Picoseconds clock_start = 0;  ///< time of an edge of that clock
  /// Requests go out at edges n with n % align == phase, counted from clock_start: the AHB.
  unsigned align = 1, phase = 0;
  friend bool operator==(const StreamInfo&, const StreamInfo&) = default;
};

struct MasterInfo {
  Master id = Master::kArmD;
  std::string label;
  unsigned stream = 0;
  unsigned reads = 1;   ///< reads it may have outstanding
  unsigned writes = 1;  ///< writes it may have unacknowledged
  bool shared = false;  ///< `reads` is the limit of both together
  friend bool operator==(const MasterInfo&, const MasterInfo&) = default;
};

/// An interrupt line of the core rises: at a time, or since a transfer has ended.
struct Interrupt {
  Picoseconds at = 0;
  std::uint8_t source = kInterrupt;  ///< stream of the transfer; kInterrupt: at that time
  Point point = Point::kEnd;
  std::uint64_t event = 0;           ///< number of the transfer there
  Picoseconds after = 0;             ///< from that to the interrupt
  friend bool operator==(const Interrupt&, const Interrupt&) = default;
};

/// What is not a matter of crossbar and SDRAM and decides how transfers go.
struct EdmaInfo {
  unsigned request_clocks = 0;        ///< of the crossbar, between two requests; 0: the trace has no transfers
  unsigned fifo = 0, depth = 0;       ///< bytes; destination registers
  unsigned ram_latency = 0, ram_word_clocks = 0;  ///< internal RAM, clocks of the core
  Picoseconds register_latency = 0;   ///< each word of a burst to registers
  /// The core's side of internal RAM: banks (0: its accesses are not in the trace), clocks for which an access holds
  /// its bank, whether it comes before a word of the EDMA.
  unsigned ram_banks = 0, ram_hold = 1;
  bool ram_core_first = true;
  friend bool operator==(const EdmaInfo&, const EdmaInfo&) = default;
};

struct ClockInfo {
  Frequency frequency;
  Picoseconds start = 0;  ///< when it last started
  friend bool operator==(const ClockInfo&, const ClockInfo&) = default;
};

struct TraceInfo {
  Picoseconds start = 0, end = 0;  ///< of what was recorded
  Picoseconds core_until = 0;      ///< when the core's last record went out; 0: not known
  Picoseconds refresh = 0;  ///< one of the refresh intervals counts from the clock after; 0: not known
  /// Parameters in force, as `key value`; keys of `fovea params`.
  std::vector<std::pair<std::string, std::string>> params;
  ClockInfo scr, ddr;  ///< crossbar, SDRAM; a stopped one is the parameters' matter
  std::vector<StreamInfo> streams;
  std::vector<MasterInfo> masters;
  std::vector<Interrupt> interrupts;
  EdmaInfo edma;
  /// Masters some of whose requests keep their recorded times, although on the chip they wait for others: with other
  /// settings a replay does not follow a run.
  std::vector<Master> kept;
};

/// Whether the master is among TraceInfo::kept.
inline bool keeps_times(const TraceInfo& info, Master m) {
  return std::find(info.kept.begin(), info.kept.end(), m) != info.kept.end();
}

/// Records of several streams, each read from its beginning to its end.
class RecordSource {
 public:
  virtual ~RecordSource() = default;
  /// False at the end of the stream. @throws UserError
  virtual bool next(unsigned stream, Record& record) = 0;
  /// Where the file has the record that next() gave last, for a message; empty: its number will do.
  virtual std::string place(unsigned) const { return {}; }
};

}  // namespace fovea::trace
