// Bus traces with right checksums and wrong contents: each refusal with its message, and each limit
// at its last valid value and the one after it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <functional>
#include <limits>

#include "model/common/check.h"
#include "tb/replay/support.h"

namespace fovea::replay::refusals {
namespace {

using testing::HasSubstr;
using trace::Record;
using trace::Release;

std::string error_of(const std::string& bytes) {
  try {
    trace::TraceFile file("t", bytes);
    Record r;
    for (unsigned s = 0; s < file.info().streams.size(); ++s)
      while (file.next(s, r)) {
      }
  } catch (const UserError& e) {
    return e.what();
  }
  return {};
}

/// A file block by block; README.md has the layout.
class FileBuilder {
 public:
  explicit FileBuilder(char version = '3') {
    bytes_ = std::string("FOVEA-BUS-TRACE ") + version + "\n";
  }
  FileBuilder& block(char kind, unsigned stream, std::uint32_t count, const std::string& raw,
                     std::uint32_t raw_size) {
    uLongf size = ::compressBound(static_cast<uLong>(raw.size()));
    std::string packed(size, '\0');
    EXPECT_EQ(::compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                         reinterpret_cast<const Bytef*>(raw.data()), static_cast<uLong>(raw.size())),
              Z_OK);
    packed.resize(size);
    std::string head{kind, static_cast<char>(stream), 0, 0};
    for (const std::uint32_t v : {count, raw_size, static_cast<std::uint32_t>(size)}) put(head, v);
    const std::string all = head + packed;
    put(head, static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(all.data()),
                                                 static_cast<uInt>(all.size()))));
    bytes_ += head + packed;
    return *this;
  }
  FileBuilder& block(char kind, unsigned stream, std::uint32_t count, const std::string& raw) {
    return block(kind, stream, count, raw, static_cast<std::uint32_t>(raw.size()));
  }
  FileBuilder& end(std::uint64_t records) {
    std::string total;
    trace::put_number(total, records);
    return block('E', 0, 0, total);
  }
  std::string error() const { return error_of(bytes_); }

 private:
  static void put(std::string& out, std::uint32_t v) {
    for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(v >> 8 * i));
  }
  std::string bytes_;
};

const std::string kInfo =
    "start 1000000\nend 900000000\nrefresh 700000\nscr 121500000 1 500\nddr 243000000 1 500\n"
    "stream 297000000 1 300 2 1\nstream 1000 1 0 1 0\n"
    "master 1 0 1 1 1 arm_d\nmaster 6 1 4 4 1 vpfe\nparam ddr.CL 4cycles\ninterrupt 2000000\n";

/// kInfo with one line changed.
std::string info_with(const std::string& line, const std::string& by) {
  std::string text = kInfo;
  const std::size_t at = text.find(line + "\n");
  EXPECT_NE(at, std::string::npos) << line;
  return text.replace(at, line.size() + (by.empty() ? 1 : 0), by);
}
std::string error_of_info(const std::string& text) {
  return FileBuilder().block('I', 0, 0, text).end(0).error();
}

/// A read of four bytes at address 0, at time 0, of the stream's master.
std::string read_of(unsigned master) {
  Record r;
  r.bytes = 4;
  r.master = static_cast<Master>(master);
  trace::CodeState state;
  std::string out;
  trace::encode(r, state, out);
  return out;
}

TEST(TraceBlocksTest, GoodOnesAreRead) {
  EXPECT_EQ(error_of_info(kInfo), "");
  EXPECT_EQ(FileBuilder().block('I', 0, 0, kInfo).block('R', 0, 1, read_of(1)).end(1).error(), "");
}

TEST(TraceBlocksTest, VersionsBesideTheKnownOnesAreRefused) {
  for (const char version : {'1', '2', '3', '4'})
    EXPECT_EQ(FileBuilder(version).block('I', 0, 0, kInfo).end(0).error(), "");
  EXPECT_EQ(FileBuilder('5').block('I', 0, 0, "version 5\n" + kInfo).end(0).error(), "");
  for (const char version : {'0', '6'})
    EXPECT_THAT(FileBuilder(version).block('I', 0, 0, kInfo).end(0).error(),
                HasSubstr("its version is not known; allowed: versions 1 to 5"));
}

// The first line is under no checksum: one flipped bit makes 4 or 1 of 5.
TEST(TraceBlocksTest, TheVersionIsInTheDescriptionToo) {
  EXPECT_THAT(FileBuilder('5').block('I', 0, 0, kInfo).end(0).error(), HasSubstr("its description has no version"));
  for (const char version : {'1', '4'})
    EXPECT_THAT(FileBuilder(version).block('I', 0, 0, "version 5\n" + kInfo).end(0).error(),
                HasSubstr("'version' in its description"));
  EXPECT_THAT(FileBuilder('5').block('I', 0, 0, "version 4\n" + kInfo).end(0).error(),
              HasSubstr("another version than its description"));
}

TEST(TraceBlocksTest, TheirOrderAndNumberMatter) {
  EXPECT_THAT(FileBuilder().block('R', 0, 1, read_of(1)).end(1).error(), HasSubstr("no description"));
  EXPECT_THAT(FileBuilder().error(), HasSubstr("its end is missing"));
  EXPECT_THAT(FileBuilder().block('I', 0, 0, kInfo).error(), HasSubstr("its end is missing"));
  EXPECT_THAT(FileBuilder().block('I', 0, 0, kInfo).end(0).end(0).error(),
              HasSubstr("something follows its end"));
  EXPECT_THAT(FileBuilder().block('I', 0, 0, kInfo).block('I', 0, 0, kInfo).end(0).error(),
              HasSubstr("an unknown block"));
  EXPECT_THAT(FileBuilder().block('I', 0, 0, kInfo).block('X', 0, 0, "").end(0).error(),
              HasSubstr("an unknown block"));
  EXPECT_EQ(FileBuilder().block('I', 0, 0, kInfo).block('R', 1, 1, read_of(6)).end(1).error(), "");
  EXPECT_THAT(FileBuilder().block('I', 0, 0, kInfo).block('R', 2, 1, read_of(6)).end(1).error(),
              HasSubstr("an unknown block"));
}

// A whole block that was taken out, or put in twice, leaves no wrong checksum behind.
TEST(TraceBlocksTest, TheNumberOfRecordsIsHeldAgainstTheEnd) {
  const auto with = [](std::uint64_t told) {
    return FileBuilder().block('I', 0, 0, kInfo).block('R', 0, 1, read_of(1)).end(told).error();
  };
  EXPECT_EQ(with(1), "");
  for (const std::uint64_t told : {0u, 2u})
    EXPECT_THAT(with(told), HasSubstr("records are missing")) << told;
  EXPECT_THAT(FileBuilder().block('I', 0, 0, kInfo).block('E', 0, 0, "").error(),
              HasSubstr("a record is cut off"));
}

TEST(TraceBlocksTest, TheirSizesAreHeldAgainstTheirContents) {
  const std::string one = read_of(1);
  const auto with = [&](std::uint32_t count, const std::string& raw, std::uint32_t size) {
    return FileBuilder().block('I', 0, 0, kInfo).block('R', 0, count, raw, size).end(count).error();
  };
  const auto size = static_cast<std::uint32_t>(one.size());
  EXPECT_THAT(with(0, one, size), HasSubstr("a block of impossible size"));
  EXPECT_THAT(with(1, one, size - 1), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(with(1, one, size + 1), HasSubstr("cannot be unpacked"));
  EXPECT_THAT(with(1, one, 64), HasSubstr("cannot be unpacked")) << "the most that a record needs";
  EXPECT_THAT(with(1, one, 65), HasSubstr("a block of impossible size"));
  EXPECT_THAT(with(8192, one, size), HasSubstr("a record is cut off"));
  EXPECT_THAT(with(8193, one, size), HasSubstr("a block of impossible size"));
  EXPECT_THAT(with(2, one, size), HasSubstr("a record is cut off (stream 0, record 1)"));
  EXPECT_THAT(with(1, one + '\0', size + 1), HasSubstr("more records than a block says"));
  EXPECT_THAT(FileBuilder().block('I', 0, 0, kInfo, (64u << 20) + 1).end(0).error(),
              HasSubstr("a block of impossible size"));
}

TEST(TraceInfoTest, LinesThatCannotBeAreRefused) {
  struct Case {
    const char *line, *good, *bad, *why;
  };
  // The last good value of each, and the one behind it.
  const Case cases[] = {
      {"start 1000000", "start 900000000", "start 900000001", "an impossible description"},
      {"refresh 700000", "refresh 1000000", "refresh 1000001", "an impossible description"},
      {"end 900000000", "end 3600000000000000", "end 3600000000000001", "an impossible description"},
      {"interrupt 2000000", "interrupt 3600000000000000", "interrupt 3600000000000001",
       "an impossible description"},
      {"scr 121500000 1 500", "scr 1000000000000 100 500", "scr 1000000000000 101 500",
       "an impossible description"},
      {"scr 121500000 1 500", "scr 10000000000 1 500", "scr 10000000001 1 500",
       "an impossible description"},
      {"ddr 243000000 1 500", "ddr 243000000 1 3600000000000000", "ddr 243000000 1 3600000000000001",
       "an impossible description"},
      {"ddr 243000000 1 500", "ddr 243000000 1 500", "ddr 243000000 0 500",
       "a clock without a frequency"},
      {"stream 297000000 1 300 2 1", "stream 297000000 1 300 2 1", "stream 297000000 1 300 2 2",
       "a stream with an impossible clock"},
      {"stream 297000000 1 300 2 1", "stream 297000000 1 300 64 63", "stream 297000000 1 300 65 63",
       "a stream with an impossible clock"},
      {"stream 297000000 1 300 2 1", "stream 297000000 1 300 1 0", "stream 297000000 1 300 0 0",
       "a stream with an impossible clock"},
      {"stream 297000000 1 300 2 1", "stream 297000000 1 300 2 0", "stream 0 1 300 2 0",
       "a stream with an impossible clock"},
      {"stream 297000000 1 300 2 1", "stream 297000000 1 300 2 0", "stream 297000000 0 300 2 0",
       "a stream with an impossible clock"},
      {"stream 1000 1 0 1 0", "stream 1000 1 0 1 0", "stream 999 1 0 1 0", "an impossible description"},
      {"stream 1000 1 0 1 0", "stream 1000000000000 1 0 1 0", "stream 1000000000001 1 0 1 0",
       "an impossible description"},
      {"stream 1000 1 0 1 0", "stream 1000000001 1000000 0 1 0", "stream 1000001001 1000001 0 1 0",
       "an impossible description"},
      {"stream 1000 1 0 1 0", "stream 1000 1 3600000000000000 1 0",
       "stream 1000 1 3600000000000001 1 0", "an impossible description"},
      {"master 6 1 4 4 1 vpfe", "master 13 1 4 4 1 last", "master 14 1 4 4 1 next",
       "a master with an impossible window"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 1 1 1 vpfe", "master 6 1 0 1 1 vpfe",
       "a master with an impossible window"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 1 1 1 vpfe", "master 6 1 1 0 1 vpfe",
       "a master with an impossible window"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 64 64 1 vpfe", "master 6 1 65 64 1 vpfe",
       "a master with an impossible window"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 64 64 1 vpfe", "master 6 1 64 65 1 vpfe",
       "a master with an impossible window"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 48 16 0 vpfe", "master 6 1 48 17 0 vpfe",
       "a master with an impossible window"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 4 4 1 vpfe", "master 6 1 4 4 2 vpfe",
       "a master with an impossible window"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 4 4 1 vpfe", "master 6 2 4 4 1 vpfe",
       "an impossible description"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 4 4 1 vpfe", "master 1 1 4 4 1 vpfe",
       "an impossible description"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 4 4 1 vpfe", "master 6 1 4 4 1 ",
       "an impossible description"},
      {"master 6 1 4 4 1 vpfe", "master 6 1 4 4 1 vpfe", "master 6 1 4 4 1 refresh",
       "an impossible description"},
      {"scr 121500000 1 500", "scr 121500000 1 500", "scr 121500000 1", "'scr' in its description"},
      {"start 1000000", "start 1000000", "start 1e6", "'start' in its description"},
      {"start 1000000", "start 1000000", "start -1", "'start' in its description"},
      {"start 1000000", "start 1000000", "begin 1000000", "'begin' in its description"},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(error_of_info(info_with(c.line, c.good)), "") << c.good;
    EXPECT_THAT(error_of_info(info_with(c.line, c.bad)), HasSubstr(c.why)) << c.bad;
  }
}

TEST(TraceInfoTest, WhatIsMissingIsRefused) {
  EXPECT_THAT(error_of_info(kInfo.substr(0, kInfo.size() - 1)),
              HasSubstr("its description is cut off"));
  std::string text = info_with("master 1 0 1 1 1 arm_d", "");
  text.erase(text.find("master 6"), 22);
  EXPECT_THAT(error_of_info(text), HasSubstr("an impossible description")) << "no master";
  EXPECT_THAT(error_of_info("start 0\nend 1\nmaster 1 0 1 1 1 a\n"),
              HasSubstr("an impossible description")) << "no stream";
  std::string many = kInfo;
  for (std::size_t n = 2; n < kMasterCount; ++n) many += "stream 1000 1 0 1 0\n";
  EXPECT_EQ(error_of_info(many), "");
  EXPECT_THAT(error_of_info(many + "stream 1000 1 0 1 0\n"), HasSubstr("an impossible description"));
}

/// The error of a file of these records of stream 1, whose clock has 1 kHz.
std::string error_of_records(const std::vector<Record>& records) {
  trace::CodeState state;
  std::string raw;
  for (const Record& r : records) trace::encode(r, state, raw);
  return FileBuilder()
      .block('I', 0, 0, kInfo)
      .block('R', 1, static_cast<std::uint32_t>(records.size()), raw)
      .end(records.size())
      .error();
}
Record video(Release release = Release::kAt) {
  Record r;
  r.master = Master::kVpfe;
  r.bytes = 64;
  r.release = release;
  return r;
}
std::string error_with(const std::function<void(Record&)>& change, Release release = Release::kAt) {
  std::vector<Record> records{video(), video(release)};
  change(records.back());
  return error_of_records(records);
}

TEST(TraceRecordTest, LimitsAreThoseOfTheFormat) {
  EXPECT_EQ(error_with([](Record& r) { r.bytes = 64; }), "");
  EXPECT_THAT(error_with([](Record& r) { r.bytes = 65; }), HasSubstr("a burst of no size"));
  EXPECT_EQ(error_with([](Record& r) { r.bytes = 1; }), "");
  EXPECT_THAT(error_with([](Record& r) { r.bytes = 0; }), HasSubstr("a burst of no size"));
  EXPECT_EQ(error_with([](Record& r) { r.priority = 7; }), "");
  EXPECT_EQ(error_with([](Record& r) { r.critical = 63; }), "");
  EXPECT_THAT(error_with([](Record& r) { r.critical = 64; }),
              HasSubstr("a critical word outside its burst"));
  EXPECT_EQ(error_with([](Record& r) { r.at = 900'000'000 + kPsPerSecond; }), "");
  EXPECT_THAT(error_with([](Record& r) { r.at = 900'000'001 + kPsPerSecond; }),
              HasSubstr("a time after its end"));
  // An hour of 1 kHz.
  EXPECT_EQ(error_with([](Record& r) { r.gap = 3'600'000; }, Release::kAfter), "");
  EXPECT_THAT(error_with([](Record& r) { r.gap = 3'600'001; }, Release::kAfter),
              HasSubstr("a gap of hours"));
  EXPECT_EQ(error_with([](Record& r) { r.wake_gap = 3'600'000; }, Release::kWhen), "");
  EXPECT_THAT(error_with([](Record& r) { r.wake_gap = 3'600'001; }, Release::kWhen),
              HasSubstr("a gap of hours"));
  EXPECT_EQ(error_with([](Record& r) { r.event = 0; }, Release::kWhen), "");
  EXPECT_THAT(error_with([](Record& r) { r.event = 1; }, Release::kWhen),
              HasSubstr("an event that never came"));
  EXPECT_EQ(error_with([](Record& r) { r.back = 1; }, Release::kAfter), "");
  EXPECT_THAT(error_with([](Record& r) { r.back = 2; }, Release::kAfter),
              HasSubstr("before the first record"));
  const auto room = [](std::uint32_t n) {
    return [n](Record& r) {
      r.write = true;
      r.room = n;
    };
  };
  EXPECT_EQ(error_with(room(1), Release::kAfter), "");
  EXPECT_THAT(error_with(room(2), Release::kAfter), HasSubstr("before the first record"));
}

TEST(TraceRecordTest, ReferencesReachAsFarAsTheReaderRemembers) {
  const auto with = [](std::uint32_t back, std::uint32_t room) {
    std::vector<Record> records(trace::kMaxBack + 2, video());
    records.push_back(video(Release::kAfter));
    records.back().write = true;
    records.back().back = back;
    records.back().room = room;
    return error_of_records(records);
  };
  EXPECT_EQ(with(trace::kMaxBack, trace::kMaxBack), "");
  EXPECT_THAT(with(trace::kMaxBack + 1, 0), HasSubstr("a reference too far back"));
  EXPECT_THAT(with(0, trace::kMaxBack + 1), HasSubstr("a reference too far back"));
}

/// The error of these bytes as the one record of stream 0.
std::string error_of_code(const std::string& code) {
  return FileBuilder().block('I', 0, 0, kInfo).block('R', 0, 1, code).end(1).error();
}
std::string coded(std::initializer_list<std::uint64_t> numbers) {
  std::string out;
  for (const std::uint64_t n : numbers) trace::put_number(out, n);
  return out;
}
// Of the flags: 128 other master, 32 other size, 6 a mark; see README.md.
TEST(TraceRecordTest, BytesThatNoWriterMakesAreRefused) {
  const char other = static_cast<char>(128 + 32), bare = static_cast<char>(128), mark = 6;
  EXPECT_EQ(error_of_code(other + coded({1, 4, 7, 0, 0})), "");
  EXPECT_THAT(error_of_code(other + coded({kMasterCount, 4, 7, 0, 0})), HasSubstr("unknown master"));
  EXPECT_THAT(error_of_code(other + coded({6, 4, 7, 0, 0})), HasSubstr("a master in another's stream"));
  EXPECT_EQ(error_of_code(other + coded({1, 4, 15, 0, 0})), "");
  EXPECT_THAT(error_of_code(other + coded({1, 4, 16, 0, 0})), HasSubstr("a burst of no size"));
  EXPECT_THAT(error_of_code(bare + coded({1, 0, 0})), HasSubstr("a burst without a size"));
  const std::uint64_t top = trace::zigzag(0xFFFF'FFFFu);
  EXPECT_EQ(error_of_code(other + coded({1, 4, 7, top, 0})), "");
  EXPECT_THAT(error_of_code(other + coded({1, 4, 7, trace::zigzag(0x1'0000'0000u), 0})),
              HasSubstr("an address beyond 4 GiB"));
  EXPECT_EQ(error_of_code(mark + coded({0, 0xFFFF'FFFFu, 0})), "");
  EXPECT_THAT(error_of_code(mark + coded({0, 0x1'0000'0000u, 0})), HasSubstr("a mark is too large"));
  EXPECT_THAT(error_of_code(mark + coded({3, 0, 0})), HasSubstr("unknown release"));
  // `when`: back, gap, what comes, its number, clocks.
  EXPECT_EQ(error_of_code(mark + coded({2, 0, 0, 0, 0, 0, 0})), "");
  EXPECT_THAT(error_of_code(mark + coded({2, 0, 0, 0, kMasterCount + 1, 0, 0})),
              HasSubstr("an unknown stream"));
  EXPECT_THAT(error_of_code(mark + coded({2, 0, 0, 0, 0, trace::zigzag(1ull << 40), 0})),
              HasSubstr("an event too far"));
  EXPECT_THAT(error_of_code(mark + coded({2, 0, 0, 0, 0, 0, 0x1'0000'0000u})),
              HasSubstr("an event too far"));
  EXPECT_THAT(error_of_code(mark + coded({0, 0}) + std::string(9, '\xFF') + '\x01'), HasSubstr("time"));
  EXPECT_THAT(error_of_code(mark + std::string(10, '\xFF')), HasSubstr("a number is too long"));
}

// Versions 1 and 2 have no room; a record of version 2 is read as it was written.
TEST(TraceRecordTest, RoomIsOfVersionThree) {
  Record r = video(Release::kAfter);
  r.write = true;
  r.back = 1;
  r.gap = 5;
  r.room = 3;
  trace::CodeState out;
  std::string code;
  trace::encode(r, out, code);
  ASSERT_EQ(code.back(), 3);
  for (const unsigned version : {2u, 3u}) {
    const std::string bytes = version == 3 ? code : code.substr(0, code.size() - 1);
    trace::ByteReader in({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    trace::CodeState state;
    Record read;
    trace::decode(in, state, read, version);
    EXPECT_TRUE(in.empty());
    r.room = version == 3 ? 3 : 0;
    EXPECT_EQ(read, r);
  }
  // Neither reads nor marks have it.
  r.write = false;
  code.clear();
  trace::encode(r, out, code);
  EXPECT_EQ(code.back(), 5);
}

}  // namespace
}  // namespace fovea::replay::refusals
