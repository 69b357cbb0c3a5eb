// Tests each priority register of the chip by the time that its master's requests take while
// another master keeps the memory busy.
#include <gtest/gtest.h>

#include <functional>
#include <systemc>

#include "model/common/check.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

class Priorities {
 public:
  Priorities() {
    rig_.set("video.width", "320").set("video.height", "128").set("camera.stamp", "false");
    rig_.set("run.frames", "1000");
    // Between the levels that are tried.
    load("load", "load", "12").set("load.priority", "3").set("load.kind", "mixed");
    rig_.set("load.gap", "3us");  // arbitration is strict: without a pause who is behind it starves
    load("load.1", "edma_tc0", "2").set("load.1.kind", "copy");
    load("load.2", "edma_tc1", "2").set("load.2.kind", "copy");
    load("load.3", "remap_engine", "2");
    rig_.build();
    rig_.advance(600 * kPsPerMs);
  }
  soc::Dm365& soc() { return rig_.board().dm365; }

  /// Mean time of this master's requests from issue to outcome, in ns.
  double time_of(Master m) {
    rig_.advance(kPsPerMs);  // the change takes effect
    soc().scr.settle();
    const Sum before = sum(m);
    const bool by_frames = m == Master::kArmD || m == Master::kVpfe || m == Master::kVpbe;
    rig_.advance((by_frames ? 40 : 2) * kPsPerMs);
    soc().scr.settle();
    const Sum after = sum(m);
    EXPECT_GT(after.requests, before.requests + 100) << kMasterNames[index(m)];
    return static_cast<double>(after.ps - before.ps) /
           static_cast<double>(after.requests - before.requests) * 1e-3;
  }
  /// More urgent than the load, then less: the time must follow.
  void expect_effect(Master m, const std::string& what, const std::function<void(unsigned)>& set) {
    set(0);
    const double urgent = time_of(m);
    set(7);
    const double patient = time_of(m);
    std::printf("  %-22s %-14s %.0f ns at priority 0, %.0f ns at 7\n", what.c_str(),
                std::string(kMasterNames[index(m)]).c_str(), urgent, patient);
    EXPECT_LT(urgent * 1.2, patient) << what;
  }

 private:
  struct Sum {
    std::uint64_t ps = 0, requests = 0;
  };
  Rig& load(const std::string& name, const std::string& port, const std::string& outstanding) {
    static unsigned base = 32;
    return rig_.set(name + ".port", port)
        .set(name + ".outstanding", outstanding)
        .set(name + ".pattern", "random")
        .set(name + ".start", "300ms")
        .set(name + ".base", std::to_string(base += 8) + "MiB");
  }
  Sum sum(Master m) {
    Sum s;
    for (const WaitTable* t : {&soc().scr.crossbar().waits, &soc().ddr.controller().waits()})
      for (std::size_t c = 0; c < kCulprits; ++c)
        s.ps += (*t)[index(m)].read.ps[c] + (*t)[index(m)].write.ps[c];
    s.requests = soc().scr.crossbar().stats[stat_index(m)]->transactions.count();
    return s;
  }
  Rig rig_;
};

TEST(PriorityTest, EachRegisterMovesTheTimeOfItsMaster) {
  Priorities p;
  auto& soc = p.soc();
  const auto write = [](RegBank& bank, std::uint32_t offset, std::uint32_t word) {
    ASSERT_EQ(bank.write(offset, 4, word), Access::kOk);
  };
  // Both sides of a controller are counted together; sum() takes the ps of one side, so a copy's side has
  // about half of its requests: the comparison does not mind.
  p.expect_effect(edma_read(0), "QUEPRI.Q0", [&](unsigned level) {
    write(soc.edma.regs, 0x284, 0x7770u | level);
  });
  p.expect_effect(edma_write(0), "QUEPRI.Q0", [&](unsigned level) {
    write(soc.edma.regs, 0x284, 0x7770u | level);
  });
  // Queue 0 is urgent; which controller has it?
  write(soc.edma.regs, 0x284, 0x7770);
  p.expect_effect(edma_read(1), "QUETCMAP.Q0", [&](unsigned level) {
    write(soc.edma.regs, 0x280, level == 0 ? 0x3201u : 0x3210u);
  });
  write(soc.edma.regs, 0x284, 0x7777);
  p.expect_effect(Master::kRemapEngine, "MSTPRI0.IMCOPP", [&](unsigned level) {
    write(soc.system.regs, 0x3C, 0x00500011u | level << 16);
  });
  p.expect_effect(Master::kArmD, "MSTPRI0.ARM_DMAP", [&](unsigned level) {
    write(soc.system.regs, 0x3C, 0x00570010u | level);
  });
  write(soc.system.regs, 0x3C, 0x00570011);
  p.expect_effect(Master::kVpbe, "BCR.RD_PRI", [&](unsigned level) {
    write(soc.vpss.regs, 0x08, 0x2u | level << 2);
  });
  p.expect_effect(Master::kVpfe, "BCR.WR_PRI", [&](unsigned level) {
    write(soc.vpss.regs, 0x08, 0x2u | level << 5);
  });
}

/// A register access as the configuration bus makes it.
std::uint32_t access(soc::Dm365& soc, bool write, std::uint32_t offset, std::uint32_t word) {
  tlm::tlm_generic_payload gp;
  gp.set_command(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
  gp.set_address(offset);
  gp.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
  gp.set_data_length(4);
  gp.set_streaming_width(4);
  sc_core::sc_time delay;
  soc.config.to("edma")->b_transport(gp, delay);
  EXPECT_EQ(gp.get_response_status(), tlm::TLM_OK_RESPONSE);
  return word;
}

TEST(EdmaTest, ItsConfigurationIsTrueAndTheClockGateHolds) {
  Rig rig;
  rig.set("edma.reset_priority", "5");
  rig.build();
  auto& soc = rig.board().dm365;
  rig.advance(kPsPerUs);
  auto& said = rig.diagnostics;
  said.clear();
  using Kind = Diagnostics::Kind;
  EXPECT_EQ(access(soc, false, 0x284, 0), 0u);
  EXPECT_EQ(said.counts().at({Kind::kGuest, "access to EDMACC while its clock is gated (PSC module 0, EDMA3 channel "
                                            "controller)"}),
            1u);
  ASSERT_EQ(soc.psc.regs.write(0xA00, 4, 0x103), Access::kOk);  // LPSC 0 on
  ASSERT_EQ(soc.psc.regs.write(0x120, 4, 1), Access::kOk);
  rig.advance(10 * kPsPerUs);
  EXPECT_EQ(access(soc, false, 0x284, 0), 0x5555u);
  EXPECT_EQ(access(soc, false, 0x280, 0), 0x3210u);
  access(soc, true, 0x280, 0xFFFF'3214);  // queue 0: a controller that is not there
  rig.advance(kPsPerUs);
  EXPECT_EQ(access(soc, false, 0x280, 0), 0x3214u);
  EXPECT_EQ(said.counts().at(
                {Kind::kGuest, "QUETCMAP names a transfer controller that is not there"}),
            1u);
  // What a driver decodes first; and an offset between two registers.
  EXPECT_EQ(access(soc, false, 0x4, 0), 0x0023'4445u);
  EXPECT_EQ(access(soc, false, 0x288, 0), 0u);
  EXPECT_EQ(said.counts().at({Kind::kNotModelled, "EDMACC register at offset 0x288"}), 1u);
}

TEST(EdmaTest, AControllerHasThePriorityOfItsMostUrgentQueue) {
  Rig rig;
  rig.build();
  auto& soc = rig.board().dm365;
  rig.advance(kPsPerUs);
  ASSERT_EQ(soc.psc.regs.write(0xA00, 4, 0x103), Access::kOk);
  ASSERT_EQ(soc.psc.regs.write(0x120, 4, 1), Access::kOk);
  rig.advance(10 * kPsPerUs);
  const auto priority = [&soc](Master m) { return soc.scr.priority[index(m)].read(); };
  access(soc, true, 0x280, 0x3200);  // queues 0 and 1 on controller 0, none on controller 1
  for (const std::uint32_t quepri : {0x4325u, 0x4352u}) {
    access(soc, true, 0x284, quepri);
    rig.advance(kPsPerUs);
    EXPECT_EQ(priority(edma_read(0)), 2u) << std::hex << quepri;
    EXPECT_EQ(priority(edma_write(0)), 2u) << std::hex << quepri;
    EXPECT_EQ(priority(edma_read(1)), 7u);
    EXPECT_EQ(priority(edma_read(2)), 3u);
    EXPECT_EQ(priority(edma_read(3)), 4u);
  }
}

}  // namespace
}  // namespace fovea::e2e
