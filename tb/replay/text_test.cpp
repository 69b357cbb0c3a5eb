// Bus traces as plain text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/common/check.h"
#include "model/trace/core/foreign_trace.h"
#include "model/trace/core/text_trace.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using testing::HasSubstr;
using trace::Record;
using trace::TextTrace;

constexpr const char* kGood =
    "# dramtrace 1\n"
    "# master 3 window 2 cpu\n"
    "# master 0 window 4 video\n"
    "# any other remark\n"
    "\n"
    "0 3 R 0x1000 32\n"
    "5000 0 W 0x2000 64\n"
    "70 3 W 0x1FF0 40\n";

std::string error_of(const std::string& text) {
  try {
    TextTrace t("t", text);
    Record r;
    for (unsigned s = 0; s < t.info().streams.size(); ++s)
      while (t.next(s, r)) {
      }
  } catch (const UserError& e) {
    return e.what();
  }
  return {};
}

TEST(TextTraceTest, MastersAndRecordsAreRead) {
  TextTrace t("t", kGood);
  ASSERT_EQ(t.info().masters.size(), 2u);
  EXPECT_EQ(t.info().masters[0].label, "cpu");
  EXPECT_EQ(t.info().masters[0].reads, 2u);
  EXPECT_EQ(t.info().masters[1].label, "video");
  EXPECT_EQ(t.info().masters[1].reads, 4u);
  Record r;
  ASSERT_TRUE(t.next(0, r));
  EXPECT_EQ(r.at, 0u);
  EXPECT_EQ(r.address, 0x1000u);
  EXPECT_EQ(r.bytes, 32u);
  EXPECT_FALSE(r.write);
  ASSERT_TRUE(t.next(1, r));
  EXPECT_EQ(r.at, 5000u);
  EXPECT_TRUE(r.write);
  EXPECT_FALSE(t.next(1, r));
}

TEST(TextTraceTest, BurstsAreCutAtSixtyFourBytes) {
  TextTrace t("t", kGood);
  Record r;
  t.next(0, r);
  ASSERT_TRUE(t.next(0, r));  // 40 bytes at 0x1FF0: 16 before the border, 24 behind it
  EXPECT_EQ(r.address, 0x1FF0u);
  EXPECT_EQ(r.bytes, 16u);
  ASSERT_TRUE(t.next(0, r));
  EXPECT_EQ(r.address, 0x2000u);
  EXPECT_EQ(r.bytes, 24u);
  EXPECT_FALSE(t.next(0, r));

  TextTrace big("t", "# dramtrace 1\n# master 0 window 1 a\n0 0 R 0x20 4096\n");
  unsigned pieces = 0, bytes = 0;
  for (; big.next(0, r); ++pieces) bytes += r.bytes;
  EXPECT_EQ(pieces, 65u);
  EXPECT_EQ(bytes, 4096u);
}

TEST(TextTraceTest, ErrorsNameTheLineAndWhatIsAllowed) {
  const std::string head = "# dramtrace 1\n# master 0 window 1 a\n";
  EXPECT_THAT(error_of("# dramtrace 2\n"), HasSubstr("'t':1: its version is not known"));
  EXPECT_THAT(error_of("# dramtrace 1\n"), HasSubstr("no master"));
  EXPECT_THAT(error_of("# dramtrace 1\n# master 0 window 1 a\n# 0 0 R 0x0 4\n"),
              HasSubstr("no record"));
  EXPECT_THAT(error_of(std::string("# dramtrace 1\n# master 0 window 1 a\n0 0 R 0x0 4\0x\n", 50)),
              HasSubstr("'4?x' is not allowed"));
  EXPECT_THAT(error_of(head + "0 1 R 0x0 4\n"), HasSubstr("'t':3: master 1 was not declared"));
  // In the usual spelling, which is read quickly, and in another one; the next line is late enough.
  for (const char* record : {"0 1 R 0x0 4\n", "0  1 R 0x0 4\n"}) {
    const std::string declared = "# master 1 window 1 b\n";
    EXPECT_THAT(error_of(head + record + declared), HasSubstr("'t':3: master 1 was not declared"));
    EXPECT_EQ(error_of(head + declared + record), "");
  }
  // Lines are counted by the hundred before a declaration.
  for (const unsigned n : {254u, 255u, 256u, 257u, 600u}) {
    const std::string empty(n, '\n'), record = "0 1 R 0x0 4\n", declared = "# master 1 window 1 b\n";
    EXPECT_THAT(error_of(head + empty + record + declared),
                HasSubstr("'t':" + std::to_string(3 + n) + ": master 1 was not declared"));
    EXPECT_EQ(error_of(head + empty + declared + record), "");
  }
  EXPECT_THAT(error_of(head + "0 0 X 0x0 4\n"), HasSubstr("allowed: R, W"));
  EXPECT_THAT(error_of(head + "0 0 R 100 4\n"), HasSubstr("hexadecimal"));
  EXPECT_THAT(error_of(head + "0 0 R 0x0 0\n"), HasSubstr("allowed: 1 to 4096"));
  EXPECT_THAT(error_of(head + "0 0 R 0x0 5000\n"), HasSubstr("allowed: 1 to 4096"));
  EXPECT_THAT(error_of(head + "-1 0 R 0x0 4\n"), HasSubstr("time in ps '-1'"));
  EXPECT_THAT(error_of(head + "0 0 R 0x0\n"), HasSubstr("a record is"));
  EXPECT_THAT(error_of(head + "0 0 R 0xFFFFFFFF 2\n"), HasSubstr("beyond 4 GiB"));
  EXPECT_THAT(error_of(head + "# master 0 window 1 b\n"), HasSubstr("declared twice"));
  EXPECT_THAT(error_of(head + "# master 1 window 1 a\n"), HasSubstr("same label"));
  EXPECT_THAT(error_of(head + "# master 1 window 0 b\n"), HasSubstr("allowed: 1 to 48"));
  EXPECT_THAT(error_of(head + "# master 1 window 49 b\n"), HasSubstr("allowed: 1 to 48"));
  EXPECT_EQ(error_of(head + "# master 1 window 48 b\n1 1 R 0x0 4\n"), "");
  EXPECT_THAT(error_of(head + "# master 1 window 1 B/c\n"), HasSubstr("a master is declared as"));
  for (const char* cause : {"bridge", "service", "row_miss", "refresh", "power_down", "own"})
    EXPECT_THAT(error_of(head + "# master 1 window 1 " + cause + "\n"),
                HasSubstr("':3: the label '" + std::string(cause) + "' is the name of a cause"));
  EXPECT_EQ(error_of(head + "# master 1 window 1 GPU-0\n1 1 R 0x0 4\n"), "");
}

// Each limit at its last good value and the one behind it.
TEST(TextTraceTest, LimitsAreWhereTheReadmeHasThem) {
  const std::string head = "# dramtrace 1\n# master 0 window 1 a\n";
  const auto labelled = [](std::size_t n) {
    return error_of("# dramtrace 1\n# master 0 window 1 " + std::string(n, 'x') + "\n0 0 R 0x0 4\n");
  };
  EXPECT_EQ(labelled(32), "");
  EXPECT_THAT(labelled(33), HasSubstr("a master is declared as"));
  const auto with = [](char c) {
    return error_of("# dramtrace 1\n# master 0 window 1 x" + std::string(1, c) + "\n0 0 R 0x0 4\n");
  };
  for (const char c : {'a', 'z', 'A', 'Z', '0', '9', '_', '-'}) EXPECT_EQ(with(c), "") << c;
  for (const char c : {'`', '{', '@', '[', '/', ':', '^', '.', ','})
    EXPECT_THAT(with(c), HasSubstr("a master is declared as")) << c;
  EXPECT_EQ(error_of(head + "0 0 R 0xFFFFFFFE 2\n"), "");
  EXPECT_THAT(error_of(head + "0 0 R 0xFFFFFFFE 3\n"), HasSubstr("beyond 4 GiB"));
  EXPECT_THAT(error_of(head + "0 0 R 0x100000000 1\n"), HasSubstr("address '0x100000000'"));
  EXPECT_EQ(error_of(head + "0 0 R 0x0 4096\n"), "");
  EXPECT_THAT(error_of(head + "0 0 R 0x0 4097\n"), HasSubstr("allowed: 1 to 4096"));
  EXPECT_EQ(error_of(head + "100000000000000 0 R 0x0 4\n"), "");
  EXPECT_THAT(error_of(head + "100000000000001 0 R 0x0 4\n"), HasSubstr("time in ps"));
  EXPECT_EQ(error_of("# dramtrace 1\n# master 65535 window 1 a\n0 65535 R 0x0 4\n"), "");
  EXPECT_THAT(error_of("# dramtrace 1\n# master 65536 window 1 a\n"), HasSubstr("master '65536'"));
  std::string ten = "# dramtrace 1\n";
  for (const char* id : {"0", "1", "2", "3", "4", "5", "6", "7", "8", "9"})
    ten += std::string("# master ") + id + " window 1 m" + id + "\n";
  EXPECT_EQ(error_of(ten + "0 9 R 0x0 4\n"), "");
  EXPECT_THAT(error_of(ten + "# master 10 window 1 m10\n"), HasSubstr("more masters than the 10"));
}

// The player asks where a record stands after it has taken it, whole or in pieces.
TEST(TextTraceTest, APieceKnowsItsLine) {
  TextTrace t("t", "# dramtrace 1\n# master 0 window 1 a\n\n0 0 R 0x20 64\n0 0 R 0x80 64\n");
  Record r;
  for (const char* line : {"line 4", "line 4", "line 5"}) {
    ASSERT_TRUE(t.next(0, r));
    EXPECT_EQ(t.place(0), line) << r.address;
  }
  EXPECT_FALSE(t.next(0, r));
}

// The earliest of what can go out: the first record of a master holds up those behind it.
TEST(TextTraceTest, ItStartsWithTheFirstRequest) {
  const std::string head = "# dramtrace 1\n# master 0 window 1 a\n# master 1 window 1 b\n";
  const auto start = [&](const std::string& lines) { return TextTrace("t", head + lines).info().start; };
  EXPECT_EQ(start("70 0 R 0x0 4\n"), 70u);
  EXPECT_EQ(start("70 0 R 0x0 4\n5 0 R 0x0 4\n"), 70u);
  EXPECT_EQ(start("70 0 R 0x0 4\n5 1 R 0x0 4\n"), 5u);
  EXPECT_EQ(start("0 0 R 0x0 4\n5 1 R 0x0 4\n"), 0u);
  // The other master comes behind more records than are read at a time.
  std::string late;
  for (int i = 0; i < 2'000; ++i) late += "900 0 R 0x0 4\n";
  EXPECT_EQ(start(late + "30 1 R 0x0 4\n"), 30u);
}

/// A file of two gigabytes that begins as `head` and has no line feed behind it.
class EndlessLine final : public trace::ByteSource {
 public:
  EndlessLine(std::string head, std::uint64_t& asked) : head_(std::move(head)), asked_(asked) {}
  std::uint64_t size() const override { return std::uint64_t{2} << 30; }
  std::size_t read(std::uint64_t offset, char* to, std::size_t bytes) const override {
    asked_ += bytes;
    for (std::size_t i = 0; i < bytes; ++i) to[i] = offset + i < head_.size() ? head_[offset + i] : '\0';
    return bytes;
  }

 private:
  std::string head_;
  std::uint64_t& asked_;
};

TEST(TextTraceTest, ALineThatDoesNotEndIsNotReadWhole) {
  for (const bool foreign : {false, true}) {
    std::uint64_t asked = 0;
    const std::string head = foreign ? "0x1000 R\n" : kGood;
    try {
      auto bytes = std::make_unique<EndlessLine>(head, asked);
      Record r;
      if (foreign) {
        trace::ForeignReading reading;
        reading.format = trace::ForeignFormat::kRamulator;
        trace::ForeignTrace t("t", std::move(bytes), reading);
        while (t.next(0, r)) {
        }
      } else {
        TextTrace t("t", std::move(bytes));
      }
      ADD_FAILURE() << "two gigabytes are no line";
    } catch (const UserError& e) {
      EXPECT_THAT(e.what(), HasSubstr("trace 't': the line that begins at byte " + std::to_string(head.size()) +
                                      " has no end within"));
    }
    EXPECT_LT(asked, 4u << 20);
  }
}

TEST(TextTraceTest, NoTextCrashesIt) {
  Rng rng(11);
  for (int n = 0; n < 20'000; ++n) {
    std::string text = kGood;
    for (std::uint64_t k = 1 + rng.below(4); k-- > 0;) {
      const std::size_t at = rng.below(text.size());
      switch (rng.below(3)) {
        case 0:
          text[at] = static_cast<char>(rng.below(256));
          break;
        case 1:
          text.erase(at, 1 + rng.below(8));
          break;
        default:
          text.insert(at, text.substr(rng.below(text.size()), rng.below(20)));
      }
      if (text.empty()) text = "#";
    }
    const std::string error = error_of(text);
    EXPECT_TRUE(error.empty() || error.starts_with("trace 't':")) << error;
  }
}

}  // namespace
}  // namespace fovea::replay
