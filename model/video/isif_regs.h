// Registers of the image sensor interface (ISIF), 0x01C71000. Source: TI's register header for the
// DM36x, Linux isif_regs.h.
#pragma once
#include "model/common/regbank.h"

namespace fovea::video {

struct IsifRegs : RegBank {
  struct Syncen : Reg {
    using Reg::Reg;
    Field vdhden{*this, "VDHDEN", 0, 1, Mode::kRw, "synchronise to the input"};
    Field wen{*this, "WEN", 1, 1, Mode::kRw, "write data to memory, from the next VD on"};
  } syncen{*this, "SYNCEN", 0x00, "synchronisation enable"};

  struct Modeset : Reg {
    using Reg::Reg;
    Field hdvdd{*this, "HDVDD", 0, 1, Mode::kRw, "HD/VD direction; 1 (output) is not modelled"};
    Field fidd{*this, "FIDD", 1, 1, Mode::kRw, "field id pin: 0 input", Modelled{0}};
    Field vdpol{*this, "VDPOL", 2, 1, Mode::kRw, "VD polarity; no meaning with embedded syncs"};
    Field hdpol{*this, "HDPOL", 3, 1, Mode::kRw, "HD polarity; no meaning with embedded syncs"};
    Field fipol{*this, "FIPOL", 4, 1, Mode::kRw, "1 inverts the field id"};
    Field swen{*this, "SWEN", 5, 1, Mode::kRw, "external write enable", Modelled{0}};
    Field dpol{*this, "DPOL", 6, 1, Mode::kRw, "1: inverts the input data", Modelled{0}};
    Field ccdmd{*this, "CCDMD", 7, 1, Mode::kRw, "1: interlaced"};
    Field ccdw{*this, "CCDW", 8, 3, Mode::kRw, "data shift; no meaning for YC data"};
    Field inpmod{*this, "INPMOD", 12, 2, Mode::kRw, "input: 0 raw, 1 YC 16 bit, 2 YC 8 bit"};
    Field hlpf{*this, "HLPF", 14, 1, Mode::kRw, "low-pass filter", Modelled{0}};
    Field mdfs{*this, "MDFS", 15, 1, Mode::kRo, "field now: 1 is the second"};
  } modeset{*this, "MODESET", 0x04, "input mode", 0x2000};

  Reg hdw{*this, "HDW", 0x08, Mode::kRw, "HD width as master; not modelled"};
  Reg vdw{*this, "VDW", 0x0C, Mode::kRw, "VD width as master; not modelled"};
  Reg ppln{*this, "PPLN", 0x10, Mode::kRw, "pixels per line as master; not modelled"};
  Reg lpfr{*this, "LPFR", 0x14, Mode::kRw, "lines per frame as master; not modelled"};

  struct Number15 : Reg {
    using Reg::Reg;
    Field value{*this, "VALUE", 0, 15, Mode::kRw, "number"};
  };
  Number15 sph{*this, "SPH", 0x18, "first sample of a row, from 0 at the sample behind SAV"};
  Number15 lnh{*this, "LNH", 0x1C, "samples of a row minus 1; two samples are a pixel"};
  Number15 slv0{*this, "SLV0", 0x20,
                "first line captured of field 0; line 1 is the first with V=0"};
  Number15 slv1{*this, "SLV1", 0x24, "first line captured of field 1"};
  Number15 lnv{*this, "LNV", 0x28, "lines captured of a field minus 1"};
  Reg culh{*this, "CULH", 0x2C, Mode::kRw, "horizontal culling; not modelled", 0xFFFF};
  Reg culv{*this, "CULV", 0x30, Mode::kRw, "vertical culling; not modelled", 0xFF};

  struct Hsize : Reg {
    using Reg::Reg;
    Field lofst{*this, "HSIZE", 0, 12, Mode::kRw, "line pitch in units of 32 bytes"};
    Field adcr{*this, "ADCR", 12, 1, Mode::kRw, "addresses go down in a line; not modelled"};
  } hsize{*this, "HSIZE", 0x34, "line pitch"};

  struct Sdofst : Reg {
    using Reg::Reg;
    Field lofts3{*this, "LOFTS3", 0, 3, Mode::kRw, "step after an odd line of field 1"};
    Field lofts2{*this, "LOFTS2", 3, 3, Mode::kRw, "step after an even line of field 1"};
    Field lofts1{*this, "LOFTS1", 6, 3, Mode::kRw, "step after an odd line of field 0"};
    Field lofts0{*this, "LOFTS0", 9, 3, Mode::kRw, "step after an even line of field 0"};
    Field fofst{*this, "FOFST", 12, 2, Mode::kRw, "start of field 1: 1 ... 4 lines"};
    Field fiinv{*this, "FIINV", 14, 1, Mode::kRw, "1 swaps the fields' places in memory"};
    /// Number of lines by which the address moves after line i of a field, by a word that was latched: codes 0 to 3
    /// mean +1 to +4, codes 4 to 7 mean -1 to -4.
    int step(std::uint32_t word, bool field, unsigned line) const {
      const Field& f = field ? (line & 1 ? lofts3 : lofts2) : (line & 1 ? lofts1 : lofts0);
      const unsigned code = (word & f.mask()) >> f.lsb();
      return code < 4 ? static_cast<int>(code) + 1 : 3 - static_cast<int>(code);
    }
    /// Rows from the start of the buffer to the first one of the second field.
    int start(std::uint32_t word) const { return static_cast<int>((word & fofst.mask()) >> fofst.lsb()) + 1; }
  } sdofst{*this, "SDOFST", 0x38, "line offsets in memory"};

  struct Cadu : Reg {
    using Reg::Reg;
    Field value{*this, "CADU", 0, 11, Mode::kRw, "address bits 31:21"};
  } cadu{*this, "CADU", 0x3C, "memory address, upper part"};
  struct Cadl : Reg {
    using Reg::Reg;
    Field value{*this, "CADL", 0, 16, Mode::kRw, "address bits 20:5"};
  } cadl{*this, "CADL", 0x40, "memory address, lower part"};

  Number15 vdint0{*this, "VDINT0", 0x70, "line at whose start VDINT0 fires; 0 is VD"};
  Number15 vdint1{*this, "VDINT1", 0x74, "line at whose start VDINT1 fires; 0 is VD"};
  Number15 vdint2{*this, "VDINT2", 0x78, "line at whose start VDINT2 fires; 0 is VD"};
  Reg cgammawd{*this, "CGAMMAWD", 0x80, Mode::kRw, "raw data only; not modelled"};

  struct Rec656if : Reg {
    using Reg::Reg;
    Field r656on{*this, "R656ON", 0, 1, Mode::kRw, "take F, V and H from the embedded codes"};
    Field eccfvh{*this, "ECCFVH", 1, 1, Mode::kRw, "correct single-bit errors of the codes"};
  } rec656if{*this, "REC656IF", 0x84, "BT.656 input"};

  struct Ccdcfg : Reg {
    using Reg::Reg;
    Field sdrpack{*this, "SDRPACK", 0, 2, Mode::kRw, "2: 8 bits a sample; others not modelled"};
    Field ycoutswp{*this, "YCOUTSWP", 2, 1, Mode::kRw, "swap Y and C towards memory"};
    Field ycinswp{*this, "YCINSWP", 4, 1, Mode::kRw, "swap Y and C at the input"};
    Field bw656{*this, "BW656", 5, 1, Mode::kRw, "10-bit input; the upper 8 bits are taken"};
    Field fidmd{*this, "FIDMD", 6, 2, Mode::kRw, "field id: 0 latched at VD", Modelled{0}};
    Field wenlog{*this,      "WENLOG", 8, 1, Mode::kRw, "logic of the external write enable",
                 Modelled{0}};
    Field trgsel{*this, "TRGSEL", 9, 1, Mode::kRw, "trigger source", Modelled{0}};
    Field extrg{*this, "EXTRG", 10, 1, Mode::kRw, "external trigger", Modelled{0}};
    Field y8pos{*this, "Y8POS", 11, 1, Mode::kRw, "1: C Y C Y in memory, 0: Y C Y C (Linux)"};
    Field bswd{*this, "BSWD", 12, 1, Mode::kRw, "swap bytes"};
    Field msbinvi{*this, "MSBINVI", 13, 1, Mode::kRw, "inverts the top bit of chroma at the input"};
    Field msbinvo{*this, "MSBINVO", 14,
                  1,     Mode::kRw, "inverts the top bit of chroma towards memory"};
    Field vdlc{*this, "VDLC", 15, 1, Mode::kRw, "0: settings latch at VD, 1: at once"};
  } ccdcfg{*this, "CCDCFG", 0x88, "data format"};

  Reg clkctl{*this, "CLKCTL", 0x1F8, Mode::kRw, "clock control; kept"};

  IsifRegs() : RegBank("ISIF") {}
  std::uint32_t address() const { return cadu.value.get() << 21 | cadl.value.get() << 5; }
};

}  // namespace fovea::video
