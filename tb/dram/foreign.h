// An initiator and a target written from IEEE 1666-2011 (SystemC with TLM-2.0) alone: nothing of Fovea
// is included here.
#pragma once
#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <cstring>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

namespace foreign {

/// One transaction, and what became of it.
struct Job {
  sc_core::sc_time at;
  tlm::tlm_command command = tlm::TLM_READ_COMMAND;
  sc_dt::uint64 address = 0;
  std::vector<unsigned char> data;
  bool byte_enables = false;
  bool ends_at_once = false;  ///< answers BEGIN_RESP with END_RESP, which takes kEarlyEnd
  // outcome
  sc_core::sc_time begin_req, end_req, begin_resp;
  tlm::tlm_response_status status = tlm::TLM_INCOMPLETE_RESPONSE;
};

/// Approximately timed, base protocol, four phases. The next BEGIN_REQ follows the END_REQ of the one
/// before, so that several transactions are under way.
class AtInitiator : public sc_core::sc_module, private tlm::tlm_mm_interface {
 public:
  const sc_core::sc_time kEarlyEnd{300, sc_core::SC_NS};
  tlm_utils::simple_initiator_socket<AtInitiator, 32> socket{"socket"};
  std::deque<Job> jobs;
  unsigned ended = 0, not_released = 0, protocol_errors = 0;

  SC_HAS_PROCESS(AtInitiator);
  explicit AtInitiator(sc_core::sc_module_name name) : sc_module(name) {
    socket.register_nb_transport_bw(this, &AtInitiator::nb_transport_bw);
    SC_THREAD(run);
    SC_METHOD(end_response);
    sensitive << response_;
    dont_initialize();
  }

 private:
  void run() {
    for (Job& job : jobs) {
      if (job.at > sc_core::sc_time_stamp()) wait(job.at - sc_core::sc_time_stamp());
      auto* p = new tlm::tlm_generic_payload(this);
      ++not_released;
      p->acquire();
      p->set_command(job.command);
      p->set_address(job.address);
      p->set_data_ptr(job.data.data());
      p->set_data_length(static_cast<unsigned>(job.data.size()));
      p->set_streaming_width(static_cast<unsigned>(job.data.size()));
      if (job.byte_enables) {
        p->set_byte_enable_ptr(&enable_);
        p->set_byte_enable_length(1);
      }
      p->set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
      open_.push_back({p, &job});
      job.begin_req = sc_core::sc_time_stamp();
      requesting_ = p;
      tlm::tlm_phase phase = tlm::BEGIN_REQ;
      sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
      const tlm::tlm_sync_enum status = socket->nb_transport_fw(*p, phase, delay);
      if (status == tlm::TLM_UPDATED) {
        wait(delay);
        phase_seen(*p, phase);
      } else if (status == tlm::TLM_COMPLETED) {
        ++protocol_errors;  // a memory always has four phases to go through
      }
      while (requesting_) wait(end_request_);
    }
  }
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& p, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    if (delay != sc_core::SC_ZERO_TIME) ++protocol_errors;  // this target annotates nothing
    if (phase == tlm::BEGIN_RESP && sc_core::sc_time_stamp() < early_end_) ++protocol_errors;
    phase_seen(p, phase);
    if (responding_ != &p || !ends_at_once(p)) return tlm::TLM_ACCEPTED;
    response_.cancel();
    responding_ = nullptr;
    end(p);
    phase = tlm::END_RESP;
    delay = kEarlyEnd;
    early_end_ = sc_core::sc_time_stamp() + delay;
    p.release();
    return tlm::TLM_UPDATED;
  }
  void phase_seen(tlm::tlm_generic_payload& p, const tlm::tlm_phase& phase) {
    Job* job = nullptr;
    for (auto& [payload, its] : open_)
      if (payload == &p) job = its;
    if (!job || (phase != tlm::END_REQ && phase != tlm::BEGIN_RESP)) {
      ++protocol_errors;
      return;
    }
    if (requesting_ == &p) {  // BEGIN_RESP implies END_REQ
      requesting_ = nullptr;
      job->end_req = sc_core::sc_time_stamp();
      end_request_.notify();
    } else if (phase == tlm::END_REQ) {
      ++protocol_errors;
    }
    if (phase != tlm::BEGIN_RESP) return;
    if (responding_) ++protocol_errors;  // one response phase at a time
    responding_ = &p;
    job->begin_resp = sc_core::sc_time_stamp();
    job->status = p.get_response_status();
    response_.notify(2, sc_core::SC_NS);  // the initiator takes its time to accept the response
  }
  void end_response() {
    tlm::tlm_generic_payload& p = *responding_;
    responding_ = nullptr;
    end(p);
    tlm::tlm_phase phase = tlm::END_RESP;
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    socket->nb_transport_fw(p, phase, delay);
    p.release();
  }
  bool ends_at_once(const tlm::tlm_generic_payload& p) const {
    for (const auto& [payload, job] : open_)
      if (payload == &p) return job->ends_at_once;
    return false;
  }
  void end(const tlm::tlm_generic_payload& p) {
    ++ended;
    for (auto o = open_.begin(); o != open_.end(); ++o)
      if (o->first == &p) {
        open_.erase(o);
        break;
      }
  }
  void free(tlm::tlm_generic_payload* p) override {
    --not_released;
    p->reset();
    delete p;
  }

  std::deque<std::pair<tlm::tlm_generic_payload*, Job*>> open_;
  tlm::tlm_generic_payload *requesting_ = nullptr, *responding_ = nullptr;
  sc_core::sc_event end_request_, response_;
  sc_core::sc_time early_end_;
  unsigned char enable_ = 0xFF;
};

/// Loosely timed: a memory that annotates its latency, or waits it out every second time.
class LtTarget : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<LtTarget, 32> socket{"socket"};
  const sc_core::sc_time latency;

  LtTarget(sc_core::sc_module_name name, std::size_t bytes, sc_core::sc_time its_latency)
      : sc_module(name), latency(its_latency), memory_(bytes) {
    socket.register_b_transport(this, &LtTarget::b_transport);
  }

 private:
  void b_transport(tlm::tlm_generic_payload& p, sc_core::sc_time& delay) {
    const bool inside = p.get_address() + p.get_data_length() <= memory_.size();
    if (!inside) {
      p.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
      return;
    }
    unsigned char* const at = memory_.data() + p.get_address();
    if (p.is_write())
      std::memcpy(at, p.get_data_ptr(), p.get_data_length());
    else
      std::memcpy(p.get_data_ptr(), at, p.get_data_length());
    if (++calls_ % 2)
      delay += latency;
    else
      wait(latency);
    p.set_response_status(tlm::TLM_OK_RESPONSE);
  }
  std::vector<unsigned char> memory_;
  unsigned calls_ = 0;
};

}  // namespace foreign
