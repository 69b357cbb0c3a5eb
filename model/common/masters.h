// Memory masters of the chip: each is a port of the crossbar, ordered and arbitrated by itself.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace fovea {

/// A master's number. Equal priorities take turns in this order (turns_after), acts of one instant go
/// by it (end_of_instant.h), culprits of waits begin with it (waits.h), and bus traces hold it, so a new
/// master goes to the end. Everywhere else it is an index or a bit of a set. All else about a master is
/// its row in kMasters.
enum class Master : std::uint8_t {
  kArmI, kArmD,
  kEdmaTc0Read, kEdmaTc1Read, kEdmaTc2Read, kEdmaTc3Read,
  kVpfe, kVpbe, kRemapEngine,
  kLoad,  // synthetic traffic for experiments; no such master on the chip
  kEdmaTc0Write, kEdmaTc1Write, kEdmaTc2Write, kEdmaTc3Write,
  kCount
};
inline constexpr std::size_t kMasterCount = static_cast<std::size_t>(Master::kCount);
constexpr std::size_t index(Master m) { return static_cast<std::size_t>(m); }
/// Among masters of equal priority: how many have their turn before this one's, after the turn of `last`.
constexpr unsigned turns_after(std::size_t last, std::size_t master) {
  return static_cast<unsigned>((master + kMasterCount - last - 1) % kMasterCount);
}

/// What lies between a master and the crossbar; decides the defaults of the port's parameters.
enum class Bridge : std::uint8_t {
  kCore,   ///< from the core's AHB: 32 bits, a clock-crossing bridge
  kVideo,  ///< from the buffers of the video subsystem: 64 bits
  kDma,    ///< from a DMA engine: 64 bits
};

/// The register that holds a master's priority on the crossbar.
enum class PrioritySource : std::uint8_t {
  kArm,         ///< MSTPRI0.ARM_DMAP of the system module
  kImcop,       ///< MSTPRI0.IMCOPP
  kVideoRead,   ///< BCR.RD_PRI of the video subsystem
  kVideoWrite,  ///< BCR.WR_PRI
  kQueue,       ///< QUEPRI of the EDMA, through QUETCMAP; `unit` is the transfer controller
  kParameter,   ///< no register: a parameter of the block
};
/// The register's name in the chip's manuals; empty without one. QUEPRI has a field for each queue.
constexpr std::string_view priority_register(PrioritySource source) {
  switch (source) {
    case PrioritySource::kArm: return "MSTPRI0.ARM_DMAP";
    case PrioritySource::kImcop: return "MSTPRI0.IMCOPP";
    case PrioritySource::kVideoRead: return "BCR.RD_PRI";
    case PrioritySource::kVideoWrite: return "BCR.WR_PRI";
    case PrioritySource::kQueue: return "QUEPRI";
    case PrioritySource::kParameter: break;
  }
  return "";
}

/// How a master's requests are released in a bus trace.
enum class Pace : std::uint8_t {
  kCore,       ///< program order, one request a port
  kSampled,    ///< each at its time
  kLines,      ///< bursts of a line at a time, those without a slot after the burst they replace
  kRepeating,  ///< after a completion, of its own or of the partner's records
  kData,       ///< each with the last beat of a read of its partner, in order
  kTransfers,  ///< they follow from transfer requests (common/transfer_request.h)
};

/// Which direction of a block a master is.
enum class Side : std::uint8_t { kBoth, kReads, kWrites };

struct MasterInfo {
  Master id{};
  std::string_view name;        ///< of the port, in traces and debugger output
  std::string_view statistics;  ///< in statistics and parameters; two sides of a block share it
  std::string_view who;         ///< for people, "while ... is served"; the same for parts of one block
  Bridge bridge = Bridge::kDma;
  PrioritySource priority = PrioritySource::kParameter;
  unsigned unit = 0;              ///< number within its kind, such as that of a transfer controller
  unsigned most_outstanding = 1;  ///< requests it may have under way at once
  Pace pace = Pace::kRepeating;
  Side side = Side::kBoth;
  /// The master that is the block's other side.
  std::optional<Master> partner = {};
  bool on_chip = true;
  /// A synthetic load may use it (`load.port`), alone or together with the block that drives it.
  bool load_allowed = false;
  /// Synthetic traffic for experiments, which moves nothing for the program.
  bool synthetic = false;
};

/// More than any port queues (bus/core/crossbar.h, trace::kMaxWindow).
inline constexpr unsigned kMostOutstanding = 32;

/// The rows of all masters, in the order of their numbers. A template, so that tests can try other
/// tables.
template <std::size_t N>
struct MasterTable {
  std::array<MasterInfo, N> rows{};

  constexpr const MasterInfo& of(Master m) const { return rows[index(m)]; }
  /// The first row with a name in the statistics, counted among the different names.
  constexpr std::size_t stat_index(Master m) const {
    std::size_t n = 0;
    for (std::size_t i = 0; rows[i].statistics != of(m).statistics; ++i) n += is_first(i);
    return n;
  }
  constexpr std::size_t stat_count() const {
    std::size_t n = 0;
    for (std::size_t i = 0; i < N; ++i) n += is_first(i);
    return n;
  }
  /// The master that serves a direction of the block of that name in the statistics.
  constexpr const MasterInfo* find(std::string_view statistics, bool write) const {
    for (const MasterInfo& r : rows)
      if (r.statistics == statistics && r.side != (write ? Side::kReads : Side::kWrites)) return &r;
    return nullptr;
  }
  /// What is wrong with the table; null if nothing is.
  constexpr const char* defect() const {
    for (std::size_t i = 0; i < N; ++i) {
      const MasterInfo& r = rows[i];
      if (index(r.id) != i) return "a row is missing or out of order";
      if (r.name.empty() || r.statistics.empty() || r.who.empty()) return "a master without a name";
      if (r.most_outstanding == 0 || r.most_outstanding > kMostOutstanding)
        return "a master with no requests, or with more than a port queues";
      if (r.on_chip && r.priority == PrioritySource::kParameter)
        return "a master of the chip without a register for its priority";
      if ((r.side == Side::kBoth) != !r.partner) return "one side of a block without the other";
      for (std::size_t k = 0; k < i; ++k) {
        if (rows[k].name == r.name) return "two masters with one name";
        if (rows[k].statistics == r.statistics && (!r.partner || *r.partner != rows[k].id))
          return "two masters with one name in the statistics";
      }
      if (!r.partner) continue;
      if (index(*r.partner) >= N) return "a partner that does not exist";
      const MasterInfo& p = of(*r.partner);
      if (!p.partner || *p.partner != r.id || p.side == r.side || p.statistics != r.statistics ||
          p.priority != r.priority || p.unit != r.unit || p.bridge != r.bridge)
        return "partners that differ in more than their side";
    }
    return nullptr;
  }

 private:
  constexpr bool is_first(std::size_t i) const {
    for (std::size_t k = 0; k < i; ++k)
      if (rows[k].statistics == rows[i].statistics) return false;
    return true;
  }
};

namespace masters {
constexpr MasterInfo arm(Master id, std::string_view name, std::string_view who) {
  return {.id = id, .name = name, .statistics = name, .who = who, .bridge = Bridge::kCore,
          .priority = PrioritySource::kArm, .most_outstanding = 1, .pace = Pace::kCore};
}
constexpr MasterInfo edma(Master id, std::string_view name, std::string_view statistics,
                          unsigned controller, Side side, Master partner) {
  return {.id = id, .name = name, .statistics = statistics, .who = "the EDMA",
          .priority = PrioritySource::kQueue, .unit = controller, .most_outstanding = 16,
          .pace = Pace::kTransfers, .side = side, .partner = partner, .load_allowed = true};
}
}  // namespace masters

inline constexpr MasterTable<kMasterCount> kMasters{{
    masters::arm(Master::kArmI, "arm_i", "the core's fetches"),
    masters::arm(Master::kArmD, "arm_d", "the core's data"),
    masters::edma(Master::kEdmaTc0Read, "edma_tc0_read", "edma_tc0", 0, Side::kReads,
                  Master::kEdmaTc0Write),
    masters::edma(Master::kEdmaTc1Read, "edma_tc1_read", "edma_tc1", 1, Side::kReads,
                  Master::kEdmaTc1Write),
    masters::edma(Master::kEdmaTc2Read, "edma_tc2_read", "edma_tc2", 2, Side::kReads,
                  Master::kEdmaTc2Write),
    masters::edma(Master::kEdmaTc3Read, "edma_tc3_read", "edma_tc3", 3, Side::kReads,
                  Master::kEdmaTc3Write),
    {.id = Master::kVpfe, .name = "vpfe", .statistics = "vpfe", .who = "the camera",
     .bridge = Bridge::kVideo, .priority = PrioritySource::kVideoWrite, .most_outstanding = 32,
     .pace = Pace::kSampled},
    {.id = Master::kVpbe, .name = "vpbe", .statistics = "vpbe", .who = "the display",
     .bridge = Bridge::kVideo, .priority = PrioritySource::kVideoRead, .most_outstanding = 32,
     .pace = Pace::kLines},
    // No part of the chip: it has the priority of the imaging coprocessor (assumed).
    {.id = Master::kRemapEngine, .name = "remap_engine", .statistics = "remap_engine",
     .who = "the remap engine", .priority = PrioritySource::kImcop, .most_outstanding = 16,
     .on_chip = false, .load_allowed = true},
    {.id = Master::kLoad, .name = "load", .statistics = "load",
     .who = "the load generator", .priority = PrioritySource::kParameter, .most_outstanding = 16,
     .on_chip = false, .load_allowed = true, .synthetic = true},
    masters::edma(Master::kEdmaTc0Write, "edma_tc0_write", "edma_tc0", 0, Side::kWrites,
                  Master::kEdmaTc0Read),
    masters::edma(Master::kEdmaTc1Write, "edma_tc1_write", "edma_tc1", 1, Side::kWrites,
                  Master::kEdmaTc1Read),
    masters::edma(Master::kEdmaTc2Write, "edma_tc2_write", "edma_tc2", 2, Side::kWrites,
                  Master::kEdmaTc2Read),
    masters::edma(Master::kEdmaTc3Write, "edma_tc3_write", "edma_tc3", 3, Side::kWrites,
                  Master::kEdmaTc3Read),
}};
static_assert(kMasters.defect() == nullptr, "see MasterTable::defect");

constexpr const MasterInfo& master_info(Master m) { return kMasters.of(m); }

/// The ports of the core, one bit each.
inline constexpr std::uint32_t kCorePorts = [] {
  std::uint32_t set = 0;
  for (const MasterInfo& r : kMasters.rows)
    if (r.bridge == Bridge::kCore) set |= std::uint32_t{1} << index(r.id);
  return set;
}();
constexpr bool is_core(Master m) { return kCorePorts >> index(m) & 1u; }
/// A DMA master that moves data for the program, beside the core.
constexpr bool moves_data(const MasterInfo& row) {
  return row.bridge == Bridge::kDma && !row.synthetic;
}

/// Name of each port.
inline constexpr std::array<std::string_view, kMasterCount> kMasterNames = [] {
  std::array<std::string_view, kMasterCount> names;
  for (std::size_t i = 0; i < kMasterCount; ++i) names[i] = kMasters.rows[i].name;
  return names;
}();

/// Masters as statistics and parameters count them, `bus.<name>.read_bytes`.
inline constexpr std::size_t kStatCount = kMasters.stat_count();
inline constexpr std::array<std::uint8_t, kMasterCount> kStatIndex = [] {
  std::array<std::uint8_t, kMasterCount> of{};
  for (const MasterInfo& r : kMasters.rows)
    of[index(r.id)] = static_cast<std::uint8_t>(kMasters.stat_index(r.id));
  return of;
}();
inline constexpr std::array<std::string_view, kStatCount> kStatNames = [] {
  std::array<std::string_view, kStatCount> names;
  for (const MasterInfo& r : kMasters.rows) names[kMasters.stat_index(r.id)] = r.statistics;
  return names;
}();
constexpr std::size_t stat_index(Master m) { return kStatIndex[index(m)]; }
constexpr std::string_view stat_name(Master m) { return master_info(m).statistics; }
/// The first master that goes by a name in the statistics.
constexpr Master master_of_stat(std::size_t stat) {
  for (const MasterInfo& r : kMasters.rows)
    if (stat_index(r.id) == stat) return r.id;
  return Master::kCount;
}

/// The master whose priority comes from a source that serves one master only.
constexpr Master master_with(PrioritySource source) {
  for (const MasterInfo& r : kMasters.rows)
    if (r.priority == source) return r.id;
  return Master::kCount;
}

/// The n-th master behind a DMA or video bridge, in the order of the numbers; kCount: there are fewer.
constexpr Master wide_master(std::size_t n) {
  for (const MasterInfo& r : kMasters.rows)
    if (r.bridge != Bridge::kCore && n-- == 0) return r.id;
  return Master::kCount;
}

/// The transfer controllers of the EDMA.
inline constexpr unsigned kTransferControllers = [] {
  unsigned n = 0;
  for (const MasterInfo& r : kMasters.rows)
    n += r.priority == PrioritySource::kQueue && r.side == Side::kReads;
  return n;
}();
constexpr Master edma_side(unsigned controller, Side side) {
  for (const MasterInfo& r : kMasters.rows)
    if (r.priority == PrioritySource::kQueue && r.unit == controller && r.side == side) return r.id;
  return Master::kCount;
}
constexpr Master edma_read(unsigned controller) { return edma_side(controller, Side::kReads); }
constexpr Master edma_write(unsigned controller) { return edma_side(controller, Side::kWrites); }

}  // namespace fovea
