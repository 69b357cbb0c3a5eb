#include "model/soc/rtl_text.h"

#include <array>
#include <cstdio>

#include "model/common/check.h"
#include "model/engine/core/engine_registers.h"

namespace fovea::soc {
namespace {

template <class... Numbers>
std::string format(const char* how, Numbers... numbers) {
  char text[64];
  std::snprintf(text, sizeof text, how, numbers...);
  return text;
}

const char* name_of(Mode mode) {
  switch (mode) {
    case Mode::kRw: return "rw";
    case Mode::kW1c: return "1 clears";
    case Mode::kWo: return "wo";
    case Mode::kRo: break;
  }
  return "ro";
}

std::string declarations(const Reg& r, std::uint32_t writable) {
  const std::string& name = r.name();
  std::string out = format("  // 0x%02X ", r.offset()) + name + ": " + r.sentence() + "\n";
  out += "  localparam logic [7:0] " + name + format("_WORD = 8'd%u;\n", r.offset() / 4);
  if (r.reset_value())
    out += "  localparam logic [31:0] " + name + format("_RESET = 32'h%08X;\n", r.reset_value());
  if (writable)
    out += "  localparam logic [31:0] " + name + format("_WRITABLE = 32'h%08X;\n", writable);
  for (const Field* f : r.fields())
    out += "  localparam int unsigned " + name + "_" + f->name() + format("_LSB = %u, ", f->lsb()) +
           name + "_" + f->name() + format("_BITS = %u;\n", f->width());
  return out;
}

std::string row(const std::string& first, const std::string& bits, const char* mode,
                const std::string& sentence) {
  return "| " + first + " | " + bits + " | " + mode + " | " + sentence + " |\n";
}

std::string rows(const Reg& r, std::uint32_t writable) {
  const std::string name = format("0x%02X `", r.offset()) + r.name() + "`";
  if (r.fields().empty()) return row(name, "31:0", writable ? "rw" : "ro", r.sentence());
  std::string out;
  for (const Field* f : r.fields()) {
    const unsigned top = f->lsb() + f->width() - 1;
    const std::string bits = f->width() == 1 ? format("%u", top) : format("%u:%u", top, f->lsb());
    const bool alone = r.fields().size() == 1 && f->sentence() == r.sentence();
    const std::string sentence = alone ? f->sentence() : "`" + f->name() + "`: " + f->sentence();
    out += row(f == r.fields().front() ? name : "", bits, name_of(f->mode()), sentence);
  }
  return out;
}

}  // namespace

RtlText rtl_text(RegBank& fresh) {
  RtlText out;
  std::array<std::uint32_t, 8> present{};
  std::string registers;
  for (const Reg* r : fresh.regs()) {
    FOVEA_CHECK(r->offset() < 0x400, "register beyond the address lines of remap_regs: " + r->name());
    const unsigned word = r->offset() / 4;
    present[word / 32] |= 1u << word % 32;
    registers += declarations(*r, r->writable());
    out.table += rows(*r, r->writable());
  }
  out.package =
      "// Registers of the remap engine. Printed by `platform_text remap_regs_pkg.sv` from\n"
      "// model/engine/core/engine_registers.h; do not edit. WORD: number of the register's word; WRITABLE: bits that "
      "keep\n"
      "// what is written.\n"
      "package remap_regs_pkg;\n"
      "  // Bit n: word n is a register.\n"
      "  localparam logic [255:0] PRESENT = 256'h";
  for (unsigned n = 8; n-- > 0;) out.package += format(n ? "%08X_" : "%08X;\n", present[n]);
  out.package += registers + "endpackage\n";
  return out;
}

RtlText rtl_text() {
  engine::EngineRegs fresh;
  return rtl_text(fresh);
}

}  // namespace fovea::soc
