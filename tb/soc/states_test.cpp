// Every register of every block, written in every byte lane, in the states in which a manual says that some of them
// cannot be written, or that a write goes elsewhere. The states are data, each with its source.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "model/periph/psc.h"
#include "sw/fovea/board/loader.h"
#include "tb/soc/states.h"

namespace fovea::soc {
namespace {

/// A board whose core does nothing, with every block's clock on.
struct States : testing::Test {
  States() {
    params.declare(set);
    set.set("camera.kind", "chart");
    set.set("engine", "tlm");
    source = app::camera_source(params, 0);
    board = std::make_unique<board::Board>("board", params, std::vector<video::PictureSource*>{source.get()}, 0, false);
    board->load({0, {0xFE, 0xFF, 0xFF, 0xEA}});  // b .
    slicer.run(kPsPerUs);
  }
  soc::Dm365& chip() { return board->dm365; }
  /// As after a reset, but for the clocks of all blocks.
  void fresh() {
    chip().reset_chip(ResetKind::kWarm);
    slicer.run(kPsPerMs);
    for (unsigned n = 0; n < periph::kLpscCount; ++n) write("psc", 0xA00 + 4 * n, 4, 3);
    write("psc", 0x120, 4, 1);
    slicer.run(kPsPerMs);
    write("vpss", 0x04, 4, 0x7F);
    slicer.run(kPsPerUs);
  }
  void transport(tlm::tlm_command command, const std::string& block, std::uint32_t offset, unsigned bytes,
                 std::uint32_t& word) {
    tlm::tlm_generic_payload gp;
    gp.set_command(command);
    gp.set_address(offset);
    gp.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
    gp.set_data_length(bytes);
    gp.set_streaming_width(bytes);
    sc_core::sc_time delay;
    chip().config.to(block)->b_transport(gp, delay);
    EXPECT_TRUE(gp.is_response_ok()) << block << " " << offset;
  }
  void write(const std::string& block, std::uint32_t offset, unsigned bytes, std::uint32_t word) {
    transport(tlm::TLM_WRITE_COMMAND, block, offset, bytes, word);
  }
  std::uint32_t read(const std::string& block, std::uint32_t offset) {
    std::uint32_t word = 0;
    transport(tlm::TLM_READ_COMMAND, block, offset, 4, word);
    return word;
  }
  RegBank& bank(const std::string& block) { return chip().placed.get<BusTarget>(block).bank(); }
  const Reg& reg(const std::string& block, const std::string& name) {
    for (const Reg* r : bank(block).regs())
      if (r->name() == name) return *r;
    throw std::out_of_range(block + " has no register " + name);
  }
  /// In the order of the bank.
  std::vector<std::uint32_t> all_of(const RegBank& bank) const {
    std::vector<std::uint32_t> out(bank.regs().size());
    for (std::size_t n = 0; n < out.size(); ++n) bank.peek(bank.regs()[n]->offset(), out[n]);
    return out;
  }
  void enter(const State& s) {
    fresh();
    for (const Write& w : s.enter) write(s.block, reg(s.block, w.reg).offset(), 4, w.word);
  }
  void walk(const State& s);
  void walk(const State& s, const Reg& r, unsigned bytes, unsigned lane);

  board::BoardParams params;
  ParamSet set;
  std::unique_ptr<video::StampedSource> source;
  std::unique_ptr<board::Board> board;
  HostTimeSlicer slicer;
  std::mt19937 random{1};
  unsigned walked = 0;
};

/// One write: exactly the bits that may change have changed.
void States::walk(const State& s, const Reg& r, unsigned bytes, unsigned lane) {
  const auto held = [&](const std::vector<Bits>& list) {
    for (const Bits& b : list)
      if (r.name() == b.reg) return b.bits;
    return 0u;
  };
  const std::uint32_t lanes = (bytes == 4 ? ~0u : (1u << 8 * bytes) - 1) << 8 * lane;
  const std::uint32_t word = ((static_cast<std::uint32_t>(random()) & ~held(s.zeros)) | held(s.ones)) & lanes;
  const std::uint32_t before = read(s.block, r.offset());
  const RegBank& all = bank(s.block);
  const auto others = all_of(all);
  write(s.block, r.offset() + lane, bytes, word >> 8 * lane);
  const auto now = all_of(all);
  ++walked;
  for (std::size_t n = 0; n < now.size(); ++n) {
    const std::string& name = all.regs()[n]->name();
    if (now[n] == others[n] || all.regs()[n] == &r) continue;
    const bool meant = std::any_of(s.moves.begin(), s.moves.end(), [&](const Move& m) {
      return matches(m.written, r.name()) && matches(m.changed, name);
    });
    EXPECT_TRUE(meant) << s.block << ", " << s.name << ": a write of " << bytes << " bytes at byte " << lane << " of "
                       << r.name() << " changes " << name << " from " << std::hex << others[n] << " to " << now[n];
  }
  if (std::any_of(s.odd.begin(), s.odd.end(), [&](const char* p) { return matches(p, r.name()); })) return;
  const std::uint32_t may = r.writable() & lanes & ~held(s.locked);
  const std::uint32_t after = read(s.block, r.offset());
  EXPECT_EQ(after & may, word & may) << s.block << ", " << s.name << ": " << r.name() << " does not keep what is "
                                     << "written, bytes " << bytes << " at " << lane;
  EXPECT_EQ(after & ~may & ~cleared_by(r, word), before & ~may & ~cleared_by(r, word))
      << s.block << ", " << s.name << ": a write of " << bytes << " bytes at byte " << lane << " changes bits of "
      << r.name() << " that it may not";
}

void States::walk(const State& s) {
  SCOPED_TRACE(std::string(s.block) + ", " + s.name + " (" + s.source + ")");
  enter(s);
  for (const Reg* r : bank(s.block).regs()) {
    if (std::any_of(s.left_out.begin(), s.left_out.end(), [&](const char* p) { return matches(p, r->name()); }))
      continue;
    for (const unsigned bytes : {4u, 2u, 1u})
      for (unsigned lane = 0; lane < 4; lane += bytes) {
        walk(s, *r, bytes, lane);
        if (HasFailure()) return;
      }
  }
}

TEST_F(States, EachRegisterOfEachBlockChangesWhatItMayAlone) {
  for (const State& s : states()) walk(s);
  std::printf("%u writes in %zu states\n", walked, states().size());
}

TEST_F(States, EachBlockHasAState) {
  for (std::size_t k = 0; k < chip().placed.size(); ++k) {
    const std::string& name = chip().placed.row(k).name;
    EXPECT_TRUE(std::any_of(states().begin(), states().end(), [&](const State& s) { return s.block == name; })) << name;
  }
}

/// While a block's clock is gated its registers read 0, and what is written is lost (assumed).
TEST_F(States, WithoutItsClockNothingOfABlockCanBeWritten) {
  unsigned blocks = 0;
  for (std::size_t k = 0; k < chip().placed.size(); ++k) {
    const Placement& row = chip().placed.row(k);
    if (!row.lpsc) continue;
    fresh();
    write("psc", 0xA00 + 4 * *row.lpsc, 4, 2);
    write("psc", 0x120, 4, 1);
    slicer.run(kPsPerMs);
    if (!chip().placed.get<BusTarget>(row.name).gated()) continue;
    const auto before = all_of(bank(row.name));
    for (const Reg* r : bank(row.name).regs()) {
      write(row.name, r->offset(), 4, static_cast<std::uint32_t>(random()));
      EXPECT_EQ(read(row.name, r->offset()), 0u) << row.name << " " << r->name();
    }
    EXPECT_EQ(all_of(bank(row.name)), before) << row.name;
    ++blocks;
  }
  EXPECT_GE(blocks, 10u);
}

}  // namespace
}  // namespace fovea::soc

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
