// The firmware loses no update to an interrupt: what an interrupt handler changes too is changed with interrupts
// masked, in each of its programs. Where a mask is taken out of the program, the loss is found.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <systemc>
#include <vector>

#include "sw/fovea/board/board_console.h"
#include "tb/e2e/cameras_rig.h"
#include "tb/e2e/interrupt_races.h"
#include "tb/e2e/rig.h"
#include "tb/e2e/views_rig.h"

namespace fovea::e2e {
namespace {

app::ElfImage program(const char* name) {
  return app::ElfImage::load(std::filesystem::path(FOVEA_FIRMWARE_DIR) / name);
}

std::string lines(const std::set<std::string>& all) {
  std::string out;
  for (const std::string& line : all) out += line + "\n";
  return out;
}

/// Two cameras in turn, one of them unplugged for a while, buffers that are checked, and a console with a new table and
/// another choice of cameras.
class InterruptRacesTest : public testing::Test {
 protected:
  InterruptRacesTest() : elf_(program("fovea_cameras.elf")) {
    small(rig_, 2);
    rig_.set("tvp5146.relock_fields", "0").set("firmware.check_capture", "true").set("run.frames", "24");
    rig_.set("fault.kind", "unplugged").set("fault.camera", "1").set("fault.start", "400ms").set("fault.end", "600ms");
    console_ = std::make_unique<app::BoardConsole>(
        rig_.build(), nullptr,
        app::Dialogue::parse("typed", "wait console\nsend shift 0 6 -4\\r\nwait new table\nsend help\\r\n"
                                      "wait camera 1: no\nsend camera 1 0\\r\nsend status\\r\n"));
  }
  void run() {
    InterruptRaces races(rig_.board(), elf_);
    rig_.run(kLimit);
    EXPECT_EQ(rig_.board().dm365.arm.failure(), "");
    lost_ = lines(races.lost());
    safe_ = races.safe();
  }
  CamerasRig rig_;
  app::ElfImage elf_;
  std::unique_ptr<app::BoardConsole> console_;
  std::string lost_;
  std::set<std::string> safe_;
};

TEST_F(InterruptRacesTest, TheProgramForCamerasInTurnLosesNoUpdate) {
  run();
  EXPECT_EQ(lost_, "");
  // What was looked at: the places at which this run needs the masks.
  EXPECT_EQ(lines(safe_), "capture_release\ncapture_take\ncapture_take_reused\nmain\nmark_buffer\noutput_queue\nput\n"
                          "turns_choose\nturns_event\nuart_queue_read\n");
  EXPECT_EQ(console_->open_step(), "") << rig_.board().uart_text();
}

template <class AnyRig>
void expect_no_loss(AnyRig& rig, const char* name, const std::string& safe) {
  const app::ElfImage elf = program(name);
  InterruptRaces races(rig.build(), elf);
  rig.run(kLimit);
  EXPECT_EQ(rig.board().dm365.arm.failure(), "");
  EXPECT_EQ(lines(races.lost()), "");
  EXPECT_EQ(lines(races.safe()), safe);
}

TEST(OtherProgramsTest, TheProgramForOneCameraLosesNoUpdate) {
  Rig rig;
  rig.set("camera.kind", "chart").set("video.width", "160").set("video.height", "184").set("run.frames", "6");
  expect_no_loss(rig, "fovea_firmware.elf", "capture_take\nmain\noutput_queue\n");
}

TEST(OtherProgramsTest, TheProgramForComposedViewsLosesNoUpdate) {
  ViewsRig rig;
  rig.set("cameras.count", "4").set("camera.kind", "chart").set("camera.stamp", "false");
  rig.set("tvp5146.relock_fields", "0").set("video.width", "160").set("video.height", "96");
  rig.set("firmware.view", "four_way").set("run.frames", "7");
  expect_no_loss(rig, "fovea_views.elf", "capture_release\ncapture_take\nmain\noutput_queue\n");
}

/// Takes every mask out of a function of the program. Left out are a mask whose update this run does not reach
/// (`pipeline_whole`), and one without which the handler would see several words of which only some are changed
/// (`view_tables_rebuild`).
class UnmaskedTest : public InterruptRacesTest, public testing::WithParamInterface<const char*> {};
TEST_P(UnmaskedTest, TheLossIsFound) {
  constexpr std::uint32_t kMask = 0xE121F00C, kNothing = 0xE1A00000;  // msr cpsr_c, r12; mov r0, r0
  const app::ElfSymbol* const f = elf_.find(GetParam());
  ASSERT_NE(f, nullptr);
  unsigned masks = 0;
  for (const auto& s : elf_.segments())
    for (std::uint32_t at = f->address; at < f->address + f->size; at += 4) {
      if (at < s.address || at - s.address + 4 > s.data.size()) continue;
      std::uint32_t word;
      std::memcpy(&word, &s.data[at - s.address], 4);
      if (word != kMask) continue;
      ++masks;
      std::vector<std::uint8_t> bytes(4);
      std::memcpy(bytes.data(), &kNothing, 4);
      rig_.board().load({at, bytes});
    }
  ASSERT_GT(masks, 0u);
  run();
  EXPECT_NE(lost_, "");
}
INSTANTIATE_TEST_SUITE_P(Functions, UnmaskedTest,
                         testing::Values("main", "mark_buffer", "pipeline_choose", "pipeline_done", "pipeline_event",
                                         "pipeline_mark_free", "put", "uart_queue_read"),
                         [](const auto& i) { return std::string(i.param); });

}  // namespace
}  // namespace fovea::e2e
