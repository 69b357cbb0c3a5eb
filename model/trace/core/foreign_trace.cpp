#include "model/trace/core/foreign_trace.h"

#include <algorithm>
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
                           kRamulator2Reads = " LD R ", kRamulator2Writes = " ST W ",
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

}  // namespace

std::optional<ForeignFormat> recognise_foreign(std::string_view first_bytes) {
  while (!first_bytes.empty()) {
    const std::size_t end = std::min(first_bytes.find('\n'), first_bytes.size());
    const auto words = split(first_bytes.substr(0, end));
    first_bytes.remove_prefix(std::min(end + 1, first_bytes.size()));
    if (is_empty(words)) continue;
    std::uint64_t v;
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
  return std::nullopt;
}

ForeignTrace::ForeignTrace(std::string name, std::unique_ptr<ByteSource> bytes,
                           const ForeignReading& reading)
    : name_(std::move(name)), bytes_(std::move(bytes)), reading_(reading), lines_(*bytes_, kBlock) {
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
  }
  request_.bytes = static_cast<unsigned>(bytes);
  if (words.size() < n + 2) bad("a request is " + form(reading_.format));
  read_direction(words[n], kDramsysReads, kDramsysWrites);
  request_.address = address(words[n + 1], false);
  // A write may carry its data, which no replay needs.
  const bool data = request_.write && words.size() == n + 3 && words[n + 2].starts_with("0x");
  if (words.size() != n + 2 && !data) bad("a request is " + form(reading_.format));
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
    switch (reading_.format) {
      case ForeignFormat::kDramsysStl:
      case ForeignFormat::kDramsysRstl:
        read_dramsys(words);
        break;
      case ForeignFormat::kRamulator:
        if (words.size() != 2) bad("a request is " + form(reading_.format));
        request_.address = address(words[0], false);
        read_direction(words[1], kRamulatorReads, kRamulatorWrites);
        break;
      case ForeignFormat::kRamulator2:
        if (words.size() != 2) bad("a request is " + form(reading_.format));
        read_direction(words[0], kRamulator2Reads, kRamulator2Writes);
        if (words[1].find(',') != std::string_view::npos)
          bad("an address vector (ReadWriteTrace) names bank, row and column; allowed: " +
              form(reading_.format) + " with a physical address");
        request_.address = address(words[1], true);
        break;
      case ForeignFormat::kDramsim3:
        if (words.size() != 3) bad("a request is " + form(reading_.format));
        request_.address = address(words[0], false);
        read_direction(words[1], kDramsim3Reads, kDramsim3Writes);
        request_.at = time(words[2]);
        break;
    }
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
