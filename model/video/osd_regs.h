// Registers of the on-screen display block (OSD), 0x01C71C00. Source: Linux vpbe_osd, davinci_osd.
#pragma once
#include "model/common/regbank.h"
#include "model/contract/memory_map.h"

namespace fovea::video {

struct OsdRegs : RegBank {
  struct ModeReg : Reg {
    using Reg::Reg;
    Field cabg{*this, "CABG", 0, 8, Mode::kRw, "background colour, CLUT index; 0 is black"};
    Field bclut{*this, "BCLUT", 8, 1, Mode::kRw, "background CLUT; kept"};
    Field fsinv{*this, "FSINV", 9, 1, Mode::kRw, "1 inverts the field signal"};
    Field other{*this, "OTHER", 10, 5, Mode::kRw, "filters and expansion", Modelled{0}};
    Field cs{*this, "CS", 15, 1, Mode::kRw, "1: Cr comes first in memory"};
  } mode{*this, "MODE", 0x00, "display mode"};

  struct Vidwinmd : Reg {
    using Reg::Reg;
    Field act0{*this, "ACT0", 0, 1, Mode::kRw, "video window 0 on"};
    Field vff0{*this, "VFF0", 1, 1, Mode::kRw, "1: each field shows every second row of memory"};
    Field vvz0{*this, "VVZ0", 2, 2, Mode::kRw, "vertical zoom; not modelled"};
    Field vhz0{*this, "VHZ0", 4, 2, Mode::kRw, "horizontal zoom; not modelled"};
    Field efc{*this, "EFC", 6, 1, Mode::kRw, "expansion filter; no effect without zoom"};
    Field act1{*this, "ACT1", 8, 1, Mode::kRw, "video window 1 on; not modelled"};
    Field window1{*this, "WINDOW1", 9, 6, Mode::kRw, "video window 1; not modelled"};
    Field vfinv{*this, "VFINV", 15, 1, Mode::kRw, "1 swaps the fields of the video windows"};
  } vidwinmd{*this, "VIDWINMD", 0x04, "video window mode"};

  struct Overlay : Reg {
    using Reg::Reg;
    Field on{*this, "ACT", 0, 1, Mode::kRw, "1: on", Modelled{0}};
    Field other{*this, "OTHER", 1, 15, Mode::kRw, "no effect while it is off"};
  };
  Overlay osdwin0md{*this, "OSDWIN0MD", 0x08, "bitmap window 0"};
  Overlay osdwin1md{*this, "OSDWIN1MD", 0x0C, "bitmap window 1"};
  Overlay rectcur{*this, "RECTCUR", 0x10, "cursor"};

  struct Ofst : Reg {
    using Reg::Reg;
    Field lo{*this, "LO", 0, 9, Mode::kRw, "line pitch in units of 32 bytes"};
    Field ah{*this, "AH", 9, 4, Mode::kRw, "address bits 26:23 in units of 32 bytes; bit 26 is 1"};
  };
  Ofst vidwin0ofst{*this, "VIDWIN0OFST", 0x18, "pitch and upper address, window 0"};
  Ofst vidwin1ofst{*this, "VIDWIN1OFST", 0x1C, "pitch and upper address, window 1; not modelled"};
  Reg osdwin0ofst{*this, "OSDWIN0OFST", 0x20, Mode::kRw, "not modelled"};
  Reg osdwin1ofst{*this, "OSDWIN1OFST", 0x24, Mode::kRw, "not modelled"};

  struct Adh : Reg {
    using Reg::Reg;
    Field v0{*this, "V0AH", 0, 7, Mode::kRw, "window 0, address bits 22:16 in units of 32 bytes"};
    Field v1{*this, "V1AH", 8, 7, Mode::kRw, "window 1"};
  } vidwinadh{*this, "VIDWINADH", 0x28, "video windows, address"};
  struct Adl : Reg {
    using Reg::Reg;
    Field low{*this, "AL", 0, 16, Mode::kRw, "address bits 15:0 in units of 32 bytes"};
  };
  Adl vidwin0adl{*this, "VIDWIN0ADL", 0x2C, "window 0, address"};
  Adl vidwin1adl{*this, "VIDWIN1ADL", 0x30, "window 1, address; not modelled"};
  Reg osdwinadh{*this, "OSDWINADH", 0x34, Mode::kRw, "not modelled"};
  Reg osdwin0adl{*this, "OSDWIN0ADL", 0x38, Mode::kRw, "not modelled"};
  Reg osdwin1adl{*this, "OSDWIN1ADL", 0x3C, Mode::kRw, "not modelled"};

  struct Number : Reg {
    using Reg::Reg;
    Field value{*this, "VALUE", 0, 11, Mode::kRw, "number"};
  };
  struct Basepx : Reg {
    using Reg::Reg;
    Field value{*this, "BPX", 0, 10, Mode::kRw, "number"};
  } basepx{*this, "BASEPX", 0x40, "left origin of all windows, pixels"};
  struct Basepy : Reg {
    using Reg::Reg;
    Field value{*this, "BPY", 0, 9, Mode::kRw, "number"};
  } basepy{*this, "BASEPY", 0x44, "upper origin of all windows, lines of a field"};
  Number vidwin0xp{*this, "VIDWIN0XP", 0x48, "window 0, left edge, pixels"};
  Number vidwin0yp{*this, "VIDWIN0YP", 0x4C, "window 0, upper edge, lines of a field"};
  Number vidwin0xl{*this, "VIDWIN0XL", 0x50, "window 0, width, pixels"};
  Number vidwin0yl{*this, "VIDWIN0YL", 0x54, "window 0, height, lines of a field"};
  Number vidwin1xp{*this, "VIDWIN1XP", 0x58, "not modelled"};
  Number vidwin1yp{*this, "VIDWIN1YP", 0x5C, "not modelled"};
  Number vidwin1xl{*this, "VIDWIN1XL", 0x60, "not modelled"};
  Number vidwin1yl{*this, "VIDWIN1YL", 0x64, "not modelled"};
  Number osdwin0xp{*this, "OSDWIN0XP", 0x68, "not modelled"};
  Number osdwin0yp{*this, "OSDWIN0YP", 0x6C, "not modelled"};
  Number osdwin0xl{*this, "OSDWIN0XL", 0x70, "not modelled"};
  Number osdwin0yl{*this, "OSDWIN0YL", 0x74, "not modelled"};
  Number osdwin1xp{*this, "OSDWIN1XP", 0x78, "not modelled"};
  Number osdwin1yp{*this, "OSDWIN1YP", 0x7C, "not modelled"};
  Number osdwin1xl{*this, "OSDWIN1XL", 0x80, "not modelled"};
  Number osdwin1yl{*this, "OSDWIN1YL", 0x84, "not modelled"};
  Number curxp{*this, "CURXP", 0x88, "not modelled"};
  Number curyp{*this, "CURYP", 0x8C, "not modelled"};
  Number curxl{*this, "CURXL", 0x90, "not modelled"};
  Number curyl{*this, "CURYL", 0x94, "not modelled"};
  Reg vbndry{*this, "VBNDRY", 0xE0, Mode::kRw, "filters at the windows' borders", 0, Modelled{0}};
  Reg extmode{*this, "EXTMODE", 0xE4, Mode::kRw, "expansion", 0, Modelled{0}};
  struct Miscctl : Reg {
    using Reg::Reg;
    Field low{*this, "LOW", 0, 3, Mode::kRw, "kept"};
    // Family: SPRUE37 (DM644x), which has it read-only; software waits for 0 before it writes a colour.
    Field cpbsy{*this, "CPBSY", 3, 1, Mode::kRo, "a colour table is being written: never, as there is none here"};
    Field middle0{*this, "DMA", 4, 2, Mode::kRw, "kept"};
    Field dmang{*this, "DMANG", 6, 1, Mode::kW1c, "data of the display came too late (vpss.miscctl_6)"};
    Field rgben{*this, "RGBEN", 7, 1, Mode::kRw, "RGB in a video window", Modelled{0}};
    Field middle{*this, "MIDDLE", 8, 6, Mode::kRw, "12 DM365 mode; kept"};
    Field s420d{*this, "S420D", 14, 1, Mode::kRw, "4:2:0 data", Modelled{0}};
    Field high{*this, "HIGH", 15, 1, Mode::kRw, "kept"};
  } miscctl{*this, "MISCCTL", 0xE8, "miscellaneous"};

  OsdRegs() : RegBank("OSD") {}
  /// Byte address of video window 0. The registers hold 27 bits in units of 32 bytes above
  /// 0x80000000. Bit 26 must be written as 1 (Linux); it selects the memory and is not part of the
  /// offset.
  std::uint32_t address() const {
    const std::uint32_t units =
        (vidwin0ofst.ah.get() & 7) << 23 | vidwinadh.v0.get() << 16 | vidwin0adl.low.get();
    return DDR_BASE + (units << 5);
  }
  std::uint32_t pitch() const { return vidwin0ofst.lo.get() * 32; }
};

}  // namespace fovea::video
