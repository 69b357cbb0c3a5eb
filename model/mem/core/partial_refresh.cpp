#include "model/mem/core/partial_refresh.h"

#include <algorithm>
#include <cstring>

namespace fovea::mem {
namespace {

/// What a cell that lost its charge reads as: any value that is not mistaken for data.
constexpr int kLostByte = 0xA5;

}  // namespace

void lose_unrefreshed(const DdrConfig& config, Picoseconds slept, Picoseconds retention, BackingStore& store,
                      const DiagnosticsRef& diagnostics) {
  if (config.refreshed_log2 == 0 || slept <= retention) return;
  const std::uint64_t page = std::uint64_t{1} << config.page_log2;
  const unsigned banks = config.timing.banks;
  const std::uint64_t rows = store.size() / page / banks;
  const unsigned of_banks = std::min(config.refreshed_log2, 2u);  // 4, 2, 1; then parts of one
  const unsigned kept_banks = std::max(banks >> of_banks, 1u);
  const std::uint64_t kept_rows = rows >> (config.refreshed_log2 - of_banks);
  for (unsigned b = 0; b < banks; ++b)
    for (std::uint64_t r = b < kept_banks ? kept_rows : 0; r < rows; ++r)
      std::memset(store.at(config.bank_on_top ? (b * rows + r) * page : (r * banks + b) * page),
                  kLostByte, page);
  diagnostics.guest("self-refresh of a part of the SDRAM (SDBCR2.PASR) was so long that the rest lost its data");
}

}  // namespace fovea::mem
