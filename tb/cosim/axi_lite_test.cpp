// Register accesses as transactions, with a slave that takes its time.
#include "model/engine/rtl/axi_lite.h"

#include <gtest/gtest.h>

#include "model/engine/rtl/slave_checker.h"

namespace fovea::rtl {
namespace {

struct LiteRig {
  /// The slave's wires are what the test has set.
  void edge() {
    lite.drive(wires);
    checker.clock(wires);
    lite.sample(wires);
  }
  AxiLite lite;
  LiteWires wires;
  RegisterPortChecker checker;
};

TEST(AxiLiteTest, AWriteEndsWithItsAnswerWhicheverPartIsTakenFirst) {
  for (const bool address_first : {true, false}) {
    LiteRig rig;
    rig.lite.write(0x44, 0x1234'5678, 15);
    (address_first ? rig.wires.aw.ready : rig.wires.w.ready) = true;
    rig.edge();
    EXPECT_TRUE(rig.wires.aw.valid && rig.wires.w.valid);
    EXPECT_EQ(rig.wires.aw.address, 0x44u);
    EXPECT_EQ(rig.wires.w.data, 0x1234'5678u);
    EXPECT_EQ(rig.wires.w.strobes, 15u);
    rig.wires.aw.ready = rig.wires.w.ready = false;
    rig.edge();
    EXPECT_EQ(rig.wires.aw.valid, !address_first);
    EXPECT_EQ(rig.wires.w.valid, address_first);
    rig.wires.aw.ready = rig.wires.w.ready = true;
    rig.edge();
    EXPECT_FALSE(rig.lite.idle());
    rig.wires.b.valid = true;
    rig.edge();
    EXPECT_TRUE(rig.lite.idle());
    EXPECT_FALSE(rig.lite.error());
    EXPECT_TRUE(rig.checker.quiet());
  }
}

TEST(AxiLiteTest, AReadReturnsDataAndAnErrorIsSeen) {
  LiteRig rig;
  rig.lite.read(0x18);
  rig.edge();
  EXPECT_TRUE(rig.wires.ar.valid);
  rig.wires.ar.ready = true;
  rig.edge();
  rig.wires.r = {true, true, 0xCAFE, 0, kOkay};
  rig.edge();
  EXPECT_FALSE(rig.wires.ar.valid);
  EXPECT_TRUE(rig.lite.idle());
  EXPECT_EQ(rig.lite.data(), 0xCAFEu);
  EXPECT_FALSE(rig.lite.error());
  rig.wires.r.valid = false;
  rig.lite.read(0x98);
  rig.edge();
  rig.wires.r = {true, true, 0, 0, kSlaveError};
  rig.edge();
  EXPECT_TRUE(rig.lite.idle() && rig.lite.error());
}

}  // namespace
}  // namespace fovea::rtl
