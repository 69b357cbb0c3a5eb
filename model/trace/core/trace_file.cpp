#include "model/trace/core/trace_file.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <map>
#include <sstream>

#include "model/common/check.h"
#include "model/common/waits.h"

namespace fovea::trace {
namespace {

constexpr std::string_view kMagic = "FOVEA-BUS-TRACE ", kVersions[] = {"1\n", "2\n", "3\n", "4\n", "5\n"};
constexpr std::uint32_t kBlockRecords = 8192;
// No record needs more, but for its accesses to internal RAM; a block that claims more is not ours.
constexpr std::uint32_t kMaxRecordBytes = 64, kMaxInfoBytes = 64u << 20;
// A block with such accesses ends with the record that brings it to so many bytes. A run of them takes up to ten.
constexpr std::uint32_t kBlockBytes = kBlockRecords * kMaxRecordBytes;
constexpr std::uint32_t kMaxBlockBytes = kBlockBytes + kMaxRecordBytes + 10 * kMaxRamRuns;
constexpr std::size_t kHeadBytes = 20;
enum BlockKind : std::uint8_t { kInfo = 'I', kRecords = 'R', kEnd = 'E' };

void put32(std::string& out, std::uint32_t v) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(v >> 8 * i));
}
std::uint32_t get32(const char* p) {
  std::uint32_t v = 0;
  for (int i = 0; i < 4; ++i)
    v |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(p[i])) << 8 * i;
  return v;
}
std::uint32_t checksum(const void* data, std::size_t n, std::uint32_t from = 0) {
  return static_cast<std::uint32_t>(
      ::crc32(from, static_cast<const Bytef*>(data), static_cast<uInt>(n)));
}

/// kind, stream, 2 x 0, records, raw bytes, packed bytes, CRC-32 of all before it and of the packed
/// bytes; then those.
std::string make_block(BlockKind kind, unsigned stream, std::uint32_t count, std::string_view raw) {
  uLongf size = ::compressBound(static_cast<uLong>(raw.size()));
  std::string packed(size, '\0');
  const int result = ::compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                                 reinterpret_cast<const Bytef*>(raw.data()),
                                 static_cast<uLong>(raw.size()), 6);
  FOVEA_CHECK(result == Z_OK, "a trace block could not be compressed");
  packed.resize(size);
  std::string out{static_cast<char>(kind), static_cast<char>(stream), 0, 0};
  put32(out, count);
  put32(out, static_cast<std::uint32_t>(raw.size()));
  put32(out, static_cast<std::uint32_t>(packed.size()));
  put32(out, checksum(packed.data(), packed.size(), checksum(out.data(), out.size())));
  return out + packed;
}

std::string info_text(const TraceInfo& info) {
  std::ostringstream out;
  out << "version " << std::size(kVersions) << "\n";  // under the checksum, which the first line is not
  out << "start " << info.start << "\nend " << info.end << "\nrefresh " << info.refresh
      << "\n";
  if (info.core_until != 0) out << "core_until " << info.core_until << "\n";
  for (const auto* c : {&info.scr, &info.ddr})
    out << (c == &info.scr ? "scr " : "ddr ") << c->frequency.num << ' ' << c->frequency.den << ' '
        << c->start << "\n";
  for (const auto& s : info.streams)
    out << "stream " << s.clock.num << ' ' << s.clock.den << ' ' << s.clock_start << ' ' << s.align
        << ' ' << s.phase << "\n";
  for (const auto& m : info.masters)
    out << "master " << index(m.id) << ' ' << m.stream << ' ' << m.reads << ' ' << m.writes << ' '
        << m.shared << ' ' << m.label << "\n";
  for (const auto& [key, value] : info.params) out << "param " << key << ' ' << value << "\n";
  Picoseconds last = 0;
  for (const Interrupt& i : info.interrupts) {
    out << "interrupt " << i.at - last;
    last = i.at;
    if (i.source != kInterrupt)
      out << ' ' << unsigned{i.source} << ' ' << static_cast<unsigned>(i.point) << ' ' << i.event << ' ' << i.after;
    out << "\n";
  }
  if (const EdmaInfo& e = info.edma; e.request_clocks != 0)
    out << "edma " << e.request_clocks << ' ' << e.fifo << ' ' << e.depth << ' ' << e.ram_latency << ' '
        << e.ram_word_clocks << ' ' << e.register_latency << "\n";
  if (const EdmaInfo& e = info.edma; e.ram_banks != 0)
    out << "ram " << e.ram_banks << ' ' << e.ram_hold << ' ' << e.ram_core_first << "\n";
  for (const Master m : info.kept) out << "kept " << index(m) << "\n";
  return out.str();
}

/// Takes the next word of a line as a number.
bool take_number(std::string_view& rest, std::uint64_t& v) {
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), v);
  if (error != std::errc{}) return false;
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  if (!rest.empty() && rest.front() != ' ') return false;
  if (!rest.empty()) rest.remove_prefix(1);
  return true;
}

}  // namespace

void TraceWriter::close_block(Stream& s, unsigned index) {
  if (s.count == 0) return;
  s.blocks.push_back(make_block(kRecords, index, s.count, s.raw));
  s.raw.clear();
  s.count = 0;
}

void TraceWriter::add(unsigned stream, const Record& record) {
  Stream& s = streams_[stream];
  encode(record, s.state, s.raw);
  ++records_;
  if (++s.count == kBlockRecords || s.raw.size() >= kBlockBytes) close_block(s, stream);
}

void TraceWriter::finish(const TraceInfo& info, const std::function<void(std::string_view)>& put) {
  put(std::string(kMagic) + std::string(kVersions[std::size(kVersions) - 1]));
  put(make_block(kInfo, 0, 0, info_text(info)));
  for (unsigned i = 0; i < streams_.size(); ++i) {
    close_block(streams_[i], i);
    for (const auto& block : streams_[i].blocks) put(block);
  }
  std::string total;
  put_number(total, records_);
  put(make_block(kEnd, 0, 0, total));
}

bool TraceFile::recognises(std::string_view bytes) { return bytes.starts_with(kMagic); }

void TraceFile::bad(const std::string& what) const {
  throw UserError("bus trace '" + name_ + "': " + what);
}

TraceFile::TraceFile(std::string name, std::string bytes)
    : TraceFile(std::move(name), std::make_unique<MemoryBytes>(std::move(bytes))) {}

TraceFile::TraceFile(std::string name, std::unique_ptr<ByteSource> bytes)
    : name_(std::move(name)), bytes_(std::move(bytes)) {
  const std::uint64_t size = bytes_->size();
  std::string begin(kMagic.size() + kVersions[0].size(), '\0');
  begin.resize(bytes_->read(0, begin.data(), begin.size()));
  if (!recognises(begin)) bad("it is not a bus trace");
  for (unsigned v = 0; v < std::size(kVersions); ++v)
    if (begin.substr(kMagic.size()) == kVersions[v]) version_ = v + 1;
  if (version_ == 0) bad("its version is not known; allowed: versions 1 to 5");
  std::uint64_t at = begin.size();
  bool ended = false, informed = false;
  while (at < size) {
    const std::string where = " at byte " + std::to_string(at);
    if (ended) bad("something follows its end" + where);
    if (size - at < kHeadBytes) bad("it is cut off" + where);
    char head[kHeadBytes];
    read(at, head, kHeadBytes);
    const auto kind = static_cast<std::uint8_t>(head[0]);
    const auto stream = static_cast<std::uint8_t>(head[1]);
    Block b{at + kHeadBytes, get32(head + 12), get32(head + 8), get32(head + 4), get32(head + 16)};
    if (size - b.offset < b.packed) bad("it is cut off" + where);
    if (checksum_of(b, checksum(head, kHeadBytes - 4)) != b.crc)
      bad("it is corrupted: wrong checksum" + where);
    const bool size_ok = kind == kRecords
                             ? b.count > 0 && b.count <= kBlockRecords &&
                                   b.raw <= (version_ < 5 ? b.count * kMaxRecordBytes : kMaxBlockBytes)
                             : b.raw <= kMaxInfoBytes;
    if (!size_ok) bad("it is corrupted: a block of impossible size" + where);
    if (!informed && kind != kInfo) bad("it is corrupted: no description" + where);
    if (kind == kInfo && !informed) {
      const auto raw = unpack(b);
      read_info({reinterpret_cast<const char*>(raw.data()), raw.size()});
      check_info();
      streams_.resize(info_.streams.size());
      for (std::size_t i = 0; i < streams_.size(); ++i)
        streams_[i].longest_gap = info_.streams[i].clock.num / info_.streams[i].clock.den * 3600;
      if (info_.edma.request_clocks != 0)
        for (const MasterInfo& m : info_.masters)
          streams_[m.stream].transfers |= master_info(m.id).priority == PrioritySource::kQueue;
      informed = true;
    } else if (kind == kRecords && stream < streams_.size()) {
      streams_[stream].blocks.push_back(b);
      streams_[stream].records += b.count;
      records_ += b.count;
    } else if (kind == kEnd) {
      try {
        const auto raw = unpack(b);
        if (ByteReader(raw).number() != records_) bad("it is corrupted: records are missing");
      } catch (const BadTrace& e) {
        bad(std::string("it is corrupted: ") + e.what());
      }
      ended = true;
    } else {
      bad("it is corrupted: an unknown block" + where);
    }
    at = b.offset + b.packed;
  }
  if (!ended) bad("it is cut off: its end is missing");
}

/// Reads what the file was seen to hold.
void TraceFile::read(std::uint64_t offset, char* to, std::size_t bytes) const {
  if (bytes_->read(offset, to, bytes) != bytes) bad("it became shorter while it was read");
}

std::uint32_t TraceFile::checksum_of(const Block& b, std::uint32_t from) const {
  std::array<char, 64 << 10> piece;
  for (std::uint32_t done = 0; done < b.packed;) {
    const std::size_t n = std::min<std::size_t>(piece.size(), b.packed - done);
    read(b.offset + done, piece.data(), n);
    from = checksum(piece.data(), n, from);
    done += static_cast<std::uint32_t>(n);
  }
  return from;
}

std::vector<std::uint8_t> TraceFile::unpack(const Block& b) const {
  std::string packed(b.packed, '\0');
  read(b.offset, packed.data(), packed.size());
  std::vector<std::uint8_t> raw(b.raw + 1u);  // never empty
  uLongf size = b.raw;
  const int result = ::uncompress(raw.data(), &size, reinterpret_cast<const Bytef*>(packed.data()),
                                  static_cast<uLong>(b.packed));
  if (result != Z_OK || size != b.raw) bad("it is corrupted: a block that cannot be unpacked");
  raw.resize(b.raw);
  return raw;
}

void TraceFile::read_info(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) bad("it is corrupted: its description is cut off");
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    const std::size_t space = std::min(line.find(' '), line.size());
    info_line(std::string(line.substr(0, space)),
              line.substr(std::min(space + 1, line.size())));
  }
}

void TraceFile::info_line(const std::string& key, std::string_view rest) {
  std::array<std::uint64_t, 6> v{};
  const auto numbers = [&](std::size_t n) {
    for (std::size_t i = 0; i < n; ++i)
      if (!take_number(rest, v[i])) bad("it is corrupted: '" + key + "' in its description");
  };
  const std::map<std::string_view, Picoseconds TraceInfo::*> times = {{"start", &TraceInfo::start},
                                                                      {"end", &TraceInfo::end},
                                                                      {"core_until", &TraceInfo::core_until},
                                                                      {"refresh", &TraceInfo::refresh}};
  if (const auto time = times.find(key); time != times.end()) {
    numbers(1);
    info_.*time->second = v[0];
  } else if (key == "version" && version_ >= 5) {
    numbers(1);
    if (v[0] != version_) bad("it is corrupted: its first line has another version than its description");
    version_told_ = true;
  } else if (key == "scr" || key == "ddr") {
    numbers(3);
    if (v[1] == 0) bad("it is corrupted: a clock without a frequency");
    ClockInfo& clock = key == "scr" ? info_.scr : info_.ddr;
    clock = ClockInfo{Frequency(v[0], v[1]), v[2]};
  } else if (key == "stream") {
    numbers(5);
    if (v[0] == 0 || v[1] == 0 || v[3] == 0 || v[3] > 64 || v[4] >= v[3])
      bad("it is corrupted: a stream with an impossible clock");
    info_.streams.push_back({Frequency(v[0], v[1]), v[2], static_cast<unsigned>(v[3]),
                             static_cast<unsigned>(v[4])});
  } else if (key == "master") {
    numbers(5);
    if (v[0] >= kMasterCount || v[2] == 0 || v[3] == 0 || v[4] > 1 ||
        std::max(v[2], v[3]) > kMaxWindow || (!v[4] && v[2] + v[3] > kMaxWindow))
      bad("it is corrupted: a master with an impossible window");
    MasterInfo m{static_cast<Master>(v[0]), std::string(rest), static_cast<unsigned>(v[1]),
                 static_cast<unsigned>(v[2]), static_cast<unsigned>(v[3]), v[4] != 0};
    info_.masters.push_back(std::move(m));
  } else if (key == "param") {
    const std::size_t space = std::min(rest.find(' '), rest.size());
    info_.params.emplace_back(rest.substr(0, space),
                              rest.substr(std::min(space + 1, rest.size())));
  } else if (key == "interrupt") {
    numbers(1);
    Interrupt i{v[0] + (info_.interrupts.empty() ? 0 : info_.interrupts.back().at)};
    if (!rest.empty()) {
      numbers(4);
      if (v[0] >= kMasterCount || v[1] >= kPoints || v[2] >> 40)
        bad("it is corrupted: an interrupt by an impossible event");
      i.source = static_cast<std::uint8_t>(v[0]);
      i.point = static_cast<Point>(v[1]);
      i.event = v[2];
      i.after = v[3];
    }
    info_.interrupts.push_back(i);
  } else if (key == "edma") {
    numbers(6);
    const bool sizes = v[0] != 0 && v[0] <= 1024 && v[1] >= 2 * kMaxBurstBytes && v[1] <= 4096 && v[2] != 0 &&
                       v[2] <= 32 && v[3] <= 1024 && v[4] != 0 && v[4] <= 1024 && v[5] <= kPsPerMs;
    if (!sizes) bad("it is corrupted: an impossible EDMA");
    info_.edma = {static_cast<unsigned>(v[0]), static_cast<unsigned>(v[1]), static_cast<unsigned>(v[2]),
                  static_cast<unsigned>(v[3]), static_cast<unsigned>(v[4]), v[5]};
  } else if (key == "ram") {
    numbers(3);
    if (v[0] == 0 || v[0] > kMaxRamBanks || v[1] == 0 || v[1] > 1024 || v[2] > 1 || info_.edma.request_clocks == 0)
      bad("it is corrupted: an impossible internal RAM");
    info_.edma.ram_banks = static_cast<unsigned>(v[0]);
    info_.edma.ram_hold = static_cast<unsigned>(v[1]);
    info_.edma.ram_core_first = v[2] != 0;
  } else if (key == "kept") {
    numbers(1);
    if (v[0] >= kMasterCount) bad("it is corrupted: an unknown master");
    info_.kept.push_back(static_cast<Master>(v[0]));
  } else {
    bad("it is corrupted: '" + key + "' in its description");
  }
}

void TraceFile::check_info() {
  constexpr Picoseconds kLatest = 3600 * kPsPerSecond;
  const auto time_ok = [](Picoseconds t) { return t <= kLatest; };
  bool ok = info_.start <= info_.end && info_.core_until <= info_.end && info_.refresh <= info_.start &&
            time_ok(info_.end) && !info_.streams.empty() &&
            info_.streams.size() <= kMasterCount && !info_.masters.empty();
  for (const auto& c : {info_.scr, info_.ddr})
    ok = ok && time_ok(c.start) && c.frequency.den <= 100 && c.frequency.hertz() <= 1e10;
  for (const auto& s : info_.streams) {
    const double hertz = s.clock.hertz();
    ok = ok && time_ok(s.clock_start) && hertz >= 1e3 && hertz <= 1e12 && s.clock.den <= 1'000'000;
  }
  for (const Interrupt& i : info_.interrupts)
    ok = ok && time_ok(i.at) && i.after <= i.at && (i.source == kInterrupt || i.source < info_.streams.size());
  std::array<bool, kMasterCount> seen{};
  for (const auto& m : info_.masters) {
    ok = ok && m.stream < info_.streams.size() && !seen[index(m.id)] && !m.label.empty() &&
         !is_culprit_name(m.label);
    seen[index(m.id)] = true;
    stream_of_[index(m.id)] = m.stream;
  }
  if (!ok) bad("it is corrupted: an impossible description");
  if (version_ >= 5 && !version_told_) bad("it is corrupted: its description has no version");
  // Before version 4 nothing was noted of what the EDMA waits for.
  if (version_ < 4)
    for (const MasterInfo& m : info_.masters)
      if (master_info(m.id).pace == Pace::kTransfers) info_.kept.push_back(m.id);
}

void TraceFile::open_block(Stream& s) {
  const Block& b = s.blocks[s.next_block++];
  s.raw = unpack(b);
  s.in = ByteReader(s.raw);
  s.left = b.count;
}

bool TraceFile::next(unsigned stream, Record& record) {
  Stream& s = streams_[stream];
  if (s.left == 0) {
    if (!s.in.empty()) bad("it is corrupted: more records than a block says");
    if (s.next_block == s.blocks.size()) return false;
    open_block(s);
  }
  --s.left;
  try {
    decode(s.in, s.state, record, version_);
    if (record.on_bus() && stream_of_[index(record.master)] != stream)
      throw BadTrace("a master in another's stream");
    if (record.kind == Kind::kTransfer && !s.transfers) throw BadTrace("a transfer in another's stream");
    if (record.gap > s.longest_gap || record.wake_gap > s.longest_gap)
      throw BadTrace("a gap of hours");
    if ((!record.ram.empty() || record.look_clocks != 0) && (stream != 0 || info_.edma.ram_banks == 0))
      throw BadTrace("accesses to internal RAM of another stream than the core's");
    const auto no_bank = [&](const RamRun& r) { return r.bank >= info_.edma.ram_banks; };
    const bool looks = record.look_clocks != 0;
    if (std::any_of(record.ram.begin(), record.ram.end(), no_bank) || (looks && no_bank({0, 1, record.look_bank})))
      throw BadTrace("an unknown bank of internal RAM");
    if (record.back > s.read || record.room > s.read) throw BadTrace("a reference to before the first record");
    if (record.release == Release::kWhen) {
      const bool interrupt = record.source == kInterrupt;
      const bool own = record.source == stream && record.kind != Kind::kTransfer;
      if (!interrupt && (record.source >= streams_.size() || own)) throw BadTrace("an unknown stream");
      const std::uint64_t events = interrupt                 ? info_.interrupts.size()
                                   : record.source == stream ? s.read
                                                             : streams_[record.source].records;
      if (record.event >= events) throw BadTrace("an event that never came");
    }
    if (record.release == Release::kAt && record.at > info_.end + kPsPerSecond)
      throw BadTrace("a time after its end");
  } catch (const BadTrace& e) {
    bad("it is corrupted: " + std::string(e.what()) + " (stream " + std::to_string(stream) +
        ", record " + std::to_string(s.read) + ")");
  }
  ++s.read;
  return true;
}

}  // namespace fovea::trace
