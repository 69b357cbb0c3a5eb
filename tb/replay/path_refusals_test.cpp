// The player of bus traces: memories and traces that it refuses, and what it warns of.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tb/own_diagnostics.h"
#include "tb/replay/played.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using trace::Record;

std::string error_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const UserError& e) {
    return e.what();
  }
  return {};
}

TEST(ReplayPathTest, WhatNoMemoryHasIsRefused) {
  using testing::HasSubstr;
  const auto play = [](const char* line, std::vector<std::pair<std::string, std::string>> keys) {
    return error_of([&] {
      trace::TextTrace t("t", std::string("# dramtrace 1\n# master 0 window 1 a\n") + line);
      Played(t.info(), t, false, keys);
    });
  };
  EXPECT_EQ(play("0 0 R 0x7FFFFC0 64\n", {}), "");
  EXPECT_THAT(play("0 0 R 0x8000000 4\n", {}), HasSubstr("outside the SDRAM of 128 MiB"));
  EXPECT_EQ(play("0 0 R 0x0 256\n\n0 0 W 0x7fffffe 4\n", {}),
            "trace 't': line 5 of a: 2 bytes at 0x08000000: outside the SDRAM of 128 MiB (ddr.part)");
  EXPECT_EQ(play("0 0 R 0x8000000 4\n", {{"ddr.part", "mt47h128m16"}}), "");
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.tRC", "12 cycles"}}), HasSubstr("ddr.tRC"));
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.tRAS", "4 cycles"}}), HasSubstr("ddr.tRAS"));
  // A refresh opens and closes a row: a clock more than tRP at least.
  for (const unsigned tRP : {5u, 8u}) {
    const auto with = [&](unsigned tRFC) {
      return play("0 0 R 0x0 4\n", {{"ddr.tRP", fmt::format("{} cycles", tRP)},
                                    {"ddr.tRC", "32 cycles"},
                                    {"ddr.tRFC", fmt::format("{} cycles", tRFC)}});
    };
    EXPECT_THAT(with(tRP), HasSubstr("ddr.tRFC")) << tRP;
    EXPECT_EQ(with(tRP + 1), "") << tRP;
  }
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.CL", "9 cycles"}}), HasSubstr("7"));
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.clock", "90MHz"}}), HasSubstr("125"));
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.banks", "6"}}), HasSubstr("powers of two"));
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.part", "mt47h32m16"}}), HasSubstr("ddr.banks"));
}

// What no part of its kind does is refused; what the part at hand forbids is a warning.
TEST(ReplayPathTest, EachKindOfMemoryHasItsClocks) {
  using testing::HasSubstr;
  std::vector<std::string> said;
  const auto play = [&](std::vector<std::pair<std::string, std::string>> keys) {
    const OwnDiagnostics diagnostics;
    const std::string error = error_of([&] {
      trace::TextTrace t("t", "# dramtrace 1\n# master 0 window 1 a\n0 0 R 0x0 4\n");
      Played(t.info(), t, false, keys);
    });
    said.clear();
    for (const auto& [what, n] : diagnostics.counts()) said.push_back(what.second);
    return error;
  };
  EXPECT_THAT(play({{"ddr.clock", "124MHz"}}), HasSubstr("125MHz .. 533MHz, DDR2"));
  EXPECT_EQ(play({{"ddr.clock", "125MHz"}, {"ddr.tREFI", "975cycles"}}), "");
  EXPECT_THAT(said, testing::IsEmpty());
  EXPECT_THAT(play({{"ddr.CL", "2cycles"}}), HasSubstr("3 .. 7 cycles, DDR2"));
  EXPECT_EQ(play({{"ddr.clock", "266MHz"}, {"ddr.CL", "4cycles"}}), "");
  EXPECT_THAT(play({{"ddr.clock", "267MHz"}, {"ddr.CL", "4cycles"}}),
              HasSubstr("'ddr.CL': 4 cycles is not allowed; allowed: more cycles at 267MHz"));
  // 3.75 ns, 2.5 ns and 1.875 ns in whole hertz, rounded up; 2 Hz more are too many.
  const auto at_CL = [&](const char* clock, const char* CL) {
    return play({{"ddr.clock", clock}, {"ddr.CL", CL}});
  };
  EXPECT_EQ(at_CL("266666667Hz", "4cycles"), "");
  EXPECT_THAT(at_CL("266666669Hz", "4cycles"), HasSubstr("more cycles at 266666669Hz"));
  EXPECT_EQ(at_CL("400000001Hz", "5cycles"), "");
  EXPECT_THAT(at_CL("400000002Hz", "5cycles"), HasSubstr("more cycles at 400000002Hz"));
  EXPECT_EQ(at_CL("533333334Hz", "7cycles"), "");
  EXPECT_THAT(at_CL("533333336Hz", "7cycles"), HasSubstr("125MHz .. 533MHz, DDR2"));
  EXPECT_THAT(at_CL("124999998Hz", "4cycles"), HasSubstr("125MHz .. 533MHz, DDR2"));
  const std::vector<std::pair<std::string, std::string>> mobile = {
      {"ddr.part", "mt46h32m16lf"}, {"ddr.banks", "4"},      {"ddr.CL", "3cycles"},
      {"ddr.clock", "166MHz"},      {"ddr.tREFI", "1290cycles"}};
  const auto with = [&](const char* key, const char* value) {
    auto keys = mobile;
    keys.emplace_back(key, value);
    return keys;
  };
  EXPECT_EQ(play(mobile), "");
  EXPECT_THAT(said, testing::IsEmpty());
  EXPECT_EQ(play(with("ddr.clock", "20MHz")), "") << "no DLL, no floor";
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("SDRCR RR: 1290 clocks programmed, "
                                                   "MT46H32M16LF-6 needs tREFI at most 7800 ns = "
                                                   "156 at 20 MHz"),
                                         HasSubstr("SDTIMR2 T_RASMAX: 8 x 1290 clocks")));
  EXPECT_THAT(play(with("ddr.clock", "201MHz")), HasSubstr("1MHz .. 200MHz, mobile DDR"));
  EXPECT_THAT(play(with("ddr.CL", "4cycles")), HasSubstr("2 or 3 cycles, mobile DDR"));
  EXPECT_THAT(play(with("ddr.CL", "2cycles")), HasSubstr("more cycles at 166MHz"));
  EXPECT_EQ(play(with("ddr.clock", "200MHz")), "");
  EXPECT_THAT(said, testing::Contains(HasSubstr("CL 3 has tCK 6 ns at least")));
  EXPECT_EQ(play({{"ddr.tRRD", "2cycles"}}), "");
  EXPECT_THAT(said, testing::Contains("SDTIMR T_RRD: 2 clocks programmed, MT47H64M16-3 needs tRRD "
                                      "10 ns = 3 at 243 MHz: 1 short"));
}

/// A trace whose content is spoilt but whose checksums are right again: plays, or one line says why
/// it cannot.
TEST(ReplayPathTest, NoTraceCrashesIt) {
  Rng rng(9);
  unsigned played = 0, refused = 0;
  for (int n = 0; n < 700; ++n) {
    trace::TraceInfo info = edma_info();
    if (rng.below(2)) info.interrupts[1] = {3'000'000, 3, trace::Point::kEnd, rng.below(4), rng.below(1'000)};
    trace::TraceWriter writer(4);
    for (std::uint64_t k = 0; k < 40; ++k)
      for (unsigned s = 0; s < 4; ++s) {
        Record r = random_record(rng, s, k);
        if (rng.below(60) != 0)  // to the SDRAM, or to internal RAM
          for (TransferRequest::Side* side : {&r.transfer.source, &r.transfer.destination}) {
            side->address = rng.below(4) ? 0x8000'0000u + side->address % 0x100'0000u
                                         : 0x1'0000u + side->address % 0x1000u;
            side->index %= 1'024;
            if (side->index < 0) side->index = -side->index;
          }
        if (rng.below(60) == 0) {  // a wild field
          switch (rng.below(9)) {
            case 0: r.address = static_cast<std::uint32_t>(rng.next()); break;
            case 1: r.bytes = static_cast<std::uint8_t>(rng.next()); break;
            case 2: r.gap = rng.next() >> rng.below(64); break;
            case 3: r.at = rng.next() >> rng.below(64); break;
            case 4: r.back = static_cast<std::uint32_t>(rng.below(60)); break;
            case 5: r.event = rng.next() >> rng.below(64); break;
            case 6: r.source = static_cast<std::uint8_t>(rng.below(kMasterCount)); break;
            case 7: r.locked = true; break;
            default: r.critical = static_cast<std::uint8_t>(rng.next()); break;
          }
        }
        writer.add(s, r);
      }
    if (rng.below(10) == 0) info.streams[0].clock = Frequency(1 + rng.next() % 2'000'000'000'000);
    if (rng.below(10) == 0) info.masters[rng.below(4)].reads = static_cast<unsigned>(rng.below(40));
    if (rng.below(10) == 0) info.start = rng.next() >> rng.below(64);
    std::string bytes;
    writer.finish(info, [&](std::string_view piece) { bytes += piece; });
    const std::string error = error_of([&] {
      trace::TraceFile file("t", bytes);
      // Hours of refreshes between two records are not worth their checkers.
      Played(file.info(), file, rng.below(2), {{"ddr.check", "none"}});
    });
    ++(error.empty() ? played : refused);
  }
  EXPECT_GT(played, 150u);
  EXPECT_GT(refused, 150u);
}

}  // namespace
}  // namespace fovea::replay
