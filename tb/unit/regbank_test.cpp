// model/common/regbank.h: modes, byte lanes, callbacks, and invalid declarations.
#include "model/common/regbank.h"

#include "tb/unit/support.h"

namespace fovea {
namespace {

struct Bank : RegBank {
  struct Ctrl : Reg {
    using Reg::Reg;
    Field low{*this, "LOW", 0, 12, Mode::kRw, "low"};
    Field id{*this, "ID", 12, 4, Mode::kRo, "fixed"};
    Field done{*this, "DONE", 16, 2, Mode::kW1c, "events"};
    Field go{*this, "GO", 24, 1, Mode::kWo, "start"};
  } ctrl{*this, "CTRL", 0x00, "control", 0x0000'5000};
  Reg data{*this, "DATA", 0x08, Mode::kRw, "data", 0x1122'3344};
  Reg view{*this, "VIEW", 0x0c, Mode::kRo, "input"};
  Bank() : RegBank("BANK") {}
};

class RegBankTest : public testing::Test {
 protected:
  std::uint32_t read(std::uint32_t offset, unsigned bytes = 4) {
    std::uint32_t v = 0xdead'beef;
    EXPECT_EQ(bank.read(offset, bytes, v), Access::kOk);
    return v;
  }
  void write(std::uint32_t offset, std::uint32_t v, unsigned bytes = 4) {
    EXPECT_EQ(bank.write(offset, bytes, v), Access::kOk);
  }
  Bank bank;
};

TEST_F(RegBankTest, ReadWriteBitsKeepAndReadOnlyBitsDoNot) {
  write(0, 0x0000'ffff);
  EXPECT_EQ(read(0), 0x0000'5fffu);
  write(0, 0x0000'5abc);
  EXPECT_EQ(read(0), 0x0000'5abcu);
}

TEST_F(RegBankTest, WritingOneClearsOnlyThoseBits) {
  bank.ctrl.done.set(3);
  write(0, 0x0001'0000);
  EXPECT_EQ(bank.ctrl.done.get(), 2u);
  write(0, 0);
  EXPECT_EQ(bank.ctrl.done.get(), 2u) << "writing 0 clears nothing";
}

TEST_F(RegBankTest, WriteOnlyBitsReachTheCallbackAndReadAsZero) {
  std::uint32_t seen = 0;
  bank.ctrl.on_write([&](std::uint32_t word) { seen = word; });
  write(0, 0x0100'0000);
  EXPECT_EQ(seen, 0x0100'0000u);
  EXPECT_EQ(read(0) & 0x0100'0000u, 0u);
}

TEST_F(RegBankTest, AReadOfAPartHasOnlyItsBytes) {
  write(8, 0xFFFF'FFFF);
  for (const std::uint32_t at : {8u, 9u, 10u, 11u}) EXPECT_EQ(read(at, 1), 0xFFu) << at;
  for (const std::uint32_t at : {8u, 10u}) EXPECT_EQ(read(at, 2), 0xFFFFu) << at;
  EXPECT_EQ(read(8, 4), 0xFFFF'FFFFu);
}

TEST_F(RegBankTest, ByteLanesAreMergedAndShifted) {
  write(0x0a, 0xaa, 1);
  EXPECT_EQ(read(8), 0x11aa'3344u);
  write(0x08, 0xbbcc, 2);
  EXPECT_EQ(read(8), 0x11aa'bbccu);
  EXPECT_EQ(read(0x0a, 2), 0x11aau);
  EXPECT_EQ(read(0x0b, 1), 0x11u);
}

TEST_F(RegBankTest, CallbackSeesOnlyTheLanesWritten) {
  std::uint32_t seen = 0;
  bank.data.on_write([&](std::uint32_t word) { seen = word; });
  write(0x09, 0x1'77, 1);
  EXPECT_EQ(seen, 0x0000'7700u);
}

TEST_F(RegBankTest, ByteWriteDoesNotClearEventsOfOtherLanes) {
  bank.ctrl.done.set(3);
  write(1, 0xff, 1);
  EXPECT_EQ(bank.ctrl.done.get(), 3u);
}

TEST_F(RegBankTest, ReadCallbackRefreshesTheValueAndPeekHasNoEffect) {
  int reads = 0;
  bank.view.on_read([&] { bank.view.set(static_cast<std::uint32_t>(++reads)); });
  std::uint32_t v = 0;
  EXPECT_EQ(bank.peek(0x0c, v), Access::kOk);
  EXPECT_EQ(v, 0u);
  EXPECT_EQ(read(0x0c), 1u);
  EXPECT_EQ(reads, 1);
}

TEST_F(RegBankTest, MisalignedAndUnmappedAccessesAreAnswered) {
  std::uint32_t v = 0;
  EXPECT_EQ(bank.read(2, 4, v), Access::kMisaligned);
  EXPECT_EQ(bank.read(1, 2, v), Access::kMisaligned);
  EXPECT_EQ(bank.read(0, 3, v), Access::kMisaligned);
  EXPECT_EQ(bank.read(0, 0, v), Access::kMisaligned);
  EXPECT_EQ(bank.write(0, 8, 0), Access::kMisaligned);
  EXPECT_EQ(bank.read(4, 4, v), Access::kNoRegister);
  EXPECT_EQ(bank.write(0x10, 4, 0), Access::kNoRegister);
  EXPECT_EQ(bank.peek(0x4000, v), Access::kNoRegister);
}

TEST_F(RegBankTest, ResetRestoresDeclaredValues) {
  write(8, 0);
  bank.ctrl.done.set(1);
  bank.reset();
  EXPECT_EQ(read(8), 0x1122'3344u);
  EXPECT_EQ(read(0), 0x0000'5000u);
}

TEST(RegBankModelledTest, ValuesThatAreNotModelledAreNamed) {
  struct Limited : RegBank {
    struct R : Reg {
      using Reg::Reg;
      Field filter{*this, "FILTER", 0, 1, Mode::kRw, "low-pass filter", Modelled{0}};
      Field free{*this, "FREE", 1, 3, Mode::kRw, "acts"};
      Field mode{*this, "MODE", 8, 6, Mode::kRw, "mode", Modelled{0, 3, 16}};
      Field burst{*this, "BURST", 16, 1, Mode::kRw, "burst", Modelled{}};
    } r{*this, "R", 0, "fields"};
    Reg whole{*this, "WHOLE", 4, Mode::kRw, "all bits", 7, Modelled{7, 0x80000000}};
    Limited() : RegBank("X") {}
  } x;
  using Texts = std::vector<std::string>;
  EXPECT_EQ(x.r.limited(), 0x0001'3F01u);
  EXPECT_EQ(x.whole.limited(), ~0u);
  EXPECT_EQ(x.whole.not_modelled(~0u), Texts{}) << "the reset value is listed";
  const std::string burst = "R.BURST (burst): not modelled";
  EXPECT_EQ(x.r.not_modelled(~0u), Texts{burst}) << "an empty list: no value is modelled";
  EXPECT_EQ(x.r.not_modelled(0xFFFF), Texts{}) << "only fields in the lanes that were written";
  x.r.set(0x1000);  // MODE = 16
  EXPECT_EQ(x.r.not_modelled(0xFF00), Texts{});
  x.r.set(0x110F);  // MODE = 17, all the lower fields
  EXPECT_EQ(x.r.not_modelled(~0u),
            (Texts{"R.FILTER (low-pass filter): only 0 is modelled",
                   "R.MODE (mode): only 0, 3 and 0x10 are modelled", burst}));
  x.whole.set(0x8000'0000);
  EXPECT_EQ(x.whole.not_modelled(~0u), Texts{});
  x.whole.set(0x8000'0007);
  EXPECT_EQ(x.whole.not_modelled(1), Texts{"WHOLE (all bits): only 7 and 0x80000000 are modelled"});
}

TEST(RegBankDeathTest, OverlappingFieldsAreADefect) {
  struct Overlapping : RegBank {
    struct R : Reg {
      using Reg::Reg;
      Field a{*this, "A", 0, 4, Mode::kRw, ""};
      Field b{*this, "B", 3, 1, Mode::kRw, ""};
    } r{*this, "R", 0, ""};
    Overlapping() : RegBank("X") {}
  };
  EXPECT_EXIT(Overlapping(), testing::ExitedWithCode(4), "fields overlap: R.B");
}

TEST(RegBankDeathTest, OverlappingRegistersAreADefect) {
  struct Overlapping : RegBank {
    Reg a{*this, "A", 4, Mode::kRw, ""};
    Reg b{*this, "B", 4, Mode::kRw, ""};
    Overlapping() : RegBank("X") {}
  };
  EXPECT_EXIT(Overlapping(), testing::ExitedWithCode(4), "registers overlap: X.B");
}

TEST(RegBankDeathTest, MisalignedOffsetIsADefect) {
  struct Misaligned : RegBank {
    Reg a{*this, "A", 2, Mode::kRw, ""};
    Misaligned() : RegBank("X") {}
  };
  EXPECT_EXIT(Misaligned(), testing::ExitedWithCode(4), "multiple of 4");
}

}  // namespace
}  // namespace fovea
