#include "model/trace/core/text_trace.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "model/common/check.h"
#include "model/common/waits.h"

namespace fovea::trace {
namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::uint8_t kNoStream = 0xFF;
constexpr std::size_t kChunk = 512;  // records that are read at a time

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(kBlank, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

bool declares_master(const std::vector<std::string_view>& words) {
  return words.size() > 1 && words[0] == "#" && words[1] == "master";
}

/// Value of a hexadecimal digit; 16 for any other character.
constexpr std::array<std::uint8_t, 256> kHexDigits = [] {
  std::array<std::uint8_t, 256> value{};
  value.fill(16);
  for (unsigned d = 0; d < 10; ++d) value['0' + d] = static_cast<std::uint8_t>(d);
  for (unsigned d = 0; d < 6; ++d)
    value['a' + d] = value['A' + d] = static_cast<std::uint8_t>(10 + d);
  return value;
}();

/// Line feeds in a text. Sums of one byte each are what compilers turn into vector instructions: std::count, whose sums
/// have eight, takes ten times as many.
std::uint64_t count_lines(const char* begin, const char* end) {
  std::uint64_t lines = 0;
  while (begin != end) {
    const char* const stop = begin + std::min<std::ptrdiff_t>(end - begin, 255);
    std::uint8_t some = 0;
    for (; begin != stop; ++begin) some = static_cast<std::uint8_t>(some + (*begin == '\n'));
    lines += some;
  }
  return lines;
}

/// Takes 1 to `most` decimal digits. @return false if there are none or more
template <std::ptrdiff_t most>
inline bool take_decimal(const char*& at, std::uint64_t& v) {
  const char* const begin = at;
  unsigned digit = static_cast<unsigned char>(*at) - unsigned{'0'};
  if (digit > 9) return false;
  v = digit;
  while ((digit = static_cast<unsigned char>(*++at) - unsigned{'0'}) <= 9) {
    if (at - begin == most) return false;
    v = v * 10 + digit;
  }
  return true;
}

}  // namespace

bool TextTrace::is_label(std::string_view word) {
  return !word.empty() && word.size() <= kMaxLabel &&
         std::all_of(word.begin(), word.end(),
                     [](char c) {
                       return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                              (c >= '0' && c <= '9') || c == '_' || c == '-';
                     }) &&
         !is_culprit_name(word);
}

void TextTrace::bad(std::string what) const {
  std::replace_if(
      what.begin(), what.end(), [](unsigned char c) { return c < 0x20; }, '?');
  throw UserError("trace '" + name_ + "':" + std::to_string(line_) + ": " + what);
}

TextTrace::TextTrace(std::string name, std::string text, const TextReading& reading)
    : TextTrace(std::move(name), std::make_unique<MemoryBytes>(std::move(text)), reading) {}

TextTrace::TextTrace(std::string name, std::unique_ptr<ByteSource> bytes,
                     const TextReading& reading)
    : name_(std::move(name)),
      bytes_(std::move(bytes)),
      reading_(reading),
      stream_of_(kMaxId + 1, kNoStream),
      front_(name_, *bytes_, reading.block) {
  try {
    find_masters();
  } catch (const UserError&) {
    ids_.clear();  // a line before may be bad too, and that one is to be reported
  }
  if (ids_.empty()) read_carefully();
  const auto none = [](const Stream& s) { return s.lines.empty(); };
  while (!ended_ && std::all_of(streams_.begin(), streams_.end(), none))
    ended_ = !read_chunk(front_, nullptr);
  if (std::all_of(streams_.begin(), streams_.end(), none)) {
    line_ = front_.line;
    bad("no record; 't_ps master R|W 0xaddress bytes' is one");
  }
  find_start();
}

/// What comes before the first request is no part of the trace. The records of a master go out in order, so the first
/// one of each is enough.
void TextTrace::find_start() {
  info_.start = kLatest;
  for (Stream& s : streams_)
    if (!s.lines.empty() || refill(s)) info_.start = std::min(info_.start, s.lines.front().at);
}

/// Looks for the declarations of masters in the whole file, as the player has to know all of them
/// when it begins. They stand in lines whose first character other than a blank is '#'.
void TextTrace::find_masters() {
  LineReader lines(name_, *bytes_, reading_.block);
  while (lines.fill()) {
    const char *counted = lines.at, *at = lines.at;
    const char* mark;
    while (at < lines.end && (mark = static_cast<const char*>(std::memchr(
                                  at, '#', static_cast<std::size_t>(lines.end - at))))) {
      const auto* before = static_cast<const char*>(
          ::memrchr(lines.at, '\n', static_cast<std::size_t>(mark - lines.at)));
      const char* const begin = before ? before + 1 : lines.at;
      const auto* const feed = static_cast<const char*>(
          std::memchr(mark, '\n', static_cast<std::size_t>(lines.end - mark)));
      at = feed + 1;
      const std::string_view line(begin, static_cast<std::size_t>(feed - begin));
      if (line.find_first_not_of(kBlank) != static_cast<std::size_t>(mark - begin)) continue;
      const Words words = split(line);
      if (!declares_master(words)) continue;
      lines.line += count_lines(counted, begin);
      counted = begin;
      line_ = lines.line + 1;
      declare(words);
    }
    lines.line += count_lines(counted, lines.end);
    lines.at = lines.end;
  }
}

/// Reads the whole file line by line up to its first defect; there is one.
void TextTrace::read_carefully() {
  info_ = {};
  streams_.clear();
  std::fill(stream_of_.begin(), stream_of_.end(), kNoStream);
  declaring_ = true;
  LineReader lines(name_, *bytes_, reading_.block);
  Line l;
  unsigned stream;
  line_ = 0;
  while (lines.fill())
    while (lines.at != lines.end) {
      ++line_;
      read_line(lines.take(), l, stream);
    }
  bad("no master; a line '# master ID window W label' is needed");
}

std::uint64_t TextTrace::number(std::string_view word, const char* what, std::uint64_t least,
                                std::uint64_t most) const {
  const bool hex = word.starts_with("0x");
  const std::string_view digits = hex ? word.substr(2) : word;
  std::uint64_t v = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), v, hex ? 16 : 10);
  if (error != std::errc{} || end != digits.data() + digits.size() || v < least || v > most)
    bad(std::string(what) + " '" + std::string(word.substr(0, 40)) +
        "' is not allowed; allowed: " + std::to_string(least) + " to " + std::to_string(most));
  return v;
}

/// The careful parser. @return false if the line holds no record
bool TextTrace::read_line(std::string_view line, Line& l, unsigned& stream) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line_ == 1) {
    if (line != kHeader) bad("its version is not known; allowed: '" + std::string(kHeader) + "'");
    return false;
  }
  const Words words = split(line);
  if (words.empty()) return false;
  if (words[0].starts_with("#")) {
    if (declaring_ && declares_master(words)) declare(words);
    return false;  // any other comment
  }
  read_record(words, l, stream);
  return true;
}

void TextTrace::declare(const Words& words) {
  const auto is_word = [](std::string_view w) { return is_label(w) || is_culprit_name(w); };
  if (words.size() != 6 || words[3] != "window" || !is_word(words[5]))
    bad("a master is declared as '# master ID window W label', the label of letters, digits, _ and "
        "-");
  const std::uint64_t id = number(words[2], "master", 0, kMaxId);
  const auto window = static_cast<unsigned>(number(words[4], "window", 1, kMaxReads));
  if (stream_of_[id] != kNoStream) bad("this master is declared twice");
  if (ids_.size() == kMaxMasters)
    bad("more masters than the " + std::to_string(kMaxMasters) + " allowed");
  for (const auto& m : info_.masters)
    if (m.label == words[5]) bad("two masters have the same label");
  if (is_culprit_name(words[5]))
    bad("the label '" + std::string(words[5]) + "' is the name of a cause of waiting");
  const auto n = static_cast<unsigned>(ids_.size());
  ids_.push_back(id);
  stream_of_[id] = static_cast<std::uint8_t>(n);
  info_.streams.emplace_back();
  info_.masters.push_back({port(n), std::string(words[5]), n, window, kWrites, false});
  streams_.emplace_back();
  streams_.back().declared = line_;
}

void TextTrace::read_record(const Words& words, Line& l, unsigned& stream) const {
  if (words.size() != 5) bad("a record is 't_ps master R|W 0xaddress bytes'");
  l.at = number(words[0], "time in ps", 0, kLatest);
  const std::uint64_t id = number(words[1], "master", 0, kMaxId);
  stream = stream_of_[id];
  if (stream == kNoStream || streams_[stream].declared > line_)
    bad("master " + std::string(words[1]) +
        " was not declared above; '# master ID window W label'");
  if (words[2] != "R" && words[2] != "W")
    bad("direction '" + std::string(words[2].substr(0, 40)) + "' is not allowed; allowed: R, W");
  l.write = words[2] == "W";
  if (!words[3].starts_with("0x")) bad("the address is hexadecimal, 0x...");
  l.address = static_cast<std::uint32_t>(number(words[3], "address", 0, ~std::uint32_t{0}));
  l.bytes = static_cast<std::uint16_t>(number(words[4], "bytes", 1, kMaxBytes));
  if (std::uint64_t{l.address} + l.bytes > std::uint64_t{1} << 32)
    bad("the burst ends beyond 4 GiB");
}

/// Takes a record line in its usual spelling: single blanks, decimal numbers, a hexadecimal address
/// of up to eight digits. The text ends in a line feed, which no loop passes. @return false for any
/// other line, and for one whose numbers are out of range
inline bool TextTrace::read_usual(const char*& at, Line& l, unsigned& stream) const {
  const char* p = at;
  std::uint64_t time, id, bytes;
  if (!take_decimal<15>(p, time) || time > kLatest || *p++ != ' ') return false;
  if (!take_decimal<5>(p, id) || id > kMaxId || *p++ != ' ') return false;
  const char direction = *p;
  if ((direction != 'R' && direction != 'W') || p[1] != ' ' || p[2] != '0' || p[3] != 'x')
    return false;
  p += 4;
  std::uint64_t address = kHexDigits[static_cast<unsigned char>(*p)];
  if (address > 15) return false;
  for (std::uint8_t digit; (digit = kHexDigits[static_cast<unsigned char>(*++p)]) < 16;)
    if ((address = address << 4 | digit) >> 32) return false;
  if (*p++ != ' ' || !take_decimal<4>(p, bytes) || bytes - 1 >= kMaxBytes) return false;
  if (*p == '\r') ++p;
  if (*p++ != '\n' || address + bytes > std::uint64_t{1} << 32) return false;
  stream = stream_of_[id];
  if (stream == kNoStream) return false;
  l.at = time;
  l.address = static_cast<std::uint32_t>(address);
  l.bytes = static_cast<std::uint16_t>(bytes);
  l.write = direction == 'W';
  at = p;
  return true;
}

/// Reads on by some records: for all streams without a reader of their own, or for `only`.
/// @return false at the end of the file
bool TextTrace::read_chunk(LineReader& lines, Stream* only) {
  for (Stream& s : streams_)  // what was handed out is forgotten when it is most of what is held
    if (s.next > kChunk && s.next > s.lines.size() / 2) {
      s.lines.erase(s.lines.begin(), s.lines.begin() + static_cast<std::ptrdiff_t>(s.next));
      s.next = 0;
    }
  for (std::size_t added = 0; added < kChunk;) {
    if (lines.at == lines.end && !lines.fill()) return false;
    Line l;
    unsigned stream;
    l.number = ++lines.line;
    const char* const begin = lines.at;
    if (!reading_.one_pass || !read_usual(lines.at, l, stream) ||
        streams_[stream].declared > l.number) [[unlikely]] {
      lines.at = begin;
      line_ = l.number;
      if (!read_line(lines.take(), l, stream)) continue;
    }
    Stream& s = streams_[stream];
    if (only ? &s != only : s.own != nullptr) continue;
    s.lines.push_back(l);
    ++added;
    if (!only && s.lines.size() - s.next >= reading_.ahead) [[unlikely]]
      s.own = std::make_unique<LineReader>(name_, *bytes_, reading_.block, lines.offset(), lines.line);
  }
  return true;
}

/// Called when all records held of a stream are handed out. @return false if it has no more
bool TextTrace::refill(Stream& s) {
  s.lines.clear();
  s.next = 0;
  while (s.lines.empty()) {
    bool& ended = s.own ? s.ended : ended_;
    if (ended) return false;
    ended = !(s.own ? read_chunk(*s.own, &s) : read_chunk(front_, nullptr));
  }
  return true;
}

std::string TextTrace::place(unsigned stream) const {
  return "line " + std::to_string(streams_[stream].current);
}

/// A burst goes in pieces, each inside 64 aligned bytes.
bool TextTrace::next(unsigned stream, Record& record) {
  Stream& s = streams_[stream];
  if (s.next == s.lines.size() && !refill(s)) return false;
  const Line& l = s.lines[s.next];
  s.current = l.number;
  record = Record{};
  record.release = Release::kAt;
  record.at = l.at;
  record.write = l.write;
  record.master = info_.masters[stream].id;
  record.address = l.address + s.done;
  const unsigned room = kMaxBurstBytes - record.address % kMaxBurstBytes;
  record.bytes = static_cast<std::uint8_t>(std::min<unsigned>(room, l.bytes - s.done));
  s.done += record.bytes;
  if (s.done == l.bytes) {
    ++s.next;
    s.done = 0;
  }
  return true;
}

}  // namespace fovea::trace
