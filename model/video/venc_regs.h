// Registers of the video encoder (VENC), 0x01C71E00. Source: Linux vpbe_venc, davinci_vpbe.
#pragma once
#include "model/common/regbank.h"

namespace fovea::video {

struct VencRegs : RegBank {
  struct Vmod : Reg {
    using Reg::Reg;
    Field venc{*this, "VENC", 0, 1, Mode::kRw, "encoder on"};
    Field vie{*this, "VIE",     1,
              1,     Mode::kRw, "composite output on; the picture is shown without it too"};
    Field rsv{*this, "RSV", 2, 1, Mode::kRw, "kept"};
    Field blnk{*this, "BLNK", 3, 1, Mode::kRw, "1: black picture"};
    Field vmd{*this, "VMD", 4, 1, Mode::kRw, "0: standard timing; 1 is not modelled"};
    Field slave{*this, "SLAVE", 5, 1, Mode::kRw, "slave mode; not modelled"};
    Field tvtyp{*this, "TVTYP", 6, 2, Mode::kRw, "0: 525/60, 1: 625/50; others not modelled"};
    Field hdmd{*this, "HDMD", 8, 1, Mode::kRw, "HD; not modelled"};
    Field nsit{*this, "NSIT", 9, 1, Mode::kRw, "non-standard interlace; not modelled"};
    Field itlc{*this, "ITLC", 10, 1, Mode::kRw, "only with NSIT; kept"};
    Field itlcl{*this, "ITLCL", 11, 1, Mode::kRw, "only with NSIT; kept"};
    Field vdmd{*this, "VDMD", 12, 3, Mode::kRw, "digital output mode; kept"};
  } vmod{*this, "VMOD", 0x00, "video mode"};

  // The built-in standard timing does not use the timing registers; they keep what is written.
  Reg vidctl{*this, "VIDCTL", 0x04, Mode::kRw, "digital output; kept"};
  struct Vdpro : Reg {
    using Reg::Reg;
    Field low{*this, "LOW", 0, 8, Mode::kRw, "attenuation, up-sampling, delays", Modelled{0}};
    Field cbmd{*this,      "CBMD", 8, 1, Mode::kRw, "1: colour bars instead of the picture",
               Modelled{0}};
    Field cbtyp{*this, "CBTYP", 9, 1, Mode::kRw, "colour bars of 75 or 100 %; kept"};
    Field high{*this, "HIGH", 10, 6, Mode::kRw, "sampling of the DACs", Modelled{0}};
  } vdpro{*this, "VDPRO", 0x08, "video processing"};
  Reg syncctl{*this, "SYNCCTL", 0x0C, Mode::kRw, "sync pins; kept"};
  Reg hspls{*this, "HSPLS", 0x10, Mode::kRw, "kept"};
  Reg vspls{*this, "VSPLS", 0x14, Mode::kRw, "kept"};
  Reg hint{*this, "HINT", 0x18, Mode::kRw, "kept"};
  Reg hstart{*this, "HSTART", 0x1C, Mode::kRw, "kept"};
  Reg hvalid{*this, "HVALID", 0x20, Mode::kRw, "kept"};
  Reg vint{*this, "VINT", 0x24, Mode::kRw, "kept"};
  Reg vstart{*this, "VSTART", 0x28, Mode::kRw, "kept"};
  Reg vvalid{*this, "VVALID", 0x2C, Mode::kRw, "kept"};
  Reg hsdly{*this, "HSDLY", 0x30, Mode::kRw, "kept"};
  Reg vsdly{*this, "VSDLY", 0x34, Mode::kRw, "kept"};
  Reg yccctl{*this, "YCCCTL", 0x38, Mode::kRw, "digital output; kept"};
  Reg rgbctl{*this, "RGBCTL", 0x3C, Mode::kRw, "digital output; kept"};
  Reg rgbclp{*this, "RGBCLP", 0x40, Mode::kRw, "digital output; kept"};
  Reg linectl{*this, "LINECTL", 0x44, Mode::kRw, "digital output; kept"};
  Reg cullline{*this, "CULLLINE", 0x48, Mode::kRw, "digital output; kept"};
  Reg lcdout{*this, "LCDOUT", 0x4C, Mode::kRw, "digital output; kept"};
  Reg brts{*this, "BRTS", 0x50, Mode::kRw, "digital output; kept"};
  Reg brtw{*this, "BRTW", 0x54, Mode::kRw, "digital output; kept"};
  Reg acctl{*this, "ACCTL", 0x58, Mode::kRw, "digital output; kept"};
  Reg pwmp{*this, "PWMP", 0x5C, Mode::kRw, "digital output; kept"};
  Reg pwmw{*this, "PWMW", 0x60, Mode::kRw, "digital output; kept"};
  Reg dclkctl{*this, "DCLKCTL", 0x64, Mode::kRw, "digital output; kept"};
  struct Vstat : Reg {
    using Reg::Reg;
    Field fidst{*this, "FIDST", 4, 1, Mode::kRo, "field now on display: 1 is the second"};
  } vstat{*this, "VSTAT", 0xB8, "status"};
  Reg dactst{*this, "DACTST", 0xC4, Mode::kRw, "DAC test and power-down", 0, Modelled{0}};
  Reg ycolvl{*this, "YCOLVL", 0xC8, Mode::kRw, "levels of luma and chroma", 0, Modelled{0}};
  Reg scprog{*this, "SCPROG", 0xCC, Mode::kRw, "phase of the colour subcarrier; kept"};
  Reg cvbs{*this, "CVBS", 0xDC, Mode::kRw, "composite output", 0, Modelled{0}};
  Reg cmpnt{*this, "CMPNT", 0xE0, Mode::kRw, "component output", 0, Modelled{0, 0x100}};
  Reg etmg0{*this, "ETMG0", 0xE4, Mode::kRw, "timing of the composite output", 0, Modelled{0}};
  Reg etmg1{*this, "ETMG1", 0xE8, Mode::kRw, "timing of the composite output", 0, Modelled{0}};
  Reg etmg2{*this, "ETMG2", 0xEC, Mode::kRw, "timing of the component output", 0, Modelled{0}};
  Reg etmg3{*this, "ETMG3", 0xF0, Mode::kRw, "timing of the component output", 0, Modelled{0}};
  Reg dacsel{*this, "DACSEL", 0xF4, Mode::kRw, "signals of the DACs; kept"};
  // Linux writes 1 and 2 for these rasters, which lets the OSD run at half the encoder's clock.
  Reg osdclk0{*this, "OSDCLK0",  0x12C, Mode::kRw, "length of the OSD's clock pattern",
              0,     Modelled{1}};
  Reg osdclk1{*this, "OSDCLK1", 0x130, Mode::kRw, "the OSD's clock pattern", 0, Modelled{2}};
  Reg hvldcl0{*this, "HVLDCL0", 0x134, Mode::kRw, "digital output; kept"};
  Reg hvldcl1{*this, "HVLDCL1", 0x138, Mode::kRw, "digital output; kept"};
  Reg osdhadv{*this, "OSDHADV", 0x13C, Mode::kRw, "advance of the OSD's line", 0, Modelled{0}};
  struct Clkctl : Reg {
    using Reg::Reg;
    Field venc{*this, "CLKENC", 0, 1, Mode::kRw, "encoder clock on: without it there is no raster"};
    Field dlcd{*this, "CLKDIG", 4, 1, Mode::kRw, "digital LCD clock; block not modelled"};
  } clkctl{*this, "CLKCTL", 0x140, "clock gates"};
  VencRegs() : RegBank("VENC") {}
};

}  // namespace fovea::video
