// Settings of the decoder that act on the chip and not here: each is warned of by its name, and no other one is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <systemc>

#include "model/common/check.h"
#include "model/common/sc_ports.h"
#include "model/video/tvp5146.h"
#include "model/video/tvp5146_settings.h"
#include "tb/own_diagnostics.h"

namespace fovea::video {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// How many fields of the written value are not modelled, from the register list of TI SLES084C: what is left of it
/// acts here (00, 03, 34, 39, 97), is read only, is of a pin that leads nowhere on this board (1A to 21, 32, 35 to
/// 38, 40, 41, F0 to F7), is ignored while the gain is automatic (46 to 51), is of data in the blanking and of the
/// processor's memory (B1 to EA), or is reserved.
unsigned expected(unsigned index, unsigned value) {
  static const std::map<unsigned, unsigned> kOnly{
      {0x01, 0x0F}, {0x04, 0x3F}, {0x05, 0x10}, {0x06, 0}, {0x07, 0}, {0x08, 2}, {0x09, 128}, {0x0A, 128},
      {0x0B, 128}, {0x0C, 0}, {0x0D, 0}, {0x0E, 14}, {0x10, 128}, {0x11, 128}, {0x12, 128}, {0x14, 128},
      {0x28, 0xCC}, {0x2A, 0}, {0x2C, 0}, {0x2D, 0}, {0x2E, 0}};
  if (const auto only = kOnly.find(index); only != kOnly.end()) return value != only->second;
  for (const auto& [first, last] : std::map<unsigned, unsigned>{
           {0x16, 0x19}, {0x22, 0x25}, {0x69, 0x69}, {0x6C, 0x6C}, {0x6F, 0x6F}, {0x74, 0x79}, {0x83, 0x83},
           {0x9E, 0x9E}})
    if (index >= first && index <= last) return 1;
  if (index == 0x02) return value % 8 > 2;
  if (index == 0x33) return (value % 8 != 0) + (value >> 5 & 1) + (value >> 6 & 1) + (value >> 7);
  if (index == 0x34) return value >> 1 & 1;
  return 0;
}

TEST(DecoderSettings, EveryValueOfEveryRegisterIsWarnedOfOrHasAReason) {
  for (unsigned index = 0; index < 256; ++index)
    for (unsigned value = 0; value < 256; ++value)
      EXPECT_EQ(decoder_not_modelled(static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(value)).size(),
                expected(index, value))
          << std::hex << index << " = " << value;
}

TEST(DecoderSettings, TheWarningNamesFieldRegisterAndWhatIsModelled) {
  EXPECT_THAT(decoder_not_modelled(0x33, 0x03),
              ElementsAre("TVP5146 OUTPUT_FORMATTER1.FORMAT (33, output format): only 0 is modelled"));
  EXPECT_THAT(decoder_not_modelled(0x33, 0x40),
              ElementsAre("TVP5146 OUTPUT_FORMATTER1.CODE_RANGE (33, range of the samples): only 0 is modelled"));
  EXPECT_THAT(decoder_not_modelled(0x33, 0xA0),
              ElementsAre(HasSubstr(".CBCR_CODE (33"), HasSubstr(".SAMPLING (33")));
  EXPECT_THAT(decoder_not_modelled(0x33, 0x18), IsEmpty()) << "reserved bits";
  EXPECT_THAT(decoder_not_modelled(0x02, 2), IsEmpty());
  EXPECT_THAT(decoder_not_modelled(0x02, 3), ElementsAre("TVP5146 VIDEO_STD (02, standard): only 0 to 2 are modelled"));
  EXPECT_THAT(decoder_not_modelled(0x0A, 0x7F),
              ElementsAre("TVP5146 CONTRAST (0A, level of luma or colour): only 80 is modelled"));
  EXPECT_THAT(decoder_not_modelled(0x75, 0),
              ElementsAre("TVP5146 FBIT_VBIT_CONTROL2 (75, F and V of signals with other numbers of lines): "
                          "what it does is not modelled"));
}

class Black : public PictureSource {
 public:
  unsigned width() const override { return picture_.width; }
  unsigned height() const override { return picture_.height; }
  const Picture& field(std::uint64_t) override { return picture_; }

 private:
  Picture picture_{720, 576};
};

/// A decoder on the I2C bus, before the first instant.
struct Decoder {
  OwnDiagnostics diagnostics;
  Tvp5146Params params;
  Black picture;
  Tvp5146 decoder{"decoder", params, picture};
  void write(std::uint8_t index, std::uint8_t value) {
    ASSERT_TRUE(decoder.i2c_start(0x5D, false));
    decoder.i2c_write(index);
    decoder.i2c_write(value);
  }
  unsigned read(std::uint8_t index) {
    decoder.i2c_start(0x5D, false);
    decoder.i2c_write(index);
    decoder.i2c_start(0x5D, true);
    return decoder.i2c_read();
  }
};
Decoder* decoder = nullptr;

std::map<std::string, std::uint64_t> warnings() {
  std::map<std::string, std::uint64_t> out;
  for (const auto& [kind, count] : decoder->diagnostics.counts()) {
    EXPECT_EQ(kind.first, Diagnostics::Kind::kNotModelled) << kind.second;
    out[kind.second] = count;
  }
  return out;
}
const char* const kRange = "TVP5146 OUTPUT_FORMATTER1.CODE_RANGE (33, range of the samples): only 0 is modelled";

TEST(DecoderSettings, ResetValuesAreThoseOfTheManual) {
  EXPECT_EQ(decoder->read(0x01), 0x0Fu);
  EXPECT_EQ(decoder->read(0x09), 0x80u);
  EXPECT_EQ(decoder->read(0x0E), 0x0Eu);
  EXPECT_EQ(decoder->read(0x28), 0xCCu);
  EXPECT_EQ(decoder->read(0x33), 0x40u);
  EXPECT_EQ(decoder->read(0x34), 0x00u);
  EXPECT_EQ(decoder->read(0x16), 0x00u) << "not known";
}

TEST(DecoderSettings, OutputsThatAreEnabledWithTheFormatOfResetAreWarnedOf) {
  decoder->diagnostics.clear();
  decoder->write(0x34, 0x10);
  EXPECT_THAT(warnings(), IsEmpty()) << "nothing is sent yet";
  decoder->write(0x34, 0x11);
  EXPECT_THAT(warnings(), ElementsAre(testing::Pair(kRange, 1)));
  decoder->write(0x34, 0x15);
  EXPECT_THAT(warnings(), ElementsAre(testing::Pair(kRange, 1))) << "they were on";
}

TEST(DecoderSettings, WhatTheFirmwareWritesIsModelled) {
  decoder->diagnostics.clear();
  const std::uint8_t sequence[][2] = {{0x34, 0}, {0x02, 2}, {0x00, 5}, {0x33, 0}, {0x03, 0}, {0x34, 0x11},
                                      {0x02, 0}, {0x39, 1}, {0x97, 1}, {0x00, 4}};
  for (const auto& [index, value] : sequence) decoder->write(index, value);
  EXPECT_THAT(warnings(), IsEmpty());
}

TEST(DecoderSettings, AWriteOfAnotherFormatIsKeptAndWarnedOfAtEachWrite) {
  decoder->diagnostics.clear();
  decoder->write(0x33, 0x41);
  decoder->write(0x33, 0x41);
  EXPECT_EQ(decoder->read(0x33), 0x41u);
  EXPECT_THAT(warnings(),
              ElementsAre(testing::Pair(kRange, 2), testing::Pair(HasSubstr("OUTPUT_FORMATTER1.FORMAT"), 2)));
  decoder->write(0x33, 0);
  EXPECT_EQ(warnings().size(), 2u);
}

TEST(DecoderSettings, AreAnErrorWithStrict) {
  decoder->diagnostics.set_strict(true);
  EXPECT_THROW(decoder->write(0x09, 0x81), NotModelled);
  EXPECT_NO_THROW(decoder->write(0x09, 0x80));
  decoder->diagnostics.set_strict(false);
}

}  // namespace
}  // namespace fovea::video

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::video::Decoder decoder;
  fovea::video::decoder = &decoder;
  return RUN_ALL_TESTS();
}
