// The slowest request of a port, and what passed between its issue and its outcome.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "model/common/mem_request.h"
#include "model/common/waits.h"

namespace fovea {

/// Where a request is while time passes.
enum class RequestPlace : std::uint8_t {
  kPort,        ///< between its master's port and the crossbar
  kCrossbar,    ///< waits for its turn, or crosses
  kController,  ///< in the SDRAM controller's input register or its FIFOs
  kReturn,      ///< from its column command on: the SDRAM, the way back, the port
};

/// A stretch of time. `culprit` is kCount where it is not known: what was served is remembered for the
/// newest 64 grants of the crossbar and commands of the SDRAM only.
struct RequestStep {
  RequestPlace place;
  Culprit culprit;
  Picoseconds from, to;
};

/// How a read found its row. A write's row matters after its acknowledgement only.
enum class FoundRow : std::uint8_t { kNotKnown, kOpen, kClosed, kOther };

/// A read from its issue to its first beat at the port, or a write to its acknowledgement. The steps
/// follow one another without a gap, and none is empty.
struct SlowRequest {
  Picoseconds issued = 0, latency = 0;  ///< latency 0: there was no request
  std::uint32_t address = 0;
  std::uint32_t row = 0;
  std::uint8_t bank = 0, bytes = 0;
  Master master = Master::kArmD;
  bool write = false;
  FoundRow found = FoundRow::kNotKnown;
  std::vector<RequestStep> steps;

  void begin(const MemRequest& r) {
    issued = r.issued;
    latency = (r.write ? r.last : r.first) - r.issued;
    address = r.address;
    bytes = r.bytes;
    master = r.master;
    write = r.write;
    row = 0;
    bank = 0;
    found = FoundRow::kNotKnown;
    steps.clear();
  }
  Picoseconds end() const { return issued + latency; }
  /// The step that ends at `to`, if anything is left until then. It begins with the end of the one before.
  void until(Picoseconds to, RequestPlace place, Culprit culprit) {
    const Picoseconds from = steps.empty() ? issued : steps.back().to;
    to = std::min(to, end());
    if (to > from) steps.push_back({place, culprit, from, to});
  }
};

/// What the crossbar asks for the rest of the story.
class SlowRequestTeller {
 public:
  virtual ~SlowRequestTeller() = default;
  /// Adds the request's place in the SDRAM and, of a read, the steps until its data are on the crossbar.
  virtual void tell(SlowRequest& s) const = 0;
};

}  // namespace fovea
