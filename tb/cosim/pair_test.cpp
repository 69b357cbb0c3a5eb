// Two backends side by side: each kind of difference is planted and found, and what may differ is let pass.
#include "model/engine/rtl/pair_backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fovea::rtl {
namespace {

using engine::Answer;
using engine::Burst;
using engine::EngineBackend;
using testing::HasSubstr;

struct Script {
  std::uint32_t address;
  Picoseconds at;
  bool write = false;
  unsigned id = 0;
  unsigned bytes = 8;
  std::uint8_t fill = 0;
};

/// Asks for what its script has, at its times; quiet when all is answered.
class Fake : public EngineBackend {
 public:
  Fake(Host& host, std::vector<Script> script) : host_(host), script_(std::move(script)) {}
  Picoseconds run(Picoseconds now) override {
    while (next_ < script_.size() && script_[next_].at <= now) {
      const Script& s = script_[next_++];
      const std::vector<std::uint8_t> data(s.write ? s.bytes : 0, s.fill);
      ++open_;
      host_.issue({s.id, s.write, s.id, s.address, s.bytes, data}, s.at);
    }
    return next_ < script_.size() ? script_[next_].at : kNever;
  }
  std::uint32_t read(std::uint32_t offset, Picoseconds) override { return registers[offset]; }
  void write(std::uint32_t offset, std::uint32_t word, unsigned, Picoseconds) override { registers[offset] = word; }
  void answer(const Answer& a) override {
    --open_;
    answers.push_back({a.tag, a.write, a.error, {}, a.first, a.last});
    bytes.push_back({a.data.begin(), a.data.end()});
  }
  bool busy() const override { return open_ > 0 || next_ < script_.size(); }
  void reset() override {}
  void line(bool level) { host_.interrupt(level); }
  engine::JobPlace job() const override { return place; }

  engine::JobPlace place;  // of all requests

  std::map<std::uint32_t, std::uint32_t> registers;
  std::vector<Answer> answers;
  std::vector<std::vector<std::uint8_t>> bytes;

 private:
  Host& host_;
  const std::vector<Script> script_;
  std::size_t next_ = 0;
  int open_ = 0;
};

struct PairRig : EngineBackend::Host {
  PairRig(const std::vector<Script>& a, const std::vector<Script>& b)
      : pair(*this, clock,
             [&](Host& h) { return keep(owner, h, a); }, [&](Host& h) { return keep(twin, h, b); },
             [this](const std::string& text, Picoseconds) { differences.push_back(text); }) {}
  static std::unique_ptr<EngineBackend> keep(Fake*& where, Host& h, const std::vector<Script>& script) {
    auto made = std::make_unique<Fake>(h, script);
    where = made.get();
    return made;
  }
  void issue(const Burst& b, Picoseconds at) override {
    issued.push_back({b.tag, b.write, b.id, b.address, b.bytes, {}});
  }
  void interrupt(bool) override { ++interrupts; }
  void answer(std::size_t n, Picoseconds at, bool error = false) {
    const std::vector<std::uint8_t> data(issued[n].write ? 0 : issued[n].bytes, 7);
    pair.answer({issued[n].tag, issued[n].write, error, data, at, at});
    pair.run(at);
  }
  Clock clock{Frequency(1'000'000'000)};  // edges at multiples of 1000 ps
  Fake *owner = nullptr, *twin = nullptr;
  std::vector<Burst> issued;
  std::vector<std::string> differences;
  unsigned interrupts = 0;
  PairBackend pair;
};

TEST(PairTest, OnlyTheOwnerReachesTheHostAndTheTwinGetsACopyOfEachAnswer) {
  PairRig rig({{0x100, 1000}}, {{0x100, 2000}});
  EXPECT_EQ(rig.pair.run(1000), 2000u);
  rig.pair.run(2000);
  ASSERT_EQ(rig.issued.size(), 1u);
  rig.answer(0, 5000);
  ASSERT_EQ(rig.twin->answers.size(), 1u);
  EXPECT_EQ(rig.twin->answers[0].first, 5000u);
  EXPECT_EQ(rig.twin->bytes[0], rig.owner->bytes[0]);
  rig.owner->line(true);
  rig.twin->line(true);
  EXPECT_EQ(rig.interrupts, 1u);
  EXPECT_TRUE(rig.differences.empty());
  EXPECT_EQ(rig.pair.summary().requests, 1u);
  EXPECT_EQ(rig.pair.table(), "lag_clocks,requests\n1,1\n");
}

TEST(PairTest, ATwinThatIsLateGetsItsAnswerWhenItAsksAndOneThatIsEarlyWaits) {
  PairRig late({{0x100, 1000}}, {{0x100, 9000}});
  late.pair.run(1000);
  late.answer(0, 5000);
  EXPECT_TRUE(late.twin->answers.empty());
  late.pair.run(9000);
  ASSERT_EQ(late.twin->answers.size(), 1u);
  EXPECT_EQ(late.twin->answers[0].first, 9000u);
  PairRig early({{0x100, 3000}}, {{0x100, 1000}});
  early.pair.run(1000);
  EXPECT_TRUE(early.issued.empty());
  early.pair.run(3000);
  early.answer(0, 4000);
  EXPECT_EQ(early.twin->answers.size(), 1u);
  EXPECT_EQ(early.pair.table(), "lag_clocks,requests\n-2,1\n");
}

/// Runs both scripts; every request is answered 10 ns later.
std::vector<std::string> differences(const std::vector<Script>& a, const std::vector<Script>& b) {
  PairRig rig(a, b);
  for (Picoseconds t = 1000; t <= 20000; t += 1000) {
    rig.pair.run(t);
    while (rig.owner->answers.size() < rig.issued.size()) rig.answer(rig.owner->answers.size(), t);
  }
  return rig.differences;
}

TEST(PairTest, EachKindOfDifferenceIsFoundOnce) {
  const Script read{0x100, 1000}, other{0x108, 2000}, write{0x200, 1000, true, 0, 8, 1};
  EXPECT_TRUE(differences({read, other, write}, {write, read, other}).empty());
  EXPECT_THAT(differences({read}, {{0x110, 1000}}),
              testing::ElementsAre(HasSubstr("0x00000100, 8 bytes; its twin 0x00000110")));
  EXPECT_THAT(differences({read}, {{0x100, 1000, false, 0, 16}}), testing::ElementsAre(HasSubstr("16 bytes")));
  EXPECT_THAT(differences({read, other}, {other, read}), testing::ElementsAre(HasSubstr("reads of the map, number 0")));
  EXPECT_THAT(differences({write}, {{0x200, 1000, true, 0, 8, 2}}),
              testing::ElementsAre(HasSubstr("writes, number 0: byte 0x00000200 is 0x01; its twin's 0x02")));
  EXPECT_THAT(differences({read, other}, {read}), testing::ElementsAre(HasSubstr("1 that the twin did not ask for")));
  EXPECT_THAT(differences({read}, {read, other}), testing::ElementsAre(HasSubstr("1 that only the twin asked for")));
  EXPECT_THAT(differences({read}, {{0x100, 1000, false, 1}}),
              testing::ElementsAre(HasSubstr("reads of the source, 1 that only the twin")));
}

// Pictures of 20 words a row: the result's at 0x200, the source's at 0x1000; the map's at 0x4000.
TEST(PairTest, ADifferenceHasTimeJobAndPlace) {
  const auto said = [](const Script& a, const Script& b, bool owner_knows) {
    PairRig rig({a}, {b});
    (owner_knows ? rig.owner : rig.twin)->place = {3, 0x5A, 0x400, 20, 0x80, 20, 0x4000};
    rig.pair.run(7'500'000);
    return rig.differences.empty() ? "" : rig.differences[0];
  };
  const Script write{0x200 + 2 * 80 + 16, 7'000'000, true, 0, 8, 1}, wrong{write.address, write.at, true, 0, 8, 2};
  for (const bool owner : {true, false})
    EXPECT_EQ(said(write, wrong, owner),
              "remap engine: RTL and model differ: writes, number 0: byte 0x000002b0 is 0x01; its twin's 0x02, job 3 "
              "(tag 0x5a), pixel (8, 2) of the result; at 0.007000 ms");
  EXPECT_THAT(said({0x1000 + 80 + 32, 1000, false, 1, 32}, {0x2000, 1000, false, 1, 32}, false),
              HasSubstr("job 3 (tag 0x5a), pixel (16, 1) of the source; at"));
  EXPECT_THAT(said({0x4040, 1000, false, 0, 64}, {0x4080, 1000, false, 0, 64}, true),
              HasSubstr("job 3 (tag 0x5a), word 16 of the map; at"));
}

TEST(PairTest, ARegisterThatDoesNotDependOnTimeIsCompared) {
  PairRig rig({}, {});
  rig.pair.write(0x40, 5, 15, 1000);
  EXPECT_EQ(rig.twin->registers[0x40], 5u);
  rig.twin->registers[0x20] = 9;  // clocks
  EXPECT_EQ(rig.pair.read(0x20, 2000), 0u);
  EXPECT_TRUE(rig.differences.empty());
  rig.twin->registers[0x40] = 6;
  rig.pair.read(0x40, 3000);
  EXPECT_THAT(rig.differences,
              testing::ElementsAre(HasSubstr("register 0x40 reads 0x00000005; its twin's 0x00000006")));
}

TEST(PairTest, BehindAnErrorOrAnAbortNothingIsComparedUntilBothAreQuiet) {
  for (const bool error : {true, false}) {
    PairRig rig({{0x100, 1000}, {0x900, 9000}}, {{0x100, 1000}, {0x108, 2000}, {0x900, 9000}});
    rig.pair.run(1000);
    if (!error) rig.pair.write(0x04, 3, 15, 1000);
    rig.answer(0, 1500, error);
    rig.pair.run(2000);
    // The twin's own request is answered with zeros.
    ASSERT_EQ(rig.twin->answers.size(), 2u);
    EXPECT_EQ(rig.twin->answers[0].error, error);
    EXPECT_THAT(rig.twin->bytes[1], testing::Each(0));
    rig.pair.run(9000);
    rig.answer(1, 10000);
    EXPECT_TRUE(rig.differences.empty());
    EXPECT_FALSE(rig.pair.busy());
    EXPECT_GE(rig.pair.summary().skipped, 1u);
  }
}

// The next job begins before all of the failed one is answered: its requests do not get the old answers.
TEST(PairTest, AnswersThatComeBehindAnErrorAreNotThoseOfTheNextJob) {
  const std::vector<Script> both = {
      {0x100, 1000}, {0x140, 1000, false, 0, 64}, {0x200, 9000, false, 0, 24}, {0x300, 12000, false, 0, 16}};
  PairRig rig(both, both);
  rig.pair.run(1000);
  rig.answer(0, 1500, true);
  rig.pair.run(9000);
  rig.answer(1, 9500);
  rig.pair.run(12000);
  ASSERT_EQ(rig.twin->bytes.size(), 4u);
  for (std::size_t n = 0; n < both.size(); ++n) EXPECT_EQ(rig.twin->bytes[n].size(), both[n].bytes) << n;
}

}  // namespace
}  // namespace fovea::rtl
