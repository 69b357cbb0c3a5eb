#include "model/trace/core/text_trace.h"

#include <algorithm>
#include <charconv>

#include "model/common/check.h"
#include "model/common/waits.h"

namespace fovea::trace {
namespace {

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view kBlank = " \t\r";
  for (std::size_t at = 0; (at = line.find_first_not_of(kBlank, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

bool is_label(std::string_view word) {
  return word.size() <= 32 && std::all_of(word.begin(), word.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '_' || c == '-';
         });
}

}  // namespace

void TextTrace::bad(std::string what) const {
  std::replace_if(what.begin(), what.end(), [](unsigned char c) { return c < 0x20; }, '?');
  throw UserError("trace '" + name_ + "':" + std::to_string(line_) + ": " + what);
}

TextTrace::TextTrace(std::string name, std::string_view text) : name_(std::move(name)) {
  while (!text.empty()) {
    ++line_;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line_ == 1 && line != kHeader)
      bad("its version is not known; allowed: '" + std::string(kHeader) + "'");
    if (line_ > 1) read_line(line);
  }
  if (streams_.empty()) bad("no master; a line '# master ID window W label' is needed");
  if (std::all_of(streams_.begin(), streams_.end(), [](const Stream& s) { return s.lines.empty(); }))
    bad("no record; 't_ps master R|W 0xaddress bytes' is one");
}

std::uint64_t TextTrace::number(std::string_view word, const char* what, std::uint64_t least,
                                std::uint64_t most) const {
  const bool hex = word.starts_with("0x");
  const std::string_view digits = hex ? word.substr(2) : word;
  std::uint64_t v = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), v, hex ? 16 : 10);
  if (error != std::errc{} || end != digits.data() + digits.size() || v < least || v > most)
    bad(std::string(what) + " '" + std::string(word.substr(0, 40)) + "' is not allowed; allowed: " +
        std::to_string(least) + " to " + std::to_string(most));
  return v;
}

void TextTrace::read_line(std::string_view line) {
  const auto words = split(line);
  if (words.empty()) return;
  if (words[0] == "#") {
    if (words.size() > 1 && words[1] == "master") read_master(words);
    return;  // any other comment
  }
  if (words[0].starts_with("#")) return;
  read_record(words);
}

void TextTrace::read_master(const std::vector<std::string_view>& words) {
  if (words.size() != 6 || words[3] != "window" || !is_label(words[5]))
    bad("a master is declared as '# master ID window W label', the label of letters, digits, _ and -");
  const std::uint64_t id = number(words[2], "master", 0, 65535);
  const auto window = static_cast<unsigned>(number(words[4], "window", 1, kMaxReads));
  if (std::find(ids_.begin(), ids_.end(), id) != ids_.end()) bad("this master is declared twice");
  if (ids_.size() == kMaxMasters)
    bad("more masters than the " + std::to_string(kMaxMasters) + " allowed");
  for (const auto& m : info_.masters)
    if (m.label == words[5]) bad("two masters have the same label");
  if (is_culprit_name(words[5]))
    bad("the label '" + std::string(words[5]) + "' is the name of a cause of waiting");
  const auto n = static_cast<unsigned>(ids_.size());
  ids_.push_back(id);
  info_.streams.emplace_back();
  info_.masters.push_back(
      {port(n), std::string(words[5]), n, window, kWrites, false});
  streams_.emplace_back();
}

void TextTrace::read_record(const std::vector<std::string_view>& words) {
  if (words.size() != 5) bad("a record is 't_ps master R|W 0xaddress bytes'");
  Line l;
  l.number = static_cast<std::uint32_t>(line_);
  l.at = number(words[0], "time in ps", 0, kLatest);
  const std::uint64_t id = number(words[1], "master", 0, 65535);
  const auto found = std::find(ids_.begin(), ids_.end(), id);
  if (found == ids_.end())
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
  streams_[static_cast<std::size_t>(found - ids_.begin())].lines.push_back(l);
}

std::string TextTrace::place(unsigned stream) const {
  const Stream& s = streams_[stream];
  return "line " + std::to_string(s.lines[s.next - (s.done == 0)].number);
}

/// A burst goes in pieces, each inside 64 aligned bytes.
bool TextTrace::next(unsigned stream, Record& record) {
  Stream& s = streams_[stream];
  if (s.next == s.lines.size()) return false;
  const Line& l = s.lines[s.next];
  record = Record{};
  record.release = Release::kAt;
  record.at = l.at;
  record.write = l.write;
  record.master = port(stream);
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
