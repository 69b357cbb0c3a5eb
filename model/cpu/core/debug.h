// A debugger's view of the core: memory through caches and buffers, without time or side effects.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// Access to the memory behind the core's ports by physical address; takes no simulated time.
class DebugMemory {
 public:
  virtual ~DebugMemory() = default;
  /// Returns false if one of the addresses is not mapped.
  virtual bool debug_read(std::uint32_t pa, std::span<std::uint8_t> to) = 0;
  virtual bool debug_write(std::uint32_t pa, std::span<const std::uint8_t> from) = 0;
};

/// May be used only between instructions, or during an SWI.
class CoreDebug {
 public:
  CoreDebug(Core& core, DebugMemory& memory) : core_(core), view_(core.view()), memory_(memory) {}

  /// Reads the bytes that loads of the core would return now. Access permissions are ignored.
  /// @return false if an address is not translated or not mapped; `to` is then undefined
  bool read(std::uint32_t va, std::span<std::uint8_t> to);
  /// Changes every copy: TCM, D-cache, buffers, memory, I-cache and decoded instructions. No line
  /// becomes dirty or is moved, so that the timing of the program stays the same.
  bool write(std::uint32_t va, std::span<const std::uint8_t> from);
  /// Physical address according to the TLB or, without filling the TLB, to the page tables.
  std::optional<std::uint32_t> physical(std::uint32_t va);
  std::uint32_t reg(unsigned i) const { return core_.reg(i); }
  /// Writing r15 chooses the next instruction; bit 0 of the value does not select the Thumb state.
  void set_reg(unsigned i, std::uint32_t value) {
    i == 15 ? core_.redirect(value) : core_.set_reg(i, value);
  }
  std::uint32_t cpsr() const { return core_.cpsr(); }
  /// Changes mode and Thumb state too.
  void set_cpsr(std::uint32_t value) { core_.change_status(value); }
  std::uint32_t spsr() const {
    return view_.registers.spsr(RegisterFile::bank(view_.registers.cpsr));
  }
  /// Returns false in user and system mode, which have no SPSR.
  bool set_spsr(std::uint32_t value);
  /// A CP15 register that can be read without side effects. Writing it has the side effects of an
  /// MCR, but takes no time.
  struct SystemRegister {
    const char* name;
    std::uint32_t SystemRegisters::*value;
    std::uint32_t number;  ///< hexadecimal digits: opc1, CRn, CRm, opc2
  };
  static std::span<const SystemRegister> system_registers();
  std::uint32_t system_register(const SystemRegister& r) const {
    return view_.system.*r.value;
  }
  void set_system_register(const SystemRegister& r, std::uint32_t value) {
    core_.change_system_register(r.number, value);
  }
  /// A register of one mode, whether or not the core is in it: r8 to r14 of user and FIQ mode, r13
  /// and r14 of the other modes, and each SPSR.
  struct BankedRegister {
    const char* name;
    std::uint8_t bank;    ///< result of RegisterFile::bank()
    std::uint8_t number;  ///< r8 to r14, or kSpsrNumber
  };
  static constexpr std::uint8_t kSpsrNumber = 16;
  static std::span<const BankedRegister> banked_registers();
  std::uint32_t banked_register(const BankedRegister& r) const {
    return r.number == kSpsrNumber ? view_.registers.spsr(r.bank)
                                   : view_.registers.banked(r.bank, r.number);
  }
  void set_banked_register(const BankedRegister& r, std::uint32_t value) {
    if (r.number == kSpsrNumber)
      core_.change_spsr(r.bank, value);
    else
      core_.change_banked(r.bank, r.number, value);
  }

  /// Unfinished work of the core at an instruction boundary. Times and addresses are 0 if there is
  /// none.
  struct Pending {
    Picoseconds data_fill = 0, instruction_fill = 0, operands = 0;  ///< when each of them ends
    std::uint32_t data_line = 0, instruction_line = 0;              ///< modified virtual addresses
    unsigned writes = 0, victim_bytes = 0;                          ///< without acknowledgement so
                                                                    ///< far
    std::uint32_t victim = 0;
    bool write_on_bus = false;
    std::uint32_t write_address = 0;
    bool irq = false, fiq = false;  ///< levels of the interrupt lines
  };
  Pending pending() const;

  /// The instruction that the core would fetch at `va`.
  std::optional<Instruction> instruction(std::uint32_t va);

  /// Reads memory as other masters see it: without the core's caches and buffers.
  bool read_behind(std::uint32_t pa, std::span<std::uint8_t> to) {
    return memory_.debug_read(pa, to);
  }
  /// After a GuestFailure: restores mode and pc of the instruction with which the failure began.
  void back_to_failure() { core_.back_to_failure(); }

  /// The core's own time, which may be ahead of the other agents.
  Picoseconds now() const { return core_.boundary_time(); }

 private:
  struct Mapping {
    std::uint32_t pa = 0;
    bool cached = false;  // cacheable by the D-cache
  };
  std::optional<Mapping> mapping(std::uint32_t mva);
  bool read_memory(std::uint32_t pa, std::span<std::uint8_t> to);

  Core& core_;      // changed through its own functions
  CoreView view_;
  DebugMemory& memory_;
};

}  // namespace fovea::cpu
