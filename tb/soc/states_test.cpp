// Every register of every block, written in every byte lane, in the states in which a manual says that some of them
// cannot be written, or that a write goes elsewhere. The states are data, each with its source.
#include "tb/soc/states.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>

#include "model/board/board.h"
#include "model/common/host_time_slicer.h"
#include "model/periph/psc.h"
#include "sw/fovea/board/loader.h"

namespace fovea::soc {
namespace {

/// A board whose core does nothing, with every block's clock on.
struct States : testing::Test {
  States() {
    params.declare(set);
    set.set("camera.kind", "chart");
    set.set("engine", "tlm");
    set.set("video.standard", "vga_progressive");  // at the digital port: needs no I2C to send
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
    auto& known = by_name[block];
    if (known.empty())
      for (const Reg* r : bank(block).regs()) known.emplace(r->name(), r);
    const auto at = known.find(name);
    if (at == known.end()) throw std::out_of_range(block + " has no register " + name);
    return *at->second;
  }
  /// In the order of the bank.
  std::vector<std::uint32_t> all_of(const RegBank& bank) const {
    std::vector<std::uint32_t> out(bank.regs().size());
    for (std::size_t n = 0; n < out.size(); ++n) bank.peek(bank.regs()[n]->offset(), out[n]);
    return out;
  }
  /// The same, with what the block computes when it is read.
  std::vector<std::uint32_t> all_of(const State& s) {
    const RegBank& all = bank(s.block);
    for (const Reg* r : s.computed.empty() ? std::vector<Reg*>() : all.regs())
      if (listed(s.computed, r->name())) read(s.block, r->offset());
    return all_of(all);
  }
  void enter(const State& s) {
    fresh();
    for (const Write& w : s.enter) {
      const std::string block = w.block ? w.block : s.block;
      if (w.reg)
        write(block, reg(block, w.reg).offset(), 4, w.word);
      else
        slicer.run(w.word * kPsPerNs);
    }
    ++entered;
  }
  /// Empty: the block is in the state.
  std::string missing(const State& s) {
    for (const Sign& sign : s.signs) {
      const std::string block = sign.block ? sign.block : s.block;
      const std::uint32_t word = read(block, reg(block, sign.reg).offset());
      if ((word & sign.mask) != sign.value)
        return fmt::format("{} reads {:#010x}, of which {:#010x} should be {:#010x}", sign.reg, word, sign.mask,
                           sign.value);
    }
    return "";
  }
  std::uint64_t warnings(const char* text) const {
    std::uint64_t sum = 0;
    for (const auto& [what, count] : diagnostics.counts())
      if (what.second.find(text) != std::string::npos) sum += count;
    return sum;
  }
  static bool listed(const std::vector<const char*>& patterns, const std::string& name) {
    return std::any_of(patterns.begin(), patterns.end(), [&](const char* p) { return matches(p, name); });
  }
  void walk(const State& s);
  void walk(const State& s, const Reg& r, unsigned bytes, unsigned lane);

  Diagnostics diagnostics;
  DiagnosticsScope scope{diagnostics};
  board::BoardParams params;
  ParamSet set;
  std::unique_ptr<video::StampedSource> source;
  std::unique_ptr<board::Board> board;
  HostTimeSlicer slicer;
  std::map<std::string, std::map<std::string, const Reg*>> by_name;
  std::mt19937 random{1};
  unsigned walked = 0, entered = 0;
};

/// What the rule says of a register that a write may change.
std::optional<std::uint32_t> expected(const Move& m, std::uint32_t before, std::uint32_t word) {
  switch (m.effect) {
    case Move::Effect::kSets:
      return before | word;
    case Move::Effect::kClears:
      return before & ~word;
    case Move::Effect::kAny:
      break;
  }
  return std::nullopt;
}

/// One write: exactly the bits that may change have changed.
void States::walk(const State& s, const Reg& r, unsigned bytes, unsigned lane) {
  const auto held = [&](const std::vector<Bits>& list) {
    for (const Bits& b : list)
      if (matches(b.reg, r.name())) return b.bits;
    return 0u;
  };
  const std::uint32_t lanes = (bytes == 4 ? ~0u : (1u << 8 * bytes) - 1) << 8 * lane;
  const std::uint32_t word = ((static_cast<std::uint32_t>(random()) & ~held(s.zeros)) | held(s.ones)) & lanes;
  const std::uint32_t before = read(s.block, r.offset());
  const RegBank& all = bank(s.block);
  const auto others = all_of(s);
  diagnostics.clear();
  write(s.block, r.offset() + lane, bytes, word >> 8 * lane);
  const auto now = all_of(s);
  ++walked;
  const auto where = [&] {
    return fmt::format("{}, {}: a write of {:#010x}, {} bytes at byte {} of {}, ", s.block, s.name, word, bytes, lane,
                       r.name());
  };
  std::vector<Move> moves;
  std::copy_if(s.moves.begin(), s.moves.end(), std::back_inserter(moves),
               [&](const Move& m) { return matches(m.written, r.name()); });
  const bool exact =
      std::any_of(moves.begin(), moves.end(), [](const Move& m) { return m.effect != Move::Effect::kAny; });
  for (std::size_t n = 0; n < now.size(); ++n) {
    if (now[n] == others[n] && !exact) continue;
    const std::string& name = all.regs()[n]->name();
    const auto move = std::find_if(moves.begin(), moves.end(), [&](const Move& m) { return matches(m.changed, name); });
    if (move != moves.end()) {
      if (const auto value = expected(*move, others[n], word)) {
        EXPECT_EQ(now[n], *value) << where() << "to " << name << ", which was " << others[n];
      }
    } else if (all.regs()[n] != &r) {
      EXPECT_EQ(now[n], others[n]) << where() << "changes " << name;
    }
  }
  const std::uint32_t after = read(s.block, r.offset());
  for (const Warned& w : s.warned) {
    if (!matches(w.reg, r.name())) continue;
    const bool tells = !w.bits || ((word ^ before) & lanes & w.bits);
    EXPECT_EQ(warnings(w.text), tells ? 1u : 0u) << where() << "and its warning";
  }
  if (listed(s.odd, r.name())) return;
  const std::uint32_t may = r.writable() & lanes & ~held(s.locked);
  EXPECT_EQ(after & may, word & may) << where() << "is not kept";
  EXPECT_EQ(after & ~may & ~cleared_by(r, word), before & ~may & ~cleared_by(r, word))
      << where() << "changes bits that it may not";
}

void States::walk(const State& s) {
  SCOPED_TRACE(std::string(s.block) + ", " + s.name + " (" + s.source + ")");
  enter(s);
  ASSERT_EQ(missing(s), "") << s.block << ", " << s.name << " is not entered";
  for (const Reg* r : bank(s.block).regs()) {
    if (listed(s.left_out, r->name())) continue;
    for (const unsigned bytes : {4u, 2u, 1u})
      for (unsigned lane = 0; lane < 4; lane += bytes) {
        if (!missing(s).empty()) {
          enter(s);
          ASSERT_EQ(missing(s), "") << s.block << ", " << s.name << " is not entered again";
        }
        walk(s, *r, bytes, lane);
        if (HasFailure()) return;
      }
  }
}

TEST_F(States, EachRegisterOfEachBlockChangesWhatItMayAlone) {
  for (const State& s : states()) walk(s);
  std::printf("%u writes in %zu states, which were entered %u times\n", walked, states().size(), entered);
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
