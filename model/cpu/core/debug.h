// What a debugger sees of the core: memory through its caches and buffers, without time or effect.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// Memory behind the core's ports, by physical address; accesses take no time.
class DebugMemory {
 public:
  virtual ~DebugMemory() = default;
  /// False: nobody answers at one of these addresses.
  virtual bool debug_read(std::uint32_t pa, std::span<std::uint8_t> to) = 0;
  virtual bool debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) = 0;
};

/// Not for use while the core is inside an instruction other than an SWI.
class CoreDebug {
 public:
  CoreDebug(Core& core, DebugMemory& memory) : core_(core), memory_(memory) {}

  /// Bytes as loads of the core would return them now. Permissions are not asked.
  /// @return false: an address is not mapped or nobody answers; `to` is then undefined
  bool read(std::uint32_t va, std::span<std::uint8_t> to);
  /// Changes every copy: TCM, D-cache, buffers, memory, I-cache, decoded instructions. No line
  /// becomes dirty and none moves, so the program's timing stays what it was.
  bool write(std::uint32_t va, std::span<const std::uint8_t> from);
  /// Physical address by the TLB, or by the tables without filling the TLB.
  std::optional<std::uint32_t> physical(std::uint32_t va);
  std::uint32_t reg(unsigned i) const { return core_.reg(i); }
  /// r15 moves the next instruction; bit 0 of its value is not the state.
  void set_reg(unsigned i, std::uint32_t value);
  std::uint32_t cpsr() const { return core_.cpsr(); }
  /// Changes mode and state as well.
  void set_cpsr(std::uint32_t value);
  std::uint32_t spsr() const { return core_.spsr_[Core::bank(core_.cpsr())]; }
  /// False in user and system mode, which have none.
  bool set_spsr(std::uint32_t value);
  /// A CP15 register that can be read without effect; written, it has those of an MCR, without
  /// time.
  struct SystemRegister {
    const char* name;
    std::uint32_t (*get)(const Core&);
    std::uint32_t number;  ///< opc1, CRn, CRm, opc2: a digit each
  };
  static std::span<const SystemRegister> system_registers();
  std::uint32_t system_register(const SystemRegister& r) const { return r.get(core_); }
  void set_system_register(const SystemRegister& r, std::uint32_t value);
  /// A register of one mode, whether or not that mode is the present one: r8 to r14 of user and FIQ
  /// mode, r13 and r14 of the others, and each SPSR.
  struct BankedRegister {
    const char* name;
    std::uint8_t bank;    ///< of Core::bank()
    std::uint8_t number;  ///< r8 .. r14; kSpsrNumber
  };
  static constexpr std::uint8_t kSpsrNumber = 16;
  static std::span<const BankedRegister> banked_registers();
  std::uint32_t banked_register(const BankedRegister& r) const { return *banked(r); }
  void set_banked_register(const BankedRegister& r, std::uint32_t value) {
    *const_cast<std::uint32_t*>(banked(r)) = value;
  }

  /// What the core has under way at a boundary. Times are 0 if there is none.
  struct Pending {
    Picoseconds data_fill = 0, instruction_fill = 0, operands = 0;  ///< until then
    std::uint32_t data_line = 0, instruction_line = 0;              ///< modified addresses
    unsigned writes = 0, victim_bytes = 0;                          ///< not yet acknowledged
    std::uint32_t victim = 0;
    bool write_on_bus = false;
    std::uint32_t write_address = 0;
    bool irq = false, fiq = false;  ///< the lines
  };
  Pending pending() const;

  /// The instruction word or half-word that the core would fetch at `va`.
  std::optional<Instruction> instruction(std::uint32_t va);

  /// Memory as everybody but the core sees it: without its caches and buffers.
  bool read_behind(std::uint32_t pa, std::span<std::uint8_t> to) {
    return memory_.debug_read(pa, to);
  }
  /// Behind a GuestFailure: mode and pc are again those of the instruction with which it began.
  void back_to_failure();

  /// The core's own time, which may lie ahead of everybody else's.
  Picoseconds now() const { return core_.time(core_.cycle_); }

 private:
  struct Place {
    std::uint32_t pa = 0;
    bool cached = false;  // by the D-cache
  };
  std::optional<Place> place(std::uint32_t mva);
  std::optional<std::uint32_t> table_word(std::uint32_t pa);
  bool read_memory(std::uint32_t pa, std::span<std::uint8_t> to);
  const std::uint32_t* banked(const BankedRegister& r) const;
  void patch_instructions(std::uint32_t mva, std::uint32_t pa, std::span<const std::uint8_t> from);

  Core& core_;
  DebugMemory& memory_;
};

}  // namespace fovea::cpu
