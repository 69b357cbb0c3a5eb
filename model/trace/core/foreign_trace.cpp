#include "model/trace/core/foreign_trace.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <charconv>

#include "model/trace/core/text_trace.h"

namespace fovea::trace {
namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::size_t kBlock = 256 << 10;
// Words for a direction, each between blanks. DRAMsim3 takes what is not a write for a read; here
// only its own words are.
constexpr std::string_view kDramsysReads = " read ", kDramsysWrites = " write ",
                           kRamulatorReads = " R ", kRamulatorWrites = " W ",
                           kRamulator2Reads = " LD ", kRamulator2Writes = " ST ",
                           kDramsim3Reads = " READ read P_MEM_RD P_FETCH ",
                           kDramsim3Writes = " WRITE write P_MEM_WR BOFF ";

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(kBlank, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

bool is_one_of(std::string_view word, std::string_view list) {
  return list.find(" " + std::string(word) + " ") != std::string_view::npos;
}

bool is_number(std::string_view word, int base, std::uint64_t& v) {
  if (base == 16 && (word.starts_with("0x") || word.starts_with("0X"))) word.remove_prefix(2);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v, base);
  return error == std::errc{} && end == word.data() + word.size();
}

/// Nothing but a comment, which DRAMSys has, or blanks.
bool is_empty(const std::vector<std::string_view>& words) {
  return words.empty() || words[0].starts_with('#');
}

/// The form of the format's lines, for messages.
std::string form(ForeignFormat f) {
  switch (f) {
    case ForeignFormat::kDramsysStl:
    case ForeignFormat::kDramsysRstl:
      return "'CYCLE: [(BYTES)] read|write 0xADDRESS'";
    case ForeignFormat::kRamulator:
      return "'0xADDRESS R|W'";
    case ForeignFormat::kRamulator2:
      return "'LD|ST ADDRESS'";
    case ForeignFormat::kDramsim3:
      return "'0xADDRESS READ|WRITE CYCLE'";
  }
  return {};
}

using Words = std::vector<std::string_view>;

/// The first line that is neither empty nor a comment; number 0: there is none.
struct FirstLine {
  std::uint64_t number = 0;
  Words words;
};
FirstLine first_line(std::string_view bytes) {
  for (std::uint64_t number = 1; !bytes.empty(); ++number) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    Words words = split(bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    if (!is_empty(words)) return {number, std::move(words)};
  }
  return {};
}

/// `3 20734016`, `8 20841280 20841280`: instructions of a core, the address of a read, that of a write-back.
bool is_cpu_trace(const Words& words) {
  const auto number = [](std::string_view w) {
    std::uint64_t v;
    return is_number(w, w.starts_with("0x") ? 16 : 10, v);
  };
  return (words.size() == 2 || words.size() == 3) && std::all_of(words.begin(), words.end(), number);
}
constexpr const char* kCpuTrace =
    "a line of a CPU trace of Ramulator: instructions of a core, a read, a write-back; a core decides their times, "
    "which no replay has; allowed: a memory trace";

/// `R 0,0,1,2,40,7`
bool is_address_vector(const Words& words) {
  return words.size() == 2 && (words[0] == "R" || words[0] == "W") &&
         words[1].find_first_not_of("0123456789,") == std::string_view::npos;
}
constexpr const char* kAddressVector =
    "a line of Ramulator 2's ReadWriteTrace, whose address vector names bank, row and column of another memory; "
    "allowed: 'LD|ST ADDRESS'";

/// The first bytes of what gzip has packed; empty if it did not.
std::string unpacked(std::string_view bytes) {
  std::string out(16, '\0');
  z_stream z{};
  if (!bytes.starts_with("\x1f\x8b") || inflateInit2(&z, 15 + 16) != Z_OK) return {};
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  inflate(&z, Z_SYNC_FLUSH);
  out.resize(out.size() - z.avail_out);
  inflateEnd(&z);
  return out;
}

}  // namespace

std::optional<ForeignFormat> recognise_foreign(std::string_view first_bytes) {
  const Words words = first_line(first_bytes).words;
  std::uint64_t v;
  if (words.size() < 2) return std::nullopt;
  if (words[0].ends_with(':') && words.size() >= 3 &&
      is_number(words[0].substr(0, words[0].size() - 1), 10, v))
    return ForeignFormat::kDramsysStl;
  if (words.size() == 2 &&
      (is_one_of(words[0], kRamulator2Reads) || is_one_of(words[0], kRamulator2Writes)))
    return ForeignFormat::kRamulator2;
  if (!is_number(words[0], 16, v)) return std::nullopt;
  if (words.size() == 2 &&
      (is_one_of(words[1], kRamulatorReads) || is_one_of(words[1], kRamulatorWrites)))
    return ForeignFormat::kRamulator;
  if (words.size() == 3 && is_number(words[2], 10, v) &&
      (is_one_of(words[1], kDramsim3Reads) || is_one_of(words[1], kDramsim3Writes)))
    return ForeignFormat::kDramsim3;
  return std::nullopt;
}

ForeignRefusal refuse_foreign(std::string_view first_bytes) {
  // gem5, protoio.hh: the number that its streams of messages begin with.
  constexpr std::string_view kGem5 = "gem5";
  constexpr const char* kPackets = "a packet trace of gem5 (protobuf), which is not read";
  if (first_bytes.starts_with(kGem5)) return {0, kPackets};
  if (first_bytes.starts_with("\x1f\x8b")) {
    if (unpacked(first_bytes).starts_with(kGem5)) return {0, kPackets};
    return {0, "packed by gzip; unpack it first"};
  }
  if (first_bytes.starts_with("\xfd" "7zXZ")) return {0, "packed by xz; unpack it first"};
  if (first_bytes.starts_with("\x28\xb5\x2f\xfd")) return {0, "packed by zstd; unpack it first"};
  if (first_bytes.starts_with("\xff\xfe") || first_bytes.starts_with("\xfe\xff"))
    return {0, "text in UTF-16; make it UTF-8 first"};
  const FirstLine first = first_line(first_bytes);
  if (first.number == 0) return {0, "without a request"};
  if (is_cpu_trace(first.words)) return {first.number, kCpuTrace};
  if (is_address_vector(first.words)) return {first.number, kAddressVector};
  std::string line;
  for (const auto w : first.words) line.append(line.empty() ? "" : " ").append(w);
  return {first.number, "'" + line.substr(0, 40) + "', a line of none of the known trace formats"};
}

ForeignTrace::ForeignTrace(std::string name, std::unique_ptr<ByteSource> bytes,
                           const ForeignReading& reading)
    : name_(std::move(name)), bytes_(std::move(bytes)), reading_(reading), lines_(name_, *bytes_, kBlock) {
  info_.streams.emplace_back();
  info_.masters.push_back(
      {TextTrace::port(0), reading.label, 0, reading.window, TextTrace::kWrites, false});
}

void ForeignTrace::bad(std::string what) const {
  std::replace_if(
      what.begin(), what.end(), [](unsigned char c) { return c < 0x20; }, '?');
  throw UserError("trace '" + name_ + "':" + std::to_string(lines_.line) + ": " + what);
}

std::uint64_t ForeignTrace::address(std::string_view word, bool decimal_allowed) const {
  const bool hex = !decimal_allowed || word.starts_with("0x") || word.starts_with("0X");
  std::uint64_t v = 0;
  if (!is_number(word, hex ? 16 : 10, v))
    bad("address '" + std::string(word.substr(0, 40)) + "' is not allowed; allowed: " +
        (decimal_allowed ? "a number of 64 bits, decimal or 0x..."
                         : "a hexadecimal number of 64 bits"));
  return v;
}

Picoseconds ForeignTrace::time(std::string_view word) {
  std::uint64_t cycle = 0;
  if (!is_number(word, 10, cycle))
    bad("cycle '" + std::string(word.substr(0, 40)) +
        "' is not allowed; allowed: a decimal number");
  unsigned __int128 sum = cycle;
  if (reading_.format == ForeignFormat::kDramsysRstl) sum += cycle_;
  const unsigned __int128 at = sum * kPsPerSecond * reading_.clock.den / reading_.clock.num;
  if (at > TextTrace::kLatest)
    bad("cycle " + std::string(word.substr(0, 40)) + " is later than the 100 s allowed");
  cycle_ = static_cast<std::uint64_t>(sum);
  return static_cast<Picoseconds>(at);
}

void ForeignTrace::read_direction(std::string_view word, std::string_view reads,
                                  std::string_view writes) {
  request_.write = is_one_of(word, writes);
  if (request_.write || is_one_of(word, reads)) return;
  const auto list = [](std::string_view words) {
    std::string out;
    for (const auto w : split(words)) out.append(out.empty() ? "" : ", ").append(w);
    return out;
  };
  bad("direction '" + std::string(word.substr(0, 40)) +
      "' is not allowed; allowed: " + list(reads) + ", " + list(writes));
}

void ForeignTrace::read_dramsys(const Words& words) {
  std::size_t n = 0;
  std::string_view cycle = words[n++];
  if (cycle.ends_with(':')) cycle.remove_suffix(1);
  request_.at = time(cycle);
  std::uint64_t bytes = reading_.bytes;
  if (n < words.size() && words[n].starts_with('(')) {
    std::string_view size = words[n++].substr(1);
    if (!size.ends_with(')') || !is_number(size.substr(0, size.size() - 1), 10, bytes) ||
        bytes - 1 >= TextTrace::kMaxBytes)
      bad("size '(" + std::string(size.substr(0, 40)) + "' is not allowed; allowed: (1) to (" +
          std::to_string(TextTrace::kMaxBytes) + ")");
    if (!std::has_single_bit(bytes))
      bad("size '(" + std::to_string(bytes) + ")' is not allowed; DRAMSys has powers of two only");
  }
  request_.bytes = static_cast<unsigned>(bytes);
  if (words.size() < n + 2) bad("a request is " + form(reading_.format));
  read_direction(words[n], kDramsysReads, kDramsysWrites);
  request_.address = address(words[n + 1], false);
  // A write may carry its data, which no replay needs.
  const bool data = request_.write && words.size() == n + 3 && words[n + 2].starts_with("0x");
  if (words.size() != n + 2 && !data) bad("a request is " + form(reading_.format));
}

void ForeignTrace::read_ramulator(const Words& words) {
  if (is_cpu_trace(words)) bad(kCpuTrace);
  if (words.size() > 2) bad("a request is " + form(reading_.format));
  request_.address = address(words[0], false);
  // It looks at the first letter only, and reads where there is none.
  if (words.size() == 2) read_direction(words[1].substr(0, 1), kRamulatorReads, kRamulatorWrites);
}

void ForeignTrace::read_line(const Words& words) {
  switch (reading_.format) {
    case ForeignFormat::kDramsysStl:
    case ForeignFormat::kDramsysRstl:
      return read_dramsys(words);
    case ForeignFormat::kRamulator:
      return read_ramulator(words);
    case ForeignFormat::kRamulator2:
      if (is_cpu_trace(words)) bad(kCpuTrace);
      if (is_address_vector(words)) bad(kAddressVector);
      if (words.size() != 2) bad("a request is " + form(reading_.format));
      read_direction(words[0], kRamulator2Reads, kRamulator2Writes);
      request_.address = address(words[1], true);
      return;
    case ForeignFormat::kDramsim3:
      if (words.size() != 3) bad("a request is " + form(reading_.format));
      request_.address = address(words[0], false);
      read_direction(words[1], kDramsim3Reads, kDramsim3Writes);
      request_.at = time(words[2]);
      return;
  }
}

/// Takes the next request line. @return false at the end of the file
bool ForeignTrace::read_request() {
  for (;;) {
    if (lines_.at == lines_.end && !lines_.fill()) {
      if (requests_ == 0) bad("no request; " + form(reading_.format) + " is one");
      return false;
    }
    ++lines_.line;
    const Words words = split(lines_.take());
    if (is_empty(words)) continue;
    ++requests_;
    request_ = {0, 0, reading_.bytes, false};
    read_line(words);
    const std::uint64_t inside = request_.address & (request_.bytes - 1);
    request_.address -= inside;
    aligned_ += inside != 0;
    if (!reading_.bounds.wrap && !reading_.bounds.holds(request_.address, request_.bytes))
      bad(reading_.bounds.refusal(request_.address, request_.bytes));
    return true;
  }
}

/// A request goes in pieces, each inside 64 aligned bytes, as those of a text trace.
bool ForeignTrace::next(unsigned, Record& record) {
  if (done_ == request_.bytes) {
    if (!read_request()) return false;
    done_ = 0;
  }
  record = Record{};
  record.release = Release::kAt;
  record.at = request_.at;
  record.write = request_.write;
  record.master = info_.masters[0].id;
  record.address =
      static_cast<std::uint32_t>((request_.address + done_) & (reading_.bounds.size - 1));
  const unsigned room = kMaxBurstBytes - record.address % kMaxBurstBytes;
  record.bytes = static_cast<std::uint8_t>(std::min(room, request_.bytes - done_));
  done_ += record.bytes;
  return true;
}

}  // namespace fovea::trace
