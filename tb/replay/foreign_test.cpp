// Traces of other simulators: files in each format with records computed by hand from the format's
// definition, limits, errors, and what the writers make.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "model/common/check.h"
#include "model/trace/core/foreign_trace.h"
#include "model/trace/core/text_trace.h"
#include "sw/fovea/replay/trace_writers.h"

namespace fovea::replay {
namespace {

using testing::HasSubstr;
using trace::Bounds;
using trace::ForeignFormat;
using trace::ForeignReading;
using trace::ForeignTrace;
using trace::Record;

constexpr std::uint64_t kMiB = 1 << 20;

struct Expected {
  Picoseconds at;
  bool write;
  std::uint32_t address;
  unsigned bytes;
  friend bool operator==(const Expected&, const Expected&) = default;
};
std::ostream& operator<<(std::ostream& os, const Expected& e) {
  return os << e.at << (e.write ? " W 0x" : " R 0x") << std::hex << e.address << std::dec << " "
            << e.bytes;
}

ForeignReading reading_of(ForeignFormat format, Frequency clock = {}) {
  ForeignReading r;
  r.format = format;
  r.clock = clock;
  r.bounds.size = 128 * kMiB;
  return r;
}

std::vector<Expected> read(const std::string& text, const ForeignReading& reading) {
  ForeignTrace t("t", std::make_unique<trace::MemoryBytes>(text), reading);
  std::vector<Expected> out;
  for (Record r; t.next(0, r);) out.push_back({r.at, r.write, r.address, r.bytes});
  return out;
}

std::string error_of(const std::string& text, const ForeignReading& reading) {
  try {
    read(text, reading);
  } catch (const UserError& e) {
    return e.what();
  }
  return {};
}

const ForeignReading kStl = reading_of(ForeignFormat::kDramsysStl, Frequency(800'000'000));

TEST(ForeignTraceTest, DramsysCyclesCountFromTheStart) {
  const std::vector<Expected> expected = {
      {0, true, 0, 64},
      {3 * 1250, false, 0x1000, 64},
      {4 * 1250, false, 0x20, 32},
      {10 * 1250, true, 0x40, 64},
      {31 * 1250, false, 0xFC0, 64},
      {30 * 1250, true, 0x7FFFFC0, 64},  // the last of 128 MiB; times need not rise
  };
  EXPECT_EQ(read("# a comment\n0:\twrite\t0x00000000\n3:\tread\t0x1000  \r\n\n4: (32) read 0x20\n"
                 "10: write 0x40 0xdeadbeef\n31: read FF8\n30 write 0X7ffffc0",
                 kStl),
            expected);
}

TEST(ForeignTraceTest, DramsysRelativeCyclesAddUp) {
  // 300 MHz: 3, 7 and 12 cycles are 10000, 23333.3 and 40000 ps.
  const std::vector<Expected> expected = {
      {10'000, false, 0x0, 64}, {23'333, true, 0x40, 64}, {40'000, false, 0x80, 64}};
  EXPECT_EQ(read("3: read 0x0\n4: write 0x40\n5: read 0x80\n",
                 reading_of(ForeignFormat::kDramsysRstl, Frequency(300'000'000))),
            expected);
}

TEST(ForeignTraceTest, RamulatorHasNoTimes) {
  ForeignReading wrapped = reading_of(ForeignFormat::kRamulator);
  wrapped.bounds.wrap = true;
  // The addresses of its README, 128 MiB = 0x8000000.
  const std::vector<Expected> expected = {{0, false, 0x2345680, 64}, {0, true, 0x4bd56c0, 64}};
  EXPECT_EQ(read("0x12345680 R\n0x4cbd56c0 W\n", wrapped), expected);
  ForeignReading small = reading_of(ForeignFormat::kRamulator2);
  small.bytes = 16;
  const std::vector<Expected> second = {{0, false, 0x1000, 16}, {0, true, 4096, 16}, {0, false, 0x50, 16}};
  EXPECT_EQ(read("LD 0x1000\nST 4096\nLD 0X50\n", small), second);
}

// Ramulator, Processor.cpp: the address is hexadecimal with or without 0x, a line without a letter is a read, and of a
// word the first letter counts.
TEST(ForeignTraceTest, RamulatorsLetters) {
  const std::vector<Expected> expected = {
      {0, false, 0x40, 64}, {0, true, 0x80, 64}, {0, false, 0xC0, 64}, {0, false, 0x100, 64}};
  EXPECT_EQ(read("40\n80 WRITE\n0xC0 READ\n100 R\n", reading_of(ForeignFormat::kRamulator)), expected);
}

// What each program does with the low bits of an address: Ramulator clears those of a transaction (Memory.h, send),
// DRAMsim3 and Ramulator 2 shift them out (configuration.cc, addr_mapper_base.cpp), DRAMSys decodes no byte within a
// burst (AddressDecoder.cpp). Byte addresses are therefore the same requests as those of their blocks.
TEST(ForeignTraceTest, AddressesAreThoseOfBlocks) {
  const struct {
    ForeignFormat format;
    const char *bytes, *blocks;
  } kPairs[] = {
      {ForeignFormat::kRamulator, "0x8 R\n0x47 W\nfff R\n", "0x0 R\n0x40 W\nfc0 R\n"},
      {ForeignFormat::kRamulator2, "LD 8\nST 0x47\nLD 4095\n", "LD 0\nST 64\nLD 4032\n"},
      {ForeignFormat::kDramsim3, "0x8 READ 1\n0x47 WRITE 2\nfff READ 3\n",
       "0x0 READ 1\n0x40 WRITE 2\nfc0 READ 3\n"},
      {ForeignFormat::kDramsysStl, "1: read 0x8\n2: (16) write 0x47\n3: (128) read 0xfff\n",
       "1: read 0x0\n2: (16) write 0x40\n3: (128) read 0xf80\n"},
  };
  for (const auto& pair : kPairs) {
    const ForeignReading reading = reading_of(pair.format, Frequency(1'000'000'000));
    EXPECT_EQ(read(pair.bytes, reading), read(pair.blocks, reading)) << pair.bytes;
    ForeignTrace t("t", std::make_unique<trace::MemoryBytes>(pair.bytes), reading);
    for (Record r; t.next(0, r);) {
    }
    EXPECT_EQ(t.aligned(), 3u) << pair.bytes;
  }
  ForeignReading small = reading_of(ForeignFormat::kRamulator);
  small.bytes = 32;
  EXPECT_EQ(read("0x3f R\n", small), (std::vector<Expected>{{0, false, 0x20, 32}}));
}

TEST(ForeignTraceTest, Dramsim3CyclesComeLast) {
  // A period of 1.5 ns.
  const auto reading = reading_of(ForeignFormat::kDramsim3, Frequency(kPsPerSecond, 1500));
  const std::vector<Expected> expected = {{7'500, false, 0x40, 64},
                                          {9'000, true, 0x80, 64},
                                          {9'000, false, 0xC0, 64},
                                          {10'500, true, 0x100, 64}};
  EXPECT_EQ(read("0x40 READ 5\n80 WRITE 6\n0xC0 P_MEM_RD 6\n0x100 write 7\n", reading), expected);
}

TEST(ForeignTraceTest, TheMasterIsAsAskedFor) {
  ForeignReading reading = kStl;
  reading.label = "gpu";
  reading.window = 5;
  ForeignTrace t("t", std::make_unique<trace::MemoryBytes>("0: read 0x0\n"), reading);
  ASSERT_EQ(t.info().masters.size(), 1u);
  EXPECT_EQ(t.info().masters[0].label, "gpu");
  EXPECT_EQ(t.info().masters[0].reads, 5u);
  EXPECT_EQ(t.info().masters[0].writes, 16u);
}

TEST(ForeignTraceTest, ErrorsNameLineAndWhatIsAllowed) {
  const ForeignReading ram = reading_of(ForeignFormat::kRamulator);
  const ForeignReading ram2 = reading_of(ForeignFormat::kRamulator2);
  const ForeignReading sim3 = reading_of(ForeignFormat::kDramsim3, Frequency(1'000'000'000));
  EXPECT_THAT(error_of("", kStl), HasSubstr("no request; 'CYCLE: [(BYTES)] read|write 0xADDRESS'"));
  EXPECT_THAT(error_of("\n#x\n", ram), HasSubstr("no request; '0xADDRESS R|W'"));
  EXPECT_THAT(error_of("0: read 0x0\n\nx: read 0x0\n", kStl), HasSubstr("'t':3: cycle 'x'"));
  EXPECT_THAT(error_of("0: fetch 0x0\n", kStl), HasSubstr("allowed: read, write"));
  EXPECT_THAT(error_of("0: READ 0x0\n", kStl), HasSubstr("allowed: read, write"));
  EXPECT_THAT(error_of("0: read\n", kStl), HasSubstr("a request is 'CYCLE:"));
  EXPECT_THAT(error_of("0: read 0x0 0x11\n", kStl), HasSubstr("a request is 'CYCLE:"));
  EXPECT_THAT(error_of("0: write 0x0 0x11 1\n", kStl), HasSubstr("a request is 'CYCLE:"));
  EXPECT_THAT(error_of("0: (0) read 0x0\n", kStl), HasSubstr("allowed: (1) to (4096)"));
  EXPECT_THAT(error_of("0: (4097) read 0x0\n", kStl), HasSubstr("allowed: (1) to (4096)"));
  EXPECT_EQ(error_of("0: (4096) read 0x0\n", kStl), "");
  EXPECT_THAT(error_of("0: (48) read 0x0\n", kStl), HasSubstr("'t':1: size '(48)' is not allowed"));
  EXPECT_THAT(error_of("0: (64 read 0x0\n", kStl), HasSubstr("size '(64'"));
  EXPECT_THAT(error_of("0: read 0xg\n", kStl), HasSubstr("address '0xg'"));
  EXPECT_THAT(error_of("0: read 0x10000000000000000\n", kStl), HasSubstr("64 bits"));
  EXPECT_THAT(error_of("0x0 X\n", ram), HasSubstr("allowed: R, W"));
  EXPECT_THAT(error_of("0x0 r\n", ram), HasSubstr("allowed: R, W"));
  EXPECT_THAT(error_of("0x0 R 5\n", ram), HasSubstr("a request is '0xADDRESS R|W'"));
  EXPECT_THAT(error_of("0x0 R\n3 20734016\n", ram), HasSubstr("'t':2: a line of a CPU trace of Ramulator"));
  EXPECT_THAT(error_of("3 20734016 4096\n", ram2), HasSubstr("'t':1: a line of a CPU trace of Ramulator"));
  EXPECT_THAT(error_of("R 0x40\n", ram2), HasSubstr("allowed: LD, ST"));
  EXPECT_THAT(error_of("LD 0x0\nLX 0x0\n", ram2), HasSubstr("'t':2: direction 'LX'"));
  EXPECT_THAT(error_of("LD 0x0\nR 0,0,1,2,40,7\n", ram2), HasSubstr("'t':2: a line of Ramulator 2's ReadWriteTrace"));
  EXPECT_THAT(error_of("LD 1f\n", ram2), HasSubstr("decimal or 0x"));
  EXPECT_THAT(error_of("0x0 READ\n", sim3), HasSubstr("a request is '0xADDRESS READ|WRITE CYCLE'"));
  EXPECT_THAT(error_of("0x0 FETCH 1\n", sim3),
              HasSubstr("allowed: READ, read, P_MEM_RD, P_FETCH, WRITE"));
  EXPECT_THAT(error_of("0x0 READ 0x5\n", sim3), HasSubstr("cycle '0x5'"));
}

TEST(ForeignTraceTest, LimitsOfAddressesAndTimes) {
  const auto sized = [](std::uint64_t address, bool wrap) {
    ForeignReading r = kStl;
    r.bounds = {64 * kMiB, wrap};
    char line[64];
    std::snprintf(line, sizeof line, "0: read 0x0\n0: read 0x%llx\n",
                  static_cast<unsigned long long>(address));
    return error_of(line, r);
  };
  EXPECT_EQ(sized(64 * kMiB - 64, false), "");
  EXPECT_EQ(sized(64 * kMiB - 1, false), "") << "of the last block";
  EXPECT_THAT(sized(64 * kMiB, false),
              HasSubstr("'t':2: 64 bytes at 0x04000000 are outside the memory of 64 MiB; --wrap"));
  EXPECT_EQ(sized(64 * kMiB, true), "");
  EXPECT_EQ(sized(~std::uint64_t{0}, true), "");
  EXPECT_THAT(sized(~std::uint64_t{0}, false), HasSubstr("outside the memory of 64 MiB"));
  // 100 s at 800 MHz.
  EXPECT_EQ(error_of("80000000000: read 0x0\n", kStl), "");
  EXPECT_THAT(error_of("80000000001: read 0x0\n", kStl), HasSubstr("later than the 100 s allowed"));
  EXPECT_THAT(error_of("18446744073709551615: read 0x0\n", kStl),
              HasSubstr("later than the 100 s"));
  EXPECT_THAT(error_of("18446744073709551616: read 0x0\n", kStl), HasSubstr("cycle '1844"));
  ForeignReading relative = kStl;
  relative.format = ForeignFormat::kDramsysRstl;
  EXPECT_EQ(error_of("40000000000: read 0x0\n40000000000: read 0x0\n", relative), "");
  EXPECT_THAT(error_of("40000000000: read 0x0\n40000000001: read 0x0\n", relative),
              HasSubstr("'t':2: cycle 40000000001 is later"));
}

// A request may be larger than the memory: each piece wraps by itself.
TEST(ForeignTraceTest, ARequestOverTheEndGoesOnAtTheBeginning) {
  ForeignReading r = kStl;
  r.bounds = {64, true};
  const std::vector<Expected> expected = {{0, false, 0, 64}, {0, false, 0, 64}};
  EXPECT_EQ(read("0: (128) read 0x3f0\n", r), expected);
}

TEST(BoundedSourceTest, RecordsAreHeldToTheMemory) {
  const std::string text =
      "# dramtrace 1\n# master 0 window 1 a\n0 0 R 0x3FFFFC0 64\n0 0 R 0x4000000 4\n";
  trace::TextTrace strict_text("t", text), wrapped_text("t", text);
  trace::BoundedSource strict("t", strict_text, {64 * kMiB, false});
  Record r;
  EXPECT_TRUE(strict.next(0, r));
  try {
    strict.next(0, r);
    ADD_FAILURE() << "taken";
  } catch (const UserError& e) {
    EXPECT_THAT(e.what(),
                HasSubstr("line 4: 4 bytes at 0x04000000 are outside the memory of 64 MiB"));
  }
  trace::BoundedSource wrapped("t", wrapped_text, {64 * kMiB, true});
  EXPECT_TRUE(wrapped.next(0, r));
  EXPECT_EQ(r.address, 0x3FFFFC0u);
  EXPECT_TRUE(wrapped.next(0, r));
  EXPECT_EQ(r.address, 0u);
  EXPECT_FALSE(wrapped.next(0, r));
}

TEST(ForeignTraceTest, FormatsAreRecognisedByTheirFirstRequest) {
  using F = ForeignFormat;
  const auto is = [](const char* text) { return trace::recognise_foreign(text); };
  EXPECT_EQ(is("# x\n\n31:\tread\t0x400140\n"), F::kDramsysStl);
  EXPECT_EQ(is("0: (64) write 0x0\n"), F::kDramsysStl);
  EXPECT_EQ(is("0x12345680 R\n"), F::kRamulator);
  EXPECT_EQ(is("LD 0x12345680\n"), F::kRamulator2);
  EXPECT_EQ(is("0x1000 WRITE 12"), F::kDramsim3);
  EXPECT_EQ(is("1000 P_FETCH 12"), F::kDramsim3);
  for (const char* none :
       {"", "\n", "# dramtrace 1\n", "hello world\n", "0 0 R 0x0 64\n", "0x10\n", "0x10 X\n",
        "W 0,0,1,2,40,7\n", "R 0x40\n", "3 20734016\n", "8 20841280 20841280\n",
        "12 READ x\n", "x: read 0x0\n", "key: value\n", "{\n", "0: read\n", "LD 0x0 0x1\n"})
    EXPECT_EQ(is(none), std::nullopt) << none;
}

// Known formats that are not read are refused by name, others by the line that is none.
TEST(ForeignTraceTest, WhatIsNotReadIsNamed) {
  const auto why = [](std::string_view bytes) {
    const trace::ForeignRefusal r = trace::refuse_foreign(bytes);
    return std::to_string(r.line) + " " + r.what;
  };
  // The example of Ramulator 2 (example_inst.trace).
  EXPECT_THAT(why("3 20734016\n1 20846400\n"), testing::StartsWith("1 a line of a CPU trace of Ramulator"));
  EXPECT_THAT(why("\n# x\n8 20841280 20841280\n"), testing::StartsWith("3 a line of a CPU trace of Ramulator"));
  EXPECT_THAT(why("R 0,0,1,2,40,7\n"), testing::StartsWith("1 a line of Ramulator 2's ReadWriteTrace"));
  EXPECT_EQ(why("#\nhello  world\n"), "2 'hello world', a line of none of the known trace formats");
  EXPECT_EQ(why("gem5\x09\x0a"), "0 a packet trace of gem5 (protobuf), which is not read");
  // printf 'gem5\n' | gzip -n
  constexpr std::string_view kPacked(
      "\x1f\x8b\x08\0\0\0\0\0\0\x03\x4b\x4f\xcd\x35\xe5\x02\0\xaa\x28\x23\xe3\x05\0\0\0", 25);
  EXPECT_EQ(why(kPacked), "0 a packet trace of gem5 (protobuf), which is not read");
  EXPECT_EQ(why(kPacked.substr(0, 12)), "0 packed by gzip; unpack it first");
  EXPECT_EQ(why("\xff\xfe" "0"), "0 text in UTF-16; make it UTF-8 first");
  EXPECT_EQ(why(""), "0 without a request");
}

/// What a writer makes of these requests.
std::string written(const app::WriterSettings& settings,
                    const std::vector<app::TimedRequest>& requests,
                    app::LineWriter** keep = nullptr) {
  static std::string out;
  static std::unique_ptr<app::LineWriter> writer;
  out.clear();
  writer = std::make_unique<app::LineWriter>(settings, [](std::string_view s) { out += s; });
  writer->begin({{"a", 4}, {"b", 48}});
  for (const auto& r : requests) writer->add(r);
  writer->end();
  if (keep) *keep = writer.get();
  return out;
}

TEST(LineWriterTest, EachFormatAsItsSimulatorReadsIt) {
  using app::TraceFormat;
  const std::vector<app::TimedRequest> requests = {
      {0, 0, 0, false, 0x1000, 64},       {2500, 2500, 1, true, 0x2000, 64},
      {2501, 2501, 0, false, 0x3040, 64},  // not on an edge of 1250 ps: the next
      {0, 2501, 0, true, 0x40, 32},        // behind the one before it
      {5000, 5000, 1, false, 0x70, 32},    // over a border of 64
  };
  const Frequency clock(kPsPerSecond, 1250);
  EXPECT_EQ(written({TraceFormat::kText, {}, 64}, requests),
            "# dramtrace 1\n# master 0 window 4 a\n# master 1 window 48 b\n0 0 R 0x1000 64\n"
            "2500 1 W 0x2000 64\n2501 0 R 0x3040 64\n0 0 W 0x40 32\n5000 1 R 0x70 32\n");
  EXPECT_EQ(
      written({TraceFormat::kDramsysStl, clock, 64}, requests),
      "0: read 0x1000\n2: write 0x2000\n3: read 0x3040\n3: (32) write 0x40\n4: (16) read 0x70\n"
      "4: (16) read 0x80\n");
  EXPECT_EQ(
      written({TraceFormat::kDramsysRstl, clock, 64}, requests),
      "0: read 0x1000\n2: write 0x2000\n1: read 0x3040\n0: (32) write 0x40\n1: (16) read 0x70\n"
      "0: (16) read 0x80\n");
  app::LineWriter* writer = nullptr;
  EXPECT_EQ(
      written({TraceFormat::kDramsim3, clock, 64}, requests, &writer),
      "0x1000 READ 0\n0x2000 WRITE 2\n0x3040 READ 3\n0x40 WRITE 3\n0x40 READ 4\n0x80 READ 4\n");
  EXPECT_EQ(writer->resized(), 2u);
  EXPECT_EQ(writer->pieces(), 3u);
  EXPECT_EQ(written({TraceFormat::kRamulator, {}, 32}, requests),
            "0x1000 R\n0x1020 R\n0x2000 W\n0x2020 W\n0x3040 R\n0x3060 R\n0x40 W\n0x60 R\n0x80 R\n");
  EXPECT_EQ(written({TraceFormat::kRamulator2, {}, 64}, requests),
            "LD 0x1000\nST 0x2000\nLD 0x3040\nST 0x40\nLD 0x40\nLD 0x80\n");
}

}  // namespace
}  // namespace fovea::replay
