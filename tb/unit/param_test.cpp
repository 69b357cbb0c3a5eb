// model/common/param.h: units, ranges, suggestions.
#include "model/common/param.h"

#include "tb/unit/support.h"

namespace fovea {
namespace {

using test::user_error;
using testing::AllOf;
using testing::HasSubstr;

struct Params : ParamGroup {
  Params() : ParamGroup("block") {}
  IntParam time{*this,  "time",   IntParam::Unit::kTime, 15'000,    5'000,
                60'000, "a time", Origin::kSourced,      "[X] p. 1"};
  IntParam size{*this,
                "size",
                IntParam::Unit::kBytes,
                16 << 10,
                1 << 10,
                1 << 20,
                "a size",
                Origin::kAssumed,
                "",
                {"8KiB", "32KiB", "between its sisters"}};
  IntParam clock{*this,         "clock",   IntParam::Unit::kHertz, 297'000'000, 1,
                 1'000'000'000, "a clock", Origin::kChoice,        ""};
  IntParam cycles{
      *this,           "cycles",        IntParam::Unit::kCycles,       4, 0, 100, "cycles",
      Origin::kFamily, "a sister chip", {"4cycles", "4cycles", "same"}};
  IntParam count{*this, "count", IntParam::Unit::kCount, 3, 0, 10, "a count", Origin::kChoice, ""};
  RealParam angle{*this, "angle", "deg", 180, 1, 220, "an angle", Origin::kChoice, ""};
  ListParam list{*this, "list", {1, 2}, {2, 3}, "a list", Origin::kChoice, ""};
  BoolParam flag{*this, "flag", false, "a flag", Origin::kChoice, ""};
  EnumParam mode{*this, "mode", "none", {"none", "tlm", "rtl"}, "a word", Origin::kChoice, ""};
  TextParam file{*this, "file", "", "a name"};
};

class ParamTest : public testing::Test {
 protected:
  ParamTest() { set.add(params); }
  Params params;
  ParamSet set;
};

// Of a key's last part a third of the letters may be wrong, and two of a short one; other parts that are right do not
// count.
TEST_F(ParamTest, TheNearestKeyIsTheOneWithTheFewestChanges) {
  struct Group : ParamGroup {
    Group() : ParamGroup("bridge") {}
    IntParam a{*this, "abcdefghi", IntParam::Unit::kCount, 3, 0, 10, "a", Origin::kChoice, ""};
    IntParam b{*this, "vwxyz", IntParam::Unit::kCount, 3, 0, 10, "b", Origin::kChoice, ""};
  } group;
  set.add(group);
  EXPECT_EQ(set.nearest("bridge.abcdefXYZ"), "bridge.abcdefghi");
  EXPECT_EQ(set.nearest("bridge.abcdeWXYZ"), "");
  EXPECT_EQ(set.nearest("bridge.vwxAB"), "bridge.vwxyz");
  EXPECT_EQ(set.nearest("bridge.vwABC"), "");
  EXPECT_EQ(set.nearest("bridg.vwxyz"), "bridge.vwxyz");
}

TEST_F(ParamTest, TimeIsKeptInPicoseconds) {
  set.set("block.time", "12.5ns");
  EXPECT_EQ(params.time(), 12'500u);
  set.set("block.time", "12500 ps");
  EXPECT_EQ(params.time(), 12'500u);
  set.set("block.time", "0.02us");
  EXPECT_EQ(params.time(), 20'000u);
}

TEST_F(ParamTest, ARealNumberReachesItsLimits) {
  set.set("block.angle", "1deg");
  EXPECT_EQ(params.angle(), 1);
  set.set("block.angle", "220deg");
  EXPECT_EQ(params.angle(), 220);
  EXPECT_THROW(set.set("block.angle", "0.999deg"), UserError);
  EXPECT_THROW(set.set("block.angle", "220.001deg"), UserError);
  EXPECT_EQ(params.angle(), 220);
}

TEST_F(ParamTest, WholeNumbersAreExactUpToTheLargest) {
  IntParam largest{params, "largest", IntParam::Unit::kCount, 0, 0, ~0ull, "a number", Origin::kChoice, ""};
  largest.set("9007199254740993");  // 2^53 + 1, no double
  EXPECT_EQ(largest(), 9'007'199'254'740'993u);
  largest.set("18446744073709551615");
  EXPECT_EQ(largest(), ~0ull);
  EXPECT_THROW(largest.set("18446744073709551616"), UserError);
  EXPECT_EQ(largest(), ~0ull);
}

TEST_F(ParamTest, SpaceAroundAValueIsNotPartOfIt) {
  for (const char* text : {" 12.5 ns", "12.5ns ", "\t12.5\tns\t", "  12.5  ns  "}) {
    set.set("block.time", "20ns");
    set.set("block.time", text);
    EXPECT_EQ(params.time(), 12'500u) << text;
  }
  set.set("block.list", " [ 10 ,\t23 ] ");
  EXPECT_EQ(params.list(), (std::vector<double>{10, 23}));
  set.set("block.list", "[10,20,34]");
  EXPECT_EQ(params.list(), (std::vector<double>{10, 20, 34}));
}

/// An exponent belongs to the number, a unit that begins with e does not exist.
TEST_F(ParamTest, ExponentsNeedADigitOnBothSides) {
  set.set("block.time", "1.25e1ns");
  EXPECT_EQ(params.time(), 12'500u);
  set.set("block.time", "2E+1ns");
  EXPECT_EQ(params.time(), 20'000u);
  set.set("block.time", "20000e-3ns");
  EXPECT_EQ(params.time(), 20'000u);
  for (const char* text : {"e1ns", "1ens", "1e", "e"}) EXPECT_THROW(set.set("block.time", text), UserError) << text;
}

TEST_F(ParamTest, SizesAreBinaryAndClocksDecimal) {
  set.set("block.size", "4KiB");
  EXPECT_EQ(params.size(), 4096u);
  set.set("block.clock", "243MHz");
  EXPECT_EQ(params.clock(), 243'000'000u);
  EXPECT_THAT(user_error([&] { set.set("block.size", "4KB"); }), HasSubstr("KiB"));
}

TEST_F(ParamTest, MissingUnitIsRefused) {
  EXPECT_THAT(user_error([&] { set.set("block.time", "12"); }),
              AllOf(HasSubstr("block.time"), HasSubstr("'12'"), HasSubstr("5ns"), HasSubstr("60ns"),
                    HasSubstr("unit")));
  EXPECT_THAT(user_error([&] { set.set("block.cycles", "12"); }), HasSubstr("cycles"));
  EXPECT_THAT(user_error([&] { set.set("block.angle", "90"); }), HasSubstr("deg"));
  // An exponent alone is no number that lacks its unit.
  EXPECT_THAT(user_error([&] { set.set("block.time", "12"); }), HasSubstr("lacks its unit"));
  EXPECT_THAT(user_error([&] { set.set("block.time", "e5"); }), testing::Not(HasSubstr("lacks its unit")));
}

TEST_F(ParamTest, RangeIsTightAtBothEnds) {
  for (const char* good : {"5ns", "60ns"}) EXPECT_NO_THROW(set.set("block.time", good)) << good;
  for (const char* bad : {"4999ps", "60001ps", "-5ns", "nan", "infns", "1e99s", ""})
    EXPECT_THROW(set.set("block.time", bad), UserError) << bad;
  EXPECT_EQ(params.time(), 60'000u) << "a refused value changes nothing";
}

TEST_F(ParamTest, FractionOfSmallestUnitIsRefusedNotRounded) {
  EXPECT_THROW(set.set("block.time", "5000.5ps"), UserError);
  EXPECT_THROW(set.set("block.count", "2.5"), UserError);
}

TEST_F(ParamTest, ValueTextReadsBackAsTheSameValue) {
  const auto check = [&](const char* key, const char* text) {
    set.set(key, text);
    const std::string printed = set.find(key)->text();
    set.set(key, printed);
    EXPECT_EQ(set.find(key)->text(), printed) << key;
    return printed;
  };
  EXPECT_EQ(check("block.time", "12.5ns"), "12500ps");
  EXPECT_EQ(check("block.size", "64KiB"), "64KiB");
  EXPECT_EQ(check("block.cycles", "0 cycles"), "0 cycles");
  EXPECT_EQ(check("block.angle", "0.1e2deg"), "10deg");
  EXPECT_EQ(check("block.list", "[1.5, -2, 3e-3]"), "[1.5, -2, 0.003]");
  EXPECT_EQ(check("block.clock", "13500kHz"), "13500kHz");
}

TEST_F(ParamTest, ListChecksItsCount) {
  set.set("block.list", "[3, 4, 5]");
  EXPECT_EQ(params.list(), (std::vector<double>{3, 4, 5}));
  for (const char* bad : {"[1]", "[1,2,3,4]", "1, 2", "[1, x]", "[]", "["})
    EXPECT_THAT(user_error([&] { set.set("block.list", bad); }), HasSubstr("2 or 3")) << bad;
}

TEST_F(ParamTest, WordsAndFlagsNameWhatIsAllowed) {
  EXPECT_THAT(user_error([&] { set.set("block.mode", "tml"); }), HasSubstr("none, tlm, rtl"));
  EXPECT_THAT(user_error([&] { set.set("block.flag", "yes"); }), HasSubstr("true, false"));
  set.set("block.mode", "rtl");
  EXPECT_EQ(params.mode.index(), 2u);
}

TEST_F(ParamTest, UnknownKeySuggestsTheNearest) {
  EXPECT_THAT(user_error([&] { set.set("block.anlge", "90deg"); }),
              HasSubstr("did you mean 'block.angle'?"));
  EXPECT_THAT(user_error([&] { set.set("zzzzzzzzzzzzzzzz", "1"); }), HasSubstr("fovea params"));
  EXPECT_THAT(user_error([&] { set.set("block.x", "1"); }), testing::Not(HasSubstr("did you mean")))
      << "nothing is near a single letter";
}

TEST_F(ParamTest, AWordOfKeysSuggestsThem) {
  EXPECT_EQ(user_error([&] { set.set("clock", "1MHz"); }), "unknown key 'clock'; did you mean 'block.clock'?");
  EXPECT_EQ(user_error([&] { set.set("angl", "1"); }), "unknown key 'angl'; did you mean 'block.angle'?");
  EXPECT_THAT(user_error([&] { set.set("lock", "1"); }), testing::Not(HasSubstr("did you mean"))) << "within a word";
  EXPECT_THAT(user_error([&] { set.set("cl", "1"); }), testing::Not(HasSubstr("did you mean"))) << "two letters";
}

TEST_F(ParamTest, ASuggestionIsNearInWhatDiffers) {
  // Three letters of five differ: 'block.' in common does not make 'block.clock' near.
  EXPECT_THAT(user_error([&] { set.set("block.checks", "1"); }),
              testing::Not(HasSubstr("did you mean")));
  EXPECT_THAT(user_error([&] { set.set("block.clok", "1MHz"); }), HasSubstr("'block.clock'?"));
  EXPECT_THAT(user_error([&] { set.set("blok.clok", "1MHz"); }), HasSubstr("'block.clock'?"));
}

TEST_F(ParamTest, AKeyOfAnotherCommandSaysSo) {
  set.add_foreign("block.crystal", "is a key of 'fovea replay'; here: block.clock");
  EXPECT_EQ(user_error([&] { set.set("block.crystal", "1MHz"); }),
            "key 'block.crystal' is a key of 'fovea replay'; here: block.clock");
  EXPECT_EQ(user_error([&] { set.set("block.cristal", "1MHz"); }),
            "unknown key 'block.cristal'; did you mean 'block.crystal'? It is a key of 'fovea "
            "replay'; here: block.clock");
}

TEST_F(ParamTest, RemembersWhetherTheUserSetIt) {
  EXPECT_FALSE(params.count.user_set());
  set.set("block.count", "3");
  EXPECT_TRUE(params.count.user_set());
}

// A part of a key is known to belong to some, of which the shortest three are named; those of numbered copies are not.
TEST(ParamHintTest, APartOfAKeyNamesTheKeysThatHaveIt) {
  struct Group : ParamGroup {
    explicit Group(const char* prefix) : ParamGroup(prefix) {}
    IntParam a{*this, "kernel", IntParam::Unit::kCount, 3, 0, 10, "a", Origin::kChoice, ""};
  };
  ParamSet set;
  const auto error = [&](const char* key) {
    try {
      set.set(key, "1");
    } catch (const UserError& e) {
      return std::string(e.what());
    }
    return std::string("taken");
  };
  Group numbered("load.1"), other_number("camera.0"), first("firmware"), second("cpu"), third("engine"),
      last("replays"), digits("v2");
  set.add(numbered);
  EXPECT_EQ(error("kernel"), "unknown key 'kernel'; 'fovea params' lists all keys");
  set.add(other_number);
  EXPECT_EQ(error("kernel"), "unknown key 'kernel'; 'fovea params' lists all keys");
  set.add(first);
  EXPECT_EQ(error("kernel"), "unknown key 'kernel'; did you mean 'firmware.kernel'?");
  EXPECT_EQ(error("firmware"), "unknown key 'firmware'; did you mean 'firmware.kernel'?");
  EXPECT_EQ(error("ke"), "unknown key 'ke'; 'fovea params' lists all keys");
  set.add(second);
  EXPECT_EQ(error("kernel"), "unknown key 'kernel'; did you mean 'cpu.kernel' or 'firmware.kernel'?");
  set.add(third);
  set.add(last);
  EXPECT_EQ(error("kernel"),
            "unknown key 'kernel'; did you mean 'cpu.kernel', 'engine.kernel' or 'replays.kernel'?");
  set.add(digits);
  EXPECT_EQ(error("kernel"), "unknown key 'kernel'; did you mean 'v2.kernel', 'cpu.kernel' or 'engine.kernel'?");
}

TEST(ParamDeathTest, DeclaringAKeyTwiceIsADefect) {
  Params a, b;
  ParamSet set;
  set.add(a);
  EXPECT_EXIT(set.add(b), testing::ExitedWithCode(4), "declared twice");
}

TEST(ParamDeathTest, DefaultOutOfItsRangeIsADefect) {
  ParamGroup group("g");
  EXPECT_EXIT(IntParam(group, "p", IntParam::Unit::kCount, 11, 0, 10, "", Origin::kChoice, ""),
              testing::ExitedWithCode(4), "out of its own range");
}

/// A parameter of 5 out of 1 .. 10 with the given origin and belief interval.
void declare(Origin origin, Belief belief) {
  ParamGroup group("g");
  IntParam(group, "p", IntParam::Unit::kCount, 5, 1, 10, "", origin, "", std::move(belief));
}

TEST(BeliefTest, IntervalIsKeptAndLeavesTheValueAlone) {
  const Params params;
  EXPECT_EQ(params.size.belief().low, "8KiB");
  EXPECT_EQ(params.size.belief().high, "32KiB");
  EXPECT_EQ(params.size.belief().reason, "between its sisters");
  EXPECT_EQ(params.size(), 16u << 10);
  EXPECT_FALSE(params.size.user_set());
  EXPECT_TRUE(params.time.belief().empty());
}

TEST(BeliefTest, EndsMayTouchTheDefaultAndTheLimits) {
  declare(Origin::kAssumed, {"5", "5", "known well"});
  declare(Origin::kFamily, {"1", "10", "anything"});
  ParamGroup group("g");
  BoolParam(group, "b", true, "", Origin::kAssumed, "", {"false", "true", "either"});
  EnumParam(group, "e", "mid", {"low", "mid", "top"}, "", Origin::kAssumed, "",
            {"mid", "top", "not the least"});
  RealParam(group, "r", "deg", 1.5, 0, 3, "", Origin::kAssumed, "", {"1.5deg", "2deg", "seen"});
}

TEST(BeliefDeathTest, AssumedAndFamilyFiguresNeedOneAndNoOtherMayHaveOne) {
  for (const Origin origin : {Origin::kAssumed, Origin::kFamily})
    EXPECT_EXIT(declare(origin, {}), testing::ExitedWithCode(4), "g.p.* need a belief interval");
  for (const Origin origin : {Origin::kSourced, Origin::kCalibrated, Origin::kChoice})
    EXPECT_EXIT(declare(origin, {"5", "6", "why"}), testing::ExitedWithCode(4),
                "g.p: only assumed and family");
}

TEST(BeliefDeathTest, WrongIntervalsAreDefects) {
  const auto expect = [](Belief belief, const char* text) {
    EXPECT_EXIT(declare(Origin::kAssumed, belief), testing::ExitedWithCode(4), text);
  };
  expect({"4", "6", ""}, "no reason");
  expect({"6", "7", "why"}, "default lies outside");
  expect({"3", "4", "why"}, "default lies outside");
  expect({"6", "4", "why"}, "default lies outside");
  expect({"0", "6", "why"}, "'0' is not allowed");
  expect({"4", "11", "why"}, "'11' is not allowed");
  expect({"4", "", "why"}, "'' is not allowed");
  ParamGroup group("g");
  EXPECT_EXIT(EnumParam(group, "e", "low", {"low", "mid", "top"}, "", Origin::kAssumed, "",
                        {"mid", "top", "why"}),
              testing::ExitedWithCode(4), "default lies outside");
}

}  // namespace
}  // namespace fovea
