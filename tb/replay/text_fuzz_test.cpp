// The one-pass parser of text traces against the careful one, and the block-wise reading against
// reading the file as a whole.
#include <gtest/gtest.h>

#include <iterator>
#include <string>
#include <vector>

#include "model/common/check.h"
#include "model/trace/core/text_trace.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using trace::Record;
using trace::TextReading;
using trace::TextTrace;

/// All that a reader says of a text: masters, records with their lines, or the error.
struct Read {
  std::vector<trace::MasterInfo> masters;
  std::vector<std::vector<Record>> records;
  std::vector<std::vector<std::string>> places;
  std::string error;
  friend bool operator==(const Read&, const Read&) = default;
};

/// `turns`: the streams are read in turn, so many records at a time; 0: each to its end.
Read read_all(const std::string& text, const TextReading& reading, unsigned turns) {
  Read out;
  try {
    TextTrace t("t", text, reading);
    out.masters = t.info().masters;
    const std::size_t n = out.masters.size();
    out.records.resize(n);
    out.places.resize(n);
    std::vector<bool> more(n, true);
    for (bool any = true; any;) {
      any = false;
      for (unsigned s = 0; s < n; ++s)
        for (unsigned k = 0; more[s] && (turns == 0 || k < turns); ++k) {
          Record r;
          more[s] = t.next(s, r);
          if (!more[s]) break;
          out.records[s].push_back(r);
          out.places[s].push_back(t.place(s));
          any = true;
        }
    }
  } catch (const UserError& e) {
    out = {};  // how far a reader comes before it sees the defect is its own matter
    out.error = e.what();
  }
  return out;
}

constexpr TextReading kCareful{1 << 20, 1 << 20, false};

void expect_same(const std::string& text, Rng& rng) {
  const Read expected = read_all(text, kCareful, 0);
  const TextReading readings[] = {
      {256 << 10, 1 << 16, true},
      {1 + rng.below(40), 1 + rng.below(4), true},
      {1 + rng.below(40), 1 + rng.below(4), false},
  };
  for (const TextReading& reading : readings) {
    const Read got = read_all(text, reading, static_cast<unsigned>(rng.below(3)));
    ASSERT_EQ(got.error, expected.error) << text;
    ASSERT_EQ(got.masters, expected.masters) << text;
    ASSERT_EQ(got.records, expected.records) << text;
    ASSERT_EQ(got.places, expected.places) << text;
  }
}

template <std::size_t n>
const char* one_of(Rng& rng, const char* const (&list)[n]) {
  return list[rng.below(n)];
}

/// A line of words each of which is good, at a limit, or one beyond it.
std::string hostile_line(Rng& rng) {
  static constexpr const char* kTimes[] = {"0",
                                           "5",
                                           "00",
                                           "70000",
                                           "100000000000000",
                                           "100000000000001",
                                           "099999999999999",
                                           "0000000000000001",
                                           "999999999999999",
                                           "1000000000000000",
                                           "18446744073709551616",
                                           "-1",
                                           "+1",
                                           "0x10",
                                           "0X10",
                                           "1e3",
                                           "",
                                           "1.0"};
  static constexpr const char* kIds[] = {"0",      "1",     "3",      "7",     "65535",
                                         "65536",  "00003", "000003", "99999", "0x3",
                                         "0xFFFF", "x",     "-0",     "8"};
  static constexpr const char* kDirections[] = {"R", "W", "r", "w", "RW", "Rx", "", "R\t"};
  static constexpr const char* kAddresses[] = {
      "0x0",         "0x1000",      "0xFFFFFFFF", "0xffffffff", "0x100000000",
      "0x000000000", "0x0FFFFFFFF", "0xFFFFFFFE", "0XFF",       "1000",
      "0x",          "0xg",         "0xAbCd",     "0x-1",       "0xFFFFFFFFFFFFFFFFF"};
  static constexpr const char* kBytes[] = {"1",    "2",  "3",    "32",    "64",   "4096",
                                           "4097", "0",  "0004", "00004", "9999", "10000",
                                           "0x20", "-4", "4x",   "65536"};
  static constexpr const char* kGaps[] = {" ", " ", " ", " ",  " ",  " ",    " ",  " ",  " ",
                                          " ", " ", " ", "  ", "\t", " \t ", "\r", "\v", ""};
  static constexpr const char* kEnds[] = {"\n",  "\n",     "\n",   "\n",   "\r\n", "\r\r\n",
                                          " \n", "\t\r\n", " x\n", "\n\n", " #\n"};
  const bool mostly = rng.below(8) != 0;
  const auto word = [&](auto& list, const char* good) {
    return std::string(mostly && rng.below(16) != 0 ? good : one_of(rng, list));
  };
  std::string line = rng.below(20) == 0 ? one_of(rng, kGaps) : "";
  line += word(kTimes, "123") + one_of(rng, kGaps);
  line += word(kIds, "3") + one_of(rng, kGaps);
  line += word(kDirections, "W") + one_of(rng, kGaps);
  line += word(kAddresses, "0x20") + one_of(rng, kGaps);
  line += word(kBytes, "100") + one_of(rng, kEnds);
  if (rng.below(60) == 0) line[rng.below(line.size())] = static_cast<char>(rng.below(256));
  return line;
}

std::string other_line(Rng& rng) {
  static constexpr const char* kOthers[] = {"\n",
                                            "# a comment # master 9\n",
                                            "#\n",
                                            "  \t\n",
                                            "  # master 7 window 48 late\n",
                                            "# master 1 window 49 w\n",
                                            "# master 0 window 0 w\n",
                                            "#master 8 window 1 no\n",
                                            "# master 0 window 1 refresh\n",
                                            "# master 3 window 1 twice\n",
                                            "# master 65535 window 1 last\n",
                                            "# master 65536 window 1 more\n",
                                            "# master\n",
                                            "# master 1 window 4 one\r\n",
                                            "# dramtrace 1\n",
                                            "# master 1 window 1 cpu\n"};
  return one_of(rng, kOthers);
}

// Most texts end at their first bad line, so most of them have few lines.
TEST(TextFuzzTest, BothParsersSayTheSameOfHostileLines) {
  Rng rng(5);
  int good = 0, bad = 0;
  for (int n = 0; n < 30'000; ++n) {
    std::string text = rng.below(200) == 0 ? "# dramtrace 2\n" : "# dramtrace 1\n";
    text += "# master 3 window 2 cpu\n# master 0 window 4 video\n";
    for (std::uint64_t lines = 1 + rng.below(6); lines-- > 0;)
      text += rng.below(6) == 0 ? other_line(rng) : hostile_line(rng);
    if (rng.below(4) == 0 && !text.empty()) text.pop_back();
    expect_same(text, rng);
    if (HasFatalFailure()) return;
    (read_all(text, kCareful, 0).error.empty() ? good : bad)++;
  }
  EXPECT_GT(good, 1'000);
  EXPECT_GT(bad, 10'000);
}

/// Good lines of `masters` masters whose records come in long runs, so that readers are far ahead
/// of each other.
std::string long_text(Rng& rng, unsigned masters, unsigned lines) {
  std::string text = "# dramtrace 1\n";
  for (unsigned m = 0; m < masters; ++m)
    text += "# master " + std::to_string(m) + " window 4 m" + std::to_string(m) + "\n";
  unsigned master = 0;
  for (unsigned n = 0; n < lines; ++n) {
    if (rng.below(50) == 0) master = static_cast<unsigned>(rng.below(masters));
    if (rng.below(40) == 0) text += "# a comment\n";
    text += std::to_string(n * 1000) + " " + std::to_string(master) + " R 0x" +
            std::to_string(rng.below(1000000)) + " " + std::to_string(1 + rng.below(200)) + "\n";
  }
  return text;
}

TEST(TextFuzzTest, LongRunsOfOneMasterAreReadTheSameInPieces) {
  Rng rng(6);
  for (int n = 0; n < 60; ++n) {
    const std::string text = long_text(rng, 1 + static_cast<unsigned>(rng.below(10)), 3'000);
    const Read expected = read_all(text, kCareful, 0);
    ASSERT_EQ(expected.error, "");
    for (const std::size_t ahead :
         {std::size_t{1}, std::size_t{7}, std::size_t{600}, std::size_t{1500}})
      for (const unsigned turns : {0u, 1u, 700u})
        ASSERT_EQ(read_all(text, {100 + rng.below(5000), ahead, true}, turns), expected);
    // A defect far behind is found, whichever of the two parsers comes there first.
    const Read broken = read_all(text + "0 99 R 0x0 4\n", kCareful, 0);
    EXPECT_NE(broken.error, "");
    ASSERT_EQ(read_all(text + "0 99 R 0x0 4\n", {200, 7, true}, 1), broken);
  }
}

/// The grammar of README.md, written a third time, for lines that both parsers might get wrong
/// alike.
TEST(TextFuzzTest, RecordsAreWhatTheLinesSay) {
  Rng rng(7);
  std::string text = "# dramtrace 1\n# master 65535 window 1 a\n";
  std::vector<Record> expected;
  for (int n = 0; n < 5'000; ++n) {
    Record r;
    r.at = rng.below(2) ? rng.below(100'000'000'000'001ull) : rng.below(1000);
    r.write = rng.below(2);
    r.bytes = static_cast<std::uint8_t>(1 + rng.below(64));
    // Inside 64 aligned bytes, so that the line is one record.
    r.address = static_cast<std::uint32_t>((rng.next() & 0xFFFFFFC0u) + rng.below(65u - r.bytes));
    r.master = TextTrace::port(0);
    expected.push_back(r);
    char line[80];
    std::snprintf(line, sizeof line,
                  rng.below(2) ? "%llu 65535 %c 0x%x %u\n" : "%llu 65535 %c 0x%X %u\n",
                  static_cast<unsigned long long>(r.at), r.write ? 'W' : 'R', r.address, r.bytes);
    text += line;
  }
  for (const bool one_pass : {true, false}) {
    TextTrace t("t", text, {4096, 100, one_pass});
    for (const Record& e : expected) {
      Record r;
      ASSERT_TRUE(t.next(0, r));
      ASSERT_EQ(r, e);
    }
    Record r;
    EXPECT_FALSE(t.next(0, r));
  }
}

}  // namespace
}  // namespace fovea::replay
