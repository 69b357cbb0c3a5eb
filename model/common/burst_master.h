// A memory master that lives in kernel time: video DMA ports, traffic generators.
#pragma once
#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/common/check.h"
#include "model/common/lookahead.h"
#include "model/common/mem_request.h"

namespace fovea {

inline Picoseconds kernel_now() { return sc_core::sc_time_stamp().value(); }
/// Exact: the kernel resolution is 1 ps (checked at elaboration).
inline sc_core::sc_time to_sc_time(Picoseconds ps) { return sc_core::sc_time::from_value(ps); }

/// Issues bursts of at most kMaxBurstBytes (each aligned to its size, so that none crosses a
/// multiple of it) on one memory master, at the current kernel time, and reports each completion
/// in kernel time at its last beat. Completions of one direction come in order.
class BurstMaster : public sc_core::sc_module {
 public:
  struct Completion {
    std::uint64_t tag;
    bool write, error;
    std::uint32_t address;
    std::span<const std::uint8_t> data;  ///< read data; valid during the call
    Picoseconds issued, first, last;
  };
  tlm_utils::simple_initiator_socket<BurstMaster> socket{"socket"};
  std::function<void(const Completion&)> on_done;

  BurstMaster(sc_core::sc_module_name name, Master id, unsigned max_outstanding)
      : sc_module(name), id_(id), slots_(max_outstanding) {
    SC_HAS_PROCESS(BurstMaster);
    socket.register_nb_transport_bw(this, &BurstMaster::nb_transport_bw);
    for (auto& s : slots_) {
      s = std::make_unique<Slot>();
      s->gp.set_extension(&s->ext);
      s->gp.set_byte_enable_ptr(nullptr);
      s->gp.set_dmi_allowed(false);
    }
    SC_METHOD(deliver);
    sensitive << due_;
    dont_initialize();
  }
  ~BurstMaster() override {
    for (auto& s : slots_) s->gp.clear_extension(&s->ext);
  }

  unsigned outstanding() const { return busy_; }
  bool can_issue() const { return busy_ < slots_.size(); }
  void write(std::uint32_t address, std::span<const std::uint8_t> data, std::uint64_t tag = 0) {
    issue(address, static_cast<unsigned>(data.size()), data.data(), tag);
  }
  void read(std::uint32_t address, unsigned bytes, std::uint64_t tag = 0) {
    issue(address, bytes, nullptr, tag);
  }

 private:
  struct Slot {
    tlm::tlm_generic_payload gp;
    MemExtension ext;
    std::array<std::uint8_t, kMaxBurstBytes> data{};
    std::uint64_t tag = 0;
    bool used = false, decided = false;
    std::uint64_t order = 0;
  };

  void issue(std::uint32_t address, unsigned bytes, const std::uint8_t* data, std::uint64_t tag) {
    FOVEA_CHECK(bytes > 0 && bytes <= kMaxBurstBytes && address % 4 == 0, "bad burst");
    Slot* s = nullptr;
    for (auto& c : slots_)
      if (!c->used) { s = c.get(); break; }
    FOVEA_CHECK(s, "burst issued beyond the outstanding limit");
    s->used = true;
    s->decided = false;
    s->tag = tag;
    s->order = ++issued_count_;
    ++busy_;
    if (data) std::memcpy(s->data.data(), data, bytes);
    s->ext.master = id_;
    s->ext.critical = 0;
    s->ext.issued = kernel_now();
    s->gp.set_command(data ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
    s->gp.set_address(address);
    s->gp.set_data_ptr(s->data.data());
    s->gp.set_data_length(bytes);
    s->gp.set_streaming_width(bytes);
    s->gp.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    tlm::tlm_phase phase = tlm::BEGIN_REQ;
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    socket->nb_transport_fw(s->gp, phase, delay);
  }

  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& gp, tlm::tlm_phase& phase,
                                     sc_core::sc_time&) {
    if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
    for (auto& s : slots_)
      if (&s->gp == &gp) s->decided = true;
    schedule();
    return tlm::TLM_COMPLETED;
  }

  Slot* next_due() {
    Slot* best = nullptr;
    for (auto& s : slots_)
      if (s->used && s->decided &&
          (!best || s->ext.last < best->ext.last ||
           (s->ext.last == best->ext.last && s->order < best->order)))
        best = s.get();
    return best;
  }

  void schedule() {
    if (Slot* s = next_due()) {
      const Picoseconds now = kernel_now();
      due_.notify(to_sc_time(s->ext.last > now ? s->ext.last - now : 0));
      ++horizon_epoch;
    }
  }

  void deliver() {
    while (Slot* s = next_due()) {
      if (s->ext.last > kernel_now()) break;
      const Completion c{s->tag, s->gp.is_write(), s->gp.is_response_error(),
                         static_cast<std::uint32_t>(s->gp.get_address()),
                         {s->data.data(), s->gp.get_data_length()},
                         s->ext.issued, s->ext.first, s->ext.last};
      s->used = s->decided = false;
      --busy_;
      // The slot may be taken again inside the call: hand out a copy of the data.
      const auto data = s->data;
      Completion out = c;
      out.data = {data.data(), c.data.size()};
      if (on_done) on_done(out);
    }
    schedule();
  }

  Master id_;
  std::vector<std::unique_ptr<Slot>> slots_;
  sc_core::sc_event due_;
  unsigned busy_ = 0;
  std::uint64_t issued_count_ = 0;
};

}  // namespace fovea
