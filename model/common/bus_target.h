// Base class of peripherals: a register bank behind a TLM target socket.
#pragma once
#include <tlm_utils/simple_target_socket.h>

#include <cstring>
#include <systemc>
#include <tlm>

#include "model/common/block.h"
#include "model/common/check.h"
#include "model/common/observers.h"
#include "model/common/reg_observer.h"
#include "model/common/regbank.h"

namespace fovea {

/// Holds a block's registers in a base class, so that they are constructed before BusTarget refers to
/// them.
template <class Regs>
struct WithRegs {
  template <class... Args>
  explicit WithRegs(Args&&... args) : regs(std::forward<Args>(args)...) {}
  Regs regs;
};

/// Base class of every peripheral with registers: b_transport reads and writes its register bank.
/// The configuration bus models the latency of the access and calls with local time equal to kernel
/// time, so b_transport neither waits nor adds a delay. The payload's address is the offset in the
/// block; accesses are 1, 2 or 4 bytes. transport_dbg reads one word without side effects.
/// A derived class holds its registers in a WithRegs, named before this base.
class BusTarget : public sc_core::sc_module, public Block {
 public:
  tlm_utils::simple_target_socket<BusTarget> reg_socket{"reg_socket"};
  const RegBank& bank() const { return bank_; }
  RegBank& bank() { return bank_; }
  BusTarget* registers() final { return this; }
  bool gated() const { return !clocked(); }
  /// What gates its clock, for the warning.
  void set_gate(std::string name) { gate_ = std::move(name); }
  void reset(ResetKind kind) override {
    bank_.reset();
    on_reset(kind);
  }
  /// `observer` is called at every access over the bus. It must outlive the Subscription that is returned.
  Subscription observe(RegisterObserver& observer) { return observers_.add(&observer); }

 protected:
  BusTarget(sc_core::sc_module_name name, RegBank& regs) : sc_module(name), bank_(regs) {
    reg_socket.register_b_transport(this, &BusTarget::b_transport);
    reg_socket.register_transport_dbg(this, &BusTarget::transport_dbg);
  }
  /// False while the block's clock is gated: reads then return 0 and writes are lost, each with a
  /// warning.
  virtual bool clocked() const { return true; }
  /// What an access to an offset without a register does. True: reads return 0 and writes are lost,
  /// as in the chip's peripherals. False: a bus error, for a block of which so little is modelled
  /// that software has to notice.
  virtual bool holes_answer() const { return true; }
  /// An access to an offset without a register, where holes answer. True: the block has noted it as the
  /// chip's does, and said so.
  virtual bool hole_accessed(std::uint32_t) { return false; }
  /// Resets what the block keeps beside its registers, which have their reset values by now.
  virtual void on_reset(ResetKind) {}

 private:
  void b_transport(tlm::tlm_generic_payload& gp, sc_core::sc_time&) {
    const auto offset = static_cast<std::uint32_t>(gp.get_address());
    const unsigned bytes = gp.get_data_length();
    Reg* const r = bank_.register_at(offset);
    std::uint32_t word = 0;
    if (!clocked()) {
      diagnostics().guest("access to " + bank_.name() + " while its clock is gated" +
                          (gate_.empty() ? "" : " (" + gate_ + ")"));
      if (gp.is_read()) std::memset(gp.get_data_ptr(), 0, bytes);
      std::memcpy(&word, gp.get_data_ptr(), bytes <= 4 ? bytes : 4);
      if (!observers_.empty()) [[unlikely]]
        report({&bank_, r, offset, bytes, gp.is_write(), true, word});
      gp.set_response_status(tlm::TLM_OK_RESPONSE);
      return;
    }
    Access a;
    if (gp.is_write()) {
      std::memcpy(&word, gp.get_data_ptr(), bytes <= 4 ? bytes : 4);
      if (r && ((word << 8 * (offset & 3u)) & r->reserved())) reserved_written(*r);
      a = RegBank::write(r, offset, bytes, word);
      if (a == Access::kOk && r->limited()) [[unlikely]]
        warn_not_modelled(*r, offset, bytes);
    } else {
      a = RegBank::read(r, offset, bytes, word);
      std::memcpy(gp.get_data_ptr(), &word, bytes <= 4 ? bytes : 4);
    }
    if (a == Access::kNoRegister && !holes_answer()) {
      gp.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
      return;
    }
    if (a == Access::kNoRegister) {
      // The chip's peripherals answer such an offset with 0; only the configuration bus reports
      // errors.
      if (!hole_accessed(offset)) {
        char where[16];
        std::snprintf(where, sizeof where, "0x%x", offset);
        diagnostics().not_modelled(bank_.name() + " register at offset " + where);
      }
      if (gp.is_read()) std::memset(gp.get_data_ptr(), 0, bytes);
      a = Access::kOk;
    }
    if (!observers_.empty() && a == Access::kOk) [[unlikely]]
      report({&bank_, r, offset, bytes, gp.is_write(), false, word});
    gp.set_response_status(a == Access::kOk ? tlm::TLM_OK_RESPONSE : tlm::TLM_BURST_ERROR_RESPONSE);
  }

  [[gnu::noinline]] void report(const RegisterAccess& access) {
    observers_.each([&](RegisterObserver* o) { o->accessed(access); });
  }

  [[gnu::noinline]] void reserved_written(const Reg& r) const {
    char bits[16];
    std::snprintf(bits, sizeof bits, "0x%08x", r.reserved());
    diagnostics().guest("1 written to reserved bits of " + bank_.name() + " " + r.name() + " (" + bits + ")");
  }

  [[gnu::noinline]] void warn_not_modelled(const Reg& r, std::uint32_t offset,
                                           unsigned bytes) const {
    const std::uint32_t lanes = (bytes == 4 ? ~0u : (1u << 8 * bytes) - 1u) << 8 * (offset & 3u);
    for (const std::string& what : r.not_modelled(lanes)) diagnostics().not_modelled(bank_.name() + " " + what);
  }

  unsigned transport_dbg(tlm::tlm_generic_payload& gp) {
    std::uint32_t word = 0;
    if (!gp.is_read() || gp.get_data_length() != 4 ||
        bank_.peek(static_cast<std::uint32_t>(gp.get_address()), word) != Access::kOk)
      return 0;
    std::memcpy(gp.get_data_ptr(), &word, 4);
    return 4;
  }

  RegBank& bank_;
  std::string gate_;  // what gates the clock; empty: not known
  Observers<RegisterObserver*> observers_;
};

}  // namespace fovea
