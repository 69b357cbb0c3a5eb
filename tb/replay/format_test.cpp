// The file format of bus traces: round trips, and rejection of damaged files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/common/check.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using trace::Record;
using trace::TraceFile;

std::vector<Record> read_all(TraceFile& file, unsigned stream) {
  std::vector<Record> out;
  for (Record r; file.next(stream, r);) out.push_back(r);
  return out;
}

TEST(TraceFileTest, GivesBackWhatWasWritten) {
  const MadeTrace made = make_trace(1, 20'000);  // several blocks a stream
  TraceFile file("t", made.bytes);
  EXPECT_EQ(file.records(), 80'000u);
  const trace::TraceInfo& info = file.info();
  EXPECT_EQ(info.start, made.info.start);
  EXPECT_EQ(info.end, made.info.end);
  EXPECT_EQ(info.core_until, made.info.core_until);
  EXPECT_EQ(info.edma, made.info.edma);
  EXPECT_EQ(info.refresh, made.info.refresh);
  EXPECT_EQ(info.scr, made.info.scr);
  EXPECT_EQ(info.ddr, made.info.ddr);
  EXPECT_EQ(info.params, made.info.params);
  EXPECT_EQ(info.streams, made.info.streams);
  EXPECT_EQ(info.masters, made.info.masters);
  EXPECT_EQ(info.interrupts, made.info.interrupts);
  for (unsigned s = 0; s < made.records.size(); ++s) EXPECT_EQ(read_all(file, s), made.records[s]) << s;
}

// Blocks are compressed: records that are all alike take much less than a byte each.
TEST(TraceFileTest, EqualRecordsTakeLittleRoom) {
  trace::TraceWriter writer(3);
  Record r;
  r.master = Master::kVpfe;
  r.write = true;
  r.bytes = 64;
  r.at = 2'000'000;
  writer.add(1, r);
  r.release = trace::Release::kAfter;
  r.back = 1;
  r.gap = 10;
  for (unsigned n = 1; n < 10'000; ++n) writer.add(1, r);
  std::string bytes;
  writer.finish(board_info(), [&](std::string_view piece) { bytes += piece; });
  EXPECT_LT(bytes.size(), 5'000u);
  trace::TraceFile file("t", std::move(bytes));
  unsigned records = 0;
  for (Record back; file.next(1, back);) ++records;
  EXPECT_EQ(records, 10'000u);
}

TEST(TraceFileTest, StreamsCanBeReadInAnyOrder) {
  const MadeTrace made = make_trace(2, 9'000);
  TraceFile file("t", made.bytes);
  Rng rng(3);
  std::vector<std::size_t> next(made.records.size());
  Record r;
  for (int i = 0; i < 20'000; ++i) {
    const auto s = static_cast<unsigned>(rng.below(made.records.size()));
    if (file.next(s, r)) {
      ASSERT_EQ(r, made.records[s][next[s]++]);
    }
  }
}

/// The message of the error that reading all of it gives; empty if there is none.
std::string error_of(const std::string& bytes) {
  try {
    TraceFile file("t", bytes);
    for (unsigned s = 0; s < file.info().streams.size(); ++s) read_all(file, s);
  } catch (const UserError& e) {
    return e.what();
  }
  return {};
}

TEST(TraceFileTest, EveryTruncationIsFound) {
  const MadeTrace made = make_trace(4, 100);
  ASSERT_EQ(error_of(made.bytes), "");
  for (std::size_t n = 0; n < made.bytes.size(); ++n)
    EXPECT_THAT(error_of(made.bytes.substr(0, n)), testing::StartsWith("bus trace 't': ")) << n;
}

TEST(TraceFileTest, EveryFlippedBitIsFound) {
  const MadeTrace made = make_trace(5, 60);
  std::string bytes = made.bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] = static_cast<char>(bytes[i] ^ 1 << bit);
      EXPECT_THAT(error_of(bytes), testing::StartsWith("bus trace 't': ")) << i << '.' << bit;
      bytes[i] = made.bytes[i];
    }
}

TEST(TraceFileTest, OtherVersionsAndFilesAreNamed) {
  std::string bytes = make_trace(6, 10).bytes;
  bytes[bytes.find('\n') - 1] = '6';
  EXPECT_THAT(error_of(bytes), testing::HasSubstr("allowed: versions 1 to 5"));
  EXPECT_THAT(error_of("PNG"), testing::HasSubstr("not a bus trace"));
  EXPECT_THAT(error_of(make_trace(6, 10).bytes + "x"), testing::HasSubstr("follows its end"));
}

// Version 1 knows no completions of others: each `when` is an interrupt.
TEST(TraceFileTest, VersionOneIsRead) {
  Record r;
  r.bytes = 4;
  r.release = trace::Release::kWhen;
  r.gap = 7;
  r.event = 2;
  r.wake_gap = 9;
  trace::CodeState out, in;
  std::string code;
  trace::encode(r, out, code);
  const std::string tail = {0, 7, 0, 4, 9};  // back, gap, the interrupts' number, event, gap
  ASSERT_TRUE(code.ends_with(tail));
  code.erase(code.size() - 3, 1);
  trace::ByteReader bytes({reinterpret_cast<const std::uint8_t*>(code.data()), code.size()});
  Record read;
  trace::decode(bytes, in, read, 1);
  EXPECT_TRUE(bytes.empty());
  EXPECT_EQ(read, r);
}

TEST(TraceFileTest, RecordsThatRefuteThemselvesAreFound) {
  const auto error_with = [](const Record& r, unsigned stream = 0) {
    trace::TraceWriter writer(3);
    writer.add(stream, r);
    std::string bytes;
    writer.finish(board_info(), [&](std::string_view piece) { bytes += piece; });
    return error_of(bytes);
  };
  Record good;
  good.bytes = 4;
  good.at = 2'000'000;
  EXPECT_EQ(error_with(good), "");
  Record r = good;
  r.release = trace::Release::kAfter;
  r.back = 1;
  EXPECT_THAT(error_with(r), testing::HasSubstr("before the first record"));
  r = good;
  r.release = trace::Release::kWhen;
  r.event = 3;
  EXPECT_THAT(error_with(r), testing::HasSubstr("event that never came"));
  r.source = 1;
  r.event = 0;  // stream 1 is empty
  EXPECT_THAT(error_with(r), testing::HasSubstr("event that never came"));
  r.source = 0;
  EXPECT_THAT(error_with(r), testing::HasSubstr("unknown stream")) << "itself";
  r.source = 3;
  EXPECT_THAT(error_with(r), testing::HasSubstr("unknown stream"));
  r = good;
  r.master = Master::kVpfe;
  EXPECT_THAT(error_with(r), testing::HasSubstr("another's stream"));
  r = good;
  r.at = board_info().end + 2 * kPsPerSecond;
  EXPECT_THAT(error_with(r), testing::HasSubstr("after its end"));
}

// `ddr.<other>.wait.read.refresh` would be two figures.
TEST(TraceFileTest, LabelsAreNoCausesOfWaiting) {
  for (const char* label : {"refresh", "own"}) {
    trace::TraceInfo info = board_info();
    info.masters.back().label = label;
    std::string bytes;
    trace::TraceWriter(3).finish(info, [&](std::string_view piece) { bytes += piece; });
    EXPECT_THAT(error_of(bytes), testing::HasSubstr("impossible description"));
  }
}

TEST(TraceFileTest, TheOrderOfStreamsDoesNotShow) {
  const auto written = [](bool swapped) {
    Rng rng(7);
    std::vector<Record> a, b;
    for (unsigned n = 0; n < 10'000; ++n) {
      a.push_back(random_record(rng, 1, n));
      b.push_back(random_record(rng, 2, n));
    }
    trace::TraceWriter writer(3);
    std::string bytes;
    for (unsigned pass = 0; pass < 2; ++pass)
      for (const Record& r : (pass == 0) != swapped ? a : b)
        writer.add((pass == 0) != swapped ? 1 : 2, r);
    writer.finish(board_info(), [&](std::string_view piece) { bytes += piece; });
    return bytes;
  };
  EXPECT_EQ(written(false), written(true));
}

}  // namespace
}  // namespace fovea::replay
