// Time division: whose turn it is, and what is said of a camera.
#include <gtest/gtest.h>

#include <string>
#include <vector>

extern "C" {
#include "sw/firmware/app/turns.h"
}

namespace {

constexpr signal_state_t kReady{1, 1, 0, 1}, kNoLock{1, 0, 0, 0}, kNothing{0, 0, 0, 0}, kOther{1, 1, 0, 0};

struct Turns : turns_t {
  explicit Turns(uint32_t cameras) { turns_init(this, cameras); }
  std::vector<std::string> said() {
    std::vector<std::string> out;
    uint32_t camera;
    camera_event_t event;
    while (turns_event(this, &camera, &event))
      out.push_back(std::to_string(camera) + " " + camera_event_text(event));
    return out;
  }
};
using Lines = std::vector<std::string>;

TEST(TurnsTest, CamerasTakeTurnsAfterEachFrame) {
  Turns t(3);
  EXPECT_EQ(t.now, 0u);
  for (const uint32_t next : {1u, 2u, 0u, 1u}) EXPECT_EQ(turns_captured(&t), next);
  EXPECT_EQ(t.said(), Lines{});
  Turns one(1);
  EXPECT_EQ(turns_captured(&one), 0u);
}

TEST(TurnsTest, ALockIsWaitedForUpToTheLimit) {
  Turns t(2);
  for (unsigned n = 1; n < TURNS_LOCK_FRAMES; ++n) EXPECT_EQ(turns_not_ready(&t, &kNoLock), 0u) << n;
  EXPECT_EQ(t.said(), Lines{});
  EXPECT_EQ(turns_not_ready(&t, &kNoLock), 1u);
  EXPECT_EQ(t.said(), Lines{"0 no lock"});
}

TEST(TurnsTest, WithoutASignalTheNextCameraHasItsTurnAtOnceAndTheLostOneIsAskedAgain) {
  Turns t(2);
  EXPECT_EQ(turns_captured(&t), 1u);
  EXPECT_EQ(turns_not_ready(&t, &kNothing), 0u);
  EXPECT_EQ(t.said(), Lines{"1 no signal"});
  for (unsigned n = 1; n < TURNS_REST_FRAMES; ++n) EXPECT_EQ(turns_captured(&t), 0u) << n;
  EXPECT_EQ(turns_captured(&t), 1u) << "after as many frame boundaries as it rests";
  EXPECT_EQ(turns_not_ready(&t, &kNothing), 0u);
  EXPECT_EQ(t.said(), Lines{}) << "said once";
  for (unsigned n = 0; n < TURNS_REST_FRAMES; ++n) turns_captured(&t);
  EXPECT_EQ(t.now, 1u);
  EXPECT_EQ(turns_captured(&t), 0u);
  EXPECT_EQ(t.said(), Lines{"1 frames again"});
}

TEST(TurnsTest, WhileAllRestEachIsAskedInTurn) {
  Turns t(2);
  for (const uint32_t next : {1u, 0u, 1u, 0u}) EXPECT_EQ(turns_not_ready(&t, &kNothing), next);
}

TEST(TurnsTest, EachFaultIsNamed) {
  Turns t(2);
  turns_not_ready(&t, &kOther);
  turns_no_frames(&t, &kReady);
  turns_torn(&t);
  turns_torn(&t);
  turns_no_frames(&t, &kOther);
  EXPECT_EQ(t.said(), (Lines{"0 wrong standard", "1 no frames", "0 lock lost, a frame is left out",
                             "0 lock lost, a frame is left out", "0 wrong standard"}));
}

TEST(TurnsTest, FramesThatLackPartsAreSaidOfTheirCameraUntilManyAreWhole) {
  Turns t(2);
  turns_captured(&t);
  turns_overflow(&t, 0);
  turns_overflow(&t, 0);
  EXPECT_EQ(t.said(), Lines{"0 overflow, frames are left out"});
  EXPECT_EQ(t.now, 1u) << "whose turn it is does not change";
  for (unsigned n = 1; n < TURNS_REGULAR_FRAMES; ++n) {
    turns_captured(&t);
    turns_captured(&t);
  }
  EXPECT_EQ(t.said(), Lines{});
  turns_captured(&t);
  EXPECT_EQ(t.said(), Lines{}) << "that was camera 1";
  turns_captured(&t);
  EXPECT_EQ(t.said(), Lines{"0 frames again"});
}

TEST(TurnsTest, AFieldThatWasTooShortIsSaidOfItsCameraAfterItsTurn) {
  Turns t(2);
  turns_captured(&t);
  turns_short(&t, 0);
  turns_short(&t, 0);
  EXPECT_EQ(t.said(), Lines{"0 irregular syncs, frames are left out"});
  EXPECT_EQ(t.now, 1u) << "whose turn it is does not change";
  for (unsigned n = 0; n < 2 * TURNS_REGULAR_FRAMES; ++n) turns_captured(&t);
  EXPECT_EQ(t.said(), Lines{"0 frames again"});
}

TEST(TurnsTest, OnlyTheChosenCamerasHaveTurnsInTheirOrder) {
  Turns t(3);
  EXPECT_EQ(turns_captured(&t), 1u);
  const uint8_t chosen[] = {2, 0, 2};
  turns_choose(&t, chosen, 3);
  EXPECT_EQ(t.now, 1u) << "until its turn is over";
  for (const uint32_t next : {2u, 0u, 2u, 2u, 0u}) EXPECT_EQ(turns_captured(&t), next);
  turns_choose(&t, chosen + 1, 1);
  for (unsigned n = 0; n < 3; ++n) EXPECT_EQ(turns_captured(&t), 0u);
  const uint8_t all[] = {0, 1, 2};
  turns_choose(&t, all, 3);
  for (const uint32_t next : {0u, 1u, 2u, 0u}) EXPECT_EQ(turns_captured(&t), next);
}

TEST(TurnsTest, AChosenCameraIsAskedAtOnce) {
  Turns t(2);
  EXPECT_EQ(turns_not_ready(&t, &kNothing), 1u);
  const uint8_t chosen[] = {1, 0};
  turns_choose(&t, chosen, 2);
  EXPECT_EQ(turns_captured(&t), 1u);
  EXPECT_EQ(turns_captured(&t), 0u) << "it no longer rests";
}

TEST(TurnsTest, IrregularFramesCostATurnAndRegularOnesAreSaidAfterMany) {
  Turns t(2);
  EXPECT_EQ(turns_irregular(&t), 1u);
  EXPECT_EQ(turns_captured(&t), 0u) << "it has its next turn as usual";
  EXPECT_EQ(turns_irregular(&t), 1u);
  EXPECT_EQ(t.said(), Lines{"0 irregular syncs, frames are left out"}) << "said once";
  turns_captured(&t);
  for (unsigned n = 1; n < TURNS_REGULAR_FRAMES; ++n) {
    turns_captured(&t);
    turns_captured(&t);
  }
  EXPECT_EQ(t.said(), Lines{});
  turns_irregular(&t);
  turns_captured(&t);
  EXPECT_EQ(t.said(), Lines{}) << "counted anew";
  for (unsigned n = 1; n <= TURNS_REGULAR_FRAMES; ++n) {
    EXPECT_EQ(t.said(), Lines{}) << n;
    turns_captured(&t);
    turns_captured(&t);
  }
  EXPECT_EQ(t.said(), Lines{"0 frames again"});
}

TEST(TurnsTest, AClockThatIsOffChangesNoTurn) {
  Turns t(2);
  turns_note(&t, CAMERA_CLOCK_OFF);
  EXPECT_EQ(turns_captured(&t), 1u);
  EXPECT_EQ(t.said(), Lines{"0 clock more than 200 ppm off"});
}

// For the watchdog: a program without frames has got on if that is the camera's doing.
TEST(TurnsTest, WhatASignalOfNoUseCostsIsCounted) {
  Turns t(1);
  turns_captured(&t);
  turns_overflow(&t, 0);
  turns_note(&t, CAMERA_CLOCK_OFF);
  EXPECT_EQ(t.given_up, 0u);
  std::uint32_t expected = 0;
  const auto one_more = [&](const char* what) { EXPECT_EQ(t.given_up, ++expected) << what; };
  turns_irregular(&t);
  one_more("irregular");
  turns_short(&t, 0);
  one_more("short");
  turns_torn(&t);
  one_more("torn");
  turns_not_ready(&t, &kNoLock);
  one_more("waiting for the lock");
  turns_not_ready(&t, &kNothing);
  one_more("no signal");
  turns_no_frames(&t, &kReady);
  one_more("no frames");
}

TEST(TurnsTest, EventsBeyondTheRoomAreCounted) {
  Turns t(1);
  for (unsigned n = 0; n < TURNS_EVENTS + 2; ++n) turns_torn(&t);
  EXPECT_EQ(t.said().size(), TURNS_EVENTS);
  EXPECT_EQ(t.lost_events, 2u);
}

}  // namespace
