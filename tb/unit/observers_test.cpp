// Lists of observers.
#include "model/common/observers.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace fovea {
namespace {

using List = Observers<std::function<void()>>;

void call(List& list) {
  list.each([](std::function<void()>& f) { f(); });
}

struct ObserversTest : testing::Test {
  List list;
  std::string calls;
  std::function<void()> note(char c) {
    return [this, c] { calls += c; };
  }
};

TEST_F(ObserversTest, AllAreCalledInTheOrderInWhichTheyWereAdded) {
  EXPECT_TRUE(list.empty());
  const Subscription a = list.add(note('a')), b = list.add(note('b')), c = list.add(note('c'));
  EXPECT_FALSE(list.empty());
  call(list);
  call(list);
  EXPECT_EQ(calls, "abcabc");
}

TEST_F(ObserversTest, TheSubscriptionTakesItsOwnEntryOut) {
  Subscription a = list.add(note('a'));
  {
    const Subscription b = list.add(note('b'));
    const Subscription c = list.add(note('c'));
  }
  call(list);
  EXPECT_EQ(calls, "a");
  a.reset();
  EXPECT_FALSE(a);
  EXPECT_TRUE(list.empty());
  call(list);
  EXPECT_EQ(calls, "a");
}

TEST_F(ObserversTest, AMovedSubscriptionKeepsTheEntryAndAnAssignedOneReleasesItsOld) {
  Subscription a = list.add(note('a'));
  Subscription moved = std::move(a);
  a.reset();
  call(list);
  EXPECT_EQ(calls, "a");
  moved = list.add(note('b'));
  call(list);
  EXPECT_EQ(calls, "ab");
}

TEST(ObserversChangeTest, TheFirstAndTheLastOneChangeWhetherThereIsAnObserver) {
  std::string changes;
  Observers<int*> list{[&] { changes += list.empty() ? '-' : '+'; }};
  int x = 0;
  EXPECT_TRUE(list.empty());
  Subscription a = list.add(&x), b = list.add(&x);
  EXPECT_FALSE(list.empty());
  EXPECT_EQ(changes, "+");
  a.reset();
  EXPECT_FALSE(list.empty()) << "the end of one is not the end of both";
  EXPECT_EQ(changes, "+");
  b.reset();
  EXPECT_TRUE(list.empty());
  EXPECT_EQ(changes, "+-");
  b = list.add(&x);
  EXPECT_EQ(changes, "+-+");
}

TEST_F(ObserversTest, AnObserverMayRemoveItselfAndOthersWhileItIsCalled) {
  Subscription a, b, c;
  a = list.add([&] {
    calls += 'a';
    a.reset();
    b.reset();
  });
  b = list.add(note('b'));
  c = list.add(note('c'));
  call(list);
  EXPECT_EQ(calls, "ac");
  call(list);
  EXPECT_EQ(calls, "acc");
}

TEST_F(ObserversTest, OneThatIsAddedDuringARoundIsCalledInTheNextOne) {
  std::vector<Subscription> added;
  const Subscription a = list.add([&] {
    calls += 'a';
    added.push_back(list.add(note('+')));
  });
  call(list);
  EXPECT_EQ(calls, "a");
  call(list);
  EXPECT_EQ(calls, "aa+");
}

TEST_F(ObserversTest, TheFirstThatAnswersEndsTheRound) {
  Observers<std::function<bool(int)>> handlers;
  const auto a = handlers.add([&](int n) { return calls += 'a', n == 1; });
  const auto b = handlers.add([&](int n) { return calls += 'b', n == 2; });
  const auto ask = [&](int n) {
    return handlers.any([n](std::function<bool(int)>& f) { return f(n); });
  };
  EXPECT_TRUE(ask(1));
  EXPECT_EQ(calls, "a");
  EXPECT_TRUE(ask(2));
  EXPECT_EQ(calls, "aab");
  EXPECT_FALSE(ask(3));
}

TEST(ObserversLifetimeTest, ASubscriptionMayOutliveTheListAndTheListMayEndDuringACall) {
  auto list = std::make_unique<List>();
  Subscription a = list->add([&] { list.reset(); });
  bool called = false;
  const Subscription b = list->add([&] { called = true; });
  List& still = *list;
  call(still);
  EXPECT_EQ(list, nullptr);
  EXPECT_TRUE(called);
  a.reset();
}

}  // namespace
}  // namespace fovea
