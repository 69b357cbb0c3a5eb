// Whose warnings are whose: references, scopes, threads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <thread>

#include "model/common/check.h"

namespace fovea {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using Kind = Diagnostics::Kind;

auto one(Kind kind, const char* text) { return ElementsAre(Pair(Pair(kind, text), 1u)); }

TEST(DiagnosticsRefTest, AnUnboundReferenceKeepsNothingAndNothingIsAnError) {
  const DiagnosticsRef unbound;
  unbound.guest("a");
  EXPECT_NO_THROW(unbound.not_modelled("b"));
  EXPECT_NO_THROW(unbound.configuration("c"));
  EXPECT_THAT(unbound.counts(), IsEmpty());
  EXPECT_THAT(DiagnosticsRef::current().counts(), IsEmpty()) << "there is no scope";
}

TEST(DiagnosticsRefTest, EachKindGoesToItsOwner) {
  Diagnostics d, other;
  const DiagnosticsRef ref = d;
  ref.guest("a");
  ref.not_modelled("b");
  ref.configuration("c");
  EXPECT_THAT(d.counts(), ElementsAre(Pair(Pair(Kind::kGuest, "a"), 1u), Pair(Pair(Kind::kNotModelled, "b"), 1u),
                                      Pair(Pair(Kind::kConfiguration, "c"), 1u)));
  EXPECT_EQ(ref.counts(), d.counts());
  EXPECT_THAT(other.counts(), IsEmpty());
}

TEST(DiagnosticsRefTest, StrictIsTheOwnersToo) {
  Diagnostics strict, lenient;
  strict.set_strict(true);
  EXPECT_THROW(DiagnosticsRef(strict).not_modelled("a"), NotModelled);
  EXPECT_THROW(DiagnosticsRef(strict).configuration("b"), UserError);
  EXPECT_NO_THROW(DiagnosticsRef(strict).guest("c"));
  EXPECT_NO_THROW(DiagnosticsRef(lenient).not_modelled("a"));
}

TEST(DiagnosticsScopeTest, TheInnermostOneIsCurrentAndWhatWasTakenStays) {
  Diagnostics outer, inner;
  std::optional<DiagnosticsScope> whole(outer);
  const DiagnosticsRef before = DiagnosticsRef::current();
  {
    const DiagnosticsScope part(inner);
    DiagnosticsRef::current().guest("inner");
    before.guest("outer");
  }
  EXPECT_THAT(inner.counts(), one(Kind::kGuest, "inner"));
  EXPECT_THAT(outer.counts(), one(Kind::kGuest, "outer"));
  DiagnosticsRef::current().guest("outer");
  EXPECT_EQ(outer.counts().begin()->second, 2u);
  whole.reset();
  DiagnosticsRef::current().guest("of no scope");
  EXPECT_EQ(outer.counts().size(), 1u);
}

TEST(DiagnosticsScopeTest, IsOfItsThread) {
  Diagnostics mine, theirs;
  const DiagnosticsScope scope(mine);
  std::thread([&] {
    DiagnosticsRef::current().guest("before");
    const DiagnosticsScope own(theirs);
    DiagnosticsRef::current().guest("theirs");
  }).join();
  DiagnosticsRef::current().guest("mine");
  EXPECT_THAT(mine.counts(), one(Kind::kGuest, "mine"));
  EXPECT_THAT(theirs.counts(), one(Kind::kGuest, "theirs"));
}

TEST(DiagnosticsScopeDeathTest, OutOfOrderIsADefect) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto cross = [] {
    Diagnostics d;
    std::optional<DiagnosticsScope> first(d), second;
    Diagnostics other;
    second.emplace(other);
    first.reset();
  };
  EXPECT_EXIT(cross(), testing::ExitedWithCode(4), "end out of their order");
}

}  // namespace
}  // namespace fovea
