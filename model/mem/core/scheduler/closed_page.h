// `ddr.scheduler = closed_page`: for traffic that seldom comes back to a row.
#pragma once
#include "model/mem/core/scheduler/ti.h"

namespace fovea::mem {

/// As `ti`, but a row is closed with its last column command, unless a queued request wants it.
template <OpenRow kOpenRow>
class ClosedPageScheduler : public TiScheduler<kOpenRow> {
 public:
  static constexpr const char* kName = "closed_page";
  static constexpr bool kClosesRows = true;
};

}  // namespace fovea::mem
