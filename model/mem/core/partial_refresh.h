// Data that a mobile part loses in partial-array self-refresh.
#pragma once
#include "model/common/check.h"
#include "model/common/units.h"
#include "model/mem/core/backing_store.h"
#include "model/mem/core/ddr_config.h"

namespace fovea::mem {

/// The part was in self-refresh for `slept` and kept only the banks, or of bank 0 the rows, with low
/// addresses (SDBCR2.PASR). Longer than `retention`: what it did not refresh is lost, with a warning.
void lose_unrefreshed(const DdrConfig& config, Picoseconds slept, Picoseconds retention, BackingStore& store,
                      const DiagnosticsRef& diagnostics);

}  // namespace fovea::mem
