// Each rule of the checkers is broken once.
#include "model/engine/rtl/slave_checker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fovea::rtl {
namespace {

template <class Checker, class Wires>
void expect_complaint(const std::vector<Wires>& clocks, const char* text) {
  Checker checker;
  for (std::size_t n = 0; n + 1 < clocks.size(); ++n) ASSERT_NO_THROW(checker.clock(clocks[n])) << text;
  try {
    checker.clock(clocks.back());
    ADD_FAILURE() << "no complaint of: " << text;
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr(text));
  }
}

AxiWires read_of(unsigned id, unsigned beats) {
  AxiWires w;
  w.ar = {true, true, id, 0, beats - 1};
  return w;
}
AxiWires beat(unsigned id, bool last, bool ready = true, std::uint64_t data = 0, unsigned response = 0) {
  AxiWires w;
  w.r = {true, ready, id, data, response, last};
  return w;
}
AxiWires write_request() {
  AxiWires w;
  w.aw = {true, true, 0, 0, 0};
  return w;
}
AxiWires write_data(bool last) {
  AxiWires w;
  w.w = {true, true, last, 0, 255};
  return w;
}
AxiWires write_answer(bool ready = true, unsigned response = 0) {
  AxiWires w;
  w.b = {true, ready, response};
  return w;
}

TEST(AxiAnswerCheckerTest, ComplainsOfEachRule) {
  const auto bad = [](const std::vector<AxiWires>& clocks, const char* text) {
    expect_complaint<AxiAnswerChecker>(clocks, text);
  };
  bad({read_of(0, 1), beat(0, true, false), AxiWires{}}, "RVALID taken back");
  bad({read_of(0, 1), beat(0, true, false), beat(0, true, true, 1)}, "R changed");
  bad({read_of(0, 1), beat(0, true, false), beat(0, true, true, 0, 2)}, "R changed");
  bad({read_of(0, 1), read_of(1, 1), beat(0, true, false), beat(1, true)}, "R changed");
  bad({beat(0, true)}, "nobody asked for");
  bad({read_of(1, 1), beat(0, true)}, "nobody asked for");
  bad({read_of(0, 1), beat(0, true), beat(0, true)}, "nobody asked for");
  bad({read_of(0, 1), beat(2, true)}, "no identifier");
  bad({read_of(0, 2), beat(0, true)}, "RLAST");
  bad({read_of(0, 2), beat(0, false), beat(0, false)}, "RLAST");
  bad({write_data(true), write_answer()}, "before its request");
  bad({write_request(), write_data(false), write_answer()}, "before its request and its last data");
  bad({write_request(), write_data(true), write_answer(false), AxiWires{}}, "BVALID taken back");
  bad({write_request(), write_data(true), write_answer(false), write_answer(true, 2)}, "B changed");
}

TEST(AxiAnswerCheckerTest, AcceptsWhatIsAllowed) {
  AxiAnswerChecker checker;
  for (const AxiWires& w : {read_of(0, 2), read_of(1, 1), beat(0, false), beat(1, true), beat(0, true, false),
                            beat(0, true), write_data(true), write_request()})
    checker.clock(w);
  EXPECT_FALSE(checker.quiet());
  checker.clock(write_answer());
  EXPECT_TRUE(checker.quiet());
}

LiteWires address(bool write, bool ready, std::uint32_t at = 0) {
  LiteWires w;
  (write ? w.aw : w.ar) = {true, ready, at};
  return w;
}
LiteWires data(bool ready, std::uint32_t word = 0, unsigned strobes = 15) {
  LiteWires w;
  w.w = {true, ready, word, strobes, 0};
  return w;
}
LiteWires answer(bool write, bool ready = true, unsigned response = 0, std::uint32_t word = 0) {
  LiteWires w;
  if (write) w.b = {true, ready, response};
  else w.r = {true, ready, word, 0, response};
  return w;
}

TEST(RegisterPortCheckerTest, ComplainsOfEachRule) {
  const auto bad = [](const std::vector<LiteWires>& clocks, const char* text) {
    expect_complaint<RegisterPortChecker>(clocks, text);
  };
  bad({address(true, false), LiteWires{}}, "AWVALID taken back");
  bad({address(true, false), address(true, false, 4)}, "AW changed");
  bad({address(false, false), LiteWires{}}, "ARVALID taken back");
  bad({address(false, false), address(false, true, 4)}, "AR changed");
  bad({data(false), LiteWires{}}, "WVALID taken back");
  bad({data(false), data(false, 1)}, "W changed");
  bad({data(false), data(false, 0, 1)}, "W changed");
  bad({address(false, true), answer(false, false), LiteWires{}}, "RVALID taken back");
  bad({address(false, true), answer(false, false), answer(false, true, 0, 1)}, "R changed");
  bad({address(true, true), data(true), answer(true, false), LiteWires{}}, "BVALID taken back");
  bad({address(true, true), data(true), answer(true, false), answer(true, true, 2)}, "B changed");
  bad({address(false, true, 2)}, "not that of a word");
  bad({address(true, true, 1)}, "not that of a word");
  bad({answer(false)}, "nobody asked for");
  bad({address(true, true), answer(true)}, "before its address and its data");
  bad({data(true), answer(true)}, "before its address and its data");
  bad({address(false, true), answer(false, true, 1)}, "EXOKAY");
  bad({address(true, true), data(true), answer(true, true, 1)}, "EXOKAY");
}

}  // namespace
}  // namespace fovea::rtl
