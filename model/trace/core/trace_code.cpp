#include "model/trace/core/trace_code.h"

namespace fovea::trace {
namespace {

// First byte of a record.
constexpr std::uint8_t kWrite = 1, kReleaseShift = 1, kMark = 3 << kReleaseShift, kFromFirst = 8,
                       kCritical = 16, kAttributes = 32, kBackOne = 64, kOtherMaster = 128;

/// Of version 3 on.
bool has_room(const Record& r) { return r.write && !r.mark && r.release == Release::kAfter; }

}  // namespace

void put_number(std::string& out, std::uint64_t v) {
  for (; v >= 0x80; v >>= 7) out.push_back(static_cast<char>(v | 0x80));
  out.push_back(static_cast<char>(v));
}

void encode(const Record& r, CodeState& s, std::string& out) {
  CodeState::Kind& kind = s.kinds[index(r.master)][r.write];
  const bool attributes =
      !r.mark && (kind.bytes != r.bytes || kind.priority != r.priority || kind.locked != r.locked);
  std::uint8_t head = r.write ? kWrite : 0;
  head |= r.mark ? kMark : static_cast<std::uint8_t>(r.release) << kReleaseShift;
  if (r.from_first) head |= kFromFirst;
  if (r.critical) head |= kCritical;
  if (attributes) head |= kAttributes;
  if (r.back == 1) head |= kBackOne;
  if (!r.mark && r.master != s.master) head |= kOtherMaster;
  out.push_back(static_cast<char>(head));
  if (r.mark) {
    put_number(out, static_cast<std::uint64_t>(r.release));
    put_number(out, r.address);
  } else {
    if (head & kOtherMaster) put_number(out, index(s.master = r.master));
    if (attributes) {
      put_number(out, r.bytes);
      put_number(out, r.priority | (r.locked ? 8u : 0u));
      kind.bytes = r.bytes;
      kind.priority = r.priority;
      kind.locked = r.locked;
    }
    if (r.critical) put_number(out, r.critical);
    put_number(out, zigzag(std::uint64_t{r.address} - kind.address));
    kind.address = r.address;
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
    put_number(out, r.source == kInterrupt ? 0 : r.source + 1u);
    std::uint64_t& last = s.event(r.source);
    put_number(out, zigzag(r.event - last));
    put_number(out, r.wake_gap);
    last = r.event;
  }
}

namespace {

/// Master, attributes and address of a request; each is coded against the last one of its kind.
void decode_request(ByteReader& in, std::uint8_t head, CodeState& s, Record& r) {
  if (head & kOtherMaster) {
    const std::uint64_t master = in.number();
    if (master >= kMasterCount) throw BadTrace("unknown master");
    s.master = static_cast<Master>(master);
  }
  r.master = s.master;
  CodeState::Kind& kind = s.kinds[index(r.master)][r.write];
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
}

/// What a request waits for that an event releases.
void decode_event(ByteReader& in, CodeState& s, Record& r, unsigned version) {
  const std::uint64_t source = version == 1 ? 0 : in.number();
  if (source > kMasterCount) throw BadTrace("an unknown stream");
  r.source = source == 0 ? kInterrupt : static_cast<std::uint8_t>(source - 1);
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
  const std::uint8_t head = in.byte();
  r.write = head & kWrite;
  r.from_first = head & kFromFirst;
  r.mark = (head & kMark) == kMark;
  std::uint64_t release = head >> kReleaseShift & 3u;
  if (r.mark) {
    release = in.number();
    if (release > 2) throw BadTrace("unknown release");
    const std::uint64_t value = in.number();
    if (value > ~std::uint32_t{0}) throw BadTrace("a mark is too large");
    r.address = static_cast<std::uint32_t>(value);
  } else {
    decode_request(in, head, s, r);
  }
  r.release = static_cast<Release>(release);
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
