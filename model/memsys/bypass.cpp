#include "model/memsys/bypass.h"

#include <bit>

namespace fovea::memsys {

MemRequest& Bypass::next() {
  unsigned best = 0, best_rank = ~0u;
  for (std::uint32_t set = masters_; set; set &= set - 1) {
    const auto m = static_cast<unsigned>(std::countr_zero(set));
    const unsigned rank = waiting_[m].front()->in_path.priority * 64u + turns_after(last_, m);
    if (rank < best_rank) best = m, best_rank = rank;
  }
  MemRequest& r = *waiting_[best].front();
  waiting_[best].pop_front();
  if (waiting_[best].empty()) masters_ &= ~(1u << best);
  return r;
}

}  // namespace fovea::memsys
