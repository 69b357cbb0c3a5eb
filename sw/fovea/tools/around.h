// `--around TIME`: the requests to the SDRAM near a time.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/common/mem_observer.h"
#include "model/common/units.h"

namespace fovea::app {

/// All requests to the SDRAM whose time, from issue to last beat, touches the given time +- 2 us, as a master sees
/// them.
class RequestsAround final : public MemObserver {
 public:
  static constexpr Picoseconds kReach = 2 * kPsPerUs;
  RequestsAround(Picoseconds at, std::function<std::string(Master)> name_of)
      : from_(at > kReach ? at - kReach : 0), to_(at + kReach), name_of_(std::move(name_of)) {}
  void submitted(const MemRequest&, bool) override {}
  void responded(const MemRequest& r) override;
  /// master,direction,port,address,bytes,issued_ns,first_ns,last_ns,priority, in the order of their issue.
  std::string csv() const;

 private:
  struct Seen {
    Picoseconds issued, first, last;
    std::uint32_t address;
    Master master;
    std::uint8_t bytes, priority;
    bool write;
  };
  Picoseconds from_, to_;
  std::function<std::string(Master)> name_of_;
  std::vector<Seen> seen_;
};

}  // namespace fovea::app
