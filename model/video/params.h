// Parameters of the video blocks.
#pragma once
#include "model/common/param.h"

namespace fovea::video {

struct VpssParams : ParamGroup {
  using Unit = IntParam::Unit;
  VpssParams() : ParamGroup("vpss") {}
  static constexpr const char* kBasePxBelief =
      "a driver that shifts the picture by four pixels would hardly be noticed on a screen";
  static constexpr const char* kBasePyBelief =
      "a driver that leaves out two lines of a field would hardly be noticed on a screen";

  IntParam burst{*this,
                 "burst",
                 Unit::kBytes,
                 64,
                 32,
                 64,
                 "largest memory burst of capture and display, 32 B or 64 B",
                 Origin::kAssumed,
                 "registers use units of 32 B; no public figure",
                 {"32B", "64B", "one or two units"}};
  IntParam write_buffer_bursts{*this,
                               "write_buffer_bursts",
                               Unit::kCount,
                               4,
                               1,
                               32,
                               "bursts of captured data that may wait for memory",
                               Origin::kAssumed,
                               "no public figure; watch capture.overflows",
                               {"2", "8", "two buffers in turn at the least"}};
  IntParam read_ahead_lines{*this,
                            "read_ahead_lines",
                            Unit::kCount,
                            1,
                            1,
                            4,
                            "lines fetched before the line on display",
                            Origin::kAssumed,
                            "no public figure; watch display.underflows",
                            {"1", "2", "a line buffer, or two in turn"}};
  IntParam read_outstanding{*this,
                            "read_outstanding",
                            Unit::kCount,
                            4,
                            1,
                            16,
                            "display reads that may be under way at once",
                            Origin::kAssumed,
                            "no public figure",
                            {"1", "8", "one read at a time, or half a kilobyte of them"}};
  EnumParam osd_latch{*this,
                      "osd_latch",
                      "field",
                      {"field", "frame"},
                      "when a new window address takes effect: at each field start, or only at "
                      "the start of the field with F = 0",
                      Origin::kAssumed,
                      "the manual's text is not public",
                      {"field", "frame", "drivers write the address in the vertical blanking"}};
  EnumParam venc_clk_sel{
      *this,
      "venc_clk_sel",
      "no_effect",
      {"no_effect", "halves"},
      "what bit 2 of VPSS_CLK_CTRL (0x01C70200) = 1 does to the raster of "
      "525/60 and 625/50: nothing, or half the line rate",
      Origin::kAssumed,
      "Linux names it ENC_CLK/2, yet sets it for these rasters with a clock of "
      "27 MHz, and a TI board test shows them with 0 (decision 0009)",
      {"no_effect", "no_effect", "programs for one board and clock use either value"}};
  EnumParam miscctl_6{
      *this,
      "miscctl_6",
      "dmang",
      {"dmang", "rgbwin"},
      "what bit 6 of the OSD's MISCCTL (0x01C71CE8) is: an error flag, set when data of the "
      "display came too late and cleared by writing 1, or a format of a video window, which "
      "is not modelled",
      Origin::kAssumed,
      "Linux's vpbe_osd_regs.h has both names for the bit; TI's register header of the DM355 "
      "names the values of DMANG 'no error' and 'error', and Linux writes 1 to it there",
      {"dmang", "rgbwin", "the DM365 shares its display with the DM355"}};
  IntParam base_px_625{*this,
                       "base_px_625",
                       Unit::kCount,
                       0x7E,
                       0,
                       1023,
                       "BASEPX that puts the window's left edge on the first active pixel, 625/50",
                       Origin::kAssumed,
                       "Linux's board-dm365-evm.c writes 0x7E, a TI board test 132",
                       {"122", "132", kBasePxBelief}};
  IntParam base_px_525{*this,
                       "base_px_525",
                       Unit::kCount,
                       0x79,
                       0,
                       1023,
                       "BASEPX that puts the window's left edge on the first active pixel, 525/60",
                       Origin::kAssumed,
                       "Linux's board-dm365-evm.c writes 0x79, a TI board test 122",
                       {"117", "125", kBasePxBelief}};
  IntParam base_py_625{*this,
                       "base_py_625",
                       Unit::kCount,
                       0x16,
                       0,
                       511,
                       "BASEPY that puts the window's top on the first active line, 625/50",
                       Origin::kAssumed,
                       "Linux's board-dm365-evm.c and a TI board test write 0x16: line 23 is 22 "
                       "after the vertical sync. TI's Linux 2.6.32 adds 2 on this chip, not for "
                       "the position: its davinci_platform.c says that bitmap window 0 shakes",
                       {"22", "24", kBasePyBelief}};
  IntParam base_py_525{*this,
                       "base_py_525",
                       Unit::kCount,
                       0x10,
                       0,
                       511,
                       "BASEPY that puts the window's top on the first active line, 525/60",
                       Origin::kAssumed,
                       "Linux's board-dm365-evm.c writes 0x10: line 20 is 16 after the vertical "
                       "sync; a TI board test writes 18",
                       {"16", "18", kBasePyBelief}};
};

struct Tvp5146Params : ParamGroup {
  using Unit = IntParam::Unit;
  Tvp5146Params() : ParamGroup("tvp5146") {}

  EnumParam standard{*this,
                     "standard",
                     "625/50",
                     {"625/50", "525/60"},
                     "what the camera on the decoder's input sends",
                     Origin::kChoice,
                     ""};
  IntParam i2c_address{*this,
                       "i2c_address",
                       Unit::kCount,
                       0x5D,
                       0x5C,
                       0x5D,
                       "7-bit I2C address, set by a pin",
                       Origin::kSourced,
                       "SLES084C; the EVM uses 0x5D"};
  IntParam relock_fields{*this,
                         "relock_fields",
                         Unit::kCount,
                         10,
                         0,
                         100,
                         "fields until the decoder locks after power-up or a change of its input, "
                         "counted from the one in progress; 0: at once, as for genlocked cameras",
                         Origin::kAssumed,
                         "Linux waits 200 ms; no figure in the data manual",
                         {"2", "25", "from the next frame to half a second"}};
  EnumParam unlocked_output{*this,
                            "unlocked_output",
                            "black",
                            {"black", "noise"},
                            "what the decoder sends while it is not locked, as long as the black-screen bits of "
                            "register 34 are 0: black, or noise as of an open input",
                            Origin::kAssumed,
                            "no public figure or sentence was found",
                            {"black", "noise", "a decoder that goes on sampling shows the noise of its input"}};
  IntParam count_lines{*this,
                       "count_lines",
                       Unit::kCount,
                       3,
                       0,
                       100,
                       "lines from the start of a first field until registers 9A and 9B can capture how many "
                       "the frame before had",
                       Origin::kAssumed,
                       "the data manual says: of the previous frame",
                       {"1", "4", "the broad pulses, by which a field's start is known, take 2.5 or 3 lines"}};
  IntParam count_capture{*this,
                         "count_capture",
                         Unit::kTime,
                         100 * kPsPerUs,
                         0,
                         kPsPerSecond,
                         "from a request in register 97 until registers 9A and 9B hold the number of lines",
                         Origin::kAssumed,
                         "the data manual of the TVP5147M1: not immediate, done by the internal processor",
                         {"10us", "1ms", "from a pass of a short loop to that of a long one"}};
  IntParam rom_version{*this,
                       "rom_version",
                       Unit::kCount,
                       0,
                       0,
                       255,
                       "what register 70 reads, the version of the decoder's program",
                       Origin::kAssumed,
                       "the data manual gives no value; Linux's tvp514x driver only prints it",
                       {"0", "255", "nothing depends on it"}};
  BoolParam output_at_reset{
      *this,           "output_at_reset",
      false,           "data and clock outputs are on before anyone writes register 34",
      Origin::kChoice, ""};
  EnumParam crop_525{*this,
                     "crop_525",
                     "first_lines",
                     {"first_lines", "studio", "486_lines"},
                     "lines that carry the 480 rows in 525/60: from 20 and 283 (upper field "
                     "first), or the studio's 285 and 23 (lower field first); 486_lines: 486 rows "
                     "from 20 and 283",
                     Origin::kChoice,
                     ""};
  IntParam phase{*this,
                 "phase",
                 Unit::kTime,
                 0,
                 0,
                 40 * kPsPerMs,
                 "start of the camera's first field after power-up",
                 Origin::kChoice,
                 ""};
};

}  // namespace fovea::video
