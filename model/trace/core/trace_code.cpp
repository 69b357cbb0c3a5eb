#include "model/trace/core/trace_code.h"

namespace fovea::trace {
namespace {

// First byte of a record.
constexpr std::uint8_t kWrite = 1, kReleaseShift = 1, kNoRequest = 3 << kReleaseShift, kFromFirst = 8,
                       kCritical = 16, kAttributes = 32, kBackOne = 64, kOtherMaster = 128;
// Second byte without a request: the release, and from there on the kind.
constexpr unsigned kKindShift = 2;
// Of a master's number: the request goes aside. Of a source: from there on the point.
constexpr unsigned kAsideBit = 32, kPointShift = 6;
static_assert(kMasterCount < kAsideBit && kMasterCount + 1 < 1u << kPointShift);
// What of a transfer differs from the one before.
constexpr std::uint8_t kIndices = 1, kCounts = 2, kModes = 4, kRamWaits = 8;

/// In place of a kind: what follows are accesses to internal RAM, then their record. Of version 5 on.
constexpr unsigned kWork = static_cast<unsigned>(Kind::kTransfer) - static_cast<unsigned>(Kind::kMark) + 1;

/// Of version 3 on.
bool has_room(const Record& r) { return r.write && r.on_bus() && r.release == Release::kAfter; }

std::uint64_t modes(const TransferRequest& t, unsigned burst, unsigned priority) {
  return t.source.constant | t.destination.constant << 1 | std::uint64_t{t.fifo_bytes} << 2 | burst << 10 |
         priority << 18;
}

}  // namespace

void put_number(std::string& out, std::uint64_t v) {
  for (; v >= 0x80; v >>= 7) out.push_back(static_cast<char>(v | 0x80));
  out.push_back(static_cast<char>(v));
}

namespace {

void encode_request(const Record& r, std::uint8_t head, CodeState& s, std::string& out) {
  CodeState::Kind& kind = s.kind_of(r);
  if (head & kOtherMaster) {
    s.master = r.master;
    s.aside = r.kind == Kind::kAside;
    put_number(out, index(r.master) + (s.aside ? kAsideBit : 0u));
  }
  if (head & kAttributes) {
    put_number(out, r.bytes);
    put_number(out, r.priority | (r.locked ? 8u : 0u));
    kind.bytes = r.bytes;
    kind.priority = r.priority;
    kind.locked = r.locked;
  }
  if (r.critical) put_number(out, r.critical);
  put_number(out, zigzag(std::uint64_t{r.address} - kind.address));
  kind.address = r.address;
  if (r.kind == Kind::kAside) put_number(out, r.service);
}

void encode_transfer(const Record& r, CodeState& s, std::string& out) {
  const TransferRequest &t = r.transfer, &last = s.transfer;
  const auto difference = [](auto now, auto before) {
    return zigzag(static_cast<std::uint64_t>(static_cast<std::int64_t>(now) - static_cast<std::int64_t>(before)));
  };
  std::uint8_t changed = 0;
  if (t.source.index != last.source.index || t.destination.index != last.destination.index) changed |= kIndices;
  if (t.acnt != last.acnt || t.bcnt != last.bcnt) changed |= kCounts;
  if (modes(t, r.burst, r.priority) != modes(last, s.burst, s.transfer_priority)) changed |= kModes;
  if (!r.ram_waits[0].empty() || !r.ram_waits[1].empty()) changed |= kRamWaits;
  out.push_back(static_cast<char>(changed));
  put_number(out, difference(t.source.address, last.source.address));
  put_number(out, difference(t.destination.address, last.destination.address));
  if (changed & kIndices) {
    put_number(out, difference(t.source.index, 0));
    put_number(out, difference(t.destination.index, 0));
  }
  if (changed & kCounts) {
    put_number(out, t.acnt);
    put_number(out, t.bcnt);
  }
  if (changed & kModes) put_number(out, modes(t, r.burst, r.priority));
  if (changed & kRamWaits)
    for (const auto& waits : r.ram_waits) {
      put_number(out, waits.size());
      for (const std::uint16_t n : waits) put_number(out, n);
    }
  s.transfer = t;
  s.burst = r.burst;
  s.transfer_priority = r.priority;
}

/// The core's accesses to internal RAM in the record's gap: they come before it.
void encode_ram(const Record& r, std::string& out) {
  out.push_back(static_cast<char>(kNoRequest));
  put_number(out, kWork << kKindShift);
  put_number(out, r.ram.size() << 1 | (r.look_clocks != 0 ? 1u : 0u));
  if (r.look_clocks != 0) {
    put_number(out, r.look_after);
    put_number(out, std::uint64_t{r.look_clocks} * kMaxRamBanks + r.look_bank);
  }
  for (const RamRun& run : r.ram) {
    put_number(out, std::uint64_t{run.skip} * (2 * kMaxRamBanks) + (run.together ? kMaxRamBanks : 0u) + run.bank);
    put_number(out, run.count);
  }
}

bool has_ram(const Record& r) { return !r.ram.empty() || r.look_clocks != 0; }

}  // namespace

void encode(const Record& r, CodeState& s, std::string& out) {
  if (has_ram(r)) encode_ram(r, out);
  const CodeState::Kind& kind = s.kind_of(r);
  const bool attributes =
      r.on_bus() && (kind.bytes != r.bytes || kind.priority != r.priority || kind.locked != r.locked);
  std::uint8_t head = r.write ? kWrite : 0;
  head |= r.on_bus() ? static_cast<std::uint8_t>(r.release) << kReleaseShift : kNoRequest;
  if (r.from_first) head |= kFromFirst;
  if (r.critical) head |= kCritical;
  if (attributes) head |= kAttributes;
  if (r.back == 1) head |= kBackOne;
  if (r.on_bus() && (r.master != s.master || (r.kind == Kind::kAside) != s.aside)) head |= kOtherMaster;
  out.push_back(static_cast<char>(head));
  if (r.on_bus()) {
    encode_request(r, head, s, out);
  } else {
    const unsigned kind_number = static_cast<unsigned>(r.kind) - static_cast<unsigned>(Kind::kMark);
    put_number(out, static_cast<unsigned>(r.release) | kind_number << kKindShift);
    if (r.kind == Kind::kMark) put_number(out, r.address);
    if (r.kind == Kind::kStep) put_number(out, r.service);
    if (r.kind == Kind::kTransfer) encode_transfer(r, s, out);
  }
  if (r.release == Release::kAt) {
    put_number(out, zigzag(r.at - s.at));
    s.at = r.at;
    return;
  }
  if (r.back != 1) put_number(out, r.back);
  put_number(out, r.gap);
  if (has_room(r)) put_number(out, r.room);
  if (r.release == Release::kWhen) {
    put_number(out, r.source == kInterrupt ? 0
                                           : (r.source + 1u) | static_cast<unsigned>(r.point) << kPointShift);
    std::uint64_t& last = s.event(r.source);
    put_number(out, zigzag(r.event - last));
    put_number(out, r.wake_gap);
    last = r.event;
  }
}

namespace {

/// Master, attributes and address of a request; each is coded against the last one of its kind.
void decode_request(ByteReader& in, std::uint8_t head, CodeState& s, Record& r, unsigned version) {
  if (head & kOtherMaster) {
    const std::uint64_t master = in.number();
    s.aside = version >= 4 && master & kAsideBit;
    const std::uint64_t number = s.aside ? master - kAsideBit : master;
    if (number >= kMasterCount) throw BadTrace("unknown master");
    s.master = static_cast<Master>(number);
  }
  r.master = s.master;
  if (s.aside) r.kind = Kind::kAside;
  CodeState::Kind& kind = s.kind_of(r);
  if (head & kAttributes) {
    const std::uint64_t bytes = in.number(), rest = in.number();
    if (bytes == 0 || bytes > kMaxBurstBytes || rest > 15) throw BadTrace("a burst of no size");
    kind.bytes = static_cast<std::uint8_t>(bytes);
    kind.priority = rest & 7u;
    kind.locked = rest & 8u;
  }
  if (kind.bytes == 0) throw BadTrace("a burst without a size");
  if (head & kCritical) {
    const std::uint64_t critical = in.number();
    if (critical >= kind.bytes) throw BadTrace("a critical word outside its burst");
    r.critical = static_cast<std::uint8_t>(critical);
  }
  const std::uint64_t address = kind.address + unzigzag(in.number());
  if (address > ~std::uint32_t{0}) throw BadTrace("an address beyond 4 GiB");
  kind.address = static_cast<std::uint32_t>(address);
  r.address = kind.address;
  r.bytes = kind.bytes;
  r.priority = kind.priority;
  r.locked = kind.locked;
  if (r.kind != Kind::kAside) return;
  r.service = in.number();
  if (r.service > kPsPerMs) throw BadTrace("an impossible access to a register");
}

/// A transfer request; what has not changed is that of the one before.
void decode_transfer(ByteReader& in, CodeState& s, Record& r) {
  TransferRequest& t = s.transfer;
  const auto signed_number = [&in] { return static_cast<std::int64_t>(unzigzag(in.number())); };
  const std::uint8_t changed = in.byte();
  for (TransferRequest::Side* side : {&t.source, &t.destination})
    side->address = static_cast<std::uint32_t>(side->address + static_cast<std::uint64_t>(signed_number()));
  if (changed & kIndices)
    for (TransferRequest::Side* side : {&t.source, &t.destination}) {
      const std::int64_t index = signed_number();
      if (index < -32768 || index > 32767) throw BadTrace("an impossible transfer");
      side->index = static_cast<std::int32_t>(index);
    }
  if (changed & kCounts)
    for (std::uint16_t* count : {&t.acnt, &t.bcnt}) {
      const std::uint64_t n = in.number();
      if (n > 0xFFFF) throw BadTrace("an impossible transfer");
      *count = static_cast<std::uint16_t>(n);
    }
  if (changed & kModes) {
    const std::uint64_t word = in.number();
    t.source.constant = word & 1u;
    t.destination.constant = word >> 1 & 1u;
    t.fifo_bytes = static_cast<std::uint8_t>(word >> 2);
    s.burst = static_cast<std::uint8_t>(word >> 10);
    s.transfer_priority = word >> 18 & 7u;
    const auto power_of_two = [](unsigned n, unsigned most) { return n != 0 && n <= most && (n & (n - 1)) == 0; };
    if (word >> 21 || !power_of_two(t.fifo_bytes, 32) || !power_of_two(s.burst, kMaxBurstBytes))
      throw BadTrace("an impossible transfer");
  }
  if (changed & kRamWaits)
    for (auto& waits : r.ram_waits)
      for (std::uint64_t left = in.number(); left != 0; --left) {
        const std::uint64_t n = in.number();
        if (n >> 16 || waits.size() == t.bytes()) throw BadTrace("an impossible transfer");
        waits.push_back(static_cast<std::uint16_t>(n));
      }
  if (s.burst == 0) throw BadTrace("an impossible transfer");
  r.transfer = t;
  r.burst = s.burst;
  r.priority = s.transfer_priority;
}

/// The core's accesses to internal RAM.
void decode_ram(ByteReader& in, Record& r) {
  const auto clocks = [&in](std::uint64_t of) {
    const std::uint64_t n = in.number();
    if (n / of > ~std::uint32_t{0}) throw BadTrace("an impossible access to internal RAM");
    return n;
  };
  const std::uint64_t head = in.number();
  if (head >> 1 > kMaxRamRuns) throw BadTrace("too many accesses to internal RAM");
  if (head & 1) {
    r.look_after = static_cast<std::uint32_t>(clocks(1));
    const std::uint64_t look = clocks(kMaxRamBanks);
    r.look_clocks = static_cast<std::uint32_t>(look / kMaxRamBanks);
    r.look_bank = static_cast<std::uint8_t>(look % kMaxRamBanks);
    if (r.look_clocks == 0) throw BadTrace("an impossible look at internal RAM");
  }
  r.ram.resize(head >> 1);
  for (RamRun& run : r.ram) {
    const std::uint64_t n = clocks(2 * kMaxRamBanks);
    run.skip = static_cast<std::uint32_t>(n / (2 * kMaxRamBanks));
    run.together = n / kMaxRamBanks & 1;
    run.bank = static_cast<std::uint8_t>(n % kMaxRamBanks);
    run.count = static_cast<std::uint32_t>(clocks(1));
    if (run.count == 0) throw BadTrace("an impossible access to internal RAM");
  }
}

/// What a request waits for that an event releases.
void decode_event(ByteReader& in, CodeState& s, Record& r, unsigned version) {
  const std::uint64_t source = version == 1 ? 0 : in.number();
  const std::uint64_t stream = version >= 4 ? source & ((1u << kPointShift) - 1) : source;
  const std::uint64_t point = version >= 4 ? source >> kPointShift : 0;
  if (stream > kMasterCount || point >= kPoints) throw BadTrace("an unknown stream");
  r.source = stream == 0 ? kInterrupt : static_cast<std::uint8_t>(stream - 1);
  r.point = static_cast<Point>(point);
  std::uint64_t& last = s.event(r.source);
  last += unzigzag(in.number());
  const std::uint64_t gap = in.number();
  if (last >> 40 || gap > ~std::uint32_t{0}) throw BadTrace("an event too far");
  r.event = last;
  r.wake_gap = static_cast<std::uint32_t>(gap);
}

}  // namespace

void decode(ByteReader& in, CodeState& s, Record& r, unsigned version) {
  r = Record{};
  std::uint8_t head = in.byte();
  std::uint64_t word = head == kNoRequest ? in.number() : 0;
  const bool work = version >= 5 && head == kNoRequest && word == kWork << kKindShift;
  if (work) {
    decode_ram(in, r);
    head = in.byte();
  }
  r.write = head & kWrite;
  r.from_first = head & kFromFirst;
  std::uint64_t release = head >> kReleaseShift & 3u;
  if ((head & kNoRequest) == kNoRequest) {
    if (work || head != kNoRequest) word = in.number();
    release = word & ((1u << kKindShift) - 1);
    const std::uint64_t kind = (word >> kKindShift) + static_cast<unsigned>(Kind::kMark);
    if (release > 2 || kind > static_cast<unsigned>(version >= 4 ? Kind::kTransfer : Kind::kMark))
      throw BadTrace("unknown release");
    r.kind = static_cast<Kind>(kind);
    if (r.kind == Kind::kMark) {
      const std::uint64_t value = in.number();
      if (value > ~std::uint32_t{0}) throw BadTrace("a mark is too large");
      r.address = static_cast<std::uint32_t>(value);
    }
    if (r.kind == Kind::kStep && (r.service = in.number()) > kPsPerMs) throw BadTrace("a step too far");
    if (r.kind == Kind::kTransfer) decode_transfer(in, s, r);
  } else {
    decode_request(in, head, s, r, version);
  }
  r.release = static_cast<Release>(release);
  if (work && (r.release == Release::kAt || (r.look_clocks != 0 && r.kind != Kind::kStep)))
    throw BadTrace("accesses to internal RAM of a record without a gap");
  if (r.release == Release::kAt) {
    r.at = s.at += unzigzag(in.number());
    return;
  }
  const std::uint64_t back = head & kBackOne ? 1 : in.number();
  if (back > kMaxBack) throw BadTrace("a reference too far back");
  r.back = static_cast<std::uint32_t>(back);
  r.gap = in.number();
  if (version >= 3 && has_room(r)) {
    const std::uint64_t room = in.number();
    if (room > kMaxBack) throw BadTrace("a reference too far back");
    r.room = static_cast<std::uint32_t>(room);
  }
  if (r.release == Release::kWhen) decode_event(in, s, r, version);
}

}  // namespace fovea::trace
